"""What a condition excludes is not computed, and all else is as CasADi has it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fricmodels.kernels import Scan
from fricmodels.kernels.branches import Branch, Operation, arranged

IN_PYTHON = {
    "OP_ADD": "{0} + {1}",
    "OP_MUL": "{0} * {1}",
    "OP_DIV": "{0} / {1}",
    "OP_SQRT": "sqrt({0})",
    "OP_LT": "{0} < {1}",
    "OP_NOT": "({0} == 0)",
    "OP_IF_ELSE_ZERO": "({1} if {0} else 0.0)",
}


@pytest.fixture(autouse=True)
def fresh_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRICMODELS_CACHE", str(tmp_path))


def line(operation: Operation) -> str:
    return f"{operation.name} = {IN_PYTHON[operation.operation].format(*operation.operands)}"


def lines(steps: Sequence[Operation | Branch]) -> list[str]:
    """Write as Python."""
    found = []
    for step in steps:
        if isinstance(step, Operation):
            found.append(line(step))
        else:
            chosen = [f"    {operation.name} = {operation.operands[1]}" for operation in step.chosen]
            zeros = [f"    {operation.name} = 0.0" for operation in step.chosen]
            within = [f"    {inner}" for inner in lines(step.within)]
            found += [f"if {step.condition}:", *within, *chosen, "else:", *zeros]
    return found


def run(operations: list[Operation], wanted: list[str], **given: float) -> dict[str, float]:
    """Carry out the lines."""
    from math import sqrt

    known: dict[str, float] = {"sqrt": sqrt, **given}  # type: ignore[dict-item]
    exec("\n".join(lines(arranged(operations, wanted))), known)
    return {name: known[name] for name in wanted}


CHOICE = [
    Operation("negative", "OP_LT", ("x", "0.0")),
    Operation("root", "OP_SQRT", ("x",)),
    Operation("not_negative", "OP_NOT", ("negative",)),
    Operation("chosen", "OP_IF_ELSE_ZERO", ("not_negative", "root")),
]


def test_the_excluded_is_not_computed() -> None:
    assert run(CHOICE, ["chosen"], x=9.0) == {"chosen": 3.0}
    assert run(CHOICE, ["chosen"], x=-9.0) == {"chosen": 0.0}  # the root would raise


def test_what_serves_elsewhere_too_is_computed_always() -> None:
    with pytest.raises(ValueError, match="math domain"):
        run(CHOICE, ["chosen", "root"], x=-9.0)


def test_one_condition_is_asked_once() -> None:
    twice = [*CHOICE, Operation("half", "OP_DIV", ("root", "2.0"))]
    twice += [Operation("other", "OP_IF_ELSE_ZERO", ("not_negative", "half"))]
    assert sum(isinstance(step, Branch) for step in arranged(twice, ["chosen", "other"])) == 1
    assert run(twice, ["chosen", "other"], x=16.0) == {"chosen": 4.0, "other": 2.0}


@st.composite
def operations(draw: st.DrawFn) -> list[Operation]:
    """Draw sums, products and choices of what was there before."""
    names, drawn = ["x", "y", "1.5", "(-0.5)"], []
    for i in range(draw(st.integers(1, 24))):
        kind = draw(st.sampled_from(["OP_ADD", "OP_MUL", "OP_LT", "OP_IF_ELSE_ZERO", "OP_IF_ELSE_ZERO"]))
        drawn.append(Operation(f"w{i}", kind, (draw(st.sampled_from(names)), draw(st.sampled_from(names)))))
        names.append(f"w{i}")
    return drawn


@given(operations(), st.floats(-2, 2), st.floats(-2, 2), st.data())
@settings(deadline=None, max_examples=300)
def test_branches_change_no_result(drawn: list[Operation], x: float, y: float, data: st.DataObject) -> None:
    names = [operation.name for operation in drawn]
    wanted = data.draw(st.lists(st.sampled_from(names), min_size=1, unique=True))
    known: dict[str, float] = {"x": x, "y": y}
    for operation in drawn:
        exec(line(operation), known)
    assert run(drawn, wanted, x=x, y=y) == {name: known[name] for name in wanted}


def test_a_compiled_recursion_with_choices_within_choices_is_casadis() -> None:
    x, u, c = (casadi.SX.sym(name) for name in "xuc")
    far = casadi.if_else(u > 0.5, casadi.exp(-x) * u, casadi.sqrt(casadi.fabs(x)) / u)
    step = casadi.Function("f", [x, u, c], [casadi.if_else(x > c, x / 2 - u, far + c), casadi.if_else(x > c, x, far)])
    inputs = np.random.default_rng(0).uniform(0.1, 1, 200)
    last, outputs, _ = Scan(step)([1.0], inputs, [0.3])
    state, expected = 1.0, []
    for value in inputs:
        following, output = step(state, value, 0.3)
        state = float(following)
        expected.append(float(output))
    np.testing.assert_allclose(outputs[:, 0], expected, rtol=1e-12)
    assert last[0] == pytest.approx(state, rel=1e-12)
