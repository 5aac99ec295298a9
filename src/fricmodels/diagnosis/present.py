"""Comparisons, diagnoses and ladders as text for the terminal: the story of the report in tables and small plots."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.correlation import correlation
from fricmodels.diagnosis.diagnose import Diagnosis, Finding
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.errors_table import sampled, show_bands
from fricmodels.diagnosis.ladder import Ladder, Rung, added
from fricmodels.diagnosis.places import profile
from fricmodels.diagnosis.remarks import remarks_on
from fricmodels.dimension import DISPLACEMENT, FORCE, INERTIA, VELOCITY, Motion
from fricmodels.recording import Recording
from fricmodels.results.words import (
    FOUND,
    NOT_FOUND,
    NOT_SEEN,
    SIZE,
    chance_text,
    form,
    share_text,
    spread_text,
    value_text,
    with_spread,
)
from fricmodels.score import headline_window, torque_error_over
from fricmodels.signals import stretches
from fricmodels.terminal import Band, Column, Marks, bar, plain, show_plot, show_table, spoken

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.results.comparison import Step
    from fricmodels.results.diagnosis import Candidate, DiagnosisDocument, Effect, Visible


_BAR = 20
_NARROW_BAR = 8
_SHOWN_REVERSALS = 4
_LEAST_SHOWN = 100
_SPEEDS = 120
_SEARCHED = 4
"""Figures of a parameter that was searched for, and has no standard error."""


def show_comparison(console: Console, comparison: Comparison) -> None:
    """Print the errors, the parameters, model against measurement, and where the model fails."""
    drive = comparison.drive
    unit = FORCE.unit(drive.motion)
    _heading(console, f"{drive.model.name} on {comparison.train.name}")
    say(console, f"{sampled(comparison)} {comparison.errors.in_words(unit)}")
    console.print()
    show_parameters(console, comparison)
    console.print()
    show_overlay(console, comparison)
    console.print()
    show_friction(console, comparison)
    console.print()
    show_where(console, comparison)
    console.print()
    show_bands(console, comparison, unit)
    console.print()


def show_parameters(console: Console, comparison: Comparison, title: str = "Parameters") -> None:
    """Print the parameters with their standard errors and units; what stands at its bound is marked."""
    drive, estimate = comparison.drive, comparison.estimate
    units = {drive.inertia_key: INERTIA.unit(drive.motion), **drive.units}
    keys, errors = tuple(estimate.parameters), estimate.own_errors
    columns = [
        Column("parameter", keys),
        Column("value", tuple(value_text(estimate.parameters[k], errors.get(k)) for k in keys), True),
        Column("std. error", tuple(spread_text(errors.get(key)) for key in keys), number=True),
        Column("unit", tuple(units.get(key, "") for key in keys)),
    ]
    said = remarks_on(comparison)
    if said:
        columns.append(Column("remark", tuple(said.get(key, "") for key in keys)))
    show_table(console, columns, title)


def show_overlay(console: Console, comparison: Comparison, rows: int = 13) -> None:
    """Plot the torque, measured and modelled, over a few reversals of the data kept back."""
    part = _stretch(comparison.test)
    modelled = part.torque - _error(comparison, part)
    unit = FORCE.unit(comparison.drive.motion)
    quantity = "torque" if comparison.drive.motion is Motion.ROTARY else "force"
    series = [
        Band("measured", ".", part.time, part.torque),
        Band("modelled", "o", part.time, modelled),
    ]
    _title(console, f"Motor {quantity}, measured and modelled, over a stretch of test data")
    show_plot(console, series, "time [s]", f"[{unit}]", rows)


def show_friction(console: Console, comparison: Comparison) -> None:
    """Plot friction torque against velocity: what the motion asks for, and the model's mean at each velocity."""
    drive = comparison.drive
    part, values = drive.timed(comparison.train, comparison.estimate.parameters)
    unit, speed = FORCE.unit(drive.motion), VELOCITY.unit(drive.motion)
    modelled = drive.friction(part, values)
    measured = modelled + _error(comparison, comparison.train)
    # One sample in a hundred may lie anywhere: the friction torque at breakaway is uncertain.
    inside = np.abs(measured) <= max(np.quantile(np.abs(measured), 0.99), float(np.max(np.abs(modelled))))
    at, curve = _mean_by(part.velocity, modelled)
    series = [
        Marks("measured", ".", part.velocity[inside], measured[inside]),
        Marks("modelled, mean", "o", at, curve),
    ]
    _title(console, "Friction torque against velocity")
    show_plot(console, series, f"velocity [{speed}]", f"[{unit}]")


