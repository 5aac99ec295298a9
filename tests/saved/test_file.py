"""The file: what goes in comes out, whatever is wrong is one line, and results can be kept."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fricmodels
from estimators.ekf import ExtendedKalman
from fricmodels import plugins
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.expressions import Expression, sign
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.term import Law, Parameters, Signals


@pytest.fixture(scope="module")
def result(made: Callable[..., Recording]) -> Any:
    return fricmodels.compare(made("coulomb-viscous+gravity", {"gravity.a": 2.0}), "coulomb-viscous+gravity", 2.0)


def test_the_file_holds_what_was_found(result: Any, tmp_path: Path) -> None:
    kept = fricmodels.keep(result)
    again = fricmodels.load(kept.save(tmp_path / "joint.model.json"))
    assert again == kept
    assert again.parameters == dict(result.estimate.parameters)
    assert again.standard_errors == pytest.approx(dict(result.estimate.standard_errors))
    assert again.not_identified == dict(result.estimate.not_identified)
    assert again.document.error is not None
    assert again.document.error.test_percent == result.errors.held_out_percent
    assert again.document.error.window_ms == result.errors.headline.window_ms
    keys, matrix = again.covariance
    np.testing.assert_allclose(np.sqrt(np.diag(matrix)), [again.standard_errors[k] for k in keys], rtol=1e-12)
    whole = np.concatenate([result.train.velocity, result.test.velocity])
    assert again.ranges["velocity"] == (whole.min(), whole.max())
    assert again.document.parameters["J"].given
    assert again.units["K_v"] == "N m s/rad"
    assert again.document.provenance.checksum == result.train.checksum
    text = (tmp_path / "joint.model.json").read_text(encoding="utf-8")
    assert json.loads(text)["schema"] == "fricmodels/model/1"
    assert str(tmp_path) not in text


class OverItsSpeed(Law):
    """Friction that grows with the speed, over a speed that only gives its unit."""

    name = "over-its-speed"
    formula = "τ = K_c·sgn ω + D·ω/ω_r"
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="dry friction")
    D = Parameter("D", unit="N m", lower=0.0, meaning="friction at the speed ω_r beyond it")
    omega_r = Parameter("omega_r", unit="rad/s", initial=1.0, lower=1.0, upper=1.0, meaning="speed")

    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return it."""
        return p.K_c * sign(s.velocity) + p.D * s.velocity / p.omega_r


def test_a_constant_is_neither_estimated_nor_at_its_bound_nor_unknown(made: Callable[..., Recording]) -> None:
    found = fricmodels.compare(made(), Model(OverItsSpeed()), 2.0)
    assert set(found.estimate.standard_errors) == {"K_c", "D"} == set(fricmodels.keep(found).standard_errors)
    assert found.estimate.covariance is not None
    assert found.estimate.covariance.shape == (2, 2)
    assert not found.estimate.not_identified
    for text in (str(found), str(fricmodels.keep(found))):
        (line,) = [line for line in text.splitlines() if "omega_r" in line and "1" in line]
        assert "bound" not in line
        assert "determined" not in line


def test_a_law_that_has_another_equation_by_now_is_refused(result: Any, tmp_path: Path) -> None:
    """Its numbers mean nothing in another equation, whatever the parameters are called."""
    path = fricmodels.keep(result).save(tmp_path / "joint.model.json")
    content = json.loads(path.read_text(encoding="utf-8"))
    content["terms"][0]["equation"] = content["terms"][0]["equation"].replace("K_v·ω", "2·K_v·ω")
    path.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=r"the law 'coulomb-viscous' is another one now: .*; fit it again") as refused:
        fricmodels.load(path)
    assert "2·K_v·ω" in str(refused.value)


def test_the_same_result_writes_the_same_file(result: Any, made: Callable[..., Recording]) -> None:
    again = fricmodels.compare(made("coulomb-viscous+gravity", {"gravity.a": 2.0}), "coulomb-viscous+gravity", 2.0)
    assert fricmodels.keep(again).document.to_json() == fricmodels.keep(result).document.to_json()


def test_every_law_and_effect_goes_through_a_file(kept: Callable[..., Any], tmp_path: Path) -> None:
    found = plugins.load()
    channel = {"other": "(j2_position)", "other-gravity": "(j2_position)"}
    channel |= {"other-friction": "(j2_velocity)", "other-inertia": "(j2_velocity)"}
    channel |= {"proximal-coupling": "(j2_velocity)", "chain-gravity": "(j2_position)"}
    names = [*found.laws, *(f"coulomb-viscous+{name}{channel.get(name, '')}" for name in found.effects)]
    for name in names:
        model = kept(name)
        again = fricmodels.load(model.save(tmp_path / "one.model.json"))
        assert again.model == model.model, name
        assert again.units == model.units, name


@pytest.mark.parametrize("kind", ["ladder", "diagnosis", "fit"])
def test_results_can_be_kept(made: Callable[..., Recording], kind: str) -> None:
    recording = made(samples=3000)
    if kind == "fit":
        drive = Drive(Model.parse("coulomb-viscous"), 2.0)
        fit = ExtendedKalman().fit(drive, recording)
        model = fricmodels.keep_fit(fit, drive, recording)
        assert model.parameters == dict(fit.parameters)
        assert model.document.provenance.estimator == "ekf"
        return
    leave_out = tuple(plugins.load().effects)
    work = fricmodels.improve if kind == "ladder" else fricmodels.diagnose
    found = work(recording, "coulomb-viscous", 2.0, leave_out=leave_out)
    model = fricmodels.keep(found)
    last = found.rungs[-1].comparison if kind == "ladder" else found.comparison
    assert model.parameters == dict(last.estimate.parameters)


