"""Eight makes of drives, and what the logger of each writes: columns, their units, digits and steps."""

from __future__ import annotations

import math
from dataclasses import dataclass

DEGREE = math.pi / 180
RPM = math.pi / 30


@dataclass(frozen=True)
class Column:
    """A column of a log.

    Attributes:
        channel: what it holds, as ``fricmodels --column`` calls it.
        header: its first line. A unit that does not stand there stands behind it in ``--column``.
        scale: SI units in its unit.
        decimals: digits behind the point.
        step: to which values are rounded, in its unit; 0 is none but the digits.
        told: whether ``--column`` is needed.
    """

    channel: str
    header: str
    scale: float = 1.0
    decimals: int = 4
    step: float = 0.0
    told: bool = True
    unit: str = ""

    @property
    def option(self) -> str:
        """What ``--column`` is told."""
        return f"{self.channel}={self.header}" + (f":{self.unit}" if self.unit else "")


@dataclass(frozen=True)
class Make:
    """A drive with its controller and its logger, in SI units of the recorded motion.

    Attributes:
        inertia, coulomb, viscous: J [kg m² or kg], K_c [N m or N], K_v [N m s/rad or N s/m].
        speed, travel: peak speed and travel of its motions.
        resolution: of the encoder.
        control_rate, log_rate: of the controller and of the logger [Hz].
        bandwidth: of the speed loop [Hz].
        speed_low_pass: corner of the low-pass through which the speed is logged and controlled [Hz].
        torque_noise: standard deviation.
        torque_time: time constant of the torque loop [s].
        torque_limit: of the controller.
        time, position, velocity, torque: the columns of its log.
        torque_constant: by which a current becomes a torque [N m/A]; a torque is logged where there is none.
        linear: whether it moves along a line.
    """

    name: str
    inertia: float
    coulomb: float
    viscous: float
    speed: float
    travel: float
    resolution: float
    control_rate: float
    log_rate: float
    bandwidth: float
    speed_low_pass: float
    torque_noise: float
    torque_time: float
    torque_limit: float
    time: Column
    position: Column
    velocity: Column
    torque: Column
    torque_constant: float | None = None
    linear: bool = False

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of its log, in order."""
        return self.time, self.position, self.velocity, self.torque


_SECONDS = Column("time", "time_s", told=False)
_MILLISECONDS = Column("time", "time [ms]", 1e-3, 0)

COBOT = Make(  # a joint of a collaborative robot with a harmonic drive, on the side of the link
    name="collaborative robot joint", inertia=1.6, coulomb=9.0, viscous=9.0, speed=1.8, travel=4.0,
    resolution=2 * math.pi / 2**17, control_rate=1000.0, log_rate=500.0, bandwidth=12.0, speed_low_pass=200.0,
    torque_noise=0.6, torque_time=5e-4, torque_limit=150.0, torque_constant=13.0,
    time=Column("time", "timestamp_s"),
    position=Column("position", "actual_q_rad", decimals=7),
    velocity=Column("velocity", "actual_qd_rad_s", decimals=6),
    torque=Column("current", "actual_current_A"),
)  # fmt: skip
ARM = Make(  # a joint of a research arm with a torque sensor
    name="research arm joint", inertia=0.65, coulomb=0.9, viscous=0.45, speed=1.8, travel=4.0,
    resolution=2 * math.pi / 2**19, control_rate=1000.0, log_rate=1000.0, bandwidth=15.0, speed_low_pass=300.0,
    torque_noise=0.04, torque_time=3e-4, torque_limit=87.0,
    time=Column("time", "t_s"),
    position=Column("position", "q [rad]", decimals=7),
    velocity=Column("velocity", "dq [rad/s]", decimals=6),
    torque=Column("torque", "tau_J [Nm]", decimals=5),
)  # fmt: skip
SERVO = Make(  # a hobby servo on a bus, which counts positions, steps of the speed and of the current
    name="bus servo", inertia=0.012, coulomb=0.16, viscous=0.05, speed=4.0, travel=4.0,
    resolution=2 * math.pi / 4096, control_rate=1000.0, log_rate=100.0, bandwidth=4.0, speed_low_pass=25.0,
    torque_noise=0.006, torque_time=1e-3, torque_limit=4.0, torque_constant=1.78,
    time=Column("time", "time_ms", 1e-3, 0),
    position=Column("position", "present_position", 2 * math.pi / 4096, 0, 1.0, unit="count/4096"),
    velocity=Column("velocity", "present_velocity_rpm", RPM, 3, 0.229),
    torque=Column("current", "present_current_mA", 1e-3, 2, 2.69),
)  # fmt: skip
MOTOR = Make(  # a small motor with an encoder of 500 lines
    name="small motor", inertia=3.1e-5, coulomb=6e-3, viscous=1.1e-5, speed=300.0, travel=400.0,
    resolution=2 * math.pi / 2000, control_rate=1000.0, log_rate=1000.0, bandwidth=12.0, speed_low_pass=120.0,
    torque_noise=3e-4, torque_time=3e-4, torque_limit=0.5, torque_constant=0.0603,
    time=_MILLISECONDS,
    position=Column("position", "Position [deg]", DEGREE, 2),
    velocity=Column("velocity", "Velocity [rpm]", RPM, 0, 1.0),
    torque=Column("current", "Current [mA]", 1e-3, 0, 1.0),
)  # fmt: skip
SCREW = Make(
    name="ball screw axis", inertia=900.0, coulomb=160.0, viscous=420.0, speed=0.3, travel=0.6,
    resolution=1e-6, control_rate=4000.0, log_rate=2000.0, bandwidth=20.0, speed_low_pass=400.0,
    torque_noise=8.0, torque_time=3e-4, torque_limit=4000.0, linear=True,
    time=Column("time", "time_s", decimals=5, told=False),
    position=Column("position", "pos_mm", 1e-3, 3),
    velocity=Column("velocity", "vel [mm/s]", 1e-3, 3),
    torque=Column("force", "force_N", decimals=1),
)  # fmt: skip
DIRECT = Make(
    name="direct drive", inertia=0.021, coulomb=0.3, viscous=0.03, speed=12.0, travel=12.0,
    resolution=2 * math.pi / 2**20, control_rate=2000.0, log_rate=1000.0, bandwidth=25.0, speed_low_pass=400.0,
    torque_noise=0.01, torque_time=3e-4, torque_limit=12.0,
    time=_SECONDS,
    position=Column("position", "theta_deg", DEGREE, 5),
    velocity=Column("velocity", "omega [deg/s]", DEGREE, 3),
    torque=Column("torque", "torque_Nm", told=False),
)  # fmt: skip
BELT = Make(
    name="belt axis", inertia=4.2e-4, coulomb=0.085, viscous=4e-4, speed=150.0, travel=120.0,
    resolution=2 * math.pi / 10000, control_rate=1000.0, log_rate=250.0, bandwidth=12.0, speed_low_pass=150.0,
    torque_noise=0.004, torque_time=5e-4, torque_limit=3.0,
    time=Column("time", "time_s", decimals=3, told=False),
    position=Column("position", "pos_deg", DEGREE, 3),
    velocity=Column("velocity", "speed [rpm]", RPM, 2),
    torque=Column("torque", "torque_Nm", told=False),
)  # fmt: skip
HYDRAULIC = Make(
    name="hydraulic axis", inertia=500.0, coulomb=650.0, viscous=8000.0, speed=0.12, travel=0.7,
    resolution=5e-6, control_rate=1000.0, log_rate=100.0, bandwidth=4.0, speed_low_pass=15.0,
    torque_noise=25.0, torque_time=2e-3, torque_limit=9000.0, linear=True,
    time=Column("time", "time_s", decimals=3, told=False),
    position=Column("position", "pos_mm", 1e-3, 3),
    velocity=Column("velocity", "vel [mm/s]", 1e-3, 3),
    torque=Column("force", "force [kN]", 1e3, 3),
)  # fmt: skip

LOAD = Column("load_force", "load_N", decimals=1)
TEMPERATURE = Column("temperature", "oil_degC", decimals=2)