def show_where(console: Console, comparison: Comparison) -> None:
    """Print the share of the squared error in each regime of motion, the greatest excess over its samples first."""
    rows = comparison.where
    unit = FORCE.unit(comparison.drive.motion)
    bars = _bars(console, [row.share_of_squared_error for row in rows])
    columns = [
        Column("regime", tuple(row.regime for row in rows)),
        Column("share of squared error", tuple(share_text(row.share_of_squared_error) for row in rows), True),
        Column("", bars),
        Column("share of samples", tuple(share_text(row.share_of_samples) for row in rows), True),
        Column("samples", tuple(str(row.samples) for row in rows), True),
        Column(f"RMS error [{unit}]", tuple(f"{row.rms_torque_error:.3g}" for row in rows), True),
    ]
    show_table(console, columns, "Where it fails: the greatest excess of error over samples first")


def show_diagnosis(console: Console, diagnosis: Diagnosis, ladder: Ladder | None = None) -> None:
    """Print the verdict in words, the evidence and parameters of what was found, and what could not have been seen."""
    data = document(diagnosis, ladder)
    _heading(console, f"Verdict: {data.verdict}")
    say(console, data.explanation)
    console.print()
    if data.effects:
        _show_evidence(console, data)
        console.print()
        _show_found(console, list(diagnosis.findings) if ladder is None else added(ladder), data.motion)
        console.print()
    _show_candidates(console, data)
    _show_remaining(console, data, diagnosis if ladder is None else ladder.last)
    _show_visibility(console, data)


def _chances(rows: Iterable[Candidate | Effect]) -> Column:
    return Column("p value, corrected", tuple(chance_text(row.p_value) for row in rows), True)


def _show_candidates(console: Console, data: DiagnosisDocument) -> None:
    """Print every effect that was tested on the given model, the one with the least error on test blocks first."""
    rows = data.candidates
    if not rows:
        return
    columns = [
        Column("effect", tuple(row.name for row in rows)),
        Column("lowers the residual on other blocks", tuple(share_text(row.held_out_gain) for row in rows), True),
        Column("explains of it", tuple(share_text(row.share_of_residual) for row in rows), True),
        _chances(rows),
        Column("passes all tests", tuple("yes" if row.gates else "no" for row in rows)),
    ]
    show_table(console, columns, f"All candidates beside {data.model}")
    console.print()


def show_correlation(console: Console, comparison: Comparison) -> None:
    """Print how the estimates of the parameters are correlated; nothing where that is not known."""
    known = correlation(comparison)
    if known is None:
        return
    keys, matrix = known
    columns = [Column("correlation of", keys)]
    columns += [Column(key, tuple(f"{row[place]:.2g}" for row in matrix), True) for place, key in enumerate(keys)]
    show_table(console, columns, f"Correlation of the parameters of {comparison.drive.model.name}")
    console.print()


