"""Estimators with one mistake each, made from a good one: the exam says which."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import numpy as np
import pytest

from fricmodels import plugins
from fricmodels.drive import Drive
from fricmodels.estimator import Estimator
from fricmodels.fit import Fit
from fricmodels.recording import Recording
from fricmodels.testing import EstimatorExam, sit


class Least(Estimator):
    """Recursive least squares as it is."""

    name = "mistaken"
    summary = "with a mistake"
    good: ClassVar[type[Estimator]] = plugins.load().estimators["rls"]

    def solve(self, drive: Drive, recording: Recording, seed: int) -> Any:
        return self.good().solve(drive, recording, seed)

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        found = self.good().fit(drive, recording, seed=seed)
        return dataclasses.replace(found, covariance=self.factor**2 * found.covariance)

    factor: ClassVar[float] = 1.0


def without_load(recording: Recording) -> Recording:
    channels = {name: values for name, values in recording.channels.items() if name != "load_torque"}
    return dataclasses.replace(recording, channels=channels)


def as_one_run(recording: Recording) -> Recording:
    step = recording.interval
    time = step * np.arange(len(recording))
    channels = {**recording.channels, "time": time}
    return dataclasses.replace(recording, channels=channels, run=np.zeros(len(recording), dtype=np.int64))


class IgnoresLoad(Least):
    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        return super().fit(drive, without_load(recording), seed=seed)


class IgnoresRuns(Least):
    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        return super().fit(drive, as_one_run(recording), seed=seed)


class Half(Least):
    factor = 0.5


class Tenfold(Least):
    factor = 10.0


class Fourfold(Least):
    factor = 4.0


class AllBias(Least):
    """Off by 1.9 standard errors in every recording: intervals of 1.96 hold the truth, and nothing is as said."""

    def fit(self, drive: Drive, recording: Recording, *, seed: int = 0) -> Fit:
        found = super().fit(drive, recording, seed=seed)
        truth = EstimatorExam.truth
        off = {key: truth[key] + 1.9 * error for key, error in found.standard_errors.items()}
        return dataclasses.replace(found, parameters={**found.parameters, **off})


MISTAKES: dict[str, tuple[type[Estimator], str, str]] = {
    "half the standard error": (Half, "coverage", "standard errors are too small; look for a factor such as 1/2"),
    "ten times the standard error": (Tenfold, "coverage", "standard errors are too large; look for a factor"),
    "four times the standard error": (Fourfold, "coverage", "standard errors are too large; look for what"),
    "an error that is all bias": (AllBias, "coverage", "errors are 1.9 standard errors"),
    "load torque ignored": (IgnoresLoad, "load_torque", "take recording.load_torque off the torque"),
    "runs ignored": (IgnoresRuns, "runs", "begin anew where recording.run changes"),
}


SLOW = ("half the standard error", "ten times the standard error", "an error that is all bias")
"""Of mistakes that coverage shows one is enough for every day."""


@pytest.mark.parametrize("mistake", [pytest.param(m, marks=pytest.mark.long if m in SLOW else ()) for m in MISTAKES])
def test_is_caught(mistake: str) -> None:
    made, check, message = MISTAKES[mistake]
    outcome = sit(type("Exam", (EstimatorExam,), {"estimator": made}), f"test_{check}")
    assert outcome.result == "failed", outcome
    assert message in outcome.message


@pytest.mark.parametrize("check", sorted({check for _, check, _ in MISTAKES.values()}))
def test_the_good_one_passes(check: str) -> None:
    outcome = sit(type("Exam", (EstimatorExam,), {"estimator": Least}), f"test_{check}")
    assert outcome.result == "passed", outcome


def test_what_an_estimator_says_of_its_exam_counts() -> None:
    told = type("Told", (Least,), {"exam": {"tolerance": 1e-12, "seeds": 3}})
    exam = type("Exam", (EstimatorExam,), {"estimator": told})
    assert (exam.tolerance, exam.seeds) == (1e-12, 3)
    assert "without noise" in sit(exam, "test_known_truth").message
    own = type("Exam", (EstimatorExam,), {"estimator": told, "seeds": 5})
    assert own.seeds == 5
    with pytest.raises(TypeError, match=r"exam says 'tolerence'.*did you mean 'tolerance'"):
        type("Exam", (EstimatorExam,), {"estimator": type("T", (Least,), {"exam": {"tolerence": 1}})})
