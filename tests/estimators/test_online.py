"""One sample at a time gives what the whole recording gives."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from estimators.detchmendy_sridhar import DetchmendySridhar
from estimators.ekf import ExtendedKalman
from estimators.rls import RecursiveLeastSquares
from fricmodels.errors import InputError

ESTIMATORS = [DetchmendySridhar, ExtendedKalman, RecursiveLeastSquares]


@pytest.mark.parametrize("cls", ESTIMATORS)
@pytest.mark.parametrize("known", [True, False], ids=["inertia given", "inertia estimated"])
def test_updates_equal_the_history(paper: SimpleNamespace, cls, known: bool) -> None:
    made = paper.recording(0.02, cycles=2)
    made = replace(made, run=(np.arange(len(made)) >= 230).astype(np.int64))
    drive = paper.drive(inertia=paper.inertia if known else None)
    history = cls().fit(drive, made).history
    online = cls().start(drive, made)
    estimates = []
    for i in range(len(made)):
        sample = {name: float(values[i]) for name, values in made.channels.items()}
        estimates.append(online.update(sample | {"run": float(made.run[i])}))
    for key in drive.keys:
        reference = history[key].to_numpy()
        found = [estimate[key] for estimate in estimates]
        np.testing.assert_allclose(found, reference, rtol=1e-9, atol=1e-9 * np.max(np.abs(reference)))
    assert online.parameters == estimates[-1]
    covariance = online.covariance
    np.testing.assert_array_equal(covariance, covariance.T)
    assert np.all(np.linalg.eigvalsh(covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))) > 0)


@pytest.mark.parametrize("cls", ESTIMATORS)
def test_a_bad_sample_is_refused(paper: SimpleNamespace, cls) -> None:
    made = paper.recording(cycles=2)
    online = cls().start(paper.drive(), made)
    with pytest.raises(InputError, match="velocity"):
        online.update({"time": 0.0, "torque": 0.0})
    online.update({"time": 0.0, "torque": 0.0, "velocity": 0.0})
    with pytest.raises(InputError, match="increase"):
        online.update({"time": 0.0, "torque": 0.0, "velocity": 0.0})


@pytest.mark.parametrize("cls", ESTIMATORS)
def test_a_sample_that_is_not_finite_is_refused(paper: SimpleNamespace, cls) -> None:
    online = cls().start(paper.drive(), paper.recording(cycles=2))
    with pytest.raises(InputError, match="finite"):
        online.update({"time": 0.0, "torque": float("nan"), "velocity": 0.0})
