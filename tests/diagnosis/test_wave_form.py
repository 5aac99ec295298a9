"""A wave over position is named only in its own form: as it is, with the direction, or with the motor torque."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import Made

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.wave_form import any_form, has_another_form
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.shifted import regression_of

WAVES = {
    "cogging": {"cogging.a": 0.5, "cogging.k": 7.3},
    "position-friction": {"position-friction.a": 0.5, "position-friction.k": 7.3},
    "torque-ripple": {"torque-ripple.a": 0.12, "torque-ripple.k": 7.3},
}


def named(made: Made, hidden: str, *leave_out: str, k: float = 7.3) -> tuple[str, list[str]]:
    values = {**WAVES[hidden], f"{hidden}.k": k}
    recording = made(f"coulomb-viscous+{hidden}", values, samples=6000)
    diagnosis = diagnose(recording, "coulomb-viscous", 2.0, leave_out=leave_out)
    return diagnosis.verdict, [name for finding in diagnosis.findings for name in finding.names]


@pytest.mark.parametrize(
    ("hidden", "k"),
    [
        pytest.param(hidden, k, marks=() if (hidden, k) == ("cogging", 40.0) else pytest.mark.long)
        for k in (7.3, 40.0)
        for hidden in sorted(WAVES)
    ],
)
def test_it_is_named_where_its_form_is_on_the_list_and_only_there(made: Made, hidden: str, k: float) -> None:
    assert named(made, hidden, k=k) == ("missing-effect", [hidden])
    verdict, names = named(made, hidden, hidden, k=k)
    assert verdict == "unknown-effect"
    assert not set(names) & set(WAVES)


@pytest.mark.parametrize(("direction", "another"), [(0.0, False), (0.3, False), (0.6, True), (2.0, True)])
def test_a_wave_that_goes_a_little_with_the_direction_is_still_what_it_mostly_is(
    made: Made, direction: float, another: bool
) -> None:
    """What the rows average away of so fast a wave is left as well; a small part in another form is not most of it."""
    both = {**WAVES["cogging"], "position-friction.a": 0.5 * direction, "position-friction.k": 7.3}
    recording = made("coulomb-viscous+cogging+position-friction", both, samples=6000)
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    without, columns = regression_of(problem, found.parameters), any_form(problem, 7.3)
    own = without.test(columns[:4])
    assert has_another_form(without, own.loss, columns, POLICY) is another


def test_nothing_visible_is_no_other_form(made: Made) -> None:
    problem, found = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), made(samples=4000))
    without = regression_of(problem, found.parameters)
    assert not has_another_form(without, without.loss, np.zeros((2, problem.rows)), POLICY)
