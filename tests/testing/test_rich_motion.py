"""The rich motion has what a term asks for, and the term is found in it again."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels import plugins
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.simulation import simulate
from fricmodels.testing import EffectExam, sit
from fricmodels.testing.recovery import rich_case
from fricmodels.testing.subject import subject

EFFECTS = plugins.load().effects


@pytest.mark.parametrize(
    ("name", "units"),
    [("other-friction", {"other.x": "rad/s"}), ("other-gravity", {"other.x": "rad"}), ("run-offset", {})],
)
def test_the_motion_has_what_a_candidate_asks_for(name: str, units: dict[str, str]) -> None:
    recording = rich_case(subject(EFFECTS[name])).recording
    assert dict(recording.units) == units
    assert (len(set(recording.run)) > 1) is (name == "run-offset")


@pytest.mark.parametrize(
    "name",
    ["other", "other-friction", "other-gravity", "chain-gravity", "other-inertia", "proximal-coupling", "run-offset"],
)
def test_what_asks_for_more_channels_or_runs_is_examined_not_skipped(name: str) -> None:
    exam = type("Exam", (EffectExam,), {"term": EFFECTS[name]})
    for check in ("test_identifiable", "test_recovered"):
        assert sit(exam, check).result == "passed"


def test_each_run_is_simulated_from_rest_with_its_own_offset() -> None:
    drive = Drive(Model.parse("coulomb-viscous+run-offset"), 0.1)
    values = {"K_v": 0.5, "K_c": 0.0, "run-offset.tau_0": 0.2, "run-offset.tau_1": -0.2}
    time = np.tile(0.01 * np.arange(400), 2)
    made = simulate(drive, values, time, 0.0, run=np.arange(800) // 400)
    for number, final in ((0, -0.4), (1, 0.4)):
        inside = made.run == number
        expected = final * (1 - np.exp(-made.time[inside] / 0.2))
        assert np.allclose(made.velocity[inside], expected, atol=1e-4)


def test_a_further_channel_drives_the_simulation() -> None:
    drive = Drive(Model.parse("coulomb-viscous+other(x)"), 0.1)
    values = {"K_v": 0.5, "K_c": 0.0, "other(x).c": -0.1}
    time = 0.01 * np.arange(400)
    made = simulate(drive, values, time, 0.0, further={"other.x": np.full(400, 2.0)}, units={"other.x": "A"})
    assert np.allclose(made.velocity, 0.4 * (1 - np.exp(-time / 0.2)), atol=1e-4)
    assert made.units == {"other.x": "A"}
