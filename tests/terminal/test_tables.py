"""Tables: no wider than the console, no number cut, no cell lost, nothing that steers the terminal."""

from __future__ import annotations

import io
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from fricmodels.terminal import Column, breaks, plain, show_records, show_table
from fricmodels.terminal.tables import fold

WIDTHS = st.integers(60, 160)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False).map(lambda value: f"{value:.5g}")
TEXTS = st.text(st.characters(codec="utf-8", categories=["L", "N", "P"]) | st.just(" "), max_size=60)


def printed(columns: list[Column], width: int, title: str = "") -> str:
    stream = io.StringIO()
    show_table(Console(file=stream, width=width), columns, title)
    return stream.getvalue()


@st.composite
def tables(draw: st.DrawFn) -> list[Column]:
    rows = draw(st.integers(1, 4))
    cells = st.tuples(*[TEXTS] * rows)
    numbers = st.tuples(*[NUMBERS] * rows)
    columns = [Column("name", draw(cells))]
    for number in range(draw(st.integers(0, 7))):
        is_number = draw(st.booleans())
        columns.append(Column(f"column {number}", draw(numbers if is_number else cells), is_number))
    return columns


@settings(max_examples=150, deadline=None)
@given(tables(), WIDTHS)
def test_a_table_fits_and_loses_nothing(columns: list[Column], width: int) -> None:
    from rich.cells import cell_len

    text = printed(columns, width)
    assert "\x1b" not in text
    assert "…" not in text or any("…" in cell for column in columns for cell in column.cells)
    assert all(cell_len(line) <= width for line in text.splitlines())
    words = text.split()
    for column in columns:
        if column.number:
            assert all(cell in words for cell in column.cells)
    # Every character of a text is there, in order within its column; together they are as often as in the cells.
    wanted = "".join(cell for column in columns for cell in column.cells).replace(" ", "")
    for sign in set(wanted):
        assert text.count(sign) >= wanted.count(sign)


@settings(max_examples=200, deadline=None)
@given(TEXTS, st.integers(4, 40))
def test_folding_keeps_every_character(text: str, width: int) -> None:
    from rich.cells import cell_len

    lines = fold(text, width).split("\n")
    assert all(cell_len(line) <= width for line in lines)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")


def test_a_model_folds_after_its_terms_and_a_unit_stays_whole() -> None:
    assert fold("coulomb-viscous+cogging+stribeck", 20) == "coulomb-viscous+\ncogging+stribeck"
    assert fold("RMS error [N m s/rad]", 14) == "RMS error\n[N m s/rad]"
    assert fold("J [kg m^2], K_v [N m s/rad]", 20) == "J [kg m^2],\nK_v [N m s/rad]"
    remark = "k = 1 [NOT DETERMINED: its interval contains zero; held at 0]"
    assert fold(remark, 30) == "k = 1 [NOT DETERMINED: its\ninterval contains zero; held\nat 0]"


def test_columns_without_room_follow_below_under_the_same_names() -> None:
    columns = [Column("parameter", ("stribeck.omega_s",))]
    columns += [Column(f"step {n}", (f"{n}.0001 ± 0.00{n}1",), number=True) for n in range(1, 9)]
    text = printed(columns, 60)
    assert text.count("stribeck.omega_s") > 1
    assert all(f"{n}.0001 ± 0.00{n}1" in text for n in range(1, 9))


def test_a_name_does_not_steer_the_terminal() -> None:
    name = "\x1b[31mred\x1b[0m \x07 \u202eabc [bold]x[/bold]"
    text = printed([Column("name", (name,))], 80, title=name)
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f\u202e]", text)
    assert "[bold]x[/bold]" in text
    assert plain("τ = a·cos kq") == "τ = a·cos kq"


@pytest.mark.parametrize("columns", [[Column("name", ())], []])
def test_an_empty_table_says_so(columns: list[Column]) -> None:
    assert "none" in printed(columns, 80)


def test_a_list_of_names_that_a_table_would_break_is_printed_in_blocks() -> None:
    names = Column("name", ("asymmetric-exponential-stick-slip", "square-root"))
    symbols = Column("parameters", ("K_v1 [N m s/rad], K_c1 [N m], B_1 [s/rad]", "K_v [N m s^(1/2)/rad^(1/2)]"))
    formulas = Column("equation", ("τ_F = [K_v1·|ω| + C_1 + (K_c1 − C_1)·exp(−B_1·|ω|)]·sgn₁ω", "τ_F = 0"))
    assert breaks([names, formulas, symbols], 80)
    assert not breaks([names, Column("from", ("here", "there"))], 60)
    stream = io.StringIO()
    show_records(Console(file=stream, width=60), [names, formulas, symbols])
    lines = stream.getvalue().splitlines()
    assert all(len(line) <= 60 for line in lines)
    assert lines[0] == "asymmetric-exponential-stick-slip"
    assert "  parameters  K_v1 [N m s/rad], K_c1 [N m], B_1 [s/rad]" in lines
    assert lines[-1] == "  parameters  K_v [N m s^(1/2)/rad^(1/2)]"
