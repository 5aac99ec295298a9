"""What a recording is: sampling, coverage, and how good its signals are."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.signals.noise_level import noise, quantum
from fricmodels.signals.rest import resting, smoothed_velocity
from fricmodels.signals.segments import gap_length


@dataclass(frozen=True)
class Description:
    """Figures about one recording, in SI units; shares are between 0 and 1, ``None`` is what does not apply.

    Attributes:
        samples, runs: their number.
        channels, derived: what was measured, and what was computed.
        duration: of all runs together, without gaps [s].
        rate: of sampling, the inverse of the median interval [Hz].
        jitter: standard deviation of the intervals over their median, gaps and lost samples aside.
        lost_samples: that regular sampling would have had besides, within gaps too.
        gaps, gap_time: number of gaps, and their duration [s].
        torque_range: least and largest motor torque [N m or N].
        saturation: share of samples at a limit of the torque.
        rest: share of samples at standstill.
        speed_range: least and largest velocity [rad/s or m/s].
        position_range: distance between the ends of the travel [rad or m].
        turns: the same in turns, on a rotary drive.
        reversals: number of changes of direction.
        velocity_noise: standard deviation of the velocity's noise, or of the derived one's [rad/s or m/s].
        velocity_step, position_step: quantisation [rad/s, rad, or in m].
    """

    name: str
    motion: Motion
    samples: int
    runs: int
    channels: tuple[str, ...]
    derived: tuple[str, ...]
    duration: float
    rate: float
    jitter: float
    lost_samples: int
    gaps: int
    gap_time: float
    torque_range: tuple[float, float]
    saturation: float
    rest: float
    speed_range: tuple[float, float]
    position_range: float | None
    turns: float | None
    reversals: int
    velocity_noise: float
    velocity_step: float | None
    position_step: float | None

    def rows(self) -> list[tuple[str, str]]:
        """Return what to print: label and value with unit."""
        length = "rad" if self.motion is Motion.ROTARY else "m"
        force = "N m" if self.motion is Motion.ROTARY else "N"
        rows = [
            ("motion", str(self.motion)),
            ("channels", ", ".join(self.channels)),
            ("derived", ", ".join(self.derived) or "none"),
            ("samples", f"{self.samples} in {self.runs} run{'s' if self.runs != 1 else ''}, {self.duration:.4g} s"),
            ("rate", f"{self.rate:.6g} Hz, jitter {100 * self.jitter:.2g} %"),
            ("gaps", f"{self.gaps}, {self.gap_time:.3g} s; {self.lost_samples} samples lost"),
            ("torque", f"{self.torque_range[0]:.4g} to {self.torque_range[1]:.4g} {force}"),
            ("saturated", f"{100 * self.saturation:.2g} % of samples"),
            ("velocity", f"{self.speed_range[0]:.4g} to {self.speed_range[1]:.4g} {length}/s"),
            ("velocity noise", f"{self.velocity_noise:.2g} {length}/s" + _step(self.velocity_step, f"{length}/s")),
            ("at rest", f"{100 * self.rest:.3g} % of samples"),
            ("reversals", str(self.reversals)),
        ]
        if self.position_range is not None:
            turns = f" ({self.turns:.4g} turns)" if self.turns is not None else ""
            travel = f"{self.position_range:.4g} {length}{turns}{_step(self.position_step, length)}"
            rows.append(("position range", travel))
        return rows

    def to_json(self) -> dict[str, Any]:
        """Return plain numbers, texts and lists."""
        values = asdict(self)
        return {key: list(v) if isinstance(v, tuple) else v for key, v in values.items()} | {"motion": str(self.motion)}


def _step(step: float | None, unit: str) -> str:
    return f", in steps of {step:.3g} {unit}" if step else ""


def describe(recording: Recording) -> Description:
    """Describe a recording; where velocity was not measured, that of the position is used.

    Raises:
        InputError: when there is neither velocity nor position.
    """
    velocity, error = smoothed_velocity(recording)
    at_rest = resting(recording)
    measured = "velocity" in recording and "velocity" not in recording.derived
    shown = recording.velocity if measured else velocity
    step = np.diff(recording.time)[np.diff(recording.run) == 0]
    gap = step >= gap_length(recording.time, recording.run)
    whole = np.maximum(np.round(step / recording.interval), 1.0)
    regular = step[(whole == 1) & ~gap]
    position = recording.channels.get("position")
    travel = None if position is None else float(np.ptp(position))
    return Description(
        name=recording.name,
        motion=recording.motion,
        samples=len(recording),
        runs=len(np.unique(recording.run)),
        channels=tuple(name for name in recording.channels if name not in recording.derived),
        derived=tuple(sorted(recording.derived)),
        duration=float(step[~gap].sum()),
        rate=1.0 / recording.interval,
        jitter=float(np.std(regular) / recording.interval) if len(regular) else 0.0,
        lost_samples=int((whole - 1).sum()),
        gaps=int(gap.sum()),
        gap_time=float(step[gap].sum()),
        torque_range=(float(recording.torque.min()), float(recording.torque.max())),
        saturation=saturation(recording.torque),
        rest=float(at_rest.mean()),
        speed_range=(float(shown.min()), float(shown.max())),
        position_range=travel,
        turns=travel / (2.0 * np.pi) if travel is not None and recording.motion is Motion.ROTARY else None,
        reversals=reversals(velocity, 3.0 * error, recording.run),
        velocity_noise=noise(recording.time, shown, recording.run) if measured else error,
        velocity_step=_visible_step(recording, "velocity") if measured else None,
        position_step=_visible_step(recording, "position"),
    )


def _visible_step(recording: Recording, channel: str) -> float | None:
    """Return the quantisation step of a measured channel, unless noise drowns it, as it does printed digits."""
    if channel not in recording or channel in recording.derived:
        return None
    step = quantum(recording[channel])
    return step if step > noise(recording.time, recording[channel], recording.run) else None


def saturation(values: Array) -> float:
    """Return the share of samples at the signal's upper or lower limit.

    A limit shows as samples piled up on the extreme value itself: more than three times what a smooth signal, whose
    turning point lies there, puts on its outermost step (1 : √2 − 1 against the next step), and three in succession.
    """
    tolerance = 1e-9 * float(np.ptp(values))
    piled = 0
    for extreme in (values.max(), values.min()):
        at = np.abs(values - extreme) <= tolerance
        inner = values[~at]
        if not len(inner):
            return 0.0
        step = quantum(inner)
        nearest = inner[np.argmin(np.abs(inner - extreme))]
        beside = np.count_nonzero(np.abs(inner - nearest) <= max(tolerance, 0.5 * step))
        if at.sum() > 3.0 * beside / (np.sqrt(2.0) - 1.0) and (at[2:] & at[1:-1] & at[:-2]).any():
            piled += int(at.sum())
    return piled / len(values)


def reversals(velocity: Array, band: float, run: Index) -> int:
    """Count changes of direction: from beyond the band about zero on one side to beyond it on the other."""
    sure = np.abs(velocity) > band
    direction, number = np.sign(velocity[sure]), run[sure]
    return int(np.count_nonzero((np.diff(direction) != 0) & (np.diff(number) == 0)))
