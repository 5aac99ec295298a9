"""Whether the torque was recorded without its sign."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fricmodels.logcheck.balance import Balance
from fricmodels.logcheck.finding import Finding, Severity
from fricmodels.logcheck.view import Log
from fricmodels.signals.clusters import LEVEL, PROBABLE, significance

_OF_ONE_SIGN = 0.99
"""Share of the mean size that the mean torque must have: noise may turn the sign of what is nearly nothing."""
_ROUNDS = 50
"""Of fitting and setting signs; a few are enough."""
_LESS = 0.5
"""Share of what the balance of the recorded torque leaves, squared, that the one with signs may leave at most."""


def magnitude(log: Log, rows: Sequence[Balance]) -> Iterator[Finding]:
    r"""Judge whether a torque that hardly ever changes its sign is the size of one that does.

    Converters and servos often record the size of a current or a load. The torque :math:`s_i|\tau_i|` is fitted with
    the signs that its own balance gives, :math:`s = \mathrm{sgn}\,X\beta`, in rounds from :math:`s =
    \mathrm{sgn}\,\omega`. A torque with a bias, as of gravity, keeps one sign there, too; and where a brake holds the
    drive in its dwells that bias acts in motion only, so that the recorded torque may have it there alone. Said where
    the balance of the torque with signs leaves less than half of what that of the recorded one does, with friction that
    takes up power and a positive inertia, and in most of the record, not by chance over its clusters: what is compared
    in each is the difference over the sum, since few of them may have most of the torque.
    """
    torque = log.short.recording.torque
    one_sign = torque.any() and abs(float(np.sum(torque))) >= _OF_ONE_SIGN * float(np.sum(np.abs(torque)))
    if log.one_way or not one_sign:
        return
    pairs = [(_biased_in_motion(row), _with_signs(row)) for row in rows]
    if not pairs:
        return
    recorded, signed = min(pairs, key=lambda pair: pair[1].unexplained)
    before, after = recorded.left**2, signed.left**2
    if np.sum(after) > _LESS * np.sum(before) or min(signed.power, signed.ratio({"J": 1.0})) < 0.0:
        return
    gained, whole = (np.bincount(recorded.cluster, x) for x in (before - after, before + after))
    share = gained[whole > 0.0] / whole[whole > 0.0]
    count = len(share)
    error = float(np.std(share, ddof=1)) / np.sqrt(count) if count > 1 else np.inf
    chance = significance(float(np.mean(share)) / error if error > 0.0 else np.inf, count)
    if chance < PROBABLE:
        yield Finding(
            "torque-magnitude",
            Severity.STOP if chance < LEVEL else Severity.WARN,
            "torque",
            f"the {log.called('torque')} never changes its sign, and is the size of a torque that does so with the "
            f"motion (p = {chance:.1g})",
            "record it with its sign, or give it that of the commanded torque before it is read",
        )


def _biased_in_motion(row: Balance) -> Balance:
    """Return the balance with a torque that acts in motion only, one way, beside all others."""
    moving = np.abs(row.columns[:, [row.names.index("K_c")]])
    return replace(row, names=(*row.names, "in motion"), columns=np.hstack([row.columns, moving]))


def _with_signs(row: Balance) -> Balance:
    """Return the balance of the torque with the signs that it gives itself, from those of the velocity."""
    size = np.abs(row.target)
    scale = np.sqrt(np.mean(row.columns**2, axis=0))
    columns = row.columns / np.where(scale > 0.0, scale, 1.0)
    solve = np.linalg.pinv(columns, rcond=1e-5)
    signs = np.where(row.columns[:, row.names.index("K_c")] < 0.0, -1.0, 1.0)
    for _ in range(_ROUNDS):
        before, signs = signs, np.where(columns @ (solve @ (signs * size)) < 0.0, -1.0, 1.0)
        if np.array_equal(before, signs):
            break
    return replace(row, target=signs * size)
