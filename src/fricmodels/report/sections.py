"""The parts of a report on one recording, each made of a diagnosis as plain data and of comparisons for the figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

from fricmodels import plugins
from fricmodels.diagnosis.policy import POLICY
from fricmodels.dimension import Motion
from fricmodels.report.error_words import window
from fricmodels.report.page import (
    Block,
    Equations,
    Fold,
    Gallery,
    Heading,
    Picture,
    Points,
    Section,
    Table,
    Words,
    table,
)
from fricmodels.report.parameters import fitted, parameters, undetermined
from fricmodels.report.pictures import (
    by_regime,
    correlated,
    covered,
    curve,
    evidence,
    excerpt,
    left_over,
    low_speed,
    marks,
    over_time,
    ranked,
)
from fricmodels.report.wording import (
    counted,
    known_model,
    listed,
    noise_alone,
    number,
    percent,
    physics,
    share,
    small,
    symbols_in,
    unit,
)
from fricmodels.results.words import BY_WINDOW, NORMAL_95, look_alikes

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.diagnosis.ladder import Rung
    from fricmodels.results.comparison import ComparisonDocument, Step
    from fricmodels.results.diagnosis import Correlation, DiagnosisDocument, Effect

_OPEN = 2
"""Effects, and what remains, that are all shown unfolded; of more only the first effect: later ones matter less."""


def found(data: DiagnosisDocument, rungs: Sequence[Rung], after: Mapping[str, Comparison] | None = None) -> Section:
    """Say which effects are missing: the physics, the equation, the size, the evidence, and what looks alike.

    Args:
        data: the diagnosis.
        rungs: the models on the way, for the pictures; empty where the recording is no longer there.
        after: the model with one effect more, by its name, where no rung has it.
    """
    steps = {rung.added: (earlier.comparison, rung.comparison) for earlier, rung in pairwise(rungs)}
    blocks: list[Block] = []
    if not data.effects and data.remaining is None:
        blocks.append(Words(data.explanation))
    for number_of, effect in enumerate(data.effects):
        still = number_of == 0 or len(data.effects) + (data.remaining is not None) <= _OPEN
        alone = (rungs[0].comparison, (after or {}).get(effect.name)) if rungs else None
        blocks += _effect(effect, data, steps.get(effect.name, alone), still)
    if data.remaining is not None and rungs:
        blocks.append(left_over(rungs[-1].comparison, data.remaining))
    if data.candidates:
        blocks.append(ranked(data.ranked, data.model))
    title = "What is missing" if data.effects else "What was tested"
    return Section("missing", "What remains unexplained" if data.remaining and not data.effects else title, blocks)


def _effect(
    effect: Effect, data: DiagnosisDocument, steps: tuple[Comparison, Comparison | None] | None, still: bool
) -> list[Block]:
    """Say what an effect is, by how much the test error falls with it, and show it; ``still`` leaves all of it open."""
    known = plugins.load().effects
    term = known[effect.name] if effect.name in known else None  # noqa: SIM401
    inner: list[Block] = [Equations([(effect.equation, "" if term is None else symbols_in(term))])]
    mark = f" In the error it looks like this: {term.signature}." if term is not None and term.signature else ""
    inner.append(Words(f"{_matters(effect, data)}{mark}"))
    if len(effect.names) > 1:
        inner.append(Words(_alike(effect)))
    values = {
        key.partition(".")[2]: value
        for key, value in data.ladder[-1].parameters.items()
        if key.startswith(f"{effect.name}.")
    }
    if term is not None and steps is not None:
        inner.append(evidence(steps[0], term(), steps[1], values or effect.parameters))
    inner.append(Fold(f"Parameters and statistics of {effect.name}", _statistics(effect, data)))
    heading = Heading(effect.name, remark="" if term is None else physics(term))
    return [heading, *inner] if still else [Fold(f"{effect.name}: {_matters(effect, data)}", inner)]


def _alike(effect: Effect) -> str:
    return look_alikes(listed(name for name in effect.names if name != effect.name), effect.separated_by)


def _matters(effect: Effect, data: DiagnosisDocument) -> str:
    """Say by how much the test error falls with an effect, the one number for how much it matters."""
    for before, after in pairwise(data.ladder):
        if after.added == effect.name:
            pair = (percent(before.held_out_rms_percent), percent(after.held_out_rms_percent))
            if turn(before, after) == "falls":
                return f"With it the test error falls from {pair[0]} to {pair[1]}."
            return f"With it the test error goes from {pair[0]} to {pair[1]}; over another window it falls."
    return _gain(effect)


def _gain(effect: Effect) -> str:
    return f"It lowers the error on blocks that took no part in fitting by {share(effect.held_out_gain)}."


def _statistics(effect: Effect, data: DiagnosisDocument) -> list[Block]:
    """Return the parameters of an effect and the statistics of its tests."""
    last = data.ladder[-1]
    values = {key: value for key, value in last.parameters.items() if key.startswith(f"{effect.name}.")}
    blocks: list[Block] = []
    if values:
        caption = f"Parameters of {effect.name}"
        blocks.append(parameters(last.model, values, last.standard_errors, data.motion, caption, said=last.remarks))
    elif effect.parameters:
        rows = [(key, number(value, 4), unit(effect.units.get(key, ""))) for key, value in effect.parameters.items()]
        titles = {"parameter": False, "value": True, "unit": False}
        blocks.append(table("Its parameters, as far as the test found them", titles, rows, symbols=True))
    blocks.append(
        Words(
            f"It explains {share(effect.share_of_residual)} of the squared error remaining before this step in the "
            f"rows of the weak form. {_gain(effect)} The chance of this without such an effect is "
            f"{small(effect.p_value)}, corrected for all effects tested."
        )
    )
    return blocks


def error_title(data: ComparisonDocument) -> str:
    """Name the torque errors, with the window that they are averaged over."""
    return f"RMS torque error {window(data)}".rstrip()


def bands(comparison: Comparison) -> Table:
    """Return the torque error per sample and over wider windows, with what noise alone would leave."""
    listed = comparison.errors.bands
    names = ["a sample", *(f"{band.window_ms:.3g} ms" for band in listed[1:])]
    rows = [
        (
            name,
            percent(band.percent),
            noise_alone(band.fit_noise_percent),
            percent(band.held_out_percent),
            noise_alone(band.noise_floor_percent),
        )
        for name, band in zip(names, listed, strict=True)
    ]
    errors = dict.fromkeys(("fit error", "of noise alone", "test error", "sensor noise alone"), True)
    return table(BY_WINDOW, {"averaged over": False, **errors}, rows)


def ladder(data: DiagnosisDocument, picture: Picture | None) -> Section:
    """Show how the error falls with each effect."""
    titles = {"model": False, "step": False, "fit error": True, "test error": True}
    rows = [
        (rung.model, _step(rung), percent(rung.rms_percent), percent(rung.held_out_rms_percent)) for rung in data.ladder
    ]
    shown = table(f"{error_title(data)}, in % of the RMS {data.reference}", titles, rows)
    blocks: list[Block] = [
        Words(
            "Each step adds the effect that explains the residual best and fits all parameters again. It stays only if "
            "the error falls, over this window or another, on data that took no part in finding it."
        )
    ]
    blocks.append(shown if picture is None else replace(picture, table=shown))
    return Section("ladder", "The ladder", blocks)


def _step(rung: Step) -> str:
    if rung.removed:
        return f"− {rung.removed}"
    return f"+ {rung.added}" if rung.added else "as given"


def ladder_words(data: DiagnosisDocument) -> str:
    """Say in one sentence how the error falls, or where it does not."""
    said, parts = "", list[str]()
    for before, after in pairwise(data.ladder):
        verb = turn(before, after)
        what = f"without {after.removed}" if after.removed else f"with {after.added}"
        begin = f"from {percent(before.held_out_rms_percent)} " if not parts and verb != "stays" else ""
        to = "at" if verb == "stays" else "to"
        parts.append(f"{verb + ' ' if verb != said else ''}{begin}{to} {percent(after.held_out_rms_percent)} {what}")
        said = verb
    return f"The test error {listed(parts, 'and')}."


def turn(before: Step, after: Step) -> Literal["falls", "rises", "stays"]:
    """Say what the test error does from one step of a ladder to the next, as far as three figures show it."""
    here, there = (each.held_out_rms_percent or 0.0 for each in (before, after))
    return "stays" if percent(here) == percent(there) else "falls" if there < here else "rises"


def measured(comparisons: Sequence[Comparison]) -> Section:
    """Show the last model against the measurement, beside the first; on demand, the first by itself."""
    last, first = comparisons[-1], comparisons[0]
    blocks: list[Block] = [over_time(last, before=first if len(comparisons) > 1 else None)]
    close = excerpt(last)
    blocks += [] if close is None else [Fold("Every sample where the error is largest", [close])]
    blocks.append(Gallery([curve(last), low_speed(last)]))
    if len(comparisons) > 1:
        blocks.insert(0, Words(f"The figures show {last.drive.model.name}, the model with what was found."))
        inner: list[Block] = [over_time(first), curve(first)]
        blocks.append(Fold(f"The same of {first.drive.model.name}, the model as given", inner))
    return Section("measured", "Model against measurement", blocks)


def fails(comparisons: Sequence[Comparison]) -> Section:
    """Show where the first model fails; on demand, maps of its error, and what is left of that in the last."""
    first, last = comparisons[0], comparisons[-1]
    blocks: list[Block] = [by_regime(first), Fold("The error over other windows", [bands(first)])]
    blocks.append(Fold(f"The error of {first.drive.model.name} by signal", [Gallery(marks(first))]))
    if len(comparisons) > 1:
        inner: list[Block] = [by_regime(last), bands(last), Gallery(marks(last))]
        blocks.append(Fold(f"The same of {last.drive.model.name}", inner))
    return Section("fails", f"Where {first.drive.model.name} fails", blocks)


def all_parameters(data: ComparisonDocument, known: Correlation | None = None, chosen: str = "") -> Section:
    """List the parameters of the final model, and on demand those of the given one.

    Args:
        data: a comparison or a diagnosis.
        known: how their estimates are correlated.
        chosen: with which of several look-alikes they hold.
    """
    steps = data.steps
    last = steps[-1]
    note = (
        f"The intervals are the estimate ± {NORMAL_95:.2f} standard errors; these hold for residuals that are "
        "correlated in time. They say how well this recording determines a parameter of this model, not whether the "
        "model is right."
    )
    formulas = equations(last.model, data.motion)
    if last.model.count("+") > _OPEN:  # each effect's own equation stands above
        formulas = [Fold("Equations of the model", formulas)]
    blocks: list[Block] = [*formulas, fitted(last, data.motion), Words(f"{chosen} {note}".strip())]
    if len(steps) > 1:
        blocks.append(Fold(f"Parameters of the given model, {data.model}", [fitted(steps[0], data.motion)]))
    pair = None if known is None else correlated(known)
    blocks += [] if pair is None else [Fold("Correlation of the parameters", [pair])]
    return Section("parameters", "Parameters", blocks)


def equations(model: str, motion: Motion) -> list[Block]:
    """Return the equation of motion with the friction law and each effect."""
    known = known_model(model)
    if known is None:
        return []
    balance = ("J·dω/dt = τ_m − τ_L − τ_F", "inertia × acceleration = motor torque − load − friction")
    if motion is Motion.LINEAR:
        words = "mass × acceleration = drive force − load − friction; on a linear axis ω is the velocity and τ a force"
        balance = ("M·dω/dt = τ_m − τ_L − τ_F", words)
    if not known.effects:
        return [Equations([balance, (known.law.formula, f"{known.law.name}: {physics(type(known.law))}")])]
    parts = [known.law, *known.effects]
    names = ["τ_law", *(f"τ_{i}" for i in range(1, len(parts)))]
    lines = [balance, (f"τ_F = {' + '.join(names)}", "friction of the law and of each effect")]
    for name, term in zip(names, parts, strict=True):
        lines.append((f"{name} = {term.formula.partition(' = ')[2]}", f"{term.name}: {physics(type(term))}"))
    return [Equations(lines)]


def limits(data: DiagnosisDocument, comparisons: Sequence[Comparison] = ()) -> Section:
    """Say what is not identified, where the drive was, what would have been found, what could not have been seen."""
    blocks: list[Block] = [*_identified(data)]
    if comparisons:
        blocks.append(Fold("Where the drive was: coverage of velocity and position", [covered(comparisons[-1])]))
    seen, blind = data.seen, data.not_seen
    if seen:
        sizes: dict[tuple[str, str], list[str]] = {}
        for name, row in sorted(seen.items(), key=lambda item: item[1].smallest_percent or 0.0):
            size = (percent(row.smallest_percent, 2), number(row.smallest_torque, 2))
            sizes.setdefault(size, []).append(name)
        titles = {"of the RMS torque": True, f"RMS torque [{data.unit}]": True, "effects": False}
        blocks += [
            Heading("Tested and not found"),
            Words(
                f"{counted(len(seen), 'other effect').capitalize()} would have been detected from the size given here. "
                f"{floor_words(row.smallest_percent for row in seen.values())}"
            ),
            table(
                "Smallest size that we would have detected",
                titles,
                [(*s, ", ".join(names)) for s, names in sizes.items()],
            ),
        ]
    if blind:
        rows_blind = [(name, *_reason(text)) for name, text in blind.items()]
        blocks += [
            Heading("Could not have been seen"),
            Words(
                f"Nothing here speaks for or against {listed(blind)}; "
                f"{'they' if len(blind) > 1 else 'it'} may act on the drive all the same."
            ),
            Fold(
                "Why not, and what to record to see them",
                [
                    table(
                        "Effects that this recording cannot show",
                        {"effect": False, "why": False, "to see it, record": False},
                        rows_blind,
                    )
                ],
            ),
        ]
    return Section("limits", "What cannot be known from this recording", blocks)


def floor_words(sizes: Iterable[float | None]) -> str:
    """Say once that the least size is a floor of ours, where some effect stands at it."""
    floor = 100 * POLICY.least_torque
    said = f"No effect below {percent(floor)} of the torque is named, however clearly it shows; that floor is ours."
    return said if any(size is not None and abs(size - floor) < 1e-9 * floor for size in sizes) else ""


def _reason(text: str) -> tuple[str, str]:
    why, _, remedy = text.partition("; to see it, record ")
    return why, remedy or "–"


def _identified(data: DiagnosisDocument) -> list[Block]:
    points = [*undetermined(data.steps[-1])]
    points += [f"{effect.name}: {_alike(effect)}" for effect in data.effects if len(effect.names) > 1]
    if not points:
        points.append("Every parameter of the final model is determined, and every effect in it has no look-alike.")
    return [Heading("Identified or not"), Points(points)]
