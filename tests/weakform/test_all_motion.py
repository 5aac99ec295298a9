"""What is left over all motion tells effects that were fitted to the rows alone from those that hold everywhere."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.diagnosis import examine
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.comparison import Comparison, compare
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.verdict import select_effect, torque_share
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.weakform.all_motion import residual_rms
from fricmodels.weakform.estimate import estimate

Made = Callable[..., Recording]

PLAY = {
    "name": "backlash",
    "gap": 0.04,
    "contact_frequency": 120.0,
    "damping_ratio": 0.7,
    "load_inertia_share": 0.4,
    "load_friction_share": 0.6,
}


def rig(*effects: dict[str, object], **changed: object) -> Rig:
    made: dict[str, object] = {
        "inertia": 2.0,
        "friction": {"viscous": 4.0, "coulomb": 10.0},
        "effects": effects,
        "excitation": {"kind": "ramp", "velocity": 2.0, "period": 4.0, "bandwidth": 15.0},
        "sensors": {"velocity_noise_percent": 0.5},
        "rate": 500,
        "samples": 16_000,
        "seed": 3,
    }
    return Rig.model_validate({**made, **changed})


@pytest.mark.parametrize(("rate", "share"), [(100.0, 0.004), (500.0, 0.0013)])
def test_a_reversal_between_two_samples_is_no_error_of_a_true_model(made: Made, rate: float, share: float) -> None:
    """By means over cells; a single sample beside a jump has the torque of its other side: 0.006 and 0.0025."""
    recording = made(noise=0.0, rate=rate, samples=3000)
    problem, _ = estimate(Drive(Model.parse("coulomb-viscous"), 2.0), recording)
    assert residual_rms(problem) < share * np.sqrt(np.mean(recording.torque**2))


@pytest.fixture(scope="module")
def played() -> Comparison:
    return compare(rig(PLAY).simulate(), "coulomb-viscous", 2.0)


@pytest.mark.long
def test_the_play_of_the_simulated_drive_is_named(played: Comparison) -> None:
    found = examine(played)
    assert found.findings
    assert found.findings[0].names[0] == "backlash"
    parameters = found.findings[0].tested.parameters
    assert parameters["w"] == pytest.approx(0.04, rel=0.2)
    assert parameters["J_l"] == pytest.approx(0.8, rel=0.3)


@pytest.mark.long
def test_play_under_a_load_is_named() -> None:
    loaded = rig(PLAY, load={"bias": 0.5, "amplitude": 4.0, "frequency": 0.31})
    found = examine(compare(loaded.simulate(), "coulomb-viscous", 2.0))
    assert found.findings
    assert found.findings[0].names[0] == "backlash"


@pytest.mark.long
def test_a_tight_joint_has_no_play() -> None:
    found = examine(compare(rig().simulate(), "coulomb-viscous", 2.0))
    assert "backlash" not in [name for finding in found.findings for name in finding.names]


def test_the_true_effect_leaves_less_over_all_motion(played: Comparison) -> None:
    problem = played.problem
    (tested,) = candidate_tests(problem, played.estimate.parameters, only=["backlash"]).tested
    after = residual_rms(problem, problem.alone(tested.effect), tested.found.nonlinear, tested.found.kept)
    assert after < 0.8 * residual_rms(problem)


def test_what_is_left_counts_in_units_of_torque_and_with_a_free_inertia_too(played: Comparison) -> None:
    free = compare(rig(PLAY).simulate(), "coulomb-viscous")
    assert residual_rms(free.problem) == pytest.approx(residual_rms(played.problem), rel=0.1)
    moving = ~played.problem.resting
    assert residual_rms(played.problem) < np.sqrt(np.mean(played.problem.recording.torque[moving] ** 2))


def test_an_effect_that_says_nonsense_where_the_rows_are_silent_is_not_named(played: Comparison) -> None:
    """Of two effects of equal rows the one that multiplies what is left over all motion is refused."""
    result = candidate_tests(played.problem, played.estimate.parameters)
    best = select_effect(result)
    assert best is not None
    before = residual_rms(played.problem)
    for tested in best.members:
        alone = played.problem.alone(tested.effect)
        assert residual_rms(played.problem, alone, tested.found.nonlinear, tested.found.kept) <= 2 * before


@pytest.mark.long
@pytest.mark.parametrize(("gap", "names"), [(4e-4, [("backlash",)]), (0.0, [])])
def test_an_effect_of_the_reversals_alone_is_named_for_its_size_over_all_motion(
    gap: float, names: list[tuple[str, ...]]
) -> None:
    """The gap is crossed within the stretches that the rows leave out; in these the effect is too small to count."""
    tight = {**PLAY, "gap": gap, "load_inertia_share": 0.34, "contact_frequency": 300.0, "damping_ratio": 0.43}
    tracking = {"kind": "tracking", "velocity": 1.2, "frequency": 0.64, "lines": 3, "bandwidth": 22.0}
    drive = rig(
        *([tight] if gap else []),
        inertia=1.2,
        friction={"viscous": [10.0, 7.0], "coulomb": [12.5, 8.5]},
        excitation={**tracking, "damping_ratio": 1.0},
        rate=680,
        samples=12_000,
        seed=1,
    )
    found = examine(compare(drive.simulate(), "asymmetric-coulomb-viscous", 1.2))
    assert [finding.names for finding in found.findings] == names
    for finding in found.findings:
        result = candidate_tests(found.comparison.problem, found.comparison.estimate.parameters, only=finding.names)
        assert torque_share(result, finding.tested.evidence) < POLICY.least_torque
