"""Good recordings: simulated drives with any hidden effect and any sensor, and real ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.rig import random_rig
from fricmodels.rig.effects import HIDDEN
from fricmodels.signals.lanczos import lanczos_derivative
from fricmodels.simulation import simulate

DATA = Path(__file__).parent.parent.parent.parent / "shared" / "data"


@dataclass(frozen=True)
class Good:
    """A good recording, its inertia if that is known, and what may rightly be said of it."""

    name: str
    recording: Recording
    inertia: float | None = None
    allowed: frozenset[str] = frozenset()


def rigs(count: int, seed: int) -> Iterator[Good]:
    """Yield drives with nothing, one or two hidden effects, each with sensors of its own."""
    names = list(HIDDEN)
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        hidden = [str(name) for name in rng.choice(names, number % 3, replace=False)]
        samples = int(rng.choice([6000, 12_000, 20_000]))
        try:
            rig = random_rig(rng, hidden, samples=samples)
            sensors = {}
            turn = 2 * np.pi if rig.motion == "rotary" else 0.02
            if rng.random() < 0.4:
                sensors["encoder_step"] = turn / 2 ** int(rng.integers(14, 21))
            if rng.random() < 0.5:
                sensors["torque_noise_percent"] = float(rng.uniform(0.1, 3.0))
            if rng.random() < 0.2:
                sensors["jitter_percent"] = float(rng.uniform(5.0, 50.0))
            kind = rng.choice(["both", "both", "both", "velocity", "position", "derived"])
            sensors |= {"velocity": "none"} if kind in ("position", "derived") else {}
            sensors |= {"position": False} if kind == "velocity" else {}
            recording = rig.model_copy(update={"sensors": rig.sensors.model_copy(update=sensors)}).simulate()
        except FricmodelsError:
            continue
        if kind == "derived":  # the logger's own smooth difference, written as if measured
            velocity = lanczos_derivative(recording.time, recording["position"], 8, recording.run)[1]
            recording = replace(recording, channels={**recording.channels, "velocity": velocity})
        words = "+".join(hidden) or "nothing hidden"
        allowed = frozenset({"torque-delay", "velocity-lag"} if "sensor-delay" in hidden else ())
        known = {key: value for key, value in recording.provenance.items() if key == "source"}
        inertia = None if "inertia-error" in hidden or "torque-gain" in hidden else rig.inertia
        yield Good(f"rig {number}: {words}, {kind}", replace(recording, provenance=known), inertia, allowed)


def simulations(count: int, seed: int) -> Iterator[Good]:
    """Yield drives under an open-loop torque, by :mod:`fricmodels.simulation`."""
    for number in range(count):
        rng = np.random.default_rng([seed, number, 1])
        law = ["coulomb-viscous", "coulomb-viscous+cogging", "exponential-stick-slip"][number % 3]
        drive = Drive(Model.parse(law))
        values = {drive.inertia_key: 10 ** rng.uniform(-3, 0.5)}
        coulomb = 5.0 * values[drive.inertia_key]
        sizes = {"K_v": coulomb / 4, "K_c": coulomb, "C": 0.7 * coulomb, "B": 2.0, "a": 0.1 * coulomb, "b": 0.0}
        for parameter in drive.parameters:
            values.setdefault(parameter.key, {**sizes, "k": 8.0}.get(parameter.key, 0.0))
        time = np.arange(8000) * 2e-3
        frequencies, phases = rng.uniform(1.0, 8.0, 3), rng.uniform(0, 2 * np.pi, 3)
        torque = sum(1.5 * coulomb * np.sin(f * time + p) for f, p in zip(frequencies, phases, strict=True))
        recording = simulate(
            drive, values, time, torque, noise=float(rng.uniform(0.2, 3.0)), seed=number, with_position=bool(number % 2)
        )
        yield Good(f"simulation {number}: {law}", replace(recording, provenance={}), values[drive.inertia_key])


def real() -> Iterator[Good]:
    """Yield the real recordings beside the project, one a joint."""
    if not DATA.is_dir():
        return
    for name in ("emps_id", "emps_pulses"):
        yield _real(name, DATA / "emps" / f"{name}.csv", ["time=t", "force=force_N", "position=pos_m"])
    for joint in range(1, 7):
        file = DATA / "tx40" / "tx40_joint_200Hz_with_derived_rigid.csv"
        columns = [f"torque=torque{joint}_Nm", f"velocity=vel{joint}_rads", f"position=pos{joint}_rad"]
        yield _real(f"tx40 joint {joint}, 200 Hz", file, ["time=t", *columns])
    for joint in range(1, 7):
        file = DATA / "tx40" / "tx40_raw_5kHz.parquet"
        columns = [f"torque=motor_torque{joint}", f"position=motor_pos{joint}_rad"]
        yield _real(f"tx40 motor {joint}, 5 kHz", file, ["time=t", *columns])
    for trajectory in "ABC":
        for joint in range(1, 7):
            file = DATA / "kuka_kr300" / f"kr300_traj{trajectory}_250Hz.csv"
            columns = [f"torque=motor_torque{joint}_Nm", f"velocity=vel{joint}_rads", f"position=pos{joint}_rad"]
            yield _real(f"kuka {trajectory} joint {joint}", file, ["time=t", *columns])
    constants = (1.0, 13.6, 13.6, -8.7, -8.7, -20.5968, -20.5968, -20.5968)
    for joint, constant in zip(("torso_lift", *(f"arm_{k}" for k in range(1, 8))), constants, strict=True):
        file = DATA / "tiago" / "tiago_torso_arm_100Hz.csv"
        columns = [f"current={joint}_effort:A", f"velocity={joint}_velocity", f"position={joint}_position"]
        yield _real(f"tiago {joint}", file, ["time=t", *columns], constant)
    laas = ["time=Time", "current=Iq:A", "velocity=Velocity", "position=Position"]
    for name in ("speed_loop_500Hz", "acceleration_1kHz"):
        yield _real(f"laas {name}", DATA / "laas_motor" / f"{name}.csv", laas, 0.0318)


def _real(name: str, file: Path, columns: list[str], constant: float | None = None) -> Good:
    return Good(name, read(file, columns=columns, torque_constant=constant))
