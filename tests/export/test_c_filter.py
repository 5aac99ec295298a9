"""A filter in C takes the samples that the same filter takes in Python, and ends where that one ends."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fricmodels
from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.estimator import SequentialEstimator
from fricmodels.export.targets import export_model
from fricmodels.export.targets.c_filter import started
from fricmodels.filtering.online import ProblemOnline
from fricmodels.filtering.problem import FilterProblem
from fricmodels.recording import Recording
from fricmodels.weakform.prepared import ready

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror"]
BODY = """
#include "j.h"
void run(long count, const double *in, double *out) {
    long k;
    int i;
    j_online filter;
    j_online_begin(&filter);
    for (k = 0; k < count; k++) {
        j_online_update(&filter, (const j_online_sample *)(const void *)(in + k * COLUMNS));
        for (i = 0; i < PARAMETERS; i++) out[k * PARAMETERS + i] = j_online_parameter(&filter, i);
    }
}
"""


def test_the_filter_is_tuned_to_the_velocity_that_it_is_given(made: Callable[..., Recording]) -> None:
    """Beside an exact position the velocity of a fit is surer than the measured one; a sample has the measured one."""
    recording = made(noise=5.0, samples=3000)
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous", 2.0))
    made_for = started(model, "ekf", recording)
    ekf = plugins.load().estimators["ekf"]()
    assert isinstance(ekf, SequentialEstimator)
    online = ekf.start(model.drive, recording)
    assert isinstance(made_for, FilterProblem)
    assert isinstance(online, ProblemOnline)
    np.testing.assert_array_equal(made_for.measurement, online.problem.measurement)
    surer = ekf.start(model.drive, ready(recording))
    assert isinstance(surer, ProblemOnline)
    assert np.all(made_for.measurement > 4.0 * surer.problem.measurement)


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
@pytest.mark.parametrize(
    ("inertia", "estimator"),
    [
        pytest.param(
            inertia,
            estimator,
            id=f"inertia {'given' if inertia else 'estimated'}-{estimator}",
            marks=() if inertia or estimator == "rls" else pytest.mark.long,
        )
        for inertia in (2.0, None)
        for estimator in ("ekf", "detchmendy-sridhar", "rls")
    ],
)
def test_the_filter_in_c_is_the_filter_in_python(
    made: Callable[..., Recording], tmp_path: Path, estimator: str, inertia: float | None
) -> None:
    """Through motion, a long rest, and motion again."""
    recording = made(noise=1.0, samples=3000)
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous+gravity", inertia))
    text = export_model(model, "c", name="j", online=estimator, recording=recording).text
    (tmp_path / "j.h").write_text(text, encoding="ascii")
    (tmp_path / "j.c").write_text(BODY, encoding="ascii")
    fields = text.split("typedef struct {\n    double time;")[1].split("}")[0].splitlines()
    order = ["time", *(line.split()[1].rstrip(";") for line in fields if line.strip().startswith("double"))]
    assert order[:2] == ["time", "velocity"]
    keys = model.drive.keys
    sizes = [f"-DCOLUMNS={len(order)}", f"-DPARAMETERS={len(keys)}"]
    library = tmp_path / "j.so"
    done = subprocess.run(
        [str(COMPILER), *STRICT, *sizes, "-shared", "-fPIC", "-o", str(library), str(tmp_path / "j.c"), "-lm"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[:3000]
    made_of = {"motor_torque": recording.torque, "load_torque": np.zeros(len(recording))}
    motion = np.stack([made_of.get(n, recording.channels.get(n, made_of["load_torque"])) for n in order], axis=1)
    rest = np.tile(motion[1000], (1500, 1))
    rest[:, order.index("motor_torque")] = rest[:, 1] = 0.0
    given = np.concatenate([motion[:1000], rest, motion[1000:]])
    given[:, 0] = np.arange(len(given)) * recording.interval
    given = np.ascontiguousarray(given)

    out = np.empty((len(given), len(keys)))
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (given, out)]
    ctypes.CDLL(str(library)).run(ctypes.c_long(len(given)), *pointers)

    made_estimator = plugins.load().estimators[estimator]()
    assert isinstance(made_estimator, SequentialEstimator)
    online = made_estimator.start(model.drive, recording)
    names = {"motor_torque": "torque"}
    near = 1e-6 if estimator == "rls" else 1e-8  # a vague start amplifies rounding; test_c_windowed.py has each update
    for k, row in enumerate(given):
        found = online.update({names.get(n, n): float(x) for n, x in zip(order, row, strict=True)})
        if k % 250 == 249 or k == len(given) - 1:
            expected = [found[key] for key in keys]
            np.testing.assert_allclose(out[k], expected, rtol=near, atol=near * np.max(np.abs(expected)))
    assert np.ptp(out[:, list(keys).index("K_c")]) > 0.1  # it does learn


def test_what_cannot_filter_says_so(made: Callable[..., Recording], kept: Callable[..., Any]) -> None:
    model, recording = kept("coulomb-viscous"), made(samples=1000)
    with pytest.raises(InputError, match="--data"):
        export_model(model, "c", online="ekf")
    with pytest.raises(InputError, match="in C only"):
        export_model(model, "urdf", online="ekf", recording=recording)
    with pytest.raises(InputError, match="cannot be written in C"):
        export_model(model, "c", online="batch", recording=recording)
    with pytest.raises(InputError, match="unknown estimator"):
        export_model(model, "c", online="efk", recording=recording)
    with pytest.raises(InputError, match="internal states, which rls cannot estimate"):
        export_model(kept("coulomb-viscous+presliding"), "c", online="rls", recording=recording)
