"""Names the parameters that a recording does not determine, and says why in words."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from estimators.batch.problem import nonlinear_search
from estimators.batch.separable import separable
from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.signals import noise, smoothed_velocity

Array = NDArray[np.float64]

NORMAL_95 = 1.959963984540054


def not_identified(
    drive: Drive, values: Array, covariance: Array, undetermined: Array, searched: tuple[Array, Array]
) -> dict[str, str]:
    """Return key → reason for each parameter that the recording does not determine.

    Args:
        drive: gives keys and units.
        values, covariance: the estimate, in the order of the drive's parameters.
        undetermined: directions along which nothing changes, in columns of unit length, shape (n, any number).
        searched: least and greatest value that the data can tell apart, infinite for linear parameters.
    """
    keys = drive.keys
    spread = np.sqrt(np.clip(np.diag(covariance), 0.0, None))
    contains_zero = np.abs(values) <= NORMAL_95 * spread
    for pair in _pairs(drive):
        contains_zero[pair] = np.all(contains_zero[pair])
    found: dict[str, str] = {}
    for direction in undetermined.T:
        members = [keys[i] for i in np.flatnonzero(np.abs(direction) > 0.05 * np.max(np.abs(direction)))]
        for key in members:
            others = [other for other in members if other != key]
            found[key] = (
                f"the recording determines only a combination of it with {', '.join(others)}"
                if others
                else "it changes nothing in this recording"
            )
    for i, parameter in enumerate(drive.parameters):
        key = parameter.key
        if key in found:
            continue
        unit = parameter.declared.unit_for(drive.motion)
        half = NORMAL_95 * spread[i]
        if not (searched[0][i] <= values[i] <= searched[1][i]):
            found[key] = f"its best value {values[i]:.3g} {unit} lies beyond what this motion can tell apart"
        elif contains_zero[i]:
            partner, correlation = _partner(covariance, spread, i)
            found[key] = f"its 95 % interval, {values[i] - half:.3g} to {values[i] + half:.3g} {unit}, contains zero"
            if correlation > 0.9:
                found[key] += f"; it trades with {keys[partner]} (correlation {correlation:.3f})"
    return found


def drowned(drive: Drive, recording: Recording, values: Mapping[str, float]) -> dict[str, float]:
    """Return key → what velocity noise makes of each parameter's regressor, as a share of it.

    The regressor is compared at a smoothed velocity and at one larger by the standard deviation of the noise, where
    the drive surely moves. Standard errors take regressors as known and do not see this.
    """
    smooth, error = smoothed_velocity(recording)
    deviation = noise(recording.time, recording.velocity, recording.run)
    moving = np.abs(smooth) > 3.0 * error
    if not moving.any():
        return {}
    there = recording.select(moving)
    here = drive.jacobian(there.with_channels(velocity=smooth[moving]), values)
    moved = smooth[moving] + deviation * np.sign(smooth[moving])
    change = np.linalg.norm(drive.jacobian(there.with_channels(velocity=moved), values) - here, axis=1)
    size = np.linalg.norm(here, axis=1)
    return {
        p.key: float(changed / whole) if whole > 0.0 else 0.0
        for p, changed, whole in zip(drive.model.parameters, change, size, strict=True)
    }


def lost_in_noise(shares: Mapping[str, float]) -> dict[str, str]:
    """Return key → reason for each parameter whose regressor is less than three times what noise makes of it."""
    reason = "what it multiplies is hidden in the noise of the velocity: the drive moves too slowly for it"
    return {key: reason for key, share in shares.items() if share > 1 / 3}


def to_hold(
    drive: Drive,
    values: Array,
    covariance: Array,
    searched: tuple[Array, Array],
    doubtful: Collection[str],
    noisy: Mapping[str, float],
) -> tuple[str, float] | None:
    """Return the parameter that the recording determines least, and the value that says least of it.

    That is zero for a linear one, the end of the scan for a nonlinear one beyond it. A stick torque, whose neutral
    value is the slip torque, and the inertia, which is never zero, are not held.

    Args:
        drive, values, covariance, searched: see :func:`not_identified`.
        doubtful: keys among which to choose.
        noisy: how much of what each multiplies is noise; the noisiest is held first.
    """
    spread = np.sqrt(np.clip(np.diag(covariance), 0.0, None))
    choices: list[tuple[float, float, str, float]] = []
    for i, p in enumerate(drive.parameters):
        if p.key not in doubtful or p.key == drive.inertia_key or spread[i] == 0.0:
            continue
        nearest = float(np.clip(values[i], searched[0][i], searched[1][i]))
        if nearest != values[i]:
            choices.append((-np.inf, 0.0, p.key, nearest))
        elif p.linear and p.at_least is None and p.declared.lower <= 0.0 <= p.declared.upper:
            choices.append((-noisy.get(p.key, 0.0), abs(values[i]) / spread[i], p.key, 0.0))
    return min(choices)[2:] if choices else None


def searched_range(drive: Drive, recording: Recording) -> tuple[Array, Array]:
    """Return the range of each nonlinear parameter that its scan covers, a factor of ten wider on either side."""
    lower, upper = np.full(len(drive.keys), -np.inf), np.full(len(drive.keys), np.inf)
    search = nonlinear_search(drive, recording)
    places = [i for i, p in enumerate(drive.parameters) if not p.linear]
    for place, starts, logarithmic in zip(places, search.starts, search.logarithmic, strict=True):
        if logarithmic and len(starts) > 1:
            lower[place], upper[place] = min(starts) / 10.0, max(starts) * 10.0
    return lower, upper


def _pairs(drive: Drive) -> list[list[int]]:
    """Return the amplitudes that share a wave number: one may be zero by the phase alone, all are by the effect."""
    split, shift = separable(drive.model), len(drive.keys) - len(drive.model.parameters)
    return [
        [shift + split.linear[row] for row, place in split.slopes if place == j and row < len(split.linear)]
        for j, index in enumerate(split.nonlinear)
        if drive.model.parameters[index].declared.periodic
    ]


def _partner(covariance: Array, spread: Array, i: int) -> tuple[int, float]:
    scale = spread * spread[i]
    correlation = np.where(scale > 0.0, np.abs(covariance[i]) / np.where(scale > 0.0, scale, 1.0), 0.0)
    correlation[i] = 0.0
    partner = int(np.argmax(correlation))
    return partner, float(correlation[partner])
