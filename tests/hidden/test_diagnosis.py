"""A short hidden-effect challenge: effects named, nothing named where nothing is hidden, and what must not matter."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache

import pytest

from fricmodels.diagnosis import Diagnosis, diagnose, improve
from fricmodels.diagnosis.ladder import added
from fricmodels.diagnosis.necessity import necessity
from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig

Draw = Callable[..., tuple[Rig, Recording]]
SAMPLES = 6_000


def diagnosed(rig: Rig, recording: Recording, leave_out: Iterable[str] = ()) -> Diagnosis:
    return diagnose(recording, Model.parse(rig.friction.law), rig.inertia, leave_out=leave_out)


def names(diagnosis: Diagnosis) -> tuple[str, ...]:
    return diagnosis.findings[0].names if diagnosis.findings else ()


@pytest.mark.parametrize(
    ("effect", "excitation"),
    [
        pytest.param("cogging", "tracking", marks=pytest.mark.long),
        pytest.param("position-friction", "tracking", marks=pytest.mark.long),
        ("gravity", "tracking"),
        pytest.param("stiffness", "ramp", marks=pytest.mark.long),
        pytest.param("stribeck", "ramp", marks=pytest.mark.long),
        pytest.param("nonlinear-viscous", "multisine", marks=pytest.mark.long),
        pytest.param("load-friction", "tracking", marks=pytest.mark.long),
        pytest.param("inertia-error", "multisine", marks=pytest.mark.long),
        pytest.param("sensor-delay", "multisine", marks=pytest.mark.long),
        pytest.param("sensor-delay", "tracking", marks=pytest.mark.long),
        pytest.param("thermal", "sine", marks=pytest.mark.long),
        ("step-change", "multisine"),
    ],
)
def test_the_hidden_effect_is_named(hidden: Draw, effect: str, excitation: str) -> None:
    rig, recording = hidden(effect, seed=1, size=0.2, noise_percent=1.0, excitation=excitation, samples=SAMPLES)
    diagnosis = diagnosed(rig, recording)
    assert effect in names(diagnosis)
    assert diagnosis.verdict == ("missing-effect" if len(names(diagnosis)) == 1 else "undecided")
    assert diagnosis.findings[0].tested.evidence.gain > 0.1


@pytest.mark.long
def test_the_instant_of_a_jump_is_found_next_to_a_rest(hidden: Draw) -> None:
    """All instants of a rest explain the same: a search that begins on that plateau has to look beyond it."""
    rig, recording = hidden("step-change", seed=1, size=0.2, noise_percent=1.0, excitation="multisine", samples=12_000)
    (hidden_jump,) = rig.effects
    found = diagnosed(rig, recording).findings[0].tested.parameters
    assert found["t_0"] == pytest.approx(hidden_jump.time, abs=0.05)
    assert found["c"] == pytest.approx(hidden_jump.coulomb, rel=0.02)


CLEAN = ("multisine", "trapezoid")
"""Excitations of which nothing is named quickly: a steady one, and one with rests; others in ``make test-long``."""


@pytest.mark.parametrize(
    "excitation",
    [*CLEAN, *(pytest.param(each, marks=pytest.mark.long) for each in ("sine", "tracking", "stair", "ramp"))],
)
def test_nothing_is_named_where_nothing_is_hidden(hidden: Draw, excitation: str) -> None:
    rig, recording = hidden(seed=2, excitation=excitation, noise_percent=1.0, samples=SAMPLES)
    assert diagnosed(rig, recording).verdict == "adequate"


def test_an_asymmetry_is_not_told_from_an_offset_while_sliding(hidden: Draw) -> None:
    rig, recording = hidden("torque-offset", seed=3, size=0.15, excitation="multisine", samples=SAMPLES)
    diagnosis = diagnosed(rig, recording)
    assert set(names(diagnosis)) == {"asymmetry", "torque-offset"}
    assert "static test" in diagnosis.findings[0].separated_by


@pytest.mark.long
def test_what_stood_for_two_effects_gives_way_once_one_of_them_is_known(hidden: Draw) -> None:
    rig, recording = hidden("sensor-delay", "inertia-error", seed=4, size=0.2, excitation="tracking", samples=SAMPLES)
    ladder = improve(recording, Model.parse(rig.friction.law), rig.inertia)
    truth = {"sensor-delay", "inertia-error"}
    stood_for_both = {rung.added for rung in ladder.rungs if rung.added} - truth
    assert stood_for_both <= {name for rung in ladder.rungs for name in rung.removed.split("+")}
    assert {finding.names[0] for finding in added(ladder)} == truth
    assert {effect.name for effect in ladder.rungs[-1].comparison.drive.model.effects} == truth
    errors = [rung.comparison.sliding.held_out_percent for rung in ladder.rungs]
    assert errors[-1] < 1.025 * min(errors)


@pytest.mark.long
def test_a_delay_and_another_effect_are_told_apart(hidden: Draw) -> None:
    rig, recording = hidden("sensor-delay", "gravity", seed=7, size=0.2, excitation="tracking", samples=SAMPLES)
    ladder = improve(recording, Model.parse(rig.friction.law), rig.inertia)
    final = ladder.rungs[-1].comparison
    assert {effect.name for effect in final.drive.model.effects} == {"sensor-delay", "gravity"}
    assert final.sliding.held_out_percent < 0.2 * ladder.rungs[0].comparison.sliding.held_out_percent
    for name in ("sensor-delay", "gravity"):
        assert necessity(final, name).gain > 0.5
    (delay,) = (effect.delay for effect in rig.effects if effect.name == "sensor-delay")
    # A held torque is half a sample late by itself.
    assert abs(abs(final.estimate.parameters["sensor-delay.T"]) - delay) < recording.interval


@pytest.mark.long
def test_two_effects_are_found_in_turn(hidden: Draw) -> None:
    rig, recording = hidden("cogging", "load-friction", seed=4, size=0.2, excitation="tracking", samples=SAMPLES)
    ladder = improve(recording, Model.parse(rig.friction.law), rig.inertia)
    final = ladder.rungs[-1].comparison
    assert {effect.name for effect in final.drive.model.effects} == {"cogging", "load-friction"}
    errors = [rung.comparison.sliding.held_out_percent for rung in ladder.rungs]
    assert errors == sorted(errors, reverse=True)
    assert final.sliding.held_out_percent < 0.5 * errors[0]


HIDING = {
    "neither helps alone": {
        "inertia": 80.43669636378648,
        "friction": {"viscous": 270.96386426114964, "coulomb": 29.142880297910917},
        "effects": [
            {"name": "inertia-error", "error": -0.14197431757033988},
            {"name": "sensor-delay", "delay": 0.01770685948551036},
        ],
        "load": {"bias": 7.826893038840037, "amplitude": 43.818316100973156, "frequency": 0.19272405538671453},
        "excitation": {
            "kind": "tracking",
            "bandwidth": 6.282511425929041,
            "damping_ratio": 0.7989434184057994,
            "velocity": 0.11337698247005447,
            "frequency": 0.22730613073997133,
            "lines": 6,
        },
        "rate": 192.1643102220055,
        "hold": False,
        "rest_speed": 1.6196711781436355e-05,
        "samples": 20_000,
        "seed": 340904914,
    },
    "a simpler one does as well": {
        "inertia": 185.0,
        "friction": {"viscous": 339.0, "coulomb": 34.0},
        "effects": [{"name": "sensor-delay", "delay": 0.064}, {"name": "inertia-error", "error": -0.38}],
        "load": {"bias": 4.2, "amplitude": 115.0, "frequency": 0.0887},
        "excitation": {
            "kind": "tracking",
            "bandwidth": 2.8,
            "damping_ratio": 0.85,
            "velocity": 0.21,
            "frequency": 0.104,
            "lines": 3,
        },
        "rate": 168.0,
        "samples": SAMPLES,
        "seed": 2,
    },
}


@pytest.mark.long
@pytest.mark.parametrize("case", HIDING)
def test_two_effects_that_hide_each_other_are_found(case: str) -> None:
    """The first one found stands for both; it gives way, or helps only together with the second."""
    rig = Rig.model_validate({"motion": "linear", "sensors": {"velocity_noise_percent": 0.91}, **HIDING[case]})
    ladder = improve(rig.simulate(), rig.friction.law, rig.inertia)
    final = ladder.rungs[-1].comparison
    assert {effect.name for effect in final.drive.model.effects} == {"inertia-error", "sensor-delay"}
    errors = [rung.comparison.sliding.held_out_percent for rung in ladder.rungs]
    assert errors[-1] < 0.2 * errors[0]
    assert ladder.last.verdict == "adequate"


LOOK_ALIKES = {
    "load-friction": {"load-friction", "directional-efficiency"},
    "thermal": {"thermal", "drift", "step-change"},
}


@pytest.mark.parametrize(
    ("effect", "view"),
    [pytest.param("load-friction", "load torque", marks=pytest.mark.long), ("thermal", "temperature")],
)
def test_an_effect_off_the_list_leaves_a_trace(hidden: Draw, effect: str, view: str) -> None:
    diagnosis = off_the_list(hidden, effect)
    assert diagnosis.verdict != "adequate"
    assert diagnosis.view is not None
    assert diagnosis.view.channels.startswith(view)
    assert diagnosis.view.evidence.gain > 0.8


@pytest.mark.parametrize("effect", [pytest.param("load-friction", marks=pytest.mark.long), "thermal"])
def test_an_effect_off_the_list_is_unknown(hidden: Draw, effect: str) -> None:
    assert off_the_list(hidden, effect).verdict == "unknown-effect"


@lru_cache
def off_the_list(hidden: Draw, effect: str) -> Diagnosis:
    excitation = "multisine" if effect == "thermal" else "ramp"
    rig, recording = hidden(effect, seed=1, size=0.2, noise_percent=1.0, excitation=excitation, samples=SAMPLES)
    return diagnosed(rig, recording, leave_out=LOOK_ALIKES[effect])


def rescaled(rig: Rig, recording: Recording, mass: float, length: float, time: float) -> tuple[Rig, Recording]:
    """Return the same motion in other units; angles have none."""
    linear = recording.motion is Motion.LINEAR
    way, force = (length, mass * length / time**2) if linear else (1.0, mass * length**2 / time**2)
    factors = {"time": time, "torque": force, "velocity": way / time, "position": way, "load_torque": force}
    channels = {name: values * factors.get(name, 1.0) for name, values in recording.channels.items()}
    inertia = rig.inertia * (mass if linear else mass * length**2)
    return rig.model_copy(update={"inertia": inertia}), replace(recording, channels=channels)


def shifted(rig: Rig, recording: Recording) -> tuple[Rig, Recording]:
    return rig, replace(recording, channels={**recording.channels, "time": recording.time + 1234.5})


def mirrored(rig: Rig, recording: Recording) -> tuple[Rig, Recording]:
    turned = ("torque", "velocity", "position", "load_torque")
    channels = {name: -values if name in turned else values for name, values in recording.channels.items()}
    return rig, replace(recording, channels=channels)


CHANGES: dict[str, Callable[[Rig, Recording], tuple[Rig, Recording]]] = {
    "units": lambda rig, recording: rescaled(rig, recording, 1e3, 1e-3, 60.0),
    "time shift": shifted,
    "mirrored": mirrored,
}


@lru_cache(maxsize=2)
def as_it_was(hidden: Draw, effect: str, scale: str) -> tuple[Rig, Recording, Diagnosis]:
    options = {"seed": 5, "size": 0.2, "noise_percent": 1.0, "excitation": "tracking", "samples": SAMPLES}
    rig, recording = hidden(effect, scale=scale, **options)
    return rig, recording, diagnosed(rig, recording)


WAVE, CURVE = ("position-friction", "linear-axis"), ("stribeck", "robot-joint")


@pytest.mark.parametrize(
    ("effect", "scale", "change"),
    [
        pytest.param(*WAVE, "units", marks=pytest.mark.long),
        pytest.param(*WAVE, "time shift", marks=pytest.mark.long),
        pytest.param(*WAVE, "mirrored", marks=pytest.mark.long),
        pytest.param(*CURVE, "units", marks=pytest.mark.long),
        (*CURVE, "time shift"),
        pytest.param(*CURVE, "mirrored", marks=pytest.mark.long),
    ],
)
def test_the_answer_does_not_depend_on_how_motion_is_described(
    hidden: Draw, effect: str, scale: str, change: str
) -> None:
    rig, recording, before = as_it_was(hidden, effect, scale)
    after = diagnosed(*CHANGES[change](rig, recording))
    assert after.verdict == before.verdict
    assert names(after) == names(before)
    assert names(before)
    pairs = zip(before.findings[:1], after.findings[:1], strict=True)
    for one, other in pairs:
        assert other.tested.evidence.explained == pytest.approx(one.tested.evidence.explained, rel=0.02)
    # Filter widths are chosen from the data in steps of a quarter; rounding can tip the choice.
    assert after.comparison.sliding.percent == pytest.approx(before.comparison.sliding.percent, rel=0.1)
    # A window of so many milliseconds is another one where a unit of time is another one; a sample stays a sample.
    one, other = before.comparison.errors.per_sample, after.comparison.errors.per_sample
    assert other.percent == pytest.approx(one.percent, rel=1e-3)
    assert other.noise_floor_percent == pytest.approx(one.noise_floor_percent, rel=1e-3)
