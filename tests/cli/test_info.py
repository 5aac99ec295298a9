"""What `info` says of a log whose motion is too little, the other commands say too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import main


def log(path: Path, moves: int) -> Path:
    """Write a servo at 50 Hz that makes some moves of a second, and holds between them."""
    time = 0.02 * np.arange(3000)
    begins = np.linspace(0.5, 58.0, moves)
    way = np.where(np.arange(moves) % 2, -1.0, 1.0)
    share = np.clip((time[:, None] - begins) / 0.9, 0.0, 1.0)
    position = 2.0 * (share**2 * (3.0 - 2.0 * share)) @ way
    velocity = np.gradient(position, time)
    friction = 0.4 * np.sign(np.round(velocity, 6)) + 0.3 * velocity
    torque = 0.05 * np.gradient(velocity, time) + friction
    rng = np.random.default_rng(0)
    table = np.column_stack([time, torque + 0.005 * rng.standard_normal(3000), position])
    np.savetxt(path, table, delimiter=",", header="time_s,torque_Nm,position_rad", comments="", fmt="%.9g")
    return path


def called(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    with pytest.raises(SystemExit) as ended:
        main([*arguments])
    said = capsys.readouterr()
    return int(ended.value.code or 0), said.out + said.err


@pytest.mark.parametrize(("moves", "enough"), [(1, False), (3, True), (50, True)])
def test_it_knows_which_log_the_others_refuse(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, moves: int, enough: bool
) -> None:
    path = str(log(tmp_path / "servo.csv", moves))
    code, info = called(capsys, "info", path)
    assert code == 0
    assert ("too little clear motion" in info) is not enough
    code, fitted = called(capsys, "compare", path, "--model", "coulomb-viscous")
    assert (code == 0) is enough
    assert ("moves too little" in fitted) is not enough


def test_it_counts_the_motion_that_the_others_fit(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A ball on a beam, to a millimetre: which rows are clear is told by the motion before what is fitted, too."""
    time, size, frequency = 0.034 * np.arange(200), np.array([[0.01], [0.003]]), np.array([[2.5], [6.0]])
    waves = size * np.sin(frequency * time + np.array([[0.0], [1.0]]))
    force = -8.0 * np.sum(frequency**2 * waves, axis=0)
    force += 0.5 * np.std(force) * np.random.default_rng(3).standard_normal(200)
    path = tmp_path / "beam.csv"
    table = np.c_[time, force, np.round(waves.sum(axis=0), 3)]
    np.savetxt(path, table, delimiter=",", header="time_s,force_N,position_m", comments="", fmt="%.9g")
    refused = called(capsys, "compare", str(path), "--model", "coulomb-viscous")[0] != 0
    assert ("too little clear motion" in called(capsys, "info", str(path))[1]) is refused
