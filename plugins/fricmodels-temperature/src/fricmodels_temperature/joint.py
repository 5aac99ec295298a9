"""A joint of an industrial robot: friction over speed at several loads and temperatures, and its measurement.

``python -m fricmodels_temperature.joint`` prints the curves and what is found again from simulated measurements.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.estimator import Estimator
from fricmodels.fit import Fit
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels_temperature.law import BittencourtGunnarsson, FreeExponent
from fricmodels_temperature.printed import EXPONENT, MOTOR_SIDE

Array: TypeAlias = NDArray[np.float64]

INERTIA = 1e-5
TEMPERATURES = (30.0, 40.0, 50.0, 60.0, 70.0, 80.0)
"""Of the joint while it is measured [°C]."""
LOADS = (0.0, 0.2, 0.45, 0.7)
"""Load torques, in units of the largest torque."""
SPEEDS = (1.0, 2.5, 5.0, 9.0, 15.0, 25.0, 40.0, 65.0, 100.0, 150.0, 210.0, 280.0)
"""At which the friction is measured, forward and backward [rad/s]."""
_INTERVAL = 0.01
_PLATEAU, _CHANGE = 40, 20
"""Samples at one speed, and from one to the next."""


def drive(model: Model | None = None) -> Drive:
    """Return the joint with a friction model; with the law of this distribution where none is given."""
    return Drive(model or Model(BittencourtGunnarsson()), INERTIA)


def friction(
    speed: Array,
    load: float,
    temperature: float,
    values: Mapping[str, float] = MOTOR_SIDE,
    model: Model | None = None,
) -> Array:
    """Return the friction torque at constant speeds, shape (N,).

    Args:
        speed: [rad/s], shape (N,).
        load: load torque, in units of the largest torque.
        temperature: [°C].
        values: parameters of the law.
        model: another friction model than the law of the source.
    """
    return drive(model).friction(_states(speed, load, temperature, "curve"), values)


def _states(speed: Array, load: float, temperature: float, name: str, run: int = 0) -> Recording:
    steady = {"torque": 0.0, "load_torque": load, "temperature": temperature}
    channels = {key: np.full(len(speed), value, dtype=np.float64) for key, value in steady.items()}
    time = _INTERVAL * np.arange(len(speed), dtype=np.float64)
    return Recording(name, Motion.ROTARY, {"time": time, "velocity": speed, **channels}, np.full(len(speed), run))


def speed_of_least_friction(load: float, temperature: float, values: Mapping[str, float] = MOTOR_SIDE) -> float:
    """Return the speed [rad/s] at which the friction is least: the end of mixed lubrication."""
    speeds = np.geomspace(0.5, 400.0, 4000)
    return float(speeds[np.argmin(friction(speeds, load, temperature, values))])


def measurement(
    *, noise: float = 0.002, seed: int = 0, values: Mapping[str, float] = MOTOR_SIDE, model: Model | None = None
) -> Recording:
    """Simulate how friction is measured: steps of constant speed at every load and temperature, in both directions.

    Args:
        noise: standard deviation of the measured torque, in units of the largest torque.
        seed: of the noise.
        values: parameters of the law.
        model: another friction model than the law of the source.
    """
    rng = np.random.default_rng(seed)
    knots = np.cumsum([0, *([_PLATEAU, _CHANGE] * len(SPEEDS))[:-1]])
    stair = np.interp(np.arange(knots[-1] + 1), knots, np.repeat(SPEEDS, 2))
    parts = [
        _states(direction * stair, direction * load, temperature, "steps of speed", run)
        for run, (temperature, load, direction) in enumerate(product(TEMPERATURES, LOADS, (1.0, -1.0)))
    ]
    channels = {key: np.concatenate([part[key] for part in parts]) for key in parts[0].channels}
    run = np.concatenate([part.run for part in parts])
    steps = Recording("steps of speed", Motion.ROTARY, channels, run)
    acceleration = np.concatenate([np.gradient(part.velocity, _INTERVAL) for part in parts])
    torque = INERTIA * acceleration + steps.load_torque + drive(model).friction(steps, values)
    return steps.with_channels(torque=torque + noise * rng.standard_normal(len(torque)), derived=False)


def identify(recording: Recording, model: Model | None = None) -> Fit:
    """Return the parameters that the batch estimator finds."""
    batch: type[Estimator] = plugins.load().estimators["batch"]
    return batch(batch.Settings.model_validate({"velocity": "measured"})).fit(drive(model), recording, seed=0)


def average_error(recording: Recording, fit: Fit, model: Model | None = None) -> float:
    """Return the mean absolute error of the friction torque at constant speed, measured less modelled."""
    steady = np.isin(np.abs(recording.velocity), SPEEDS)
    measured = recording.torque - recording.load_torque
    return float(np.mean(np.abs(measured - drive(model).friction(recording, fit.parameters))[steady]))


def main(loads: Sequence[float] = (0.0, 0.7)) -> None:
    """Print curves, their least friction, and what is identified."""
    shown = np.array([1.0, 5.0, 15.0, 40.0, 100.0, 280.0])
    print("| load | °C | " + " | ".join(f"{speed:g} rad/s" for speed in shown) + " | least at |")
    print("|---" * (3 + len(shown)) + "|")
    for load in loads:
        for temperature in TEMPERATURES[::2]:
            cells = " | ".join(f"{value:.3f}" for value in friction(shown, load, temperature))
            least = speed_of_least_friction(load, temperature)
            print(f"| {load:g} | {temperature:g} | {cells} | {least:.0f} rad/s |")
    recording = measurement()
    fit = identify(recording)
    print("\n| parameter | true | found |\n|---|---|---|")
    for key, true in MOTOR_SIDE.items():
        print(f"| {key} | {true:g} | {fit.parameters[key]:.4g} ± {fit.standard_errors[key]:.1g} |")
    free = Model(FreeExponent())
    fit_of_exponent = identify(recording, free)
    found, error = fit_of_exponent.parameters["alpha"], fit_of_exponent.standard_errors["alpha"]
    print(f"\nexponent, where it is estimated too: {found:.4g} ± {error:.1g}, true {EXPONENT}")
    standard, again = Model.parse("coulomb-viscous+stribeck"), measurement(seed=1)
    plain = average_error(again, identify(recording, standard), standard)
    print(f"\naverage error of another measurement: Stribeck law {plain:.4f}, this law {average_error(again, fit):.4f}")


if __name__ == "__main__":
    main()
