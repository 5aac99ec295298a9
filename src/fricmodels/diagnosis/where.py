"""Where a model fails: the share of the squared torque error by regime of motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import OTHER, RUN, Recording
from fricmodels.signals import resting
from fricmodels.signals.one_way import goes_one_way

_MOST_RUNS = 8
"""More rows of runs than this would hide the others in a table."""


@dataclass(frozen=True)
class Regime:
    """One regime: its share of the squared error, of the samples, and the RMS error there.

    A regime where the share of the error is well above the share of samples is where the model fails.
    """

    regime: str
    share_of_squared_error: float
    samples: int
    share_of_samples: float
    rms_torque_error: float


_GROUPS = {
    "rest": "motion", "breakaway": "motion", "reversal": "motion", "start": "motion",
    "low speed": "speed", "mid speed": "speed", "high speed": "speed",
    "accelerating": "acceleration", "decelerating": "acceleration",
    "forward": "direction", "backward": "direction",
}  # fmt: skip
_WORDS = {
    "rest": "at rest", "breakaway": "right after breakaway", "reversal": "right after reversals",
    "start": "right after starts",
    "low speed": "at low speed", "mid speed": "at medium speed", "high speed": "at high speed",
    "accelerating": "while accelerating", "decelerating": "while decelerating",
    "forward": "in forward motion", "backward": "in backward motion",
    "position: low": "at low positions", "position: middle": "at middle positions",
    "position: high": "at high positions",
    "load: light": "under light load", "load: medium": "under medium load", "load: heavy": "under heavy load",
    "temperature: cold": "in the cold", "temperature: warm": "when warm", "temperature: hot": "when hot",
    "time: early": "early in the record", "time: middle": "in the middle of the record",
    "time: late": "late in the record",
}  # fmt: skip


def in_words(regime: str) -> str:
    """Return where a regime is, as in a sentence."""
    return _WORDS.get(regime, f"in {regime.replace(': ', ' ')}")


def grouped(rows: Iterable[Regime]) -> dict[str, list[Regime]]:
    """Return regimes by what divides them (direction, speed, position, …), the group with the largest spread first.

    The regimes of a group do not overlap; those of different groups do.
    """
    groups: dict[str, list[Regime]] = {}
    for row in rows:
        groups.setdefault(_GROUPS.get(row.regime, row.regime.partition(":")[0]), []).append(row)
    return dict(sorted(groups.items(), key=lambda item: -max(row.rms_torque_error for row in item[1])))


def where(error: Array, prepared: Recording) -> list[Regime]:
    """Return every regime of a recording, the one with the largest excess of error first.

    Args:
        error: torque error, shape (N,).
        prepared: with velocity and acceleration.
    """
    total = float(np.sum(error**2))
    rows = []
    for name, mask in regimes(prepared).items():
        count = int(np.count_nonzero(mask))
        if count:
            own = float(np.sum(error[mask] ** 2))
            share = own / total if total > 0 else 0.0
            rows.append(Regime(name, share, count, count / len(error), float(np.sqrt(own / count))))
    return sorted(rows, key=lambda row: row.share_of_samples - row.share_of_squared_error)


def regimes(prepared: Recording) -> dict[str, Mask]:
    """Return the regimes of motion by name, each a mask over the samples; they overlap between kinds."""
    velocity, acceleration = prepared.velocity, prepared["acceleration"]
    rest = resting(prepared)
    speed = np.abs(velocity)
    moving = ~rest
    masks: dict[str, Mask] = {"rest": rest}
    near = _near_starts(prepared, rest)
    masks["breakaway"] = near & _after_rest(prepared, rest)
    masks["reversal" if _turns_back(prepared) else "start"] = near & ~masks["breakaway"]
    low, high = np.quantile(speed[moving], [1 / 3, 2 / 3]) if np.any(moving) else (0.0, 0.0)
    masks["low speed"] = moving & (speed < low)
    masks["mid speed"] = moving & (speed >= low) & (speed < high)
    masks["high speed"] = moving & (speed >= high)
    masks["accelerating"] = moving & (velocity * acceleration > 0)
    masks["decelerating"] = moving & (velocity * acceleration <= 0)
    if not goes_one_way(velocity):  # else the other way is noise about rest
        masks["forward"] = moving & (velocity > 0)
        masks["backward"] = moving & (velocity < 0)
    if "position" in prepared:
        masks.update(_thirds("position", prepared["position"], "low", "middle", "high"))
    if "load_torque" in prepared:
        masks.update(_thirds("load", np.abs(prepared.load_torque), "light", "medium", "heavy"))
    if "temperature" in prepared:
        masks.update(_thirds("temperature", prepared["temperature"], "cold", "warm", "hot"))
    masks.update(_thirds("time", np.arange(len(prepared), dtype=float), "early", "middle", "late"))
    for channel in prepared.further:
        masks.update(_thirds(channel.removeprefix(OTHER), prepared[channel], "low", "middle", "high"))
    masks.update(_runs(prepared))
    return masks


def _thirds(channel: str, values: Array, *names: str) -> dict[str, Mask]:
    if np.ptp(values) == 0:
        return {}
    edges = np.quantile(values, [1 / 3, 2 / 3])
    place = np.digitize(values, edges)
    return {f"{channel}: {name}": place == i for i, name in enumerate(names)}


def _runs(prepared: Recording) -> dict[str, Mask]:
    """Mark each run that was recorded, where there are several and no more than can be read."""
    run = prepared.signal(RUN).astype(int)
    names = prepared.provenance.get("runs", {})
    numbers = np.unique(run).tolist()
    return {f"run: {names.get(n, n)}": run == n for n in numbers} if 1 < len(numbers) <= _MOST_RUNS else {}


def _near_starts(prepared: Recording, rest: Mask) -> Mask:
    """Mark a twentieth of the median time between starts of motion, at least three samples, after each.

    A reversal is a start.
    """
    side = np.where(rest, 0.0, np.sign(prepared.velocity))
    begins = np.concatenate([[False], (side[1:] != side[:-1]) & (side[1:] != 0)])
    index = np.flatnonzero(begins)
    if not len(index):
        return np.zeros(len(side), dtype=bool)
    between = float(np.median(np.diff(index))) if len(index) > 1 else len(side)
    length = max(3, round(between / 20))
    last = np.maximum.accumulate(np.where(begins, np.arange(len(side)), -length - 1))
    return np.asarray((np.arange(len(side)) - last < length) & ~rest)


def _turns_back(prepared: Recording) -> bool:
    """Whether the drive goes both ways in some run."""
    runs = np.split(prepared.velocity, np.flatnonzero(np.diff(prepared.run)) + 1)
    return any(not goes_one_way(velocity) for velocity in runs)


def _after_rest(prepared: Recording, rest: Mask) -> Mask:
    """Mark the motion that began from rest, up to the next reversal or rest."""
    side = np.where(rest, 0.0, np.sign(prepared.velocity))
    changed = np.concatenate([[True], side[1:] != side[:-1]])
    from_rest = np.concatenate([[False], rest[:-1]]) & changed
    group = np.cumsum(changed)
    started: Mask = from_rest[np.flatnonzero(changed)]
    return np.asarray(started[group - 1] & ~rest)
