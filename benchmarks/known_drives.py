"""Recordings of drives whose truth is known, one kind a cell, for :mod:`coverage_matrix`."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping
from dataclasses import astuple, dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.rig.sensors import quantised
from fricmodels.simulation import simulate

SECONDS = 12.0
NOISE = 0.01
"""Standard deviation of the velocity noise over the RMS velocity."""
AUTOREGRESSION = 0.98
INERTIA = 1.8
LAW = {"K_v": 6.0, "K_c": 9.0}
RIG_EFFECTS: Mapping[str, dict[str, Any]] = {
    "cogging": {"harmonics": [{"order": 9.0, "amplitude": 2.0, "phase": 0.6}]},
    "stribeck": {"rise": 4.0, "speed": 0.15, "exponent": 1.0},
    "gravity": {"sine": 3.0, "cosine": 1.5},
    "presliding": {"kind": "dahl", "width": 0.01, "damping_ratio": 0.0},
}
TRUTH: Mapping[str, dict[str, float]] = {
    "cogging": {"a": 2.0 * math.cos(0.6), "b": -2.0 * math.sin(0.6), "a_2": 0.0, "b_2": 0.0, "k": 9.0},
    "stribeck": {"F_s": 4.0, "omega_s": 0.15, "delta": 1.0},
    "gravity": {"a": 1.5, "b": 3.0},
    "presliding": {"F_1": 9.0, "F_2": 9.0, "D": 0.0, "x_s": 0.01},
}
CLOSED = {"bandwidth": 6.0, "damping_ratio": 0.8}
MOVES = {"kind": "trapezoid", "velocity": 1.5, "acceleration": 6.0, "span": 2.0, **CLOSED}
MOTIONS: Mapping[str, dict[str, Any]] = {
    "multisine": {"kind": "multisine", "amplitude": 24.0, "frequency": 0.3, "lines": 6},
    "sine": {"kind": "sine", "amplitude": 20.0, "frequency": 0.5},
    "point-to-point": {**MOVES, "rests": (0.1, 0.6)},
    "trapezoid": {**MOVES, "rests": (0.001, 0.002)},
}
TURN = 2 * math.pi


@dataclass(frozen=True)
class Cell:
    """One kind of recording, and the model and inertia with which it is fitted.

    Attributes:
        source: who simulates it; ``simulate`` replays the torque of the rig. torque: between samples.
        noise: of the velocity, white or coloured (AR 0.98) or rounded to a step, each of 1 % of its RMS value; with
            positions only, counts of a turn.
        rate: samples per second. motion: one of :data:`MOTIONS`. inertia: given or estimated.
        effect: one of :data:`TRUTH`, or none.
    """

    source: str = "rig"
    torque: str = "held"
    noise: str = "white"
    rate: int = 1000
    motion: str = "multisine"
    inertia: str = "given"
    effect: str = "none"

    @property
    def name(self) -> str:
        """What it is called, and what its random numbers come from."""
        return "/".join(str(value) for value in astuple(self))

    @property
    def drive(self) -> Drive:
        """The true model, with its inertia if that is given."""
        return _drive(self.effect, INERTIA if self.inertia == "given" else None)

    @property
    def truth(self) -> dict[str, float]:
        """True value of each parameter."""
        effect = TRUTH.get(self.effect, {})
        return {"J": INERTIA, **LAW, **{f"{self.effect}.{symbol}": value for symbol, value in effect.items()}}

    @property
    def counts(self) -> int | None:
        """Counts a turn of the encoder, where only positions are recorded."""
        return int(self.noise.removeprefix("encoder-")) if self.noise.startswith("encoder-") else None

    def recording(self, number: int) -> Recording:
        """Return the recording of one replication, with a velocity if one is measured."""
        seed = zlib.crc32(f"{self.name}#{number}".encode())
        rig = Rig.model_validate(
            {
                "inertia": INERTIA,
                "friction": {"viscous": LAW["K_v"], "coulomb": LAW["K_c"]},
                "effects": [{"name": self.effect, **RIG_EFFECTS[self.effect]}] if self.effect != "none" else [],
                "excitation": MOTIONS[self.motion],
                "rate": self.rate,
                "samples": int(SECONDS * self.rate),
                "rest_speed": 1e-4,
                "hold": self.torque == "held",
                "seed": seed,
            }
        )
        moved = rig.simulate()
        if self.source == "simulate":
            moved = simulate(
                self.drive,
                self.truth,
                moved.time,
                moved.torque,
                between_samples="held" if self.torque == "held" else "linear",
                substeps=max(1, 2000 // self.rate),
                initial_velocity=float(moved.velocity[0]),
                with_position=True,
            )
        return self._sensed(moved, np.random.default_rng(seed))

    def _sensed(self, moved: Recording, rng: np.random.Generator) -> Recording:
        """Return what the sensors make of an exact recording."""
        channels = {"time": moved.time, "torque": moved.torque}
        if self.counts is not None or "position" in self.drive.model.needs:
            start = rng.uniform(0, TURN)
            channels["position"] = quantised(moved["position"] + start, TURN / (self.counts or 65536)) - start
        if self.counts is None:
            size = NOISE * float(np.sqrt(np.mean(moved.velocity**2)))
            channels["velocity"] = _noisy(moved.velocity, self.noise, size, rng)
        return Recording(self.name, moved.motion, channels, moved.run)

    def lower_bound(self, recording: Recording) -> dict[str, float]:
        r"""Return the Cramér–Rao bound of each free parameter's standard deviation, where the noise is white.

        The velocity at the samples is all that is measured: :math:`\sigma^2 (S^T S)^{-1}` with S its derivative by the
        parameters under the recorded torque.
        """
        if self.noise != "white" or "position" in recording:
            return {}
        moved = self.recorded_velocity(recording, self.truth)
        sigma = NOISE * float(np.sqrt(np.mean(moved**2)))
        columns, keys = [], [p.key for p in self.drive.parameters]
        for key in keys:
            step = 1e-4 * (abs(self.truth[key]) or 1.0)
            up, down = (
                self.recorded_velocity(recording, {**self.truth, key: self.truth[key] + h}) for h in (step, -step)
            )
            columns.append((up - down) / (2 * step))
        sensitivity = np.array(columns)
        covariance = sigma**2 * np.linalg.pinv(sensitivity @ sensitivity.T, hermitian=True)
        return dict(zip(keys, np.sqrt(np.diag(covariance)).tolist(), strict=True))

    def recorded_velocity(self, recording: Recording, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Return the velocity of a drive from rest under a recorded torque."""
        held = "held" if self.torque == "held" else "linear"
        substeps = max(1, 2000 // self.rate)
        return simulate(
            self.drive, values, recording.time, recording.torque, between_samples=held, substeps=substeps
        ).velocity


def _noisy(velocity: NDArray[np.float64], kind: str, size: float, rng: np.random.Generator) -> NDArray[np.float64]:
    white = rng.standard_normal(len(velocity))
    if kind == "rounded":
        step = size * math.sqrt(12)
        return np.asarray(step * np.round(velocity / step + rng.uniform()))
    if kind == "coloured":
        from scipy.signal import lfilter

        white[1:] *= math.sqrt(1 - AUTOREGRESSION**2)
        white = lfilter([1.0], [1.0, -AUTOREGRESSION], white)
    return np.asarray(velocity + size * white)


@lru_cache
def _drive(effect: str, inertia: float | None) -> Drive:
    return Drive(Model.parse("coulomb-viscous" + (f"+{effect}" if effect != "none" else "")), inertia)
