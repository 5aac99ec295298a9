"""A diagnosis and a ladder are copied and pickled whole: what they remembered is found again."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable

from fricmodels.diagnosis import diagnose, improve
from fricmodels.recording import Recording


def test_results_are_pickled_and_copied(made: Callable[..., Recording]) -> None:
    values = {"gravity.a": 1.0, "gravity.b": 0.5}
    recording = made("coulomb-viscous+gravity", values, noise=0.2)
    found = [diagnose(recording, "coulomb-viscous", 2.0), improve(recording, "coulomb-viscous", 2.0)]
    for result in found:
        text = repr(result)
        assert "gravity" in text
        assert repr(pickle.loads(pickle.dumps(result))) == text
        assert repr(copy.deepcopy(result)) == text
