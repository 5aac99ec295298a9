"""What only its own past predicts: noise with a colour, or something that acts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

from fricmodels.diagnosis import diagnose
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.coloured_residual import coloured_residual
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.explain import explain
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.estimate import estimate

Made = Callable[..., Recording]
Array = NDArray[np.float64]
LAW = Model.parse("coulomb-viscous")


def lasting(count: int, correlation: float, seed: int = 3) -> Array:
    driving = np.random.default_rng(seed).standard_normal(count)
    driving[1:] *= np.sqrt(1 - correlation**2)
    return np.asarray(lfilter([1.0], [1.0, -correlation], driving))


def with_torque(recording: Recording, torque: Array) -> Recording:
    return recording.with_channels(derived=False, torque=recording.torque + torque)


def left_of(recording: Recording) -> object:
    problem, found = estimate(Drive(LAW, 2.0), recording)
    return coloured_residual(candidate_tests(problem, found.parameters, only=("gravity",)))


def test_lasting_noise_of_the_torque_is_named_as_that_and_no_effect(made: Made) -> None:
    clean = made()
    recording = with_torque(clean, 0.015 * np.std(clean.torque) * lasting(len(clean), 0.98))
    diagnosis = diagnose(recording, LAW, 2.0)
    assert diagnosis.verdict == "adequate"
    noise = diagnosis.noise
    assert noise is not None
    assert noise.percent == pytest.approx(1.5, rel=0.25)
    assert noise.lasts == pytest.approx(-recording.interval / np.log(0.98), rel=0.5)
    assert str(noise) in explain(diagnosis)
    left = document(diagnosis).coloured_noise
    assert left is not None
    assert noise.deviation == left.SI


def test_what_comes_back_or_grows_or_never_ends_is_no_noise(made: Made) -> None:
    clean = made()
    size, time = 0.015 * np.std(clean.torque), clean.time
    drawn = lasting(len(clean), 0.98)
    assert left_of(with_torque(clean, size * drawn)) is not None
    assert left_of(with_torque(clean, size * drawn * 3 * time / time[-1])) is None
    assert left_of(with_torque(clean, 2 * size * np.sin(2 * np.pi * 3.1 * time))) is None
    walk = np.cumsum(np.random.default_rng(0).standard_normal(len(clean)))
    assert left_of(with_torque(clean, size * walk / np.std(walk))) is None
