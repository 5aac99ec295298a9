"""The parts of a report on one recording, each made of a diagnosis as plain data and of comparisons for the figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.report.page import Block, Equation, Fold, Heading, Picture, Points, Section, Table, Words, table
from fricmodels.report.wording import (
    NORMAL_95,
    counted,
    declared,
    interval,
    known_model,
    listed,
    meaning_of,
    number,
    percent,
    physics,
    small,
    unit,
    unit_of,
)

if TYPE_CHECKING:
    from fricmodels.diagnosis.diagnose import Comparison

Data = Mapping[str, Any]
"""A diagnosis as plain data; see :mod:`fricmodels.diagnosis.document`."""


def found(data: Data) -> Section:
    """Say which effects are missing: the physics, the equation, the size, the evidence, and what looks alike."""
    blocks: list[Block] = []
    if not data["effects"]:
        blocks.append(Words(data["explanation"]))
    for effect in data["effects"]:
        blocks += _effect(effect, data)
    if data["unknown"] is not None and (len(data["effects"]) or data["verdict"] == "unknown-effect"):
        blocks += [Heading("Something else"), Words(unknown_words(data))]
    return Section("missing", "What is missing" if data["effects"] else "The verdict", blocks)


def unknown_words(data: Data) -> str:
    """Say what predicts the residual that no known effect explains."""
    view = data["unknown"]
    return (
        f"Something remains that no known effect explains: the residual can be predicted from {view['channels']}; with "
        f"that it falls by {100 * view['held_out_gain']:.0f} % on blocks that were not used for fitting. Look at the "
        "maps of the residual over these, and write an effect of your own (fricmodels new effect NAME)."
    )


def _effect(effect: Data, data: Data) -> list[Block]:
    entry = plugins.load().effects
    term = entry[effect["name"]] if effect["name"] in entry else None
    blocks: list[Block] = [Heading(effect["name"], remark="" if term is None else physics(term))]
    if term is not None and term.signature:
        blocks.append(Words(f"Its mark in the residual: {term.signature}."))
    blocks.append(Equation(effect["equation"], "added to the friction torque of the model"))
    blocks.append(
        Words(
            f"It explains {percent(100 * effect['share_of_residual'])} of the residual of the model before it and lowers "
            f"that residual by {percent(100 * effect['held_out_gain'])} on blocks that were not used for fitting. The "
            f"chance of that without such an effect is {small(effect['p_value'])}, corrected for all effects tested."
        )
    )
    if len(effect["class"]) > 1:
        others = listed((name for name in effect["class"] if name != effect["name"]), "and")
        blocks.append(
            Words(f"This recording cannot tell it from {others}. What would tell them apart: {effect['separated_by']}.")
        )
    last = data["ladder"][-1]
    values = {key: value for key, value in last.get("parameters", {}).items() if key.startswith(f"{effect['name']}.")}
    if values:
        blocks.append(parameters(last["model"], values, last["standard_errors"], Motion(data["motion"]), "Its parameters"))
    elif effect["parameters"]:
        rows = [(key, number(value, 4), unit(effect["units"].get(key, ""))) for key, value in effect["parameters"].items()]
        titles = {"parameter": False, "value": True, "unit": False}
        blocks.append(table("Its parameters, as far as the test found them", titles, rows, symbols=True))
    return blocks


def parameters(
    model: str,
    values: Mapping[str, float | None],
    errors: Mapping[str, float | None],
    motion: Motion,
    caption: str,
    truth: Mapping[str, float] | None = None,
) -> Table:
    """Return parameters with 95 % intervals, units and meaning; beside them the truth, where it is known."""
    known = declared(model)
    rows = []
    for key, value in values.items():
        middle, half = interval(value, errors.get(key))
        if not half:
            half = "given" if errors.get(key) is None and key in ("J", "M") else "not determined"
        own = (number(truth[key], 4) if key in truth else "–",) if truth else ()
        rows.append((key, middle, half, *own, unit_of(key, known, motion), _meaning(key, known)))
    titles = {"parameter": False, "value": True, "95 % interval": True} | ({"truth": True} if truth else {})
    return table(caption, titles | {"unit": False, "meaning": False}, rows, symbols=True)


def _meaning(key: str, known: Mapping[str, Any]) -> str:
    effect = key.rpartition(".")[0]
    return f"{meaning_of(key, known)} ({effect})" if effect else meaning_of(key, known)


def ladder(data: Data, picture: Picture | None) -> Section:
    """Show how the error falls with each effect."""
    titles = {"model": False, "step": False, "error on what was fitted": True, "error on what was kept back": True}
    rows = [
        (rung["model"], _step(rung), percent(rung["rms_percent"]), percent(rung["held_out_rms_percent"]))
        for rung in data["ladder"]
    ]
    shown = table("RMS torque error, in % of the RMS motor torque", titles, rows)
    blocks: list[Block] = [
        Words(
            "Each step adds the effect that explains the residual best and fits all parameters again. It stays only if "
            "the error falls on data that took no part in finding it."
        )
    ]
    blocks += [picture] if picture is not None else []
    return Section("ladder", "The ladder", [*blocks, shown])


def _step(rung: Data) -> str:
    if rung.get("removed"):
        return f"− {rung['removed']}"
    return f"+ {rung['added']}" if rung["added"] else "as given"


def ladder_words(data: Data) -> str:
    """Say in one sentence how the error falls."""
    rungs = data["ladder"]
    parts = [f"to {percent(rung['held_out_rms_percent'])} with {rung['added']}" for rung in rungs[1:] if rung["added"]]
    return (
        f"On data kept back the error falls from {percent(rungs[0]['held_out_rms_percent'])} {listed(parts, 'then')}. "
        f"Sensor noise alone would leave about {percent(data['noise_floor_percent'])}."
    )


def measured(comparisons: Sequence[Comparison]) -> Section:
    """Show each model against the measurement."""
    from fricmodels.report.pictures import model_against_measurement

    blocks: list[Block] = []
    for i, comparison in enumerate(comparisons):
        if len(comparisons) > 1:
            blocks.append(Heading(comparison.drive.model.name, remark=("as given", "with what was found")[min(i, 1)]))
        blocks += model_against_measurement(comparison)
    return Section("measured", "Model against measurement", blocks)


def fails(comparisons: Sequence[Comparison]) -> Section:
    """Show where the first model fails; on demand, what is left of that in the last."""
    from fricmodels.report.pictures import failures

    blocks: list[Block] = [
        Words(
            "The residual is the measured torque less the modelled. What a model lacks leaves its mark there: stripes "
            "over one quantity, a line at one order, a loop after reversals."
        ),
        *failures(comparisons[0]),
    ]
    if len(comparisons) > 1:
        blocks.append(Fold(f"The same of the last model, {comparisons[-1].drive.model.name}", failures(comparisons[-1])))
    return Section("fails", "Where the model fails", blocks)


def all_parameters(data: Data) -> Section:
    """List the parameters of the final model, and on demand those of the given one."""
    motion = Motion(data["motion"])
    last = data["ladder"][-1] if "parameters" in data["ladder"][-1] else data
    note = (
        f"The intervals are the estimate ± {NORMAL_95:.2f} standard errors; these hold for residuals that are correlated "
        "in time. They say how well this recording determines a parameter of this model, not whether the model is right."
    )
    blocks: list[Block] = [*equations(last["model"]), *fitted(last, motion), Words(note)]
    if len(data["ladder"]) > 1:
        blocks.append(Fold(f"Parameters of the given model, {data['model']}", fitted(data, motion)))
    return Section("parameters", "Parameters", blocks)


def fitted(data: Data, motion: Motion) -> list[Block]:
    """Return the table of a model's parameters."""
    return [parameters(data["model"], data["parameters"], data["standard_errors"], motion, data["model"])]


