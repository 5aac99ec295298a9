"""Recursive least squares in C99: every update is that of Python, from wherever Python is."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import fricmodels
from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.estimator import SequentialEstimator
from fricmodels.export.targets import export_model
from fricmodels.recording import Recording

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror"]
BODY = """
#include "j.h"
void run(long count, const double *in, const double *before, double *out) {
    long k;
    int i;
    j_online filter;
    j_online_begin(&filter);
    for (k = 0; k < count; k++) {
        for (i = 0; i < MEMORY; i++) filter.memory[i] = before[k * MEMORY + i];
        j_online_update(&filter, (const j_online_sample *)(const void *)(in + k * COLUMNS));
        for (i = 0; i < MEMORY; i++) out[k * MEMORY + i] = filter.memory[i];
    }
}
"""


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
@pytest.mark.parametrize("inertia", [2.0, None], ids=["inertia given", "inertia estimated"])
def test_each_update_is_that_of_python(made: Callable[..., Recording], tmp_path: Path, inertia: float | None) -> None:
    """To 1e-12 of the parameters, and of their covariance on its own scale, once the vague start is forgotten."""
    recording = made(noise=1.0, samples=2000)
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous+gravity", inertia))
    text = export_model(model, "c", name="j", online="rls", recording=recording).text
    (tmp_path / "j.h").write_text(text, encoding="ascii")
    (tmp_path / "j.c").write_text(BODY, encoding="ascii")
    made_estimator = plugins.load().estimators["rls"]()
    assert isinstance(made_estimator, SequentialEstimator)
    online = made_estimator.start(model.drive, recording)
    order = ["time", "velocity", "position", "torque", "load_torque"]
    fields = [line.split()[1].rstrip(";") for line in text.split("typedef struct {\n    double time;")[1].split("}")[0]
              .splitlines() if line.strip().startswith("double")]  # fmt: skip
    assert fields == ["velocity", "position", "motor_torque", "load_torque"]
    given = np.stack([recording.channels.get(name, np.zeros(len(recording))) for name in order], axis=1)
    given[700:780, 1] = 0.0  # standstill, longer than what is smoothed
    memory = [online.state["memory"]]
    for row in given:
        online.update(dict(zip(order, row.tolist(), strict=True)))
        memory.append(online.state["memory"])
    python = np.array(memory)
    size = python.shape[1]
    library = tmp_path / "j.so"
    defined = [f"-DCOLUMNS={len(order)}", f"-DMEMORY={size}"]
    done = subprocess.run(
        [str(COMPILER), *STRICT, *defined, "-shared", "-fPIC", "-o", str(library), str(tmp_path / "j.c"), "-lm"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[:3000]
    before, out = np.ascontiguousarray(python[:-1]), np.empty((len(given), size))
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (np.ascontiguousarray(given), before, out)]
    ctypes.CDLL(str(library)).run(ctypes.c_long(len(given)), *pointers)

    count = len(model.drive.keys)
    late, expected = out[500:], python[501:]
    rows, columns = np.tril_indices(count)
    spread = np.sqrt(expected[:, [count + int(np.flatnonzero((rows == i) & (columns == i))[0]) for i in range(count)]])
    scale = np.concatenate([np.tile(np.abs(expected[:, :count]).max(axis=1)[:, None], count),
                            spread[:, rows] * spread[:, columns]], axis=1)  # fmt: skip
    assert np.max(np.abs(late - expected) / scale) < 1e-12
    np.testing.assert_array_equal(out[760:775], before[760:775])
    assert np.ptp(python[500:, 1]) > 0


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
def test_a_model_of_the_speed_alone_compiles_without_a_warning(made: Callable[..., Recording], tmp_path: Path) -> None:
    """Its regressors need no signal of the sample but those that are given beside it."""
    recording = made(samples=2000)
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous", 2.0))
    text = export_model(model, "c", name="j", online="rls", recording=recording).text
    (tmp_path / "j.h").write_text(text, encoding="ascii")
    (tmp_path / "j.c").write_text(BODY, encoding="ascii")
    options = ["-DCOLUMNS=1", "-DMEMORY=1", "-fsyntax-only", str(tmp_path / "j.c")]
    done = subprocess.run([str(COMPILER), *STRICT, *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:3000]


def test_what_rls_cannot_do_in_c(made: Callable[..., Recording]) -> None:
    recording = made(samples=2000)
    model = fricmodels.keep(fricmodels.compare(recording, "coulomb-viscous+sensor-delay", 2.0))
    with pytest.raises(InputError, match="rate of the motor torque"):
        export_model(model, "c", online="rls", recording=recording)
