"""The servo on the bench as what drives a simulation: its firmware, its motor, and the pendulum that it swings."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np

from fricmodels import Recording
from fricmodels.dimension import Motion
from fricmodels.expressions import Expression, sin
from fricmodels.loop import Loop
from fricmodels.parameter import Parameter
from fricmodels.term import Parameters, Signals
from fricmodels_bam.bench import CONTROL_GAIN, GRAVITY, LENGTH, MASS, STEP

GOAL, ENABLED, GAIN, SUPPLY = (f"other.{name}" for name in ("goal", "enabled", "gain", "supply"))
IDLE = "other.idle_supply"
_IDLE_TIME = 0.2
"""The motor is idle for so long at the beginning of each log [s]."""


class Firmware(Loop):
    r"""The position controller of the servo, its motor under a voltage, and the pendulum.

    .. math::
        \tau_m = \epsilon\,\frac{k_t}{R}\big(U\,\operatorname{clip}(c\,K_p\,(q_r - q), \pm 1) - k_t\omega\big), \qquad
        \tau_L = m g l \sin(q + q_0)

    with the constant c of the firmware, gain K_p, supply voltage U, and ε = 0 while the torque is switched off.

    Source: Duclusaud et al. (2025), and the authors' program.
    """

    name = "xl330-firmware"
    exam: ClassVar = {"channels": {ENABLED: 1.0, GAIN: 100.0, SUPPLY: 7.5}}
    channels = (GOAL, ENABLED, GAIN, SUPPLY)
    load: ClassVar[bool] = True
    k_t = Parameter("k_t", unit="N m", initial=0.4, lower=0.05, upper=5.0, meaning="torque constant [N m/A]")
    R = Parameter("R", initial=4.0, lower=0.5, upper=50.0, meaning="resistance [Ω]")
    q_offset = Parameter("q_offset", initial=0.0, lower=-0.2, upper=0.2, meaning="angle of the pendulum's zero [rad]")

    def motor_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque of the motor: none where it is switched off."""
        return s[ENABLED] * p.k_t / p.R * (s[SUPPLY] * duty(s) - p.k_t * s.velocity)

    def load_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the weight of the pendulum."""
        return MASS * GRAVITY * LENGTH * sin(s.position + p.q_offset)


class SaggingSupply(Firmware):
    r"""The same with a supply, wires and bridge of a resistance of their own.

    While the bridge is on, which it is for a share D of the time, the motor's current flows through them too:

    .. math:: D\,(U_0 - R_s i) = R\,i + k_t\omega \quad\Rightarrow\quad
              i = \frac{D U_0 - k_t\omega}{R\,(1 + \rho\,|D|)}, \qquad \rho = R_s/R

    U_0 is the voltage of the idle supply: what the servo reads while it works is of either phase of the bridge, and has
    the sag in it already.
    """

    name = "xl330-sagging-supply"
    exam: ClassVar = {"channels": {ENABLED: 1.0, GAIN: 100.0, IDLE: 7.5}}
    channels = (GOAL, ENABLED, GAIN, IDLE)
    rho = Parameter("rho", initial=0.3, lower=0.0, upper=5.0, meaning="resistance of the supply, of the motor's")

    def motor_torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque of the motor: none where it is switched off."""
        import casadi

        on = duty(s)
        resistance = p.R * (1 + p.rho * casadi.fabs(on))
        return s[ENABLED] * p.k_t / resistance * (s[IDLE] * on - p.k_t * s.velocity)


def duty(s: Signals) -> Expression:
    """Return the duty cycle that the firmware asks for."""
    import casadi

    return casadi.fmax(-1, casadi.fmin(1, CONTROL_GAIN * s[GAIN] * (s[GOAL] - s.position)))


def recorded(path: Path, step: float = STEP) -> Recording:
    """Return the logs of the bench as one recording on an even grid, each log a run of it, in order of their names.

    The motor torque was not measured: the channel is zero, and the firmware says it. ``provenance["runs"]`` has the
    number of each log by ``TRAJECTORY/GAIN``.

    Args:
        path: as of :func:`fricmodels_bam.bench.read_logs`. step: of the grid [s]; the source's if not given.
    """
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    parts, called = [], {}
    for number, name in enumerate(np.unique(table["log"])):
        rows = table[table["log"] == name]
        time = rows["t"].astype(float)
        grid = np.arange(time[0], time[-1], step)
        channels = {
            "time": grid,
            "torque": np.zeros(len(grid)),
            "position": np.interp(grid, time, rows["pos_rad"]),
            GOAL: np.interp(grid, time, rows["goal_pos_rad"]),
            ENABLED: (np.interp(grid, time, rows["torque_enable"]) > 0.5).astype(float),
            GAIN: np.full(len(grid), float(rows["kp"][0])),
            SUPPLY: np.interp(grid, time, rows["vin_V"]),
            IDLE: np.full(len(grid), float(np.median(rows["vin_V"][time < time[0] + _IDLE_TIME]))),
        }
        called[f"{rows['trajectory'][0]}/{rows['kp'][0]}"] = number
        parts.append((number, channels))
    joined = {name: np.concatenate([channels[name] for _, channels in parts]) for name in parts[0][1]}
    run = np.concatenate([np.full(len(channels["time"]), number) for number, channels in parts])
    return Recording("XL330", Motion.ROTARY, joined, run.astype(np.int64), provenance={"runs": called})
