"""When an answer is right, and the tables of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from hidden.figures import share
from logs.case import KINDS, Case

Row = dict[str, Any]
Judged = tuple[Case, Row, "Judgement"]


@dataclass(frozen=True)
class Judgement:
    """What is right in an answer, and what is not.

    Attributes:
        right: classes of look-alikes that hold a name of something that is there.
        wrong: classes that hold none.
        missed: true causes of which no name is in any class.
        unknown: whether the answer says that something remains that no listed effect explains.
        is_right: nothing hidden: no wrong name, and nothing said to be unknown; something of the list: all of it named,
            and nothing else; a cause that no list has: no wrong name.
    """

    right: tuple[tuple[str, ...], ...]
    wrong: tuple[tuple[str, ...], ...]
    missed: tuple[tuple[str, ...], ...]
    unknown: bool
    is_right: bool

    @property
    def text(self) -> str:
        """The judgement in a few words."""
        if self.is_right:
            return "right"
        parts = [f"not there: {_listed(self.wrong)}"] if self.wrong else []
        parts += [f"missed: {_listed(self.missed)}"] if self.missed else []
        return "; ".join([*parts, *(["said to be unknown"] if self.unknown else [])])


def judge(case: Case, row: Row) -> Judgement:
    """Judge an answer; that of a row without one misses all, and is not right."""
    named = [tuple(name.partition("(")[0] for name in names) for names in row.get("names", ())]
    true = {name for group in case.there for name in group} | set(case.beside)
    right = tuple(names for names in named if true.intersection(names))
    wrong = tuple(names for names in named if not true.intersection(names))
    given = {name for names in right for name in names}
    missed = tuple(group for group in case.there if not given.intersection(group))
    unknown = bool(row.get("unknown"))
    good = row["status"] == "ok" and not wrong
    if case.kind == "clean":
        good = good and not unknown
    elif case.kind != "unlisted":
        good = good and not missed
    return Judgement(right, wrong, missed, unknown, good)


def _listed(classes: Iterable[Sequence[str]]) -> str:
    return ", ".join(" or ".join(names) for names in classes)


def summary(pairs: Iterable[tuple[Case, Row]]) -> list[str]:
    """Return a table by kind, and a line for each answer that is not right, as lines of Markdown."""
    judged = [(case, row, judge(case, row)) for case, row in pairs]
    head = (
        "kind", "right (95 % interval)", "names that are there", "names that are not", "causes missed", "“unknown”",
        "without an answer",
    )  # fmt: skip
    lines = ["", _line(head), "|" + "---|" * len(head)]
    for kind in KINDS:
        lines += [_line((kind, *_counts([one for one in judged if one[0].kind == kind])))]
    lines += [_line(("all", *_counts(judged)))]
    wrong = [_told(*one) for one in judged if not one[2].is_right]
    versions = {row["code"] for _, row, _ in judged}
    if len(versions) > 1:
        lines += ["", f"The rows come from {len(versions)} versions of the code."]
    return [*lines, *(["", "Not right:", "", *wrong] if wrong else [])]


def _counts(judged: Sequence[Judged]) -> tuple[object, ...]:
    answers = [judgement for _, row, judgement in judged if row["status"] == "ok"]
    causes = sum(len(case.there) for case, row, _ in judged if row["status"] == "ok")
    return (
        share(judgement.is_right for _, _, judgement in judged),
        sum(len(one.right) for one in answers),
        sum(len(one.wrong) for one in answers),
        f"{sum(len(one.missed) for one in answers)} of {causes}",
        sum(one.unknown for one in answers),
        len(judged) - len(answers),
    )


def _line(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _told(case: Case, row: Row, judgement: Judgement) -> str:
    """Return a line on an answer that is not right."""
    head = (
        f"- `{case.name}` ({case.kind}; {case.truth or 'nothing hidden'}, {row['hidden_percent']:.1f} % of the torque)"
    )
    if row["status"] != "ok":
        return f"{head}: {row['message']}"
    first, last = row["ladder"][0][1], row["ladder"][-1][1]
    errors = f"test error {first:.3g} → {last:.3g} %, noise {row['floor_percent']:.3g} %"
    return f"{head}: named {_listed(row['names']) or 'nothing'}; {judgement.text}; {errors}"
