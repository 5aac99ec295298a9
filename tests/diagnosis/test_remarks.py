"""What is said beside a parameter: where a search ended at what the recording tells, too."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.document import comparison_document
from fricmodels.diagnosis.remarks import AT_END, remarks_on
from fricmodels.dimension import Motion
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.report.parameters import undetermined
from fricmodels.weakform.candidate import within_recording

INERTIA, VISCOUS, COULOMB, RISE = 0.05, 0.12, 0.8, 0.4


def record(lag: float, parts: int = 50) -> Recording:
    """Return a drive whose friction follows its own curve late [s], sampled every 10 ms; with one's own fine steps."""
    rng, step = np.random.default_rng(2), 0.01 / parts
    time = step * np.arange(6000 * parts)
    velocity = 2.0 * np.sin(3.0 * time) + 1.2 * np.sin(7.7 * time + 1.0)
    rate = 6.0 * np.cos(3.0 * time) + 9.24 * np.cos(7.7 * time + 1.0)
    curve, late = np.exp(-np.abs(velocity) / 0.4), np.empty(len(time))
    state, follows = curve[0], 1.0 - np.exp(-step / lag)
    for i, value in enumerate(curve):
        late[i] = state
        state += follows * (value - state)
    torque = INERTIA * rate + VISCOUS * velocity + (COULOMB + RISE * late) * np.sign(velocity)
    channels = {"time": time, "velocity": velocity, "torque": torque}
    sampled = {name: values[::parts].copy() for name, values in channels.items()}
    sampled["torque"] += 0.002 * rng.standard_normal(6000)
    return Recording("late", Motion.ROTARY, sampled, np.zeros(6000, dtype=np.int64))


@pytest.mark.parametrize(("lower", "upper"), [(0.0, 1e-9), (1e6, 2e6), (1.0, 1.0)])
def test_bounds_that_are_declared_beyond_what_a_recording_tells_are_kept(lower: float, upper: float) -> None:
    problem = compare(record(0.03), "coulomb-viscous", INERTIA).problem
    declared = Parameter("w", unit="rad/s", lower=lower, upper=upper, initial=upper, scan=(0.1, 0.3))
    found = within_recording(problem, declared)
    assert lower <= found.lower <= found.initial <= found.upper <= upper


@pytest.mark.parametrize(("lag", "told"), [(0.03, True), (0.007, False)])
def test_a_search_that_ends_at_what_the_recording_tells_says_so(lag: float, told: bool) -> None:
    comparison = compare(record(lag), "coulomb-viscous+frictional-lag", INERTIA)
    found = comparison.estimate.parameters["frictional-lag.T"]
    assert (found == pytest.approx(lag, rel=0.1)) is told
    assert (remarks_on(comparison).get("frictional-lag.T") == AT_END) is not told
    points = undetermined(comparison_document(comparison).steps[-1])
    assert any(text.startswith("At the end of what was sought: frictional-lag.T") for text in points) is not told
