"""A drive that is held at the ends of its travel, or elsewhere, by more than its friction."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels import diagnose
from fricmodels.diagnosis.document import document
from fricmodels.dimension import Motion
from fricmodels.recording import Recording
from fricmodels.report.answer import answer
from fricmodels.results.words import END_STOP

INERTIA, VISCOUS, COULOMB = 0.05, 0.3, 0.8


def held(at: float) -> Recording:
    """Return moves between two places, where the controller pushes on against what holds the drive.

    Args:
        at: share of the travel at which the moves in one direction end; those in the other end at its beginning, and
            every third move goes through all of it.
    """
    rng, step = np.random.default_rng(2), 0.002
    pieces, position = [], 0.0
    for number in range(24):
        target = 0.0 if number % 2 else (2.0 if number % 3 == 0 else 2.0 * at)
        samples = int(abs(target - position) / 1.2 / step)
        phase = np.linspace(0.0, 1.0, samples + 1)[1:]
        pieces.append(position + (target - position) * (phase - np.sin(2 * np.pi * phase) / (2 * np.pi)))
        pieces.append(np.full(150, target))
        position = target
    path = np.concatenate(pieces)
    velocity = np.gradient(path, step)
    torque = INERTIA * np.gradient(velocity, step) + VISCOUS * velocity + COULOMB * np.sign(velocity)
    still = np.abs(velocity) < 1e-9
    outwards = np.sign(np.concatenate([[1.0], np.diff(path)]))
    side = outwards[np.maximum.accumulate(np.where(outwards != 0.0, np.arange(len(path)), 0))]
    ends = (path > 1.99) | (path < 0.01) if at == 1.0 else np.abs(path - 2.0 * at) < 0.01
    torque = np.where(still, np.where(ends, 2.5 * side, 0.5 * side), torque)
    channels = {
        "time": step * np.arange(len(path)),
        "torque": torque + 0.01 * rng.standard_normal(len(path)),
        "velocity": velocity + 0.001 * rng.standard_normal(len(path)),
        "position": path,
    }
    return Recording("stops", Motion.ROTARY, channels, np.zeros(len(path), dtype=np.int64))


@pytest.mark.parametrize(("at", "stops"), [(1.0, True), (0.5, False)])
def test_what_holds_a_drive_at_the_ends_of_its_travel_is_told_as_an_end_stop(at: float, stops: bool) -> None:
    found = diagnose(held(at), "coulomb-viscous", INERTIA)
    assert found.verdict == "unknown-effect"
    assert found.remaining is not None
    where = found.remaining.where
    assert "at rest" in where
    assert where.endswith(END_STOP) is stops
    assert ("0 and 2 rad" in where) is stops
    assert ("as a brake or an end stop does" in where) is not stops
    said = answer(document(found))
    assert ("Leave out what touches an end stop" in said.next) is stops
    assert ("Find out whether something else holds it at rest" in said.next) is not stops
