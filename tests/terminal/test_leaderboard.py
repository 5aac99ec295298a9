"""The leaderboard in a terminal: every figure whole, at any width, in plain text when piped."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricmodels.cli import main
from fricmodels.tournament import Leaderboard


def board() -> Leaderboard:
    rng = np.random.default_rng(0)
    rows = [
        {
            "model": f"asymmetric-exponential-stick-slip+cogging+{'x' * 30}{number}", "estimator": "detchmendy-sridhar",
            "dataset": f"\x1b[31mrun {number}", "tags": {"noise_percent": float(rng.uniform()), "seed": number % 3},
            "rms_torque_error_percent": float(rng.lognormal()), "parameters": {}, "standard_errors": {},
            "held_out_rms_torque_error_percent": float(rng.lognormal()), "true_parameters": None,
            "seconds": float(rng.lognormal()), "status": "ok" if number else "failed", "message": "why " * 20,
        }
        for number in range(7)
    ]  # fmt: skip
    return Leaderboard.ranked(rows)


@pytest.mark.parametrize("width", [40, 60, 80, 120])
def test_figures_are_whole_at_any_width(
    width: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    shown = board()
    shown.write(tmp_path)
    monkeypatch.setenv("COLUMNS", str(width))
    with pytest.raises(SystemExit) as stopped:
        main(["leaderboard", str(tmp_path)])
    assert stopped.value.code == 0
    text = capfd.readouterr().out
    assert "\x1b" not in text
    assert max(len(line) for line in text.splitlines()) <= width
    words = text.split()
    left_out = " ".join(words).partition("Left out for want of room: ")[2].partition(";")[0]
    for row in shown.rows:
        assert f"{row['held_out_rms_torque_error_percent']:.3g}" in words
        for key, title in (("rms_torque_error_percent", "fit"), ("seconds", "seconds")):
            assert f"{row[key]:.3g}" in words or title in left_out
    assert "…" not in text
    assert "failed" in words
