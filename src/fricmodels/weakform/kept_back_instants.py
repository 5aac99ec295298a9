r"""Instants that lie in data that were kept back: the only ones that can tell them.

Blocks are kept back all over a record, and a jump within one is seen before it and after it, not in it. Any instant of
the block fits as well, and its middle would blame the model for up to half of the block. So of these instants that one
is taken that leaves least of the block, with all other parameters as they were fitted,

.. math:: S(t) = \sum_{t_k < t} e_k^2(t_e) + \sum_{t_k \ge t} e_k^2(t_b),

where e is the torque error with an instant at the end of the block, t_e, or at its beginning, t_b: before the jump the
model is the one, after it the other. A gap in which nothing was recorded tells nothing; there the middle stays.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.score.torque import filtered_torque_error, sliding_half_width

_FEWEST = 4
"""Samples in a block from which on it tells an instant."""


def told_by_kept_back(drive: Drive, recording: Recording, parameters: Mapping[str, float]) -> dict[str, float]:
    """Return the instants, by key, that lie in a part of the whole recording that was kept back, as that tells them.

    Args:
        drive: model and inertia.
        recording: what was fitted.
        parameters: by key, the inertia among them.
    """
    keys = [p.key for p in drive.model.parameters if p.declared.instant]
    if not keys or recording.origin is None:
        return {}
    fitted, whole = np.unique(recording.time), recording.whole()
    found: dict[str, float] = {}
    for key in keys:
        after = int(np.searchsorted(fitted, parameters[key]))
        if not 0 < after < len(fitted):
            continue
        begin, end = float(fitted[after - 1]), float(fitted[after])
        inside = np.flatnonzero((whole.time > begin) & (whole.time < end))
        inside = inside[np.argsort(whole.time[inside], kind="stable")]  # runs may lie beside each other in time
        if len(inside) < _FEWEST:
            continue
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
