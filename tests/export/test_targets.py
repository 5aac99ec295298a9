"""Exports against their programs and against the whole model: what is written is nearest, and said to be."""

from __future__ import annotations

import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fricmodels
from fricmodels.arrays import rms
from fricmodels.errors import InputError
from fricmodels.export.targets import TARGETS, export_model
from fricmodels.export.targets.nearest import COULOMB_VISCOUS, MUJOCO, nearest
from fricmodels.export.targets.validity import motion_over
from fricmodels.recording import Recording

ROBOT = """<mujoco>
  <!-- a comment that stays -->
  <option gravity="0 0 0" timestep="0.0005" integrator="RK4"/>
  <worldbody><body><joint name="elbow" type="hinge" axis="0 0 1"/><geom size="0.1" mass="1e-9"/></body></worldbody>
  <actuator><motor name="m" joint="elbow"/></actuator>
</mujoco>"""
ARM = '<robot name="r"><link name="a"/><joint name="elbow" type="revolute"><parent link="a"/></joint></robot>'


def loaded(text: str) -> tuple[Any, Any, Any]:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed; pip install mujoco")
    model = mujoco.MjModel.from_xml_string(text)
    return mujoco, model, mujoco.MjData(model)


def friction_in(data: Any) -> float:
    """Return the friction torque of a joint that slides: what its motor's torque loses."""
    return float(-(data.qfrc_passive[0] + data.qfrc_constraint[0] + data.qfrc_actuator[0] - data.ctrl[0]))


@pytest.mark.parametrize(
    "name",
    [
        "coulomb-viscous",
        "coulomb-viscous+cogging",
        "coulomb-viscous+cogging+torque-offset",
        "coulomb-viscous+cogging+cogging(2)",
        "coulomb-viscous+stiffness",
        "coulomb-viscous+stiffness+cogging",
    ],
)
def test_mujoco_has_the_torque_that_it_can_express(kept: Callable[..., Any], name: str) -> None:
    """Along a simulation in MuJoCo under a sine, MuJoCo's own friction is the model's, while the joint slides."""
    model = kept(name, {"K_v": 0.3, "K_c": 0.8})
    done = export_model(model, "mjcf", name="elbow", into=ROBOT, armature=model.inertia)
    assert done.nearest is not None
    assert done.nearest.how == "exact"
    assert done.nearest.cost == 0.0
    assert "a comment that stays" in done.text
    mujoco, m, d = loaded(done.text)
    assert m.nu == 1, "passive motors take no control"
    worst, compared = 0.0, 0
    for k in range(4000):
        d.ctrl[0] = 9.0 * math.sin(2e-3 * k)
        mujoco.mj_forward(m, d)
        if abs(d.qvel[0]) > 0.3:
            expected = model.torque(velocity=d.qvel[0], position=d.qpos[0])
            worst = max(worst, abs(friction_in(d) - expected))
            compared += 1
        mujoco.mj_step(m, d)
    assert compared > 1500
    assert worst <= 1e-9


