"""Writes the tables of the documentation that the code knows: effects, and constants of the diagnosis."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

from fricmodels import plugins
from fricmodels.diagnosis.look_alikes import declared
from fricmodels.diagnosis.policy import Policy
from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.recording import channel_of
from fricmodels.report.wording import unit
from fricmodels.term import Effect

DOCS = Path(__file__).parent
BEGIN, END = "<!-- generated: begin -->", "<!-- generated: end -->"


def built_in() -> list[Effect]:
    """Return the effects that come with the project, in order of registration."""
    registered = plugins.load().effects
    return [registered[name]() for name in registered if registered.entry(name).distribution == "fricmodels"]


def cell(text: str) -> str:
    """Return text that does not end a column of a Markdown table."""
    return text.replace("|", r"\|")


def channels(effect: Effect) -> str:
    """Return the channels that an effect needs besides time, torque and velocity."""
    touched = {channel_of(signal) for signal in Model.only(effect).needs}
    return ", ".join(sorted(touched - {"time", "torque", "torque_rate", "velocity", "acceleration"}))


def generated() -> str:
    """Return the generated part of the page."""
    effects = built_in()
    lines = ["| name | torque | leaves in the residual | needs | searched for |", "|---|---|---|---|---|"]
    for effect in effects:
        flags = Model.only(effect).linear
        searched = ", ".join(f"`{p.symbol}`" for p, linear in zip(effect.parameters, flags, strict=True) if not linear)
        beside = f"`{effect.only_beside}` in the model" if effect.only_beside else ""
        needs = "; ".join(text for text in (channels(effect), effect.needs_motion, beside) if text)
        lines.append(f"| `{effect.name}` | {cell(effect.formula)} | {effect.signature} | {needs} | {searched} |")
    lines += ["", "## Their parameters", "", "| effect | symbol | unit | meaning |", "|---|---|---|---|"]
    for effect in effects:
        for p in effect.parameters:
            lines.append(f"| `{effect.name}` | `{p.symbol}` | {unit(p.unit_for(Motion.ROTARY)) or '1'} | {p.meaning} |")
    lines += ["", "## Look-alikes", "", "| these | are told apart by |", "|---|---|"]
    groups: dict[str, list[str]] = {}
    for one, other in combinations([effect.name for effect in effects], 2):
        text = declared(one, other)
        if text:
            groups.setdefault(text, [])
            groups[text] += [name for name in (one, other) if name not in groups[text]]
    lines += [f"| {', '.join(f'`{name}`' for name in names)} | {text} |" for text, names in groups.items()]
    return "\n".join(lines) + "\n"


def constants() -> str:
    """Return the table of the decision constants."""
    lines = ["| constant | value | unit | rule | evidence |", "|---|---|---|---|---|"]
    lines += [f"| `{name}` | " + " | ".join(cell(text) for text in rest) + " |" for name, *rest in Policy.table()]
    return "\n".join(lines) + "\n"


PAGES = {"effects.md": generated, "decisions/policy.md": constants}
"""Pages with a generated part, and what writes it."""


def page(name: str) -> str:
    """Return a page with its generated part renewed."""
    text = (DOCS / name).read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    return f"{before}{BEGIN}\n{PAGES[name]()}{END}{after}"


if __name__ == "__main__":
    for name in PAGES:
        (DOCS / name).write_text(page(name), encoding="utf-8")
