"""A contact that bends by less than sensors see has any torque at rest that it can have; a softer one has not."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels.arrays import rms
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.score import torque_error_over
from fricmodels.score.holding import holding_interval, unseen_at_rest
from fricmodels.signals import resting
from fricmodels.weakform.prepared import ready

INERTIA, COULOMB, VISCOUS = 0.05, 0.8, 0.12
BENT = Drive(Model.parse("coulomb-viscous+presliding"), INERTIA)


def pushed_at_rest() -> Recording:
    """Return a drive that swings with rests, in which a controller pushes it to and fro within its friction."""
    time = 1e-3 * np.arange(8000)
    phase = np.mod(time, 2.0)
    moves = phase < 1.0
    velocity = np.where(moves, 2.0 * np.sin(2.0 * np.pi * phase), 0.0)
    rate = np.where(moves, 4.0 * np.pi * np.cos(2.0 * np.pi * phase), 0.0)
    position = np.where(moves, (1.0 - np.cos(2.0 * np.pi * phase)) / np.pi, 0.0)
    friction = np.where(moves, VISCOUS * velocity + COULOMB * np.sign(velocity), 0.0)
    push = np.where(moves, 0.0, 0.9 * COULOMB * np.sin(2.0 * np.pi * 3.0 * phase))
    channels = {"time": time, "velocity": velocity, "position": position, "torque": INERTIA * rate + friction + push}
    return ready(Recording("pushed", Motion.ROTARY, channels, np.zeros(len(time), dtype=np.int64)))


def bent(reach: float) -> dict[str, float]:
    """Return the same friction as that of a contact that bends over a reach [rad]."""
    contact = {"presliding.F_1": COULOMB, "presliding.F_2": COULOMB, "presliding.D": 0.0, "presliding.x_s": reach}
    return {"J": INERTIA, "K_v": VISCOUS, "K_c": COULOMB, **contact}


def test_a_stiff_contact_leaves_as_little_as_coulomb_friction_a_soft_one_does_not() -> None:
    recording = pushed_at_rest()
    still = resting(recording)
    assert np.mean(still) == pytest.approx(0.5, abs=0.02)
    rigid = Drive(Model.parse("coulomb-viscous"), INERTIA)
    plain = torque_error_over(rigid, {"J": INERTIA, "K_v": VISCOUS, "K_c": COULOMB}, recording, 0.0)[still]
    way = unseen_at_rest(BENT, recording)
    stiff, soft = (torque_error_over(BENT, bent(reach), recording, 0.0)[still] for reach in (way / 20.0, 0.05))
    assert rms(plain) < 0.01
    assert rms(stiff) < 0.05
    assert rms(soft) > 0.3


@pytest.mark.parametrize("share", [0.01, 0.1, 1.0, 10.0])
def test_the_torque_at_rest_may_differ_by_what_the_contact_bends_on_the_unseen_way(share: float) -> None:
    """dz/dx = (1 − z)/x_s along the motion and (−1 − z)/x_s against it: z goes to ±1 as exp(−way/x_s)."""
    recording = pushed_at_rest()
    way = unseen_at_rest(BENT, recording)
    known = np.full(len(recording), 0.3)
    states = [known if state.symbol == "z" else np.zeros(len(recording)) for state in BENT.model.states]
    values = bent(way / share)
    least, greatest = holding_interval(BENT, recording, values, states, way=way)
    left = np.exp(-share)
    some = np.flatnonzero(resting(recording))[100]
    assert greatest[some] / COULOMB == pytest.approx(1.0 - 0.7 * left, abs=0.05)
    assert least[some] / COULOMB == pytest.approx(-1.0 + 1.3 * left, abs=0.05)


def test_a_model_without_memory_has_no_such_way() -> None:
    assert unseen_at_rest(Drive(Model.parse("coulomb-viscous"), INERTIA), pushed_at_rest()) == 0.0
