"""What is said of a parameter in the text, the report and the documents."""

from __future__ import annotations

from collections.abc import Callable
from io import StringIO

import pytest
from rich.console import Console

from fricmodels.diagnosis.comparison import Comparison, compare_model, kept_back
from fricmodels.diagnosis.correlation import correlation
from fricmodels.diagnosis.document import comparison_document
from fricmodels.diagnosis.present import show_parameters
from fricmodels.diagnosis.remarks import remarks
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.report.parameters import fitted, undetermined
from fricmodels.saved import keep
from fricmodels.weakform.prepared import ready

TRADED = ("K_c1", "K_c2", "stiffness.tau_0")


@pytest.fixture(scope="module")
def traded(made: Callable[..., Recording]) -> Comparison:
    """A law with a friction for each direction beside a spring: the torque at its middle is part of both."""
    train, test = kept_back(ready(made("coulomb-viscous+stiffness", {"stiffness.k": 1.0}, samples=4000)))
    return compare_model(train, test, Drive(Model.parse("asymmetric-coulomb-viscous+stiffness"), 2.0))


def test_what_is_held_at_nothing_is_not_said_to_be_that(traded: Comparison) -> None:
    data, stream = comparison_document(traded), StringIO()
    show_parameters(Console(file=stream, width=120), traded)
    lines = {line.split()[0]: line for line in stream.getvalue().splitlines() if line.split()}
    rows = {row[0]: row[2] for row in fitted(data.steps[-1], data.motion).rows}
    points = " ".join(undetermined(data.steps[-1]))
    stored = keep(traded).document.parameters
    assert data.remarks == {
        "K_c1": "not identified",
        "K_c2": "not identified",
        "stiffness.tau_0": "not identified, held at 0",
    }
    for key in TRADED:
        said = data.remarks[key]
        assert lines[key].rstrip().endswith(said)
        assert "not determined" in lines[key]
        assert rows[key] == said
        assert f"{key} is not determined: {data.not_identified[key]}." in points
        assert (stored[key].identified, stored[key].standard_error, data.standard_errors[key]) == (False, None, 0.0)
    assert "zero" not in points
    known = correlation(traded)
    assert known is not None
    assert not set(TRADED) & set(known[0])


def test_the_reason_comes_before_the_value() -> None:
    known = {p.key: p.declared for p in Model.parse("coulomb-viscous").parameters}
    values, errors = {"K_v": 0.01, "K_c": 3.0}, {"K_v": 0.02, "K_c": 0.1}
    assert remarks(known, values, errors) == {"K_v": "may be 0"}
    zero = {"K_v": "its 95 % interval, -0.03 to 0.05 N m s/rad, contains zero; held at 0"}
    assert remarks(known, values, errors, zero) == {"K_v": "may be 0"}
    nothing = {"K_v": "it changes nothing in this recording; held at 0.01", "K_c": "it changes nothing"}
    assert remarks(known, values, errors, nothing) == {"K_v": "not identified, held at 0.01", "K_c": "not identified"}
    assert remarks(known, values, errors, {}, ("K_v",)) == {"K_v": "by what was kept back"}
    assert remarks(known, {**values, "K_c": 0.0}, errors)["K_c"] == "at its bound"
