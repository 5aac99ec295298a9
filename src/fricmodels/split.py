"""What is fitted and what is kept back for the score."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt, PositiveFloat, PositiveInt, model_validator

from fricmodels.arrays import Array, Index, Mask
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.signals.segments import gap_lengths, usual_steps

_ENOUGH_RUNS = 4
"""With so many runs whole ones are kept back: a cut within one would leave too short pieces."""
_ROUNDING = 1e-6
"""Share of a sampling interval within which a sample lies on a border: the rounding of a stamp decides nothing."""
_FAIR = 0.25
"""Least share of its fair part that blocks kept back hold of what a drive does for a block's time or longer."""

WHOLE_RUNS = "whole_runs"
"""Provenance of what is kept back: names of the runs that are in it whole."""


class Split(BaseModel):
    """How a recording is divided into a part to fit and a part to score. Nothing is drawn at random.

    Attributes:
        by: ``spread``, whole runs spread over all where there are four or more, else blocks; ``blocks``, every so
            many-th of equal blocks of time, pauses left out, spread over each run, such that they hold of all that the
            drive does for long; ``runs``, the last runs; ``cycles``, the last cycles of periodic motion in each run;
            ``time``, a piece of time in each run.
        fraction: share that is kept back: of the runs, of the time of each run (its end), of the blocks.
        test_runs: numbers or names of the runs that are kept back, instead of a fraction.
        test_cycles: cycles kept back at the end of each run.
        period: of the motion [s], for ``cycles``; found from the recording if not given.
        test_from, test_to: time [s] from and to which samples are kept back, since the start of their run.
        blocks: number of blocks in each run.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    by: Literal["spread", "runs", "cycles", "time", "blocks"] = "spread"
    fraction: Annotated[float, Field(gt=0, lt=1)] = 0.3
    test_runs: tuple[int | str, ...] | None = None
    test_cycles: PositiveInt = 2
    period: PositiveFloat | None = None
    test_from: float | None = None
    test_to: float | None = None
    blocks: Annotated[NonNegativeInt, Field(ge=2)] = 10

    @model_validator(mode="before")
    @classmethod
    def _implied(cls, given: Any) -> Any:
        """A piece of time is one way of splitting, whether it is named or not."""
        if isinstance(given, Mapping) and "by" not in given and {"test_from", "test_to"} & set(given):
            return {**given, "by": "time"}
        return given

    @model_validator(mode="after")
    def _belongs(self) -> Split:
        """Refuse a setting that the chosen way of splitting does not use."""
        used = {
            "spread": {"fraction", "blocks"},
            "runs": {"fraction", "test_runs"},
            "cycles": {"test_cycles", "period"},
            "time": {"fraction", "test_from", "test_to"},
            "blocks": {"fraction", "blocks"},
        }
        changed = {
            name
            for name, info in type(self).model_fields.items()
            if name != "by" and getattr(self, name) != info.default
        }
        unused = sorted(changed - used[self.by])
        if unused:
            owner = next(by for by, names in used.items() if unused[0] in names)
            raise ValueError(f"'{unused[0]}' is not used when splitting by {self.by}; say by: {owner}")
        return self


def split(recording: Recording, how: Split | None = None) -> tuple[Recording, Recording]:
    """Return what is to be fitted and what is to be scored; the provenance of this names the runs that are in it whole.

    Raises:
        InputError: when either part would be empty, a run is not there, or no period can be found.
    """
    how = how or Split()
    test = {"spread": _spread, "runs": _runs, "cycles": _cycles, "time": _time, "blocks": _blocks}[how.by](
        recording, how
    )
    if test.all() or not test.any():
        what = "nothing" if test.all() else "everything"
        raise InputError(
            f"splitting recording '{recording.name}' by {how.by} leaves {what} to fit and "
            f"{'everything' if test.all() else 'nothing'} to score; change the split"
        )
    kept_back = part_of(recording, test)
    known = {**kept_back.provenance, WHOLE_RUNS: _whole_runs(recording, test)}
    return part_of(recording, ~test), replace(kept_back, provenance=known)


def part_of(recording: Recording, mask: Mask) -> Recording:
    """Select samples; where a run is cut out of the middle, what follows becomes a run of its own."""
    part = recording.select(mask)
    where = np.flatnonzero(mask)
    cut = (np.diff(where) > 1) & (np.diff(part.run) == 0)
    if not cut.any():
        return part
    piece = np.r_[0, np.cumsum((np.diff(where) > 1) | (np.diff(part.run) != 0))]
    return replace(part, run=piece.astype(np.int64))


def _whole_runs(recording: Recording, kept_back: Mask) -> tuple[str, ...]:
    """Return the names of the runs that are kept back whole; none where a part of some run is."""
    numbers = np.unique(recording.run[kept_back])
    if np.isin(numbers, recording.run[~kept_back]).any():
        return ()
    names = recording.provenance.get("runs", {})
    return tuple(str(names.get(int(number), number)) for number in numbers)


def _spread(recording: Recording, how: Split) -> Mask:
    numbers = recording.run_numbers
    if len(numbers) < _ENOUGH_RUNS:
        return _blocks(recording, how)
    return np.asarray(np.isin(recording.run, numbers[_spread_over(len(numbers), how.fraction)]))


def _spread_over(count: int, fraction: float) -> Index:
    """Return the places of a share of so many, at even distances."""
    chosen = min(max(1, round(fraction * count)), count - 1)
    return np.unique(((np.arange(chosen) + 0.5) * count / chosen).astype(np.int64))


def _runs(recording: Recording, how: Split) -> Mask:
    numbers = recording.run_numbers
    if how.test_runs is None:
        if len(numbers) < 2:
            raise InputError(
                f"recording '{recording.name}' is a single run and cannot be split by runs; "
                f"split by time, or name the column of the run with --column run=COLUMN"
            )
        count = min(max(1, round(how.fraction * len(numbers))), len(numbers) - 1)
        return np.isin(recording.run, numbers[-count:])
    names = {str(name): int(number) for number, name in recording.provenance.get("runs", {}).items()}
    wanted = []
    for run in how.test_runs:
        number = names.get(str(run), run)
        if number not in numbers:
            known = ", ".join(names) if names else ", ".join(str(n) for n in numbers[:20])
            raise InputError(f"recording '{recording.name}' has no run '{run}'; it has {known}")
        wanted.append(int(number))
    return np.isin(recording.run, wanted)


def _elapsed(recording: Recording, time: Array | None = None) -> tuple[Array, Array]:
    """Return the time since the start of the run, and the duration of the run, of each sample."""
    time = recording.time if time is None else time
    numbers, inverse = np.unique(recording.run, return_inverse=True)
    start, stop = np.full(len(numbers), np.inf), np.full(len(numbers), -np.inf)
    np.minimum.at(start, inverse, time)
    np.maximum.at(stop, inverse, time)
    return time - start[inverse], (stop - start)[inverse]


def _without_pauses(recording: Recording) -> Array:
    """Return the time of each sample [s] as if every gap were one sampling interval: in a gap there is nothing."""
    step = np.diff(recording.time)
    pause = (step >= gap_lengths(recording.time, recording.run)) & (np.diff(recording.run) == 0)
    if not pause.any():
        return recording.time
    paused = np.cumsum(np.where(pause, step - usual_steps(recording.time, recording.run), 0.0))
    return np.asarray(recording.time - np.append(0.0, paused))


def _time(recording: Recording, how: Split) -> Mask:
    elapsed, duration = _elapsed(recording)
    rounding = _ROUNDING * recording.interval
    if how.test_from is None and how.test_to is None:
        return np.asarray(elapsed > (1.0 - how.fraction) * duration + rounding)
    start = -np.inf if how.test_from is None else how.test_from - rounding
    stop = np.inf if how.test_to is None else how.test_to + rounding
    return np.asarray((elapsed >= start) & (elapsed <= stop))


def _cycles(recording: Recording, how: Split) -> Mask:
    elapsed, duration = _elapsed(recording)
    length = period(recording) if how.period is None else how.period
    return np.asarray(elapsed > duration - how.test_cycles * length * (1.0 + 1e-9))


def _blocks(recording: Recording, how: Split) -> Mask:
    """Mark blocks at even distances, the first choice of which that holds of all that the drive does for long.

    A slow drive may rest, or go one way, in none of the blocks that come first. What it does then could not be judged.
    """
    elapsed, duration = _elapsed(recording, _without_pauses(recording))
    on_border = elapsed + _ROUNDING * recording.interval
    block = np.minimum((how.blocks * on_border / np.where(duration > 0, duration, 1.0)).astype(int), how.blocks - 1)
    first = _spread_over(how.blocks, how.fraction)
    kinds = [kind for kind in _kinds(recording) if float(np.mean(kind)) >= 1.0 / how.blocks]
    for moved in range(how.blocks):
        test = np.isin(block, (first + moved) % how.blocks)
        there = float(np.mean(test))
        if all(float(np.mean(test[kind])) >= _FAIR * there for kind in kinds):
            return np.asarray(test)
    return np.asarray(np.isin(block, first))


def _kinds(recording: Recording) -> list[Mask]:
    """Return where the drive rests, goes forward and goes backward, where a channel tells."""
    from fricmodels.signals import resting, smoothed_velocity

    if "velocity" not in recording and "position" not in recording:
        return []
    rest, velocity = resting(recording), smoothed_velocity(recording)[0]
    return [rest, ~rest & (velocity > 0.0), ~rest & (velocity < 0.0)]


def period(recording: Recording) -> float:
    """Return the period [s] of the motion, from the autocorrelation of the torque and the velocity or position.

    The period is the first peak that is nearly as high as any (nine tenths), by a parabola over its top, a fortieth of
    the period to either side. The correlation at each lag is that of the samples that overlap there.

    Raises:
        InputError: when the motion is not periodic, or not two periods long.
    """
    from fricmodels.signals.resample import resample

    longest = max(recording.runs(), key=lambda run: run.time[-1] - run.time[0])
    even = resample(longest)
    names = [name for name in ("torque", "velocity", "position") if name in even and name not in even.derived]
    correlation = np.mean([_autocorrelation(even[name]) for name in names], axis=0)
    lag = np.arange(len(correlation))
    below = np.flatnonzero(correlation < 0.5)
    later = correlation[below[0] :] if len(below) else np.empty(0)
    if not len(later) or later.max() < 0.7 or later.argmax() == len(later) - 1:
        raise InputError(
            f"the motion of recording '{recording.name}' does not repeat itself for two periods; "
            f"give the period, or split by time"
        )
    first = int(below[0] + np.argmax(later >= 0.9 * later.max()))
    peak = first + int(np.argmax(correlation[first : first + first // 4 + 2]))
    near = np.abs(lag - peak) <= max(1, peak // 40)
    curvature, slope, _ = np.polyfit(lag[near] - peak, correlation[near], 2)
    shift = -0.5 * slope / curvature if curvature < 0 else 0.0
    return float((peak + shift) * even.interval)


def _autocorrelation(values: Array) -> Array:
    """Return the correlation of a signal with itself at lags up to half its length, normalised on the overlap."""
    from scipy.signal import fftconvolve

    centred = values - values.mean()
    count = len(centred)
    lags = count // 2
    product = fftconvolve(centred, centred[::-1])[count - 1 : count - 1 + lags]
    energy = np.r_[0.0, np.cumsum(centred**2)]
    head, tail = energy[count - np.arange(lags)], energy[count] - energy[np.arange(lags)]
    scale = np.sqrt(head * tail)
    return np.asarray(product / np.where(scale > 0, scale, 1.0))
