"""A drive keeps a tenth of its inertia, whatever a controller does along the motion."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.comparison import Comparison, compare, with_effect
from fricmodels.diagnosis.verdict import select_effect
from fricmodels.dimension import Motion
from fricmodels.effects.inertia_error import InertiaError
from fricmodels.recording import Recording
from fricmodels.weakform.candidate import lower_bound

INERTIA, COULOMB, GRAVITY, PUSH = 0.13, 0.4, 2.5, 0.9


@pytest.fixture(scope="module")
def pendulum() -> Recording:
    """Return a swing-up: the controller pushes along the motion, so that friction alone balances the torque."""
    time = np.arange(1200) / 200.0

    def rate(_: float, state: np.ndarray) -> list[float]:
        pushed = (PUSH - COULOMB) * np.tanh(state[1] / 0.02)
        return [state[1], (pushed - GRAVITY * np.sin(state[0])) / INERTIA]

    course = solve_ivp(rate, (0.0, time[-1]), [0.3, 0.0], t_eval=time, max_step=2e-3).y
    rng = np.random.default_rng(1)
    channels = {
        "time": time,
        "torque": PUSH * np.sign(course[1]) + 0.02 * rng.standard_normal(len(time)),
        "velocity": course[1] + 0.01 * rng.standard_normal(len(time)),
        "position": course[0],
    }
    return Recording("pendulum", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64))


@pytest.fixture(scope="module")
def base(pendulum: Recording) -> Comparison:
    return compare(pendulum, "coulomb-viscous", INERTIA)


def test_gravity_is_what_is_missing_and_no_inertia_below_zero(base: Comparison) -> None:
    """With J − ΔJ of nothing a friction equal to the push would explain all of it."""
    result = candidate_tests(base.problem, base.estimate.parameters)
    found = select_effect(result)
    assert found is not None
    assert found.first.name == "gravity"
    assert not {"inertia-error", "torque-gain"}.intersection(found.names)
    assert np.hypot(*(found.first.parameters[s] for s in "ab")) == pytest.approx(GRAVITY, rel=0.1)


def test_a_fit_takes_no_more_inertia_away_than_there_is(base: Comparison) -> None:
    assert lower_bound(base.problem, InertiaError.dJ) == pytest.approx(-0.9 * INERTIA)
    fitted = with_effect(base, InertiaError(), {"dJ": -0.1})
    assert fitted.estimate.parameters["inertia-error.dJ"] >= -0.9 * INERTIA - 1e-12


def test_where_it_is_estimated_it_has_no_bound_of_its_own(pendulum: Recording) -> None:
    problem = compare(pendulum, "coulomb-viscous").problem
    assert lower_bound(problem, InertiaError.dJ) == -np.inf