def _show_remaining(console: Console, data: DiagnosisDocument, final: Diagnosis) -> None:
    """Plot what remains over the channel that shows it, and list the known effects that come nearest."""
    rest = data.remaining
    if rest is None or final.result is None:
        return
    seen = profile(final.result, rest.over, "both" if rest.place is None else rest.place.direction)
    if seen is not None:
        channel = rest.over.replace("_", " ")
        _title(console, f"What remains: mean over {channel}, motion {seen.direction}")
        show_plot(console, [Marks("mean residual", "o", seen.at, seen.torque)], channel, f"[{data.unit}]")
        console.print()
    if rest.nearest:
        here = form(data.ladder[-1].held_out_rms_percent, ".3g")
        falls = tuple(f"{here} → {form(one.held_out_percent, '.3g')} %" for one in rest.nearest)
        columns = [
            Column("effect", tuple(one.name for one in rest.nearest)),
            Column("test error", falls, True),
            Column("to take it anyway", tuple(f"--model {one.model}" for one in rest.nearest)),
        ]
        show_table(console, columns, "The known effects that come nearest to what remains")
        console.print()


def _show_evidence(console: Console, data: DiagnosisDocument) -> None:
    rows = data.effects
    columns = [
        Column("effect", tuple(row.name for row in rows)),
        Column("explains of the residual", tuple(share_text(row.share_of_residual) for row in rows), True),
        Column("lowers it on other blocks", tuple(share_text(row.held_out_gain) for row in rows), True),
        _chances(rows),
    ]
    if any(len(row.names) > 1 for row in rows):
        columns.append(Column("or", tuple(", ".join(row.names[1:]) for row in rows)))
    show_table(console, columns, FOUND)


def _show_found(console: Console, findings: list[Finding], motion: Motion) -> None:
    rows = [
        (
            f"{f.tested.name}.{p.symbol}",
            value_text(f.tested.parameters[p.symbol], f.tested.standard_errors.get(p.symbol), _SEARCHED),
            spread_text(f.tested.standard_errors[p.symbol]) if p.symbol in f.tested.standard_errors else "",
            p.unit_for(motion),
            p.meaning,
        )
        for f in findings
        for p in f.tested.effect.parameters
    ]
    names, values, spreads, units, meanings = zip(*rows, strict=True) if rows else ((), (), (), (), ())
    columns = [Column("parameter", names), Column("value", values, True), Column("±", spreads, True)]
    columns.append(Column("unit", units))
    if any(meanings):
        columns.append(Column("meaning", meanings))
    show_table(console, columns, SIZE)


def _show_visibility(console: Console, data: DiagnosisDocument) -> None:
    seen, blind = data.seen.values(), data.not_seen
    if seen:
        columns = [
            Column("effect", tuple(data.seen)),
            Column("% of RMS torque", tuple(f"{form(row.smallest_percent, '.2g')} %" for row in seen), True),
            Column(f"RMS torque [{data.unit}]", tuple(form(row.smallest_torque, ".2g") for row in seen), True),
        ]
        if any(row.band for row in seen):
            unit = (DISPLACEMENT**-1).unit(data.motion)
            columns.append(Column(f"waves [{unit}]", tuple(_band(row) for row in seen)))
        show_table(console, columns, NOT_FOUND)
        console.print()
    if blind:
        columns = [Column("effect", tuple(blind)), Column("why", tuple(blind.values()))]
        show_table(console, columns, NOT_SEEN)
        console.print()


def _band(row: Visible) -> str:
    return "" if row.band is None else f"{form(row.band[0], '.2g')} to {form(row.band[1], '.2g')}"


