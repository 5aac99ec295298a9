"""A page on a linear axis: every word about a torque is one about a force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fricmodels.dimension import Motion
from fricmodels.export.columns import Column
from fricmodels.report.page import (
    Block,
    Code,
    Equations,
    Fold,
    Gallery,
    Heading,
    Page,
    Picture,
    Points,
    Section,
    Table,
    Words,
)
from fricmodels.results.words import of_motion


def in_forces(page: Page) -> Page:
    """Return a page whose words are those of a linear axis; commands, figures and names of effects stay.

    Args:
        page: on a recording of a linear axis.
    """
    verdict = page.verdict
    said = replace(
        verdict,
        sentence=_force(verdict.sentence),
        details=[_force(each) for each in verdict.details],
        lines=[(_force(what), _force(text)) for what, text in verdict.lines],
    )
    tiles = [replace(tile, label=_force(tile.label), remark=_force(tile.remark)) for tile in page.tiles]
    sections = [Section(each.name, _force(each.title), _blocks(each.blocks)) for each in page.sections]
    return replace(page, verdict=said, tiles=tiles, sections=sections)


def _force(text: str) -> str:
    return of_motion(text, Motion.LINEAR)


def _blocks(blocks: Sequence[Block]) -> list[Block]:
    return [_block(block) for block in blocks]


def _block(block: Block) -> Block:
    match block:
        case Words():
            return replace(block, text=_force(block.text))
        case Points():
            return Points([_force(item) for item in block.items])
        case Equations():
            return Equations([(formula, _force(meaning)) for formula, meaning in block.lines])
        case Table():
            return _table(block)
        case Picture():
            return _picture(block)
        case Gallery():
            return Gallery([_picture(each) for each in block.blocks])
        case Fold():
            return Fold(_force(block.title), _blocks(block.blocks))
        case Heading():
            return Heading(_force(block.text), _force(block.remark))
        case Code():
            return block


def _picture(picture: Picture) -> Picture:
    table = None if picture.table is None else _table(picture.table)
    return replace(picture, title=_force(picture.title), message=_force(picture.message), table=table)


def _table(table: Table) -> Table:
    columns = [Column(_force(each.title), tuple(map(_force, each.cells)), each.number) for each in table.columns]
    return Table(_force(table.caption), columns, table.symbols)
