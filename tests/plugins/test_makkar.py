"""A law from a distribution of its own takes part in a tournament like any other."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import pytest

from fricmodels import plugins
from fricmodels.model import Model
from fricmodels.tournament import load_config, run

pytestmark = pytest.mark.skipif(
    not list(importlib.metadata.entry_points(group="fricmodels", name="makkar")),
    reason="the plugin is not installed: pip install -e ./plugins/fricmodels-makkar",
)

CONFIG = """\
datasets:
  - name: smooth motor
    simulate:
      model: makkar
      parameters: {gamma_1: 0.004, gamma_2: 0.5, gamma_3: 0.05, gamma_4: 0.008, gamma_5: 1.0, gamma_6: 1.0e-4}
      inertia: 4.87e-6
      amplitude: 0.02
      frequency: 39.54
models: [makkar, square-root]
estimators: batch
"""


def test_it_comes_from_its_own_distribution() -> None:
    assert plugins.load().laws.entry("makkar").distribution == "fricmodels-makkar"
    assert Model.parse("makkar+cogging").name == "makkar+cogging"


def test_it_wins_on_a_drive_that_it_describes(tmp_path: Path) -> None:
    file = tmp_path / "config.yaml"
    file.write_text(CONFIG)
    board = run(load_config(file), tmp_path / "out", executor="serial")
    assert [row["status"] for row in board.rows] == ["ok", "ok"], [row["message"] for row in board.rows]
    first, second = board.rows
    assert first["model"] == "makkar"
    error = "held_out_rms_torque_error_percent"
    assert first[error] < 0.5 * second[error]
