"""The answer in a terminal: what is missing first, one figure, how sure, what next; the rest with ``--verbose``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fricmodels.diagnosis.document import comparison_document, document
from fricmodels.diagnosis.errors_table import sampled
from fricmodels.diagnosis.ladder import added
from fricmodels.diagnosis.present import change, say, show_overlay, show_parameters
from fricmodels.errors import InputError
from fricmodels.report.answer import Answer, answer
from fricmodels.report.captions import where_words
from fricmodels.report.channels import channel_of_rest, shown_over
from fricmodels.report.error_words import comparison_words
from fricmodels.report.figures.against import error_over
from fricmodels.report.wording import change as change_of
from fricmodels.report.wording import counted, listed_classes, on_parameters, percent, small
from fricmodels.results.words import ALONG, of_motion
from fricmodels.terminal import Band, Column, Marks, bar, plain, show_plot, show_table, spoken

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.diagnosis.diagnose import Diagnosis, Finding
    from fricmodels.diagnosis.ladder import Ladder
    from fricmodels.results.diagnosis import DiagnosisDocument

_BAR = 24
_ROWS = 9
_RANKED = 4
_WORST = 3
_EXPLAINED = 3
"""Effects that are explained in a line each."""


def show_answer_of_ladder(console: Console, ladder: Ladder, options: Sequence[str] = ()) -> None:
    """Print what ``improve`` found: the answer, the ladder, how sure, what next, the final parameters, the verdict."""
    data = document(ladder.first, ladder)
    found = answer(data, options)
    _first(console, data, found, added(ladder) if data.effects else ())
    _ladder(console, data)
    _rest(console, data, found)
    last = ladder.rungs[-1].comparison
    console.print()
    show_parameters(console, last, f"Parameters of {last.drive.model.name}")
    for remark in on_parameters(data):
        say(console, remark)
    _last(console, data)


def show_answer_of_diagnosis(console: Console, diagnosis: Diagnosis, options: Sequence[str] = ()) -> None:
    """Print what ``diagnose`` found: the answer, the error against its channel, the candidates, how sure, what next."""
    data = document(diagnosis)
    found = answer(data, options)
    _first(console, data, found, diagnosis.findings)
    _evidence(console, data, diagnosis)
    _candidates(console, data)
    _rest(console, data, found)
    _last(console, data)


def show_answer_of_comparison(console: Console, comparison: Comparison) -> None:
    """Print how far off a model is: the error, model against measurement, the parameters, where it fails most."""
    data = comparison_document(comparison)
    sentence, errors = comparison_words(data)
    _bold(console, f"{data.dataset}: {sentence}")
    say(console, f"{errors} {sampled(comparison)}")
    console.print()
    show_overlay(console, comparison, _ROWS)
    console.print()
    show_parameters(console, comparison)
    console.print()
    say(console, where_words(comparison, _WORST))
    say(console, "What is missing in it: fricmodels diagnose, with the same options. More: --verbose.")


def _first(console: Console, data: DiagnosisDocument, found: Answer, findings: Sequence[Finding]) -> None:
    _bold(console, f"{data.dataset}: {found.sentence}")
    for finding in findings[:_EXPLAINED]:
        say(console, f"{finding.tested.name}: {of_motion(finding.tested.effect.physics, data.motion)}.")
    say(console, found.error)
    console.print()


def _rest(console: Console, data: DiagnosisDocument, found: Answer) -> None:
    for title, text in (("How sure", found.sure), ("What remains", found.remains), ("Next", found.next)):
        if text:
            say(console, f"{title}: {text}")
    if found.command:
        # A command is copied: it is not folded.
        console.print(plain(spoken(console, f"  {found.command}")), markup=False, highlight=False, soft_wrap=True)
    if data.not_seen:
        blind = counted(len(data.not_seen), "effect")
        say(console, f"This recording cannot show {blind}; --verbose lists them, with the rest.")


def _last(console: Console, data: DiagnosisDocument) -> None:
    names = listed_classes(effect.names for effect in data.effects)
    steps = data.ladder
    errors = [percent(steps[0].held_out_rms_percent)]
    errors += [percent(steps[-1].held_out_rms_percent)] if len(steps) > 1 else []
    what = f": {names}" if names else ""
    if names and len(steps) > 1 and data.remaining is not None and data.remaining.percent:
        what += ", and more that is unknown"
    console.print()
    verdict = f"{data.verdict}, so far" if data.partial else data.verdict
    _bold(console, f"Verdict: {verdict}{what}; test error {' → '.join(errors)}")


def _ladder(console: Console, data: DiagnosisDocument) -> None:
    steps = data.ladder
    most = max(step.held_out_rms_percent or 0.0 for step in steps) or 1.0
    width = _BAR if console.width >= 80 else _BAR // 3
    ascii_only = console.options.ascii_only
    columns = [
        Column("step", tuple(change(step) for step in steps)),
        Column("fit error", tuple(_figure(console, step.rms_percent) for step in steps), True),
        Column("test error", tuple(_figure(console, step.held_out_rms_percent) for step in steps), True),
        Column(
            "",
            tuple(bar((step.held_out_rms_percent or 0.0) / most, width, ascii_only=ascii_only) for step in steps),
        ),
    ]
    show_table(console, columns)
    console.print()


def _figure(console: Console, value: float | None) -> str:
    return spoken(console, percent(value))


def _candidates(console: Console, data: DiagnosisDocument) -> None:
    rows = data.ranked[:_RANKED]
    if not rows:
        return
    columns = [
        Column("candidate", tuple(row.name for row in rows)),
        Column("error on test blocks", tuple(spoken(console, change_of(row.held_out_gain)) for row in rows), True),
        Column("p, corrected", tuple(spoken(console, small(row.p_value)) for row in rows), True),
        Column("passes all tests", tuple("yes" if row.gates else "no" for row in rows)),
    ]
    tried = len(data.candidates)
    show_table(console, columns, f"The best of {tried} candidates, each by itself" if tried > 1 else "The candidate")
    console.print()


def _evidence(console: Console, data: DiagnosisDocument, diagnosis: Diagnosis) -> None:
    """Plot the mean error against the channel that shows what is missing, and what the effect says there."""
    comparison = diagnosis.comparison
    channel, period, after, name, along = "velocity", None, None, "", None
    if diagnosis.findings:
        tested = diagnosis.findings[0].tested
        name = tested.name
        channel, period = shown_over(comparison, tested.effect, tested.parameters)
        after = None if diagnosis.refits is None else diagnosis.refits.with_effect(tested)
    elif data.remaining is not None:
        channel, along = (
            channel_of_rest(data.remaining, comparison.train),
            True if ALONG in data.remaining.channel else None,
        )
    try:
        over = error_over(comparison, channel, after, period, along=along)
    except InputError:
        over = error_over(comparison, "velocity", after, along=along)
    series: list[Band] = [Marks("mean error", "o", over.before.at, over.before.mean)]
    series += [Marks(f"what {name} adds", "+", over.before.at, over.before.other)] if over.left is not None else []
    what = f"{data.quantity.capitalize()} error{', opposing motion' if over.opposes else ''}"
    _bold(console, f"{what}, against {over.axis.partition(' [')[0]}")
    show_plot(console, series, over.axis, f"[{data.unit}]", _ROWS)
    console.print()


def _bold(console: Console, text: str) -> None:
    say(console, text, "bold")
