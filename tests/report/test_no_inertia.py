"""An inertia of nothing is explained where the last model has it, and not where the first one had."""

from __future__ import annotations

import io

import numpy as np
from rich.console import Console
from tests.conftest import Made

from fricmodels.diagnosis import improve
from fricmodels.recording import Recording
from fricmodels.report.console import show_answer_of_ladder


def printed(recording: Recording) -> tuple[str, list[float]]:
    """Return what is printed of a ladder, in one line, and each inertia in standard errors."""
    ladder, text = improve(recording, "coulomb-viscous"), io.StringIO()
    show_answer_of_ladder(Console(file=text, width=100), ladder)
    fits = [rung.comparison.estimate for rung in ladder.rungs]
    return " ".join(text.getvalue().split()), [fit.parameters["J"] / fit.standard_errors["J"] for fit in fits]


def test_a_spring_hides_the_inertia_of_the_first_model_only(made: Made) -> None:
    text, inertia = printed(made("coulomb-viscous+stiffness", {"stiffness.k": 90.0}, samples=4000))
    assert inertia[0] < 1.96 < 10.0 < inertia[-1]
    assert "No inertia shows" not in text


def test_a_torque_along_the_motion_shows_none(made: Made) -> None:
    own = made(samples=4000)
    noise = 0.05 * np.random.default_rng(0).standard_normal(len(own))
    text, inertia = printed(own.with_channels(derived=False, torque=3.0 * np.sign(own.velocity) + noise))
    assert inertia[-1] < 1.96
    assert "No inertia shows" in text
