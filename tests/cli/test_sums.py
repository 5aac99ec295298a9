"""``fricmodels sums``, and ``fit`` by sums."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import fricmodels
from fricmodels.cli import _run

MODEL = ["--model", "coulomb-viscous"]


@pytest.fixture
def recordings(tmp_path: Path) -> list[str]:
    paths = []
    for number in range(2):
        time = 0.002 * np.arange(8000)
        velocity = 4 * np.sin(2.1 * time + number) + 3 * np.sin(5.3 * time)
        slope = 8.4 * np.cos(2.1 * time + number) + 15.9 * np.cos(5.3 * time)
        torque = 0.05 * slope + 0.1 * velocity + 0.4 * np.sign(velocity)
        noisy = velocity + 0.01 * np.random.default_rng(number).standard_normal(8000)
        paths.append(tmp_path / f"arm{number}.parquet")
        pd.DataFrame({"time_s": time, "torque_Nm": torque, "velocity_rad_s": noisy}).to_parquet(paths[-1])
    return [str(path) for path in paths]


def test_sums_are_made_apart_added_and_fitted(
    recordings: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "sums"
    assert _run(["sums", recordings[0], *MODEL, "--out", str(out)]) == 0
    plan = str(out / "arm0.sums.json")
    assert _run(["sums", recordings[1], *MODEL, "--like", plan, "--out", str(out)]) == 0
    both = [plan, str(out / "arm1.sums.json")]
    assert _run(["fit", *both, *MODEL, "--inertia", "0.05", "--out", str(tmp_path / "a.model.json")]) == 0
    assert _run(["sums", *both, *MODEL, "--out", str(tmp_path / "all.sums.json")]) == 0
    assert "16000 samples in 2 files" in capsys.readouterr().out
    one = ["fit", str(tmp_path / "all.sums.json"), *MODEL, "--inertia", "0.05"]
    assert _run([*one, "--out", str(tmp_path / "b.model.json")]) == 0
    at_once = ["fit", *recordings, *MODEL, "--sums", "--inertia", "0.05"]
    assert _run([*at_once, "--out", str(tmp_path / "c.model.json")]) == 0
    models = [fricmodels.load(tmp_path / f"{name}.model.json") for name in "abc"]
    assert models[0].parameters == models[1].parameters
    assert models[0].parameters["K_c"] == pytest.approx(0.4, rel=5e-3)
    assert models[2].parameters["K_c"] == pytest.approx(models[0].parameters["K_c"], rel=1e-3)  # another plan
    assert models[0].document.provenance.samples_fitted == 16000
    assert models[0].document.provenance.files == ("arm0.parquet", "arm1.parquet")


def test_what_does_not_go_together_is_one_line(
    recordings: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "sums")
    assert _run(["sums", recordings[0], *MODEL, "--out", out]) == 0
    plan = f"{out}/arm0.sums.json"
    refused = [
        ["fit", plan, recordings[1], *MODEL, "--out", f"{out}/m.json"],
        ["fit", plan, "--model", "square-root", "--out", f"{out}/m.json"],
        ["fit", plan, *MODEL, "--objective", "position", "--out", f"{out}/m.json"],
        ["sums", plan, *MODEL, "--out", out],
        ["sums", recordings[0], recordings[0], *MODEL, "--out", out],
        ["sums", recordings[0], "--model", "exponential-stick-slip", "--out", out],
        ["sums", recordings[0], *MODEL, "--like", recordings[1], "--out", out],
    ]
    for command in refused:
        capsys.readouterr()
        assert _run(command) == 2, command
        said = capsys.readouterr().err.strip()
        assert said.startswith("error: ")
        assert "\n" not in said
        assert "unexpected" not in said