def test_a_row_of_a_leaderboard_can_be_kept(made: Callable[..., Recording]) -> None:
    recording = made(samples=2000)
    row = {
        "model": "coulomb-viscous", "estimator": "batch", "status": "ok",
        "parameters": {"J": 2.0, "K_v": 0.5, "K_c": 3.0},
        "standard_errors": {"K_v": 0.1}, "not_identified": {"K_v": "vague"}, "rms_torque_error_percent": 2.0,
        "held_out_rms_torque_error_percent": 3.0, "rms_torque_error_band_ms": 20.0,
    }  # fmt: skip
    model = fricmodels.keep_row(row, recording, 2.0)
    assert model.torque(velocity=2.0) == pytest.approx(4.0)
    assert model.not_identified == {"K_v": "vague"}
    assert model.document.error is not None
    assert (model.document.error.test_percent, model.document.error.window_ms) == (3.0, 20.0)
    with pytest.raises(InputError, match="diverged"):
        fricmodels.keep_row({**row, "status": "diverged"}, recording)


def test_what_has_no_model_cannot_be_kept() -> None:
    with pytest.raises(InputError, match=r"what is given \(dict\) cannot be kept"):
        fricmodels.keep({})


def test_a_bound_that_was_hit_is_said(kept: Callable[..., Any]) -> None:
    model = kept("exponential-stick-slip", {"K_c": 1.0, "C": 1.0, "K_v": 0.0})
    bounds = {key: p.at_bound for key, p in model.document.parameters.items()}
    assert bounds == {"J": "", "K_v": "lower", "K_c": "at least C", "C": "", "B": ""}


def test_what_changes_nothing_has_no_error_of_zero(made: Callable[..., Recording]) -> None:
    recording = made(samples=2000)
    row = {
        "model": "coulomb-viscous", "estimator": "batch", "status": "ok",
        "parameters": {"J": 2.0, "K_v": 0.5, "K_c": 3.0}, "standard_errors": {"K_v": 0.0, "K_c": 0.0},
        "not_identified": {"K_v": "it changes nothing"},
    }  # fmt: skip
    assert fricmodels.keep_row(row, recording).standard_errors == {"K_c": 0.0}


def changed(text: str, **changes: Any) -> str:
    content = json.loads(text)
    for path, value in changes.items():
        at, *keys = path.split("__")
        if keys:
            inner = content[at]
            for key in keys[:-1]:
                inner = inner[key]
            inner[keys[-1]] = value
        else:
            content[at] = value
    return json.dumps(content)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"schema": "fricmodels/model/9"}, "fricmodels/model/1"),
        ({"model": 3}, "model"),
        ({"parameters__K_v__value": "big"}, "value"),
        ({"parameters": {}}, "parameters"),
        ({"motion": "spiral"}, "motion"),
        ({"rest_width": -1.0}, "rest_width"),
        ({"model": "square-root"}, "parameters|K_v"),
        ({"motion": "linear"}, "'M'"),
        ({"covariance": {"keys": ["K_v"], "values": [[1.0, 2.0]]}}, "rows"),
    ],
)
def test_a_file_that_was_changed_is_one_line(
    kept: Callable[..., Any], tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    path = tmp_path / "x.model.json"
    path.write_text(changed(kept("coulomb-viscous+cogging").document.to_json(), **changes), encoding="utf-8")
    with pytest.raises(InputError, match=message) as raised:
        fricmodels.load(path)
    assert "\n" not in str(raised.value)
    assert str(path) in str(raised.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"schema": "fricmodels/model/1"}', '{"a": NaN}', "\x00"])
def test_what_is_no_model_file_is_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "x.model.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as raised:
        fricmodels.load(path)
    assert "\n" not in str(raised.value)


def test_a_missing_file_says_how_to_make_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="fricmodels fit"):
        fricmodels.load(tmp_path / "no.model.json")


def test_a_missing_plugin_is_named(kept: Callable[..., Any], tmp_path: Path) -> None:
    content = json.loads(kept("coulomb-viscous+cogging").document.to_json())
    text = json.dumps(content).replace("cogging", "wiper")
    terms = json.loads(text)
    terms["terms"][1] |= {"distribution": "fricmodels-wiper", "version": "0.3"}
    path = tmp_path / "x.model.json"
    path.write_text(json.dumps(terms), encoding="utf-8")
    message = "needs the effect 'wiper' of fricmodels-wiper 0.3, which is not installed"
    with pytest.raises(InputError, match=re.escape(message)):
        fricmodels.load(path)


class Homemade(Law):
    """A law of a notebook: τ = c ω³."""

    name = "homemade"
    formula = "τ_F = c·ω³"
    c = Parameter("c", unit="N m s^3/rad^3")

    def torque(self, s: Any, p: Any) -> Any:
        """Return c ω³."""
        return p.c * s.velocity**3


def test_a_law_of_a_notebook_can_be_used_and_says_why_it_cannot_be_loaded(
    made: Callable[..., Recording], tmp_path: Path
) -> None:
    kept = fricmodels.keep(fricmodels.compare(made(samples=3000), Model(Homemade()), 2.0))
    assert kept.torque(velocity=2.0) == pytest.approx(8.0 * kept.parameters["c"])
    with pytest.raises(InputError, match="defined in a notebook"):
        fricmodels.load(kept.save(tmp_path / "x.model.json"))


def test_a_later_version_may_add_keys(kept: Callable[..., Any], tmp_path: Path) -> None:
    model = kept("coulomb-viscous")
    content = json.loads(model.document.to_json()) | {"colour": "red"}
    path = tmp_path / "x.model.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    assert fricmodels.load(path).parameters == model.parameters
