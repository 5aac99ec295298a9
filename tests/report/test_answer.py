"""The answer box: what comes first, how sure, what is left, and the next command; its figures are those of the docs."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from fricmodels.laws.coulomb_viscous import CoulombViscous
from fricmodels.report.answer import answer, command_line
from fricmodels.report.error_words import comparison_words
from fricmodels.report.reliability import CHANGING, ONE_SINE, RECORDS
from fricmodels.report.sections import ladder_words
from fricmodels.results.comparison import Band
from fricmodels.results.diagnosis import DiagnosisDocument

DOCS = Path(__file__).parents[2] / "docs"


def data(**own: Any) -> DiagnosisDocument:
    """Return a diagnosis: gravity was found, and nothing is left."""
    errors = {"SI": 1.0, "percent": 60.0, "held_out_percent": 60.0, "band_ms": 5.0, "bands": [band(2.0)]}
    content = {
        "schema": "fricmodels/diagnosis/1",
        "dataset": "joint",
        "model": "coulomb-viscous",
        "motion": "rotary",
        "inertia": {"value": 1.8, "unit": "kg m^2", "estimated": False},
        "parameters": {},
        "standard_errors": {},
        "rms_torque_error": errors,
        "noise_floor_percent": 3.2,
        "where": [],
        "verdict": "missing-effect",
        "effects": [effect()],
        "ladder": [step("coulomb-viscous", 60.0), step("coulomb-viscous+gravity", 4.0, "gravity")],
        "recording": recording("time=t:ms"),
        "versions": {},
        **own,
    }
    return DiagnosisDocument.model_validate_json(json.dumps(content))


def effect(**own: Any) -> dict[str, Any]:
    figures = {"p_value": 1e-12, "share_of_residual": 0.9, "held_out_gain": 0.8, "parameters": {}}
    return {"name": "gravity", "class": ["gravity"], "separated_by": "", **figures, **own}


def band(window_ms: float) -> dict[str, Any]:
    return {**dict.fromkeys(Band.model_fields, 1.0), "window_ms": window_ms}


def recording(*columns: str) -> dict[str, Any]:
    read = {"source": "my log.csv", "sha256": "0", "reader": "csv", "columns": columns, "torque_constant": 0.5}
    samples = {"fitted": 7, "kept_back": 3}
    return {**read, "channels": [], "derived": [], "samples": samples, "interval": 0.002, "true_model": None}


def step(model: str, error: float, added: str = "") -> dict[str, Any]:
    return {"model": model, "rms_percent": error, "held_out_rms_percent": error, "added": added}


def rest(percent: float, nearest: float) -> dict[str, Any]:
    near = [{"name": "cogging", "model": "coulomb-viscous+gravity+cogging", "held_out_percent": nearest}]
    left = {"percent": percent, "SI": 1.0, "channel": "position", "where": "", "place": None, "text": "."}
    return {**left, "nearest": near}


def test_names_on_one_sine_come_with_how_often_such_names_were_wrong() -> None:
    note = {"kind": "one-frequency", "severity": "note", "text": "the motion is one sine of 0.7 Hz"}
    on_one = {**recording("time=t:ms"), "findings": [note]}
    assert ONE_SINE.said in answer(data(recording=on_one)).sure
    assert ONE_SINE.said not in answer(data()).sure
    assert ONE_SINE.said not in answer(data(recording=on_one, verdict="adequate", effects=[])).sure


def test_a_law_that_has_several_named_effects_in_one_is_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    class Bristles(CoulombViscous):
        name = "bristles"
        combines = frozenset({"presliding", "stribeck"})

    laws = {"coulomb-viscous": CoulombViscous, "bristles": Bristles}
    monkeypatch.setattr("fricmodels.report.answer.plugins.load", lambda: SimpleNamespace(laws=laws))
    model = "coulomb-viscous+presliding+stribeck"
    ladder = [step("coulomb-viscous", 60.0), step(model, 4.0, "stribeck")]
    two = [effect(**{"class": ["presliding"]}, name="presliding"), effect(**{"class": ["stribeck"]}, name="stribeck")]
    said = answer(data(effects=two, ladder=ladder)).next
    assert "bristles has presliding and stribeck in one" in said
    assert "bristles" not in answer(data(effects=two[:1], ladder=ladder)).next
    assert "in one" not in answer(data(model="bristles", effects=two, ladder=ladder)).next


@pytest.mark.parametrize(("fit", "test", "said"), [(17.8, 1.4, True), (2.5, 1.4, False), (0.1, 0.01, False)])
def test_an_error_that_is_far_larger_where_it_was_fitted_is_said(fit: float, test: float, said: bool) -> None:
    """A step and a slow ramp: the starts were fitted, the ramp was kept back. Below 0.3 % nobody needs to know."""
    last = {**step("coulomb-viscous+gravity", test, "gravity"), "rms_percent": fit}
    text = answer(data(ladder=[step("coulomb-viscous", 60.0), last])).error
    assert ("Where it was fitted 17.8 % is left" in text.replace("\u00a0", " ")) is said
    assert ("Where it was fitted" in text) is said


@pytest.mark.parametrize("fit", [17.8, 2.5])
def test_the_fit_error_of_a_model_is_said_once(fit: float) -> None:
    """Either with what it means that it is far larger than the test error, or by itself."""
    errors = {"SI": 1.0, "percent": fit, "held_out_percent": 1.4, "band_ms": 5.0, "bands": [band(2.0)]}
    last = {**step("coulomb-viscous", 1.4), "rms_percent": fit}
    text = comparison_words(data(rms_torque_error=errors, ladder=[last]))[1].replace("\u00a0", " ")
    assert text.count(f"{fit:.3g}") == 1


@pytest.mark.parametrize(("value", "asked"), [(8e-6, True), (4.0, False)])
def test_while_no_inertia_shows_the_next_thing_is_to_give_it(value: float, asked: bool) -> None:
    """A slow ramp of a voltage, back and forth: a friction that drifts is the ramp itself, and 0.1 % remains."""
    known = {"parameters": {"J": value, "K_c": 7.0}, "standard_errors": {"J": 8e-6, "K_c": 0.03}}
    last = {**step("coulomb-viscous+gravity", 0.1, "gravity"), **known}
    box = answer(data(ladder=[step("coulomb-viscous", 24.0), last], noise_floor_percent=0.1))
    assert ("gravity may be the course of the command itself" in box.next) is asked
    assert " fit " in box.command


def test_errors_of_a_drive_that_coasts_are_of_the_torque_of_its_inertia() -> None:
    note = {"kind": "coasting", "severity": "note", "text": "the torque is 0 throughout"}
    coasting = {**recording("time=t:ms"), "findings": [note]}
    assert "of the RMS torque of the inertia on data" in answer(data(recording=coasting)).error
    assert "of the RMS motor torque on data" in answer(data()).error


@pytest.mark.parametrize("verdict", [*RECORDS, "one-frequency", "changing"])
def test_how_often_an_answer_was_wrong_is_what_the_pages_say(verdict: str) -> None:
    record = {**RECORDS, "one-frequency": ONE_SINE, "changing": CHANGING}[verdict]
    for page, phrases in record.cited.items():
        assert f"docs/{page}" in record.said
        text = " ".join(re.sub(r"^> ?", "", (DOCS / page).read_text(encoding="utf-8"), flags=re.MULTILINE).split())
        for phrase in phrases:
            assert phrase in text, f"{page} says something else now: write {verdict} anew"


def test_one_number_says_how_much_it_matters() -> None:
    found = answer(data())
    assert found.sentence == "The model coulomb-viscous lacks one effect: gravity."
    assert "60.0\u00a0% → 4.00\u00a0%" in found.error
    assert "noise alone would leave about 3.20\u00a0%" in found.error
    assert "below one in a million" in found.sure
    assert "docs/hidden_effects.md" in found.sure


def test_what_remains_far_above_noise_is_said_before_what_was_found() -> None:
    steps = [step("coulomb-viscous", 60.0), step("coulomb-viscous+gravity", 26.9, "gravity")]
    found = answer(data(ladder=steps, remaining=rest(26.7, 26.0)))
    assert found.sentence.startswith(
        "26.9\u00a0% of the motor torque remains unexplained, far above noise (3.20\u00a0%)"
    )
    assert found.sentence.index("remains") < found.sentence.index("gravity")
    assert found.tone == "bad"
    assert found.next.startswith("What remains goes with position, in a form that no effect on the list has")
    nowhere = answer(data(ladder=steps, remaining={**rest(26.7, 26.0), "channel": ""}))
    assert nowhere.next.startswith("Record what this log lacks"), "no recorded channel has its form"
    assert "--model coulomb-viscous+gravity " in found.command


def test_what_remains_is_said_with_the_answer_however_much_of_it_noise_may_be() -> None:
    """An unknown cause beside the effect that was found: 7.3 % of the torque beyond a noise of 5.2 %."""
    steps = [step("coulomb-viscous", 19.0), step("coulomb-viscous+gravity", 8.99, "gravity")]
    found = answer(data(ladder=steps, noise_floor_percent=5.22, remaining=rest(7.32, 7.39)))
    assert found.sentence == (
        "The model coulomb-viscous lacks one effect: gravity. With it 7.32\u00a0% of the motor torque, beyond noise, "
        "remains unexplained."
    )
    assert answer(data(ladder=steps, noise_floor_percent=9.5, remaining=rest(0.0, 7.39))).sentence.endswith("gravity.")


def test_what_predicts_a_part_that_is_too_small_is_not_said_to_be_nothing() -> None:
    unknown = {"channels": "acceleration", "p_value": 1e-9, "held_out_gain": 0.3}
    found = answer(data(unknown=unknown, noise_floor_percent=3.9))
    assert found.remains.endswith("what acceleration predicts of it is too small a part to be noticed.")
    sized = answer(data(unknown={**unknown, "torque_percent": 0.36}, noise_floor_percent=3.9))
    assert sized.remains.endswith("what acceleration predicts of it (0.360\u00a0%) is too small a part to be noticed.")
    assert answer(data(noise_floor_percent=3.9)).remains.endswith("nothing predicts the rest.")


def test_a_model_that_leaves_more_than_noise_is_not_simply_to_be_used() -> None:
    assert answer(data(noise_floor_percent=3.9)).next.startswith("Use the model")
    assert answer(data(noise_floor_percent=0.8)).next.startswith("Record it faster or with less noise")


@pytest.mark.parametrize(("friction", "error", "said"), [(0.0, 111.0, True), (0.0, 40.0, False), (0.4, 111.0, False)])
def test_a_torque_that_is_not_what_moves_the_drive_is_to_be_checked(friction: float, error: float, said: bool) -> None:
    """The torque of another joint, with the inertia given: no effect that is on no list is to be written for it."""
    parameters = {"J": 1.8, "K_v": 0.0, "K_c": friction}
    last = {**step("coulomb-viscous", error), "parameters": parameters}
    left = {**rest(error, error), "channel": "time"}
    found = answer(data(verdict="unknown-effect", effects=[], ladder=[last], remaining=left, parameters=parameters))
    assert found.next.startswith("Check the column of the torque: no friction shows in it") is said
    assert (found.command == "") is said


@pytest.mark.parametrize(("inside", "said"), [(0.05, True), (0.2, False)])
def test_of_a_rest_that_nothing_predicts_the_place_is_said_where_much_of_it_lies(inside: float, said: bool) -> None:
    """A command that reaches the motor late shows in the starts; a better record would not change that."""
    rows = [("low speed", 0.88, 0.32), ("start", 0.41, inside), ("rest", 0.01, 0.001)]
    shares = [{"regime": n, "share_of_squared_error": s, "samples": 9, "share_of_samples": k} for n, s, k in rows]
    last = step("coulomb-viscous", 7.8)
    found = answer(data(verdict="adequate", effects=[], ladder=[last], where=shares, noise_floor_percent=2.3))
    words = "Look first right after starts: 41 % of the squared error lie there, in 5 % of the samples."
    assert (words in found.next.replace("\u00a0", " ")) is said
    assert ("Record it faster" in found.next) is not said


def test_what_nothing_predicts_but_is_far_above_noise_is_said_with_the_answer() -> None:
    steps = [step("coulomb-viscous", 7.94), step("coulomb-viscous+gravity", 2.62, "gravity")]
    found = answer(data(ladder=steps, noise_floor_percent=0.205))
    assert found.sentence == (
        "The model coulomb-viscous lacks one effect: gravity. With it 2.62\u00a0% of the motor torque remains, more "
        "than noise (0.205\u00a0%)."
    )
    least = [step("coulomb-viscous", 7.94), step("coulomb-viscous+gravity", 0.25, "gravity")]
    assert answer(data(ladder=least, noise_floor_percent=1e-4)).sentence.endswith("gravity."), "no effect is so small"


def test_noise_is_that_of_the_last_model() -> None:
    """It grows with the inertia, which a model that lacks an effect may not find: it had none, and noise of 0.2 %."""
    steps = [
        {**step("coulomb-viscous", 99.0), "noise_floor_percent": 0.2},
        {**step("coulomb-viscous+gravity", 12.6, "gravity"), "noise_floor_percent": 11.9},
    ]
    found = answer(data(ladder=steps, noise_floor_percent=0.2))
    assert "more than noise" not in found.sentence
    assert "noise alone would leave about 11.9" in found.error
    older = answer(data(ladder=[step("coulomb-viscous", 99.0), step("coulomb-viscous+gravity", 12.6, "gravity")]))
    assert "noise alone would leave about 3.2" in older.error, "a file of an older version"


@pytest.mark.parametrize("channel", ["torque", "velocity", ""])
def test_a_noise_that_was_estimated_too_large_is_said_with_its_channel_and_what_to_do(channel: str) -> None:
    last = {**step("coulomb-viscous", 2.0), "noise_floor_percent": 12.6, "noise_channel": channel}
    found = answer(data(verdict="adequate", effects=[], ladder=[last]))
    whose = f"the noise of the {channel}" if channel else "the noise"
    assert f"; {whose} was estimated at 12.6\u00a0%, an estimate that is too high: go by the test error" in found.error
    assert (f"a {channel} that is logged finer, or with less noise, tells it better" in found.error) == bool(channel)


def test_an_effect_that_comes_near_is_offered_with_its_command() -> None:
    steps = [step("coulomb-viscous", 60.0), step("coulomb-viscous+gravity", 26.9, "gravity")]
    found = answer(data(ladder=steps, remaining=rest(26.7, 9.0)), ["--leave-out", "drift", "--trust"])
    assert "26.9\u00a0% → 9.00\u00a0%" in found.next
    assert shlex.split(found.command)[1] == "compare"
    assert "coulomb-viscous+gravity+cogging" in found.command
    assert "--leave-out" not in found.command
    assert "--trust" in found.command


@pytest.mark.parametrize(
    ("nearest", "against", "channel", "offered"),
    [
        (18.0, "", "position", True),
        (20.0, "", "position", False),
        (9.0, "it has waves all over the way", "position, in one stretch", False),
        (20.0, "", "its own course shortly before", False),
    ],
)
def test_an_effect_is_offered_if_it_explains_a_good_part_and_nothing_speaks_against_it(
    nearest: float, against: str, channel: str, offered: bool
) -> None:
    steps = [step("coulomb-viscous", 60.0), step("coulomb-viscous+gravity", 26.9, "gravity")]
    left = {**rest(26.7, nearest), "channel": channel}
    left["nearest"][0]["against"] = against
    found = answer(data(ladder=steps, remaining=left))
    assert ("cogging comes nearest" in found.next, "+cogging" in found.command) == (offered, offered)
    if not offered:
        of_form = "What remains goes with position" if channel.startswith("position") else "Record what this log lacks"
        assert found.next.startswith(of_form)


@pytest.mark.parametrize(
    ("channel", "said"), [("speed, along the motion", True), ("motor torque", True), ("time", False)]
)
@pytest.mark.parametrize("nearest", [9.0, 26.0])
def test_laws_may_have_the_form_of_what_goes_with_speed_or_load(channel: str, nearest: float, said: bool) -> None:
    steps = [step("coulomb-viscous", 60.0), step("coulomb-viscous+gravity", 26.9, "gravity")]
    found = answer(data(ladder=steps, remaining={**rest(26.7, nearest), "channel": channel}))
    assert ("fricmodels list laws" in found.next) == said


def test_look_alikes_are_told_apart_by_an_experiment() -> None:
    alike = effect(**{"class": ["gravity", "stiffness"], "separated_by": "a turn and more"})
    found = answer(data(verdict="undecided", effects=[alike], ladder=[step("coulomb-viscous", 60.0)]))
    assert "gravity or stiffness" in found.sentence
    assert found.next == "To tell gravity from stiffness apart: a turn and more."
    assert found.command == ""


def test_a_class_beside_a_certain_effect_is_told_apart_and_the_model_is_kept() -> None:
    alike = effect(**{"class": ["stiffness", "cogging"], "separated_by": "a turn and more"})
    for found in (answer(data(effects=[effect(), alike])), answer(data(verdict="undecided", effects=[alike]))):
        assert found.next == "To tell stiffness from cogging apart: a turn and more. To use the model as it is:"
        assert " fit " in found.command


def test_a_torque_in_time_is_to_be_found_and_no_effect_is_tried() -> None:
    one, of_time = (
        [step("coulomb-viscous", 9.4)],
        {"channels": "time, at 1.7 Hz", "p_value": 1e-9, "held_out_gain": 0.5},
    )
    left = {**rest(9.3, 6.0), "channel": "time, at 1.7 Hz"}
    found = answer(data(verdict="unknown-effect", effects=[], ladder=one, unknown=of_time, remaining=left))
    assert "predicted from time (at 1.7 Hz), whatever the drive does" in found.remains
    assert found.next.startswith("Find what goes at 1.7 Hz (a pump, a fan, another machine)")
    assert found.command.endswith("--report error.html")


@pytest.mark.parametrize(
    ("part", "said"), [(4.0, ", of which speed predicts 4.00\u00a0%;"), (7.0, ", predicted from speed;")]
)
def test_a_channel_that_predicts_a_small_part_of_what_remains_is_not_said_to_predict_all(
    part: float, said: str
) -> None:
    """Sampling makes an error of single samples that no channel tells, about reversals."""
    unknown = {"channels": "speed", "p_value": 1e-9, "held_out_gain": 0.9, "torque_percent": part}
    one, left = [step("coulomb-viscous", 9.4)], {**rest(9.3, 6.0), "channel": "speed", "where": "x"}
    found = answer(data(verdict="unknown-effect", effects=[], ladder=one, unknown=unknown, remaining=left))
    assert said in found.remains


def test_noise_makes_no_more_than_all() -> None:
    left = answer(data(ladder=[step("coulomb-viscous", 60.0), step("coulomb-viscous+gravity", 3.0, "gravity")]))
    assert "as much as noise makes (about 3.20\u00a0%)" in left.remains
    assert "of which" not in left.remains


def test_a_force_is_called_so() -> None:
    found = answer(data(motion="linear"))
    assert "motor force" in found.error
    assert found.command.startswith("fricmodels fit ")
    assert found.command.endswith("--linear --out joint.model.json")


def test_a_command_reads_the_recording_as_it_was_read() -> None:
    words = shlex.split(command_line(data(), "improve", "square-root"))
    assert words[:3] == ["fricmodels", "improve", "my log.csv"]
    assert words[words.index("--column") + 1] == "time=t:ms"
    assert words[words.index("--torque-constant") + 1] == "0.5"
    plain = data(recording=recording("time=time_s", "torque=torque_Nm"))
    assert "--column" not in command_line(plain, "improve", "square-root")
    axis = data(motion="linear", recording=recording("time=time_s", "torque=force_N", "velocity=velocity_m_s"))
    assert "--column" not in command_line(axis, "improve", "square-root"), "an axis has standard names too"
    assert "--column" in command_line(plain.model_copy(update={"motion": "linear"}), "improve", "square-root")


def test_an_answer_without_effects_says_what_it_can() -> None:
    one = [step("coulomb-viscous", 94.7)]
    unknown = {"channels": "position", "p_value": 1e-9, "held_out_gain": 0.5}
    found = answer(data(verdict="unknown-effect", effects=[], ladder=one, unknown=unknown, remaining=rest(94.0, 94.0)))
    assert "no known effect explains" in found.sentence
    assert "Position predicts the error, and not by chance: p is below" in found.sure
    adequate = answer(data(verdict="adequate", effects=[], ladder=[step("coulomb-viscous", 3.3)]))
    assert adequate.tone == "good"
    assert "on 98 of 1562 rougher ones" in adequate.sure
    assert adequate.next.startswith("Use the model")
    far = answer(data(verdict="adequate", effects=[], ladder=[step("coulomb-viscous", 8.65)]))
    assert far.tone == "warn"
    assert far.sentence.endswith("Yet 8.65\u00a0% of the motor torque remains, more than noise (3.20\u00a0%).")
    assert far.next.startswith("Record it faster or with less noise")
    assert " fit " in far.command
    seen = answer(data(verdict="adequate", effects=[], ladder=[step("coulomb-viscous", 3.3)], unknown=unknown))
    assert "nothing that could be predicted" not in seen.sentence
    assert "too small a part of the error to be noticed" in seen.sentence
    assert "Position predicts a small part of the error, and not by chance" in seen.sure


def test_a_step_that_raises_the_test_error_is_not_said_to_lower_it() -> None:
    steps = [step("a", 60.0), step("a+gravity", 30.0, "gravity"), step("a+gravity+drift", 32.0, "drift")]
    steps += [step("a+gravity+drift+cogging", 28.0, "cogging"), step("a+gravity+cogging", 28.0, "")]
    steps[-1]["removed"] = "drift"
    words = ladder_words(data(ladder=steps))
    assert words == (
        "The test error falls from 60.0\u00a0% to 30.0\u00a0% with gravity, rises to 32.0\u00a0% with drift, falls to "
        "28.0\u00a0% with cogging and stays at 28.0\u00a0% without drift."
    )


def test_noise_that_is_too_small_to_tell_reads_as_a_sentence() -> None:
    found = answer(data(noise_floor_percent=1e-5))
    assert "noise alone would leave less than 0.1\u00a0%" in found.error
    assert "of which noise makes less than 0.1\u00a0%" in found.remains
    assert "about" not in found.error


def test_numbers_of_a_place_have_a_true_minus_sign() -> None:
    place = {"channel": "load_torque", "low": -0.15, "high": -0.08, "direction": "backward", "torque": -0.04}
    place |= {"passes": 9, "p_value": 1e-9, "share": 0.1}
    left = {**rest(26.7, 26.0), "place": place, "where": "at load torque -0.115 N m, 0.073 N m wide: -0.04 N m"}
    found = answer(data(remaining=left))
    assert "largest at load torque −0.115 N m, 0.073 N m wide: −0.04 N m." in found.remains
