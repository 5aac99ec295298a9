r"""Instants that lie in data that were kept back: the only ones that can tell them.

Blocks are kept back all over a record, and a jump within one is seen before it and after it, not in it. Any instant of
the block fits as well, and its middle would blame the model for up to half of the block. So of these instants that one
is taken that leaves least of the block, with all other parameters as they were fitted,

.. math:: S(t) = \sum_{t_k < t} e_k^2(t_e) + \sum_{t_k \ge t} e_k^2(t_b),

where e is the torque error with an instant at the end of the block, t_e, or at its beginning, t_b: before the jump the
model is the one, after it the other. A gap in which nothing was recorded tells nothing; there the middle stays.

Rows span many samples, and none reaches into a block: a jump near the end of one may be fitted just outside of it. So a
block counts that its interval reaches, and then t goes through both.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.score.torque import filtered_torque_error, sliding_half_width
from fricmodels.weakform.inference import NORMAL_95

_FEWEST = 4
"""Samples in a block from which on it tells an instant."""


def told_by_kept_back(
    drive: Drive, recording: Recording, parameters: Mapping[str, float], errors: Mapping[str, float]
) -> dict[str, float]:
    """Return the instants, by key, that may lie in a part of the recording that was kept back, as that tells them.

    Args:
        drive: model and inertia.
        recording: what was fitted.
        parameters, errors: by key, the inertia among them, and standard errors.
    """
    keys = [p.key for p in drive.model.parameters if p.declared.instant]
    if not keys or recording.origin is None:
        return {}
    fitted, whole = np.unique(recording.time), recording.whole()
    found: dict[str, float] = {}
    for key in keys:
        window = _window(fitted, np.unique(whole.time), parameters[key], NORMAL_95 * errors.get(key, 0.0))
        if window is None:
            continue
        begin, end = window
        inside = np.flatnonzero((whole.time > begin) & (whole.time < end))
        inside = inside[np.argsort(whole.time[inside], kind="stable")]  # runs may lie beside each other in time
        half_width = sliding_half_width(recording)
        not_yet, already = (
            filtered_torque_error(drive, {**parameters, **found, key: instant}, whole, half_width)[inside] ** 2
            for instant in (end, begin)
        )
        left = np.concatenate([[0.0], np.cumsum(not_yet - already)])
        time = np.concatenate([[begin], whole.time[inside], [end]])
        place = int(np.argmin(left))
        found[key] = float(0.5 * (time[place] + time[place + 1]))
    return found


def _window(fitted: Array, every: Array, instant: float, reach: float) -> tuple[float, float] | None:
    """Return the times between which an instant is sought: the block that it lies in, or those that it may lie in.

    Args:
        fitted, every: times of the samples that were fitted, and of all, ascending.
        instant: as fitted. reach: how far off it is likely to be, on either side.
    """
    count = np.diff(np.searchsorted(every, fitted)) - 1
    blocks = np.flatnonzero(count >= _FEWEST)
    begins, ends = fitted[blocks], fitted[blocks + 1]
    within = (begins < instant) & (instant <= ends)
    if within.any():
        return float(begins[within][0]), float(ends[within][0])
    near = (begins < instant + reach) & (ends > instant - reach)
    if not near.any() or not np.isfinite(reach):
        return None
    begin, end = min(float(begins[near][0]), instant - reach), max(float(ends[near][-1]), instant + reach)
    return max(begin, float(every[0])), min(end, float(every[-1]))
