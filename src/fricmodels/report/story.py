"""The report on one recording: what is missing in a model, and what the recording could not show."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, cast

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.processes import give_back
from fricmodels.progress import each
from fricmodels.report import sections
from fricmodels.report.answer import answer
from fricmodels.report.captions import where_words
from fricmodels.report.error_words import comparison_words, of_noise, window
from fricmodels.report.linear import in_forces
from fricmodels.report.motion import motion_section, simulated
from fricmodels.report.page import Page, Picture, Section, Tile, Verdict
from fricmodels.report.provenance import recording_section
from fricmodels.report.wording import (
    count,
    counted,
    listed,
    noise_alone,
    on_parameters,
    percent,
    physics,
)

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.diagnosis.diagnose import Diagnosis
    from fricmodels.diagnosis.ladder import Ladder, Rung
    from fricmodels.motion import Judged
    from fricmodels.results.comparison import ComparisonDocument
    from fricmodels.results.diagnosis import DiagnosisDocument


def of_ladder(ladder: Ladder, options: Sequence[str] = (), motion: Sequence[Judged] = ()) -> Page:
    """Return the report on a ladder, and on the motion that its rungs simulate where they were judged by it."""
    from fricmodels.diagnosis.document import document

    found = page(document(ladder.first, ladder), ladder.rungs, "improve", options, simulate=not motion)
    return _with_motion(found, motion)


def of_diagnosis(diagnosis: Diagnosis, options: Sequence[str] = ()) -> Page:
    """Return the report on a diagnosis."""
    from fricmodels.diagnosis.document import document
    from fricmodels.diagnosis.ladder import Rung

    refits, after = diagnosis.refits, {}
    for tested in [] if refits is None else [finding.tested for finding in diagnosis.findings]:
        larger = refits.with_effect(tested) if refits is not None else None
        after.update({} if larger is None else {tested.name: larger})
    return page(document(diagnosis), [Rung(diagnosis.comparison)], "diagnose", options, after)


def _with_motion(page: Page, motion: Sequence[Judged]) -> Page:
    """Put simulated motion before the last section, which is that of the recording, where models were judged by it."""
    if not motion:
        return page
    return replace(page, sections=[*page.sections[:-1], motion_section(motion), page.sections[-1]])


def of_comparison(comparison: Comparison, options: Sequence[str] = (), motion: Sequence[Judged] = ()) -> Page:
    """Return the report on a comparison: the model against the measurement and where it fails, without a diagnosis."""
    from fricmodels.diagnosis.document import comparison_document

    data = comparison_document(comparison)
    advice = "What is missing in it is another question: fricmodels diagnose, with the same options, answers that."
    sentence, errors = comparison_words(data)
    found = [
        _measured([comparison], simulate=not motion),
        sections.fails([comparison]),
        sections.all_parameters(data),
        recording_section(data, "compare", options),
    ]
    details = [errors, where_words(comparison, most=3), advice]
    return _with_motion(_page(data, Verdict(sentence, "plain", details), found), motion)


def page(
    data: DiagnosisDocument,
    rungs: Sequence[Rung],
    command: str,
    options: Sequence[str] = (),
    after: Mapping[str, Comparison] | None = None,
    *,
    simulate: bool = True,
) -> Page:
    """Return the report on a diagnosis.

    Args:
        data: the diagnosis.
        rungs: the models on the way, for the figures; empty where the recording is no longer there.
        command: that made it.
        options: of that command.
        after: the model with one effect more, by its name, where no rung has it.
        simulate: whether to show the motion that the model makes of the measured torque.
    """
    ends = _ends([rung.comparison for rung in rungs])
    remarks = " ".join(on_parameters(data))
    parts: list[Callable[[], Section]] = [lambda: sections.found(data, rungs, after)]
    if len(data.ladder) > 1:
        parts.append(lambda: sections.ladder(data, _ladder_picture(data, rungs)))
    if ends:
        parts += [lambda: _measured(ends, simulate=simulate), lambda: sections.fails(ends)]
    parts += [
        lambda: sections.all_parameters(data, data.correlation, remarks),
        lambda: sections.limits(data, ends),
        lambda: recording_section(data, command, options),
    ]
    found = []
    for make in each("drawing the report", parts):
        found.append(make())
        give_back(data.recording.samples.total)
    return _page(data, verdict(data, options), found)


def _page(data: ComparisonDocument, answer: Verdict, found: Sequence[Section]) -> Page:
    page = Page(
        title=data.dataset,
        kicker="Friction report on a recording",
        verdict=answer,
        tiles=tiles(data),
        sections=found,
        made_by=f"fricmodels {data.versions['fricmodels']}",
    )
    return in_forces(page) if data.motion is Motion.LINEAR else page


def _measured(ends: Sequence[Comparison], *, simulate: bool) -> Section:
    found = sections.measured(ends)
    return replace(found, blocks=[*found.blocks, simulated(ends)]) if simulate else found


def _ends(comparisons: Sequence[Comparison]) -> list[Comparison]:
    """Return the first and the last comparison, once where they are the same."""
    return list(comparisons) if len(comparisons) < 2 else [comparisons[0], comparisons[-1]]


def _ladder_picture(data: DiagnosisDocument, rungs: Sequence[Rung]) -> Picture | None:
    from fricmodels.report import figures

    if not rungs:
        return None
    figure = figures.ladder(cast("Ladder", SimpleNamespace(rungs=rungs)))  # it looks at nothing else of a ladder
    words = f"{sections.ladder_words(data)} The axis is logarithmic."
    if all(trace.name != "sensor noise alone" for trace in figure.data):
        words += f" What noise would leave, {of_noise(data)}, lies beyond it."
    return Picture("The error, step by step", words, figure, name="ladder-steps")


def verdict(data: DiagnosisDocument, options: Sequence[str] = ()) -> Verdict:
    """Return the answer, how large, how sure, what remains and what to do next; the rest is folded."""
    found = answer(data, options)
    lines = [
        ("How much it matters", found.error),
        ("How sure", found.sure),
        ("What remains", found.remains),
        ("About the recording", _warned(data)),
        ("What to do next", found.next),
    ]
    details = [*_physics(data), *found.details]
    if len(data.ladder) > 1:
        details.insert(0, sections.ladder_words(data))
    return Verdict(found.sentence, found.tone, details, [line for line in lines if line[1]], found.command)


def _warned(data: DiagnosisDocument) -> str:
    """Name what is the matter with the recording, where it bears on the answer."""
    kinds = list(dict.fromkeys(one.kind for one in data.recording.findings if one.severity != "note"))
    if not kinds:
        return ""
    return f"{counted(len(kinds), 'warning').capitalize()}: {listed(kinds)}; the last section says what each means."


def _physics(data: DiagnosisDocument) -> list[str]:
    """Return each missing effect in one line of plain words."""
    known = plugins.load().effects
    names = [effect.name for effect in data.effects]
    return [f"{name}: {physics(known[name])}." for name in names if name in known]


def tiles(data: ComparisonDocument) -> list[Tile]:
    """Return the few figures that carry the verdict."""
    rungs = data.steps
    over = window(data)
    shown = [Tile(percent(rungs[0].held_out_rms_percent), "test error of the model as given", data.model)]
    if len(rungs) > 1:
        last = rungs[-1]
        gained = [name for name in last.model.split("+") if name not in data.model.split("+")]
        shown.append(Tile(percent(last.held_out_rms_percent), "test error with what was found", f"+ {listed(gained)}"))
    shown.append(
        Tile(noise_alone(data.last_noise_floor_percent), "sensor noise alone", over or "estimated from the channels")
    )
    samples = data.recording.samples
    kept_back = 100 * samples.kept_back / samples.total
    shown.append(Tile(count(samples.total), "samples", f"{kept_back:.0f} % for the test error"))
    return shown
