"""A noise of the torque that would leave more than inertia and friction do is not there."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter
from tests.conftest import Made

from fricmodels.recording import Recording
from fricmodels.score import noise as scored
from fricmodels.signals.noise_colour import Noise
from fricmodels.weakform.prepared import ready


def drawn(recording: Recording) -> float:
    """Return the standard deviation of the torque's noise, averaged over five samples."""
    values = scored.noise_like(recording, "torque", np.random.default_rng(0))
    return float(np.std(np.convolve(values, np.full(5, 0.2), "valid")))


def test_lasting_noise_that_is_there_is_reckoned_with(made: Made) -> None:
    clean = made()
    colour = 0.95
    innovation = 0.3 * np.sqrt(1 - colour**2) * np.random.default_rng(1).standard_normal(len(clean))
    noisy = clean.with_channels(derived=False, torque=clean.torque + lfilter([1.0], [1.0, -colour], innovation))
    assert drawn(ready(noisy)) == pytest.approx(0.3, rel=0.4)


def test_lasting_noise_that_cannot_be_there_is_none(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a torque does by itself may look like noise that lasts; the motion explains it."""
    recording = ready(made())
    usual = drawn(recording)
    false = Noise(white=usual * np.sqrt(5.0), lasting=float(np.std(recording.torque)), samples=100.0)
    monkeypatch.setattr(scored, "noise_of", lambda *_, **__: false)
    assert drawn(recording) <= 1.1 * usual