def show_ladder(console: Console, ladder: Ladder) -> None:
    """Print the error after each step, and how the parameters changed."""
    rungs = ladder.rungs
    errors = [rung.comparison.errors for rung in rungs]
    most = max(error.held_out_percent for error in errors) or 1.0
    columns = [
        Column("step", tuple(str(number) for number in range(len(rungs))), True),
        Column("model", tuple(change(rung) for rung in rungs)),
        Column("fit error", tuple(f"{error.percent:.3g} %" for error in errors), True),
        Column("test error", tuple(f"{error.held_out_percent:.3g} %" for error in errors), True),
        Column("", _bars(console, [error.held_out_percent / most for error in errors])),
    ]
    show_table(console, columns, f"The ladder: RMS torque error {errors[0].averaged}, in % of the RMS motor torque")
    console.print()
    estimates = [rung.comparison.estimate for rung in rungs]
    keys = tuple(dict.fromkeys(key for estimate in estimates for key in estimate.parameters))
    columns = [Column("parameter", keys)]
    for number, estimate in enumerate(estimates):
        cells = tuple(
            with_spread(estimate.parameters[key], estimate.standard_errors.get(key))
            if key in estimate.parameters
            else ""
            for key in keys
        )
        columns.append(Column(f"step {number}", cells, number=True))
    show_table(console, columns, "Parameters from step to step, ± standard error")
    console.print()
    show_correlation(console, rungs[-1].comparison)


def change(step: Rung | Step) -> str:
    """Return what was done to the model of the step before; of the first, its name."""
    if step.removed:
        return f"without {step.removed}"
    return f"with {step.added}" if step.added else step.model


def _bars(console: Console, shares: list[float]) -> tuple[str, ...]:
    width = _BAR if console.width >= 80 else _NARROW_BAR
    return tuple(bar(share, width, ascii_only=console.options.ascii_only) for share in shares)


def _error(comparison: Comparison, part: Recording) -> Array:
    window = headline_window(comparison.train, comparison.drive.inertia)
    return torque_error_over(comparison.drive, comparison.estimate.parameters, part, window)


def _stretch(recording: Recording) -> Recording:
    """Return a few reversals from the middle of the longest uninterrupted stretch."""
    longest = max(stretches(recording.time, recording.run), key=lambda part: part.stop - part.start)
    one = recording.select(np.arange(longest.start, longest.stop))
    forward = one.velocity > 0.05 * np.max(np.abs(one.velocity))
    starts = np.flatnonzero(forward[1:] & ~forward[:-1])
    middle, half = len(one) // 2, len(one) // 2
    if len(starts) > 1:
        period = int(np.median(np.diff(starts)))
        half = min(half, max(_SHOWN_REVERSALS // 2 * period // 2, _LEAST_SHOWN))
    return one.select(np.arange(max(middle - half, 0), min(middle + half, len(one))))


def _mean_by(velocity: Array, values: Array) -> tuple[Array, Array]:
    """Return the mean of values in even bins of the velocity, where there are any."""
    edges = np.linspace(float(velocity.min()), float(velocity.max()), _SPEEDS + 1)
    place = np.clip(np.digitize(velocity, edges) - 1, 0, _SPEEDS - 1)
    count = np.bincount(place, minlength=_SPEEDS)
    total = np.bincount(place, values, minlength=_SPEEDS)
    held = count > 0
    return ((edges[:-1] + edges[1:]) / 2)[held], total[held] / count[held]


def _heading(console: Console, text: str) -> None:
    from rich.text import Text

    line = plain(text)
    console.print(Text(line, style="bold"))
    console.print(Text(("=" if console.options.ascii_only else "━") * min(len(line), console.width)))


def _title(console: Console, text: str) -> None:
    from rich.text import Text

    console.print(Text(text, style="bold"))


def say(console: Console, text: str, style: str = "") -> None:
    """Print sentences, folded to the width; a number stays beside its unit."""
    from rich.text import Text

    # A number stays on one line with its unit, and with what it is the value of.
    plainer = plain(spoken(console, text)).replace("N m", "N\N{NO-BREAK SPACE}m")
    whole = re.sub(r" (?=%|N\b|ms\b)|(?<=[=±]) | (?=[=±])", "\N{NO-BREAK SPACE}", plainer)
    lines = textwrap.wrap(whole, console.width, break_on_hyphens=False, break_long_words=False)
    console.print(Text("\n".join(lines).replace("\N{NO-BREAK SPACE}", " "), style=style))
