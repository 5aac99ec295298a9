"""A sensor that is zeroed anew for every run: found, told from one offset, and scored fairly on runs not fitted to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricmodels.diagnosis import compare, diagnose, improve, kept_back, ready
from fricmodels.diagnosis.comparison import compare_model
from fricmodels.diagnosis.document import comparison_document, document, write
from fricmodels.drive import Drive
from fricmodels.logcheck import summary
from fricmodels.model import Known, Model
from fricmodels.recording import Recording
from fricmodels.report.error_words import comparison_words
from fricmodels.report.figures.samples import Samples
from fricmodels.report.folder import page
from fricmodels.saved import FittedModel, keep
from fricmodels.score.zeroed import zeroed

Made = Callable[..., Recording]
OFFSETS = np.array([0.5, -0.3, 0.1, 0.8, -0.6])


def days(made: Made, offsets: np.ndarray = OFFSETS, samples: int = 8000) -> Recording:
    own = made(samples=samples, noise=0.2)
    run = np.arange(samples) * len(offsets) // samples
    noise = 0.02 * np.random.default_rng(1).standard_normal(samples)
    return replace(own.with_channels(derived=False, torque=own.torque + offsets[run] + noise), run=run)


def test_offsets_of_runs_are_found_and_lower_the_test_error(made: Made) -> None:
    ladder = improve(days(made), "coulomb-viscous", 2.0)
    assert [finding.names for finding in ladder.first.findings] == [("run-offset",)]
    last = ladder.rungs[-1]
    assert (last.model, ladder.last.verdict) == ("coulomb-viscous+run-offset", "adequate")
    for key, value in last.comparison.estimate.parameters.items():
        if key.startswith("run-offset"):
            assert value == pytest.approx(OFFSETS[int(key.rpartition("_")[2])], abs=0.02)


def test_one_offset_is_no_offset_of_runs(made: Made) -> None:
    found = diagnose(days(made, np.full(5, 0.5)), "coulomb-viscous", 2.0)
    assert found.findings[0].names[0] == "torque-offset"
    assert "run-offset" not in found.findings[0].names


def test_no_offset_is_none(made: Made) -> None:
    assert diagnose(days(made, np.zeros(5)), "coulomb-viscous", 2.0).findings == ()


def test_beside_a_constant_they_count_from_the_last_run(made: Made) -> None:
    three = days(made, OFFSETS[:3])
    for name in ("asymmetric-coulomb-viscous", "coulomb-viscous+torque-offset"):
        found = compare(three, f"{name}+run-offset", 2.0).estimate
        assert not [key for key in found.not_identified if key.startswith("run-offset")]
        assert found.parameters["run-offset.tau_0"] == pytest.approx(OFFSETS[0] - OFFSETS[2], abs=0.02)
        assert found.parameters["run-offset.tau_1"] == pytest.approx(OFFSETS[1] - OFFSETS[2], abs=0.02)


@pytest.mark.long
@pytest.mark.parametrize("law", ["asymmetric-coulomb-viscous", "coulomb-viscous+torque-offset"])
def test_they_are_found_beside_a_constant(made: Made, law: str) -> None:
    """The candidate has an offset for each run, the fitted effect one less."""
    ladder = improve(days(made, OFFSETS[:3]), law, 2.0)
    assert (ladder.rungs[-1].model, ladder.last.verdict) == (f"{law}+run-offset", "adequate")


def test_a_run_sampled_more_slowly_counts_as_well(made: Made) -> None:
    """One run in three has every tenth sample only: its steps are no gaps, and its offset is found."""
    whole = days(made, OFFSETS[:3], samples=24_000)
    slow = (whole.run == 2) & (np.arange(len(whole)) % 10 != 0)
    recording = whole.select(~slow)
    found = compare(recording, "coulomb-viscous+run-offset", 2.0).estimate
    for run, offset in enumerate(OFFSETS[:3]):
        assert found.parameters[f"run-offset.tau_{run}"] == pytest.approx(offset, abs=0.02)
    told = summary(recording)
    assert not {"gap", "missing-samples", "jitter"} & {one.kind for one in told.findings}
    assert told.rates == pytest.approx((50.0, 500.0), rel=1e-6)
    assert ("rate", "50 to 500 Hz, not the same in each run, evenly sampled") in told.rows()


def test_a_run_that_was_not_fitted_gives_its_zero_by_its_other_half(made: Made) -> None:
    train, test = kept_back(ready(days(made)))
    fitted = compare_model(train, test, Drive(Model.parse("coulomb-viscous+run-offset"), 2.0))
    values = fitted.estimate.parameters
    taken = test.torque - zeroed(fitted.drive, values, test).torque
    for run in np.unique(test.signal("run")).astype(int):
        here = taken[test.signal("run") == run]
        assert len(set(here.round(9))) == 2  # each half has its own, from the other
        np.testing.assert_allclose(here, OFFSETS[run], atol=0.05)
    without = Drive(Model.parse("coulomb-viscous"), 2.0)
    assert zeroed(without, values, test) is test
    assert zeroed(fitted.drive, values, train) is train


def test_figures_join_fitted_and_kept_back_with_the_offset_of_each_run(made: Made) -> None:
    fitted = compare(days(made), "coulomb-viscous+run-offset", 2.0)
    samples = Samples.of(fitted)
    assert set(np.unique(samples.recording.signal("run"))) == set(range(5))


def held(model: FittedModel) -> Model:
    """Return a saved model as --fixed takes it."""
    return model.model.knowing(Known(model.parameters, model.standard_errors, fixed=True, runs=model.fitted_runs))


def test_a_held_model_takes_the_offsets_of_other_runs_from_them(made: Made, tmp_path: Path) -> None:
    """Runs 0 and 1 of another day are other runs: theirs are not the offsets of the runs that were fitted."""
    own, other = days(made, OFFSETS[:2]), days(made, OFFSETS[2:])
    model = FittedModel.load(keep(compare(own, "coulomb-viscous+run-offset", 2.0)).save(tmp_path / "m.model.json"))
    found, refitted = (compare(other, one, 2.0) for one in (held(model), "coulomb-viscous+run-offset"))
    assert found.offsets_of_runs == 3
    assert found.errors.held_out_percent < 1.05 * refitted.errors.held_out_percent
    assert found.errors.percent < 1.05 * refitted.errors.percent
    assert found.estimate.parameters == model.parameters
    sentence = "The offset of each of 3 runs is taken from the run itself"
    assert sentence in comparison_words(comparison_document(found))[1]
    assert FittedModel.load(keep(found).save(tmp_path / "again.model.json")).parameters == model.parameters


def test_a_held_model_knows_its_own_runs_by_their_torque(made: Made) -> None:
    own = days(made, OFFSETS[:2])
    fitted = compare(own, "coulomb-viscous+run-offset", 2.0)
    model = keep(fitted)
    found = compare(own, held(model), 2.0)
    assert (found.offsets_of_runs, found.errors) == (0, fitted.errors)
    turned = compare(replace(own, run=1 - own.run), held(model), 2.0)
    assert turned.offsets_of_runs == 0
    np.testing.assert_allclose(turned.errors.percent, fitted.errors.percent, rtol=0.1)
    assert "is taken from" not in comparison_words(comparison_document(turned))[1]
    unknown = FittedModel(model.document.model_copy(update={"run_checksums": ()}))
    assert compare(own, held(unknown), 2.0).offsets_of_runs == 2


@pytest.mark.long
def test_what_other_runs_show_is_not_hidden_by_their_offsets(made: Made, tmp_path: Path) -> None:
    model = keep(compare(days(made, OFFSETS[:2]), "coulomb-viscous+run-offset", 2.0))
    found = diagnose(days(made, OFFSETS[2:4]), held(model), 2.0)
    assert (found.verdict, found.findings) == ("adequate", ())
    write(document(found), tmp_path)
    assert "There are no figures: offsets were taken from the runs" in str(page(tmp_path).sections[0].blocks[0])


def test_a_torque_of_other_runs_has_no_offset(made: Made) -> None:
    own, other = (ready(days(made, offsets)) for offsets in (OFFSETS[:2], OFFSETS[2:4]))
    model = keep(compare(own, "coulomb-viscous+run-offset", 2.0))
    plain = {key: model.parameters[key] for key in ("K_v", "K_c")}
    slides = np.abs(own.velocity) > 0.1
    friction = plain["K_v"] * own.velocity + plain["K_c"] * np.sign(own.velocity)
    offsets = np.array([model.parameters["run-offset.tau_0"], model.parameters["run-offset.tau_1"]])
    np.testing.assert_allclose((model.torque(own) - friction)[slides], offsets[own.run][slides], atol=1e-6)
    np.testing.assert_allclose((model.torque(other) - friction)[slides], 0.0, atol=1e-6)
