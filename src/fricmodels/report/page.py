"""A report as a document: sections of words, equations, tables, pictures; what it says, before how it looks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

from fricmodels.export.columns import Column

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

Tone = Literal["good", "warn", "bad", "plain"]


@dataclass(frozen=True)
class Words:
    """A paragraph."""

    kind: ClassVar[str] = "words"
    text: str
    lead: bool = False


@dataclass(frozen=True)
class Points:
    """A list of short statements."""

    kind: ClassVar[str] = "points"
    items: Sequence[str]


@dataclass(frozen=True)
class Equations:
    """Formulas in plain text, set as mathematics, each with its meaning in words."""

    kind: ClassVar[str] = "equations"
    lines: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Table:
    """Columns of text; ``symbols`` says that the first column holds symbols of parameters, set as mathematics."""

    kind: ClassVar[str] = "table"
    caption: str
    columns: Sequence[Column]
    symbols: bool = False

    @property
    def rows(self) -> list[tuple[str, ...]]:
        """Cells, row by row."""
        return list(zip(*(column.cells for column in self.columns), strict=True))


@dataclass(frozen=True)
class Picture:
    """A figure, its message in words, and a table that says the same.

    Attributes:
        title: what is shown.
        message: what it shows, in words: caption and name for screen readers.
        figure: of plotly.
        table: the same in numbers, or ``None`` where a table of the report says it already.
        name: of the figure in the page, the same in every page that has it; a number follows where there are several.
        wide: whether it takes a whole row of a gallery.
    """

    kind: ClassVar[str] = "picture"
    title: str
    message: str
    figure: Figure
    table: Table | None = None
    name: str = ""
    wide: bool = False


@dataclass(frozen=True)
class Gallery:
    """Pictures beside each other where there is room."""

    kind: ClassVar[str] = "gallery"
    blocks: Sequence[Picture]


@dataclass(frozen=True)
class Code:
    """Text to copy: commands, configuration."""

    kind: ClassVar[str] = "code"
    title: str
    text: str


@dataclass(frozen=True)
class Fold:
    """Blocks that are shown on demand."""

    kind: ClassVar[str] = "fold"
    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Heading:
    """A heading within a section, with a remark beside it."""

    kind: ClassVar[str] = "heading"
    text: str
    remark: str = ""


Block = Words | Points | Equations | Table | Picture | Gallery | Code | Fold | Heading


@dataclass(frozen=True)
class Section:
    """A part of the report; ``name`` is its anchor."""

    name: str
    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Tile:
    """One figure worth seeing first: value, what it is, and how to read it."""

    value: str
    label: str
    remark: str = ""


@dataclass(frozen=True)
class Verdict:
    """The answer in one sentence, and what follows from it.

    Attributes:
        sentence: the answer.
        tone: good, warn or bad.
        details: more sentences; they fold where there are lines.
        lines: what a reader asks next, each with its answer: how large, how sure, what remains, what to do.
        command: that does the next thing.
    """

    sentence: str
    tone: Tone
    details: Sequence[str] = ()
    lines: Sequence[tuple[str, str]] = ()
    command: str = ""


@dataclass(frozen=True)
class Page:
    """A whole report.

    Attributes:
        title: of the recording or the tournament.
        kicker: what kind of report it is.
        verdict: the answer, at the top.
        tiles: the few figures that carry it.
        sections: everything else, in reading order.
        made_by: the line at the foot.
    """

    title: str
    kicker: str
    verdict: Verdict
    tiles: Sequence[Tile]
    sections: Sequence[Section]
    made_by: str


def table(caption: str, titles: Mapping[str, bool], rows: Sequence[Sequence[str]], *, symbols: bool = False) -> Table:
    """Build a table from rows; each title says whether its column holds numbers."""
    cells = list(zip(*rows, strict=True)) if rows else [()] * len(titles)
    columns = [Column(title, tuple(own), number) for (title, number), own in zip(titles.items(), cells, strict=True)]
    return Table(caption, columns, symbols)