def equations(model: str) -> list[Block]:
    """Return the equation of motion with the friction law and each effect."""
    known = known_model(model)
    if known is None:
        return []
    total = " + ".join(["τ_law", *(f"τ_{i}" for i in range(1, len(known.effects) + 1))])
    terms = [("τ_law", known.law), *((f"τ_{i}", effect) for i, effect in enumerate(known.effects, start=1))]
    blocks: list[Block] = [Equation(f"J·dω/dt = τ_m − τ_L − τ_F;  τ_F = {total}", "motor torque less load less friction")]
    for name, term in terms:
        own = term.formula.partition(" = ")[2]
        blocks.append(Equation(f"{name} = {own}", f"{term.name}: {physics(type(term))}"))
    return blocks


def limits(data: Data) -> Section:
    """Say what is not identified, what would have been found, and what could not have been seen."""
    blocks: list[Block] = [*_identified(data)]
    seen = {name: row for name, row in data["could_have_been_seen"].items() if not row["missing"]}
    blind = {name: row["missing"] for name, row in data["could_have_been_seen"].items() if row["missing"]}
    if seen:
        unit_text = "N m" if data["motion"] == Motion.ROTARY else "N"
        rows = [
            (name, percent(row["smallest_percent"]), number(row["smallest_torque"])) for name, row in seen.items()
        ]
        titles = {"effect": False, "of the RMS torque": True, f"RMS torque [{unit_text}]": True}
        blocks += [
            Heading("Looked for and not found"),
            Words(f"This recording would have shown {counted(len(seen), 'other effect')}, each from this size on."),
            table("Smallest effect that would have been found", titles, rows),
        ]
    if blind:
        rows_blind = [(name, *_reason(text)) for name, text in blind.items()]
        blocks += [
            Heading("Could not have been seen"),
            Words("These may act on the drive all the same; nothing here speaks for or against them."),
            table("Effects that this recording cannot show", {"effect": False, "why": False, "record": False}, rows_blind),
        ]
    return Section("limits", "What cannot be known from this recording", blocks)


def _reason(text: str) -> tuple[str, str]:
    why, _, remedy = text.partition("; to see it, record ")
    return why, remedy or "–"


def _identified(data: Data) -> list[Block]:
    last = data["ladder"][-1] if "parameters" in data["ladder"][-1] else data
    errors: Mapping[str, float | None] = last["standard_errors"]
    loose = [key for key, error in errors.items() if error is None or error <= 0]
    weak = [
        key
        for key, error in errors.items()
        if error and (value := last["parameters"].get(key)) is not None and abs(value) < NORMAL_95 * error
    ]
    points = []
    if loose:
        points.append(f"Not determined by this recording: {listed(loose)}.")
    if weak:
        points.append(f"Not told from zero: {listed(weak)}; the 95 % interval includes it.")
    for effect in data["effects"]:
        if len(effect["class"]) > 1:
            points.append(f"Not told apart: {listed(effect['class'])}. What would: {effect['separated_by']}.")
    if not points:
        points.append("Every parameter of the final model is determined, and every effect in it has no look-alike.")
    return [Heading("Identified or not"), Points(points)]