def test_mujoco_simulates_the_motion_of_this_package(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous+cogging", {"K_v": 0.3, "K_c": 0.8})
    done = export_model(model, "mjcf", name="elbow", into=ROBOT, armature=model.inertia)
    mujoco, m, d = loaded(done.text)
    torque = 4.0 + 3.0 * np.sin(2e-3 * np.arange(2000))  # it never comes to rest
    velocity = np.empty(len(torque))
    d.qvel[0] = 3.0
    for k, push in enumerate(torque):
        velocity[k] = d.qvel[0]
        d.ctrl[0] = push
        mujoco.mj_step(m, d)
    own = model.simulate(torque, {"velocity": 3.0}, interval=5e-4, between_samples="held")
    assert np.min(own.velocity) > 0.3
    np.testing.assert_allclose(velocity, own.velocity, rtol=2e-4)


def test_mujoco_has_the_lugre_law_as_it_is(kept: Callable[..., Any]) -> None:
    if "lugre" not in fricmodels.plugins.load().laws:
        pytest.skip("the plugin fricmodels-lugre is not installed")
    values = {"F_c": 0.5, "sigma_1": 3.0, "sigma_2": 0.2, "z_c": 5e-4, "r": 1.6, "v_s": 0.05}
    model = kept("lugre", values)
    done = export_model(model, "mjcf", name="elbow", into=ROBOT, armature=2.0)
    mujoco, m, d = loaded(done.text)
    rng = np.random.default_rng(3)
    for velocity, deflection in zip(rng.uniform(-1, 1, 200), rng.uniform(-1.5, 1.5, 200), strict=True):
        d.qvel[0], d.act[0] = velocity, deflection * values["z_c"]
        mujoco.mj_forward(m, d)
        expected = model.torque(velocity=velocity, states=[deflection])
        assert friction_in(d) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_writing_twice_is_writing_once(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous+cogging+cogging(2)")
    once = export_model(model, "mjcf", name="elbow", into=ROBOT).text
    twice = export_model(model, "mjcf", name="elbow", into=once).text
    assert once.count("<dcmotor") == twice.count("<dcmotor") == 4


@pytest.fixture(scope="module")
def curved(made: Callable[..., Recording]) -> tuple[Any, Recording]:
    recording = made("coulomb-viscous+stribeck", {"stribeck.F_s": 2.0, "stribeck.omega_s": 1.0, "stribeck.delta": 1.0})
    return fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous+stribeck", 2.0)), recording


def test_what_cannot_be_expressed_is_refitted_not_cut_off(curved: tuple[Any, Recording]) -> None:
    """The refit errs less than the model with its Stribeck part cut off, and both figures are told."""
    model, recording = curved
    found = nearest(model, COULOMB_VISCOUS, recording)
    motion = fricmodels.diagnosis.ready(recording)
    full = model.torque(motion)
    refit = found.drive.friction(motion, found.parameters)
    cut = model.parameters["K_v"] * motion.velocity + model.parameters["K_c"] * np.sign(motion.velocity)
    assert found.how == "refitted"
    assert found.cost == pytest.approx(rms(full - refit), rel=1e-9)
    assert found.cost < 0.6 * rms(full - cut)
    assert [one.name for one in found.left_out] == ["stribeck"]
    assert found.left_out[0].torque == pytest.approx(rms(full - cut), rel=0.02)
    assert found.test_percent is not None
    assert found.test_percent[1] > 2 * found.test_percent[0]
    assert any("cost: RMS" in note for note in found.notes("N m"))


def test_without_a_recording_it_is_projected_and_says_so(curved: tuple[Any, Recording]) -> None:
    """Over the range, no other numbers of the target's law come nearer."""
    model, _ = curved
    found = nearest(model, COULOMB_VISCOUS)
    assert found.how == "projected"
    assert any("not refitted" in note for note in found.notes("N m"))
    motion = motion_over(model)
    for name, (low, high) in model.ranges.items():
        if name in motion:
            span = high - low
            assert motion[name].min() == pytest.approx(low, abs=0.01 * span)
            assert motion[name].max() == pytest.approx(high, abs=0.01 * span)
    full = model.torque(motion)
    for key in ("K_v", "K_c"):
        for factor in (0.97, 1.03):
            other = {**found.parameters, key: factor * found.parameters[key]}
            assert rms(full - found.drive.friction(motion, other)) > found.cost


def test_a_bending_contact_does_not_become_viscous(kept: Callable[..., Any]) -> None:
    """Over strokes as long as recorded a contact that bends over a hundredth of them hardly counts."""
    bend = {"presliding.F_1": 0.2, "presliding.F_2": 0.2, "presliding.D": 0.5, "presliding.x_s": 0.01}
    model = kept("coulomb-viscous+presliding", {"K_v": 0.3, "K_c": 0.8, **bend})
    motion = motion_over(model)
    low, high = model.ranges["position"]
    turns = np.flatnonzero(np.diff(np.sign(motion.velocity)) != 0)
    ways = np.abs(np.add.reduceat(motion.velocity * np.gradient(motion.time), turns))[:-1]
    assert np.median(ways) == pytest.approx(high - low, rel=0.1)
    found = nearest(model, COULOMB_VISCOUS)
    assert found.parameters["K_v"] == pytest.approx(0.3, rel=0.1)
    assert found.parameters["K_c"] == pytest.approx(0.8, rel=0.1)


def test_a_law_of_the_target_comes_through_unchanged(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous", {"K_v": 0.125, "K_c": 0.75})
    for target in ("urdf", "ros2", "isaac", "mjcf"):
        done = export_model(model, target, name="elbow")
        assert done.nearest is not None
        assert done.nearest.how == "exact"
        assert "0.125" in done.text
        assert "0.75" in done.text
    urdf = ET.fromstring(export_model(model, "urdf", name="elbow", into=ARM).text)
    dynamics = urdf.find("joint/dynamics")
    assert dynamics is not None
    assert dynamics.attrib == {"damping": "0.125", "friction": "0.75"}


def test_gravity_is_left_to_the_links_and_does_not_bend_the_friction(made: Callable[..., Recording]) -> None:
    recording = made("coulomb-viscous+gravity", {"gravity.a": 4.0, "gravity.b": -2.0})
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous+gravity", 2.0))
    for found in (nearest(model, COULOMB_VISCOUS, recording), nearest(model, MUJOCO)):
        assert [one.name for one in found.left_out] == ["gravity"]
        assert found.how == "exact"
        assert found.parameters["K_c"] == pytest.approx(3.0, rel=0.02)


def test_isaac_breaks_away_at_the_whole_model_s_torque(kept: Callable[..., Any]) -> None:
    values = {"K_v": 0.1, "K_c": 2.0, "C": 1.0, "B": 3.0}
    model = kept("exponential-stick-slip", values)
    given: dict[str, Any] = {}
    text = export_model(model, "isaac", name="elbow").text
    for line in text.splitlines():
        if "{" in line:
            key, _, rest = line.strip().partition("=")
            given[key] = float(rest.split(":")[1].rstrip("},"))
    assert given["friction"] == pytest.approx(2.0, rel=1e-6)
    assert 1.0 <= given["dynamic_friction"] <= 2.0
    compile(text, "isaac", "exec")


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", ["coulomb-viscous", "exponential-stick-slip+presliding+thermal+load-friction"])
def test_nothing_undetermined_goes_out_in_silence(kept: Callable[..., Any], target: str, name: str) -> None:
    law = "K_v"
    done = export_model(kept(name, not_identified={law: "its interval contains zero"}), target, name="elbow")
    assert any("NOT DETERMINED" in note for note in done.notes)
    assert "NOT DETERMINED" in done.text or json.loads(done.text)["parameters"][law]["identified"] is False
    if target in ("urdf", "drake", "ros2", "mjcf"):
        ET.fromstring(f"<x xmlns:drake='d'>{done.text}</x>")


def test_a_constant_is_fitted_once(made: Callable[..., Recording]) -> None:
    """An asymmetric law is a constant and a symmetric one: MuJoCo has both, whether or not an offset is named."""
    values = {"K_v1": 0.5, "K_v2": 0.5, "K_c1": 3.5, "K_c2": 2.5}
    recording = made("asymmetric-coulomb-viscous", values)
    for name in ("asymmetric-coulomb-viscous", "asymmetric-coulomb-viscous+torque-offset"):
        model = fricmodels.keep(fricmodels.compare(recording, name, 2.0))
        for given in (recording, None):
            found = nearest(model, MUJOCO, given)
            (constant,) = [value for key, value in found.parameters.items() if key.endswith("tau_0")]
            assert constant == pytest.approx(0.5, abs=0.02)
            assert found.parameters["K_c"] == pytest.approx(3.0, abs=0.05)
            assert found.cost < 0.02 * found.torque


def test_a_spring_is_written_beside_a_friction_that_is_refitted(made: Callable[..., Recording]) -> None:
    """Its constant is the one of an asymmetric law, too: of both together the recording tells one."""
    values = {"K_v1": 0.5, "K_v2": 0.5, "K_c1": 3.5, "K_c2": 2.5, "stiffness.k": 4.0, "stiffness.tau_0": 0.2}
    recording = made("asymmetric-coulomb-viscous+stiffness", values)
    model = fricmodels.keep(fricmodels.compare(recording, "asymmetric-coulomb-viscous+stiffness", 2.0))
    for given in (recording, None):
        done = export_model(model, "mjcf", name="elbow", recording=given)
        assert done.nearest is not None
        assert done.nearest.parameters["stiffness.k"] == pytest.approx(4.0, rel=0.02)
        assert done.nearest.parameters["stiffness.tau_0"] == pytest.approx(0.7, abs=0.03)
        assert not done.nearest.not_identified
        root = ET.fromstring(f"<x>{done.text}</x>")
        joint = root.find("joint")
        assert joint is not None
        assert float(joint.get("stiffness", "nan")) == done.nearest.parameters["stiffness.k"]
        assert joint.get("springref") == "0"
        assert any("elbow_offset: leave it out where it is the weight" in note for note in done.notes)


def test_a_compliance_that_is_left_out_changes_no_friction(kept: Callable[..., Any]) -> None:
    """Refitted in its place the friction would make the torque of a body that swings on a spring."""
    values = {"joint-compliance.J_l": 0.03, "joint-compliance.omega_n": 75.0, "joint-compliance.zeta": 0.02}
    model = kept("coulomb-viscous+joint-compliance", {"K_v": 0.1, "K_c": 0.6, **values})
    for target, damping in (
        ("mjcf", 'damping="0.1 0.0 0.0" frictionloss="0.6"'),
        ("urdf", 'damping="0.1" friction="0.6"'),
    ):
        done = export_model(model, target, name="elbow")
        assert done.nearest is not None
        assert done.nearest.how == "exact"
        assert damping in done.text
        assert any("left out: joint-compliance" in note for note in done.notes)


def test_friction_that_is_the_same_in_both_directions_has_no_offset(curved: tuple[Any, Recording]) -> None:
    model, recording = curved
    for given in (recording, None):
        assert "torque-offset.tau_0" not in nearest(model, MUJOCO, given).parameters


def test_an_angle_that_may_be_zero_is_determined(made: Callable[..., Recording]) -> None:
    """Friction of gravity about φ = 0 is known to a thousandth of a radian: zero is an angle like any other."""
    name = "coulomb-viscous+gravity+gravity-friction"
    values = {"K_c": 0.4, "gravity.a": 0.0, "gravity.b": 2.0, "gravity-friction.c": 0.8, "gravity-friction.phi": 0.0}
    model = fricmodels.keep(fricmodels.compare(made(name, values), name, 2.0))
    assert model.standard_errors["gravity-friction.phi"] < 0.01
    assert "gravity-friction.phi" in model.not_identified
    for target in ("c", "mjcf", "urdf"):
        assert not any("NOT DETERMINED" in note for note in export_model(model, target, name="elbow").notes)


def test_the_joint_is_that_of_a_body(kept: Callable[..., Any]) -> None:
    """An equality, and the transmission of a URDF, name a joint, too."""
    model = kept("coulomb-viscous", {"K_v": 0.3, "K_c": 0.8})
    robot = ROBOT.replace("<worldbody>", '<equality><joint name="elbow" joint1="elbow"/></equality><worldbody>')
    text = export_model(model, "mjcf", name="elbow", into=robot).text
    root = ET.fromstring(text)
    assert "damping" not in root.find("equality/joint").attrib  # type: ignore[union-attr]
    assert "damping" in root.find("worldbody/body/joint").attrib  # type: ignore[union-attr]
    named = ARM.replace("<link", '<transmission name="t"><joint name="elbow"/></transmission><link', 1)
    arm = ET.fromstring(export_model(model, "urdf", name="elbow", into=named).text)
    assert arm.find("transmission/joint/dynamics") is None
    assert arm.find("joint/dynamics") is not None


def test_inertia_and_gear_of_a_robot_are_told(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous", {"K_v": 0.3, "K_c": 0.8})
    geared = ROBOT.replace('joint="elbow"/></act', 'joint="elbow" gear="50 0 0 0 0 0"/></act')
    told = " ".join(export_model(model, "mjcf", name="elbow", into=geared).notes)
    assert f"whole inertia is {model.inertia:.4g}" in told
    assert "gear of 50" in told
    given = " ".join(export_model(model, "mjcf", name="elbow", into=ROBOT, armature=1.0).notes)
    assert "armature" not in given
    assert "gear" not in given


def test_what_is_behind_a_projection_is_said_too(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous+stribeck", not_identified={"stribeck.omega_s": "it is vague"})
    for target in ("urdf", "isaac", "mjcf"):
        assert "stribeck.omega_s" in " ".join(export_model(model, target, name="elbow").notes)


def test_a_linear_axis_has_its_own_units(kept: Callable[..., Any]) -> None:
    model = kept("coulomb-viscous+cogging", motion=fricmodels.dimension.Motion.LINEAR)
    done = export_model(model, "urdf", name="x")
    assert any(" N over" in note for note in done.notes)
    assert not any("N m" in note for note in done.notes)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"target": "mjfc"}, "did you mean 'mjcf'"),
        ({"target": "c", "into": ROBOT}, "leave --into out"),
        ({"target": "mjcf", "into": ARM}, "<robot>"),
        ({"target": "mjcf", "into": "<mujoco"}, "cannot be read"),
        ({"target": "mjcf", "into": ROBOT, "name": "elbov"}, "did you mean 'elbow'"),
        ({"target": "mjcf", "into": '<!DOCTYPE x [<!ENTITY a "b">]><mujoco/>'}, "DOCTYPE"),
    ],
)
def test_what_cannot_be_written_says_why(kept: Callable[..., Any], given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        export_model(kept("coulomb-viscous"), **{"name": "elbow", **given})


@pytest.mark.parametrize("target", ["mjcf", "urdf"])
def test_a_gap_that_no_recording_drives_changes_no_friction(kept: Callable[..., Any], target: str) -> None:
    """Over a range of validity velocity and acceleration go each at its own pace: no drive crosses a gap so."""
    values = {"K_v": 1e-3, "K_c": 0.03}
    gap = {"backlash.J_l": 2e-4, "backlash.w": 0.03, "backlash.a": 50.0}
    with_gap, plain = kept("coulomb-viscous+backlash", {**values, **gap}), kept("coulomb-viscous", values)
    written = [export_model(model, target) for model in (with_gap, plain)]
    friction = [re.search(r'(?:frictionloss|friction)="([-\d.e]+)"', one.text) for one in written]
    first, second = (float(found[1]) for found in friction if found is not None)
    assert first == pytest.approx(second, rel=1e-3)
    (note,) = [note for note in written[0].notes if note.startswith("left out: backlash")]
    assert "give the recording" in note


def test_a_model_whose_file_tells_no_runs_is_exported(kept: Callable[..., Any], tmp_path: Path) -> None:
    model, path = kept("coulomb-viscous", {"K_v": 0.3, "K_c": 0.8}), tmp_path / "arm.model.json"
    path.write_text(json.dumps({**json.loads(model.document.to_json()), "runs": [], "run_checksums": []}))
    assert export_model(fricmodels.load(path), "c").text
