"""What was recorded beside a joint: told from friction, whatever its unit, and added to a model."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose, improve
from fricmodels.diagnosis.explain import explain
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording

Made = Callable[..., Recording]
OTHER = "other(j2_acceleration)"
COUPLING = 0.2


def coupled(
    made: Made, seed: int, coupling: float = COUPLING, friction: float = 0.0, samples: int = 6000, unrelated: int = 2
) -> Recording:
    """A joint that another one pulls at, and joints that have nothing to do with it."""
    own = made(seed=seed, samples=samples)
    rng = np.random.default_rng(100 + seed)
    channels, units = {}, {}
    for joint in range(2, 3 + unrelated):
        omega, phase = 2 * np.pi * rng.uniform(0.2, 2.5, 3), rng.uniform(0, 2 * np.pi, 3)
        angles = omega[:, None] * own.time + phase[:, None]
        motion = (np.cos(angles).T @ (1 / omega), -np.sin(angles).sum(0), -np.cos(angles).T @ omega)
        for values, name, unit in zip(
            motion, ("position", "velocity", "acceleration"), ("rad", "rad/s", "rad/s^2"), strict=True
        ):
            channels[f"other.j{joint}_{name}"] = values
            units[f"other.j{joint}_{name}"] = unit
    pull = coupling * channels["other.j2_acceleration"] + friction * np.sign(channels["other.j2_velocity"])
    noise = 0.02 * rng.standard_normal(samples)
    return Recording(
        "joint 1",
        Motion.ROTARY,
        {**own.channels, **channels, "torque": own.torque + pull + noise},
        own.run,
        units=units,
    )


def test_another_joint_is_named_with_its_inertia_and_added(made: Made) -> None:
    ladder = improve(coupled(made, 0), "coulomb-viscous", 2.0)
    assert ladder.first.verdict == "missing-effect"
    assert ladder.rungs[-1].model == f"coulomb-viscous+{OTHER}"
    assert ladder.last.verdict == "adequate"
    said = explain(ladder.first, ladder)
    assert "goes with the acceleration of joint 2 (channel j2_acceleration): rigid-body coupling, not friction" in said
    found = re.search(r"c = ([\d.]+) ± ([\d.e-]+) kg", said)
    assert found is not None
    value, error = map(float, found.groups())
    assert value == pytest.approx(0.2, rel=1e-3)
    assert abs(value - 0.2) < 3 * error
    assert "kg m^2" in said


def test_velocities_alone_tell_of_an_inertia_too(made: Made) -> None:
    own = coupled(made, 0, unrelated=1)
    kept = {name: values for name, values in own.channels.items() if not name.endswith("_acceleration")}
    units = {name: unit for name, unit in own.units.items() if name in kept}
    recording = Recording("joint 1", own.motion, kept, own.run, units=units)
    found = diagnose(recording, "coulomb-viscous", 2.0).findings[0]
    assert found.names == ("other-inertia(j2_velocity)",)
    assert found.tested.parameters["c"] == pytest.approx(COUPLING, rel=0.02)
    assert found.tested.effect.parameters[0].unit_for(Motion.ROTARY) == "kg m^2"


def test_friction_of_a_part_that_moves_with_another_joint(made: Made) -> None:
    found = diagnose(coupled(made, 1, coupling=0.0, friction=0.4), "coulomb-viscous", 2.0)
    assert [finding.names for finding in found.findings] == [("other-friction(j2_velocity)",)]
    assert found.findings[0].tested.parameters["d"] == pytest.approx(0.4, abs=0.02)


@pytest.mark.parametrize("seed", [pytest.param(2, marks=pytest.mark.long), 3])
def test_joints_that_do_nothing_are_not_named(made: Made, seed: int) -> None:
    found = diagnose(coupled(made, seed, coupling=0.0), "coulomb-viscous", 2.0)
    assert (found.verdict, found.findings, found.view) == ("adequate", (), None)


@pytest.mark.long
def test_the_inertia_lies_within_its_interval(made: Made) -> None:
    """Of 30 intervals of 95 % no fewer than 25 hold the truth, as in 99.8 % of all cases."""
    inside = 0
    for seed in range(30):
        estimate = compare(coupled(made, seed, unrelated=0, samples=3000), f"coulomb-viscous+{OTHER}", 2.0).estimate
        apart = estimate.parameters[f"{OTHER}.c"] - COUPLING
        inside += abs(apart) < 1.96 * estimate.standard_errors[f"{OTHER}.c"]
    assert inside >= 25


@pytest.mark.long
@pytest.mark.parametrize("factor", [180 / np.pi, 1e-6])
def test_another_unit_is_another_coefficient_and_the_same_answer(made: Made, factor: float) -> None:
    own = coupled(made, 0, samples=4000, unrelated=0)
    name = "other.j2_acceleration"
    other = own.with_channels(derived=False, **{name: factor * own[name]})
    first, second = (diagnose(each, "coulomb-viscous", 2.0).findings[0] for each in (own, other))
    assert second.names == first.names == (OTHER,)
    assert second.tested.parameters["c"] * factor == pytest.approx(first.tested.parameters["c"], rel=1e-9)
    assert second.tested.evidence.gain == pytest.approx(first.tested.evidence.gain, rel=1e-6)


@pytest.mark.parametrize(
    ("motion", "unit", "expected"),
    [
        (Motion.ROTARY, "rad/s^2", "kg m^2"),
        (Motion.ROTARY, "rad/s", "N m s/rad"),
        (Motion.ROTARY, "A", "N m/A"),
        (Motion.ROTARY, "m/s", "N m/(m/s)"),
        (Motion.ROTARY, "", "N m/[drum]"),
        (Motion.LINEAR, "m/s^2", "kg"),
        (Motion.LINEAR, "rad/s^2", "N/(rad/s^2)"),
    ],
)
def test_the_unit_of_a_coefficient(motion: Motion, unit: str, expected: str) -> None:
    channels = {name: np.ones(2) for name in ("time", "torque", "velocity", "other.drum")}
    recording = Recording("r", motion, channels, np.zeros(2, dtype=np.int64), units={"other.drum": unit})
    model = Model.parse("coulomb-viscous+other(drum)").on(recording)
    assert model.parameters[-1].declared.unit_for(motion) == expected
    assert model.name == "coulomb-viscous+other(drum)"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("other", r"'other' is of a further channel; name it: other\(CHANNEL\)"),
        ("stribeck(x)", "'stribeck' takes nothing in brackets, found 'x'"),
        ("other(x", r"'other\(x' lacks its closing bracket"),
    ],
)
def test_names_that_mean_nothing(name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Model.parse(f"coulomb-viscous+{name}")


def test_a_channel_that_is_missing_or_of_another_kind(made: Made) -> None:
    recording = coupled(made, 0, samples=1000, unrelated=0)
    with pytest.raises(InputError, match=r"--column other.j3_velocity=COLUMN\[:UNIT\]"):
        compare(recording, "coulomb-viscous+other(j3_velocity)", 2.0)
    with pytest.raises(InputError, match=r"is of a channel in m/s or rad/s; 'other.j2_acceleration' is in rad/s"):
        compare(recording, "coulomb-viscous+other-friction(j2_acceleration)", 2.0)
