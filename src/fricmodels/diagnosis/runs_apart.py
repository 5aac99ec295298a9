"""Whether the runs of a recording want parameters of their own: files of two drives, or of one that has changed.

One set of parameters is fitted to all runs. Where each run by itself leaves much less of the same model, no effect of
the motion is missing: the runs are not of one drive, payload, temperature or unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.dimension import INERTIA
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.once import once
from fricmodels.progress import each
from fricmodels.recording import RUN, Recording
from fricmodels.results.comparison import OfRuns, RunsApart
from fricmodels.score.bands import torque_error_over
from fricmodels.score.zeroed import zeroed
from fricmodels.split import WHOLE_RUNS
from fricmodels.weakform.estimate import Estimate, estimate

_MUCH_LESS = 0.5
"""Share of the error beyond noise that runs by themselves leave at most, where it is told. A judgement, of what is said
beside a verdict: it names nothing."""
_MOST = 2
"""Parameters that are told."""
_ENOUGH = 32
"""Runs that are fitted at most, spread over all."""
_DIFFERS = 4.0
"""Standard errors of their difference by which the least and the greatest value of a parameter differ at least."""


@dataclass(frozen=True)
class _Run:
    """One run.

    Attributes:
        name: as its file is called, or its number.
        found: what was fitted to it; ``None`` where that could not be.
        together, apart: squared torque errors with the parameters of all, and with its own.
        torque: squared motor torque.
    """

    name: str
    found: Estimate | None
    together: Array
    apart: Array
    torque: Array


@once
def runs_apart(comparison: Comparison) -> RunsApart | None:
    """Return what is left if each run has parameters of its own, and which of these differ; ``None`` where that is not
    much less than what one set of them leaves.

    Each run is fitted from the parameters of all, without what was kept back of it; one that was kept back whole is
    fitted, too. Of very many some are fitted. A run that cannot be fitted by itself counts with what all leave of it.
    """
    drive, values, headline = comparison.drive, comparison.estimate.parameters, comparison.errors.headline
    noise, whole = headline.fit_noise_percent, bool(comparison.test.provenance.get(WHOLE_RUNS))
    parts = [comparison.train, comparison.test] if whole else [comparison.train]
    every = [(part, int(number)) for part in parts for number in np.unique(part.signal(RUN))]
    count = len(every)
    most = max(headline.percent, headline.held_out_percent if whole else 0.0)
    if drive.model.known.fixed or count < 2 or most <= noise / _MUCH_LESS:
        return None
    window = 0.0 if headline is comparison.errors.per_sample else headline.window_ms / 1e3
    chosen = np.unique(np.linspace(0, count - 1, min(count, _ENOUGH)).round().astype(int)).tolist()
    spread = each("fitting each run by itself", [every[place] for place in chosen])
    runs = [_fitted(drive, values, part, number, window) for part, number in spread]
    together, apart, torque = (
        float(np.sqrt(np.mean(np.concatenate([getattr(run, of) for run in runs]))))
        for of in ("together", "apart", "torque")
    )
    together, apart = 100 * together / torque, 100 * apart / torque
    if apart**2 - noise**2 > _MUCH_LESS**2 * (together**2 - noise**2):
        return None
    units = {drive.inertia_key: INERTIA.unit(drive.motion), **drive.units}
    return RunsApart(
        runs=count, fitted=len(runs), together_percent=together, percent=apart, parameters=_differing(runs, units)
    )


def _fitted(drive: Drive, values: Mapping[str, float], part: Recording, number: int, window: float) -> _Run:
    """Fit a run of a recording by itself."""
    run, known = part.select(part.signal(RUN) == number), part.provenance.get("runs", {})
    own, name = Drive(drive.model.on(run), drive.inertia, drive.motion), str(known.get(number, f"run {number}"))
    together = torque_error_over(drive, values, zeroed(drive, values, run), window) ** 2
    try:
        _, found = estimate(own, run, values)
    except InputError:
        return _Run(name, None, together, together, run.torque**2)
    return _Run(name, found, together, torque_error_over(own, found.parameters, run, window) ** 2, run.torque**2)


def _differing(runs: list[_Run], units: Mapping[str, str]) -> tuple[OfRuns, ...]:
    """Return the parameters that differ most between runs, in their standard errors, the most certain first."""
    rows = []
    fits = [(run.name, run.found) for run in runs if run.found is not None]
    for key, unit in units.items():
        known = [
            (found.parameters[key], found.own_errors.get(key) or 0.0, name)
            for name, found in fits
            if key in found.parameters and key not in found.not_identified
        ]
        if len(known) < 2:
            continue
        (least, error, least_run), (greatest, other, greatest_run) = min(known), max(known)
        error = float(np.hypot(error, other))
        if greatest - least > _DIFFERS * error > 0.0:
            row = OfRuns(
                key=key, unit=unit, least=least, least_run=least_run, greatest=greatest, greatest_run=greatest_run
            )
            rows.append(((greatest - least) / error, row))
    return tuple(row for _, row in sorted(rows, key=lambda pair: -pair[0])[:_MOST])
