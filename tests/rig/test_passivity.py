"""Contacts that bend give back no more than they took, whatever the motion: friction is no motor."""

import math

import numpy as np
import pytest
from numba import njit

from fricmodels.rig.motion import friction_torque, weakening_ratio
from fricmodels.rig.physics import DAHL, LUGRE, MAXWELL_SLIP, PHYSICS, bristles, slow_factors

WIDTH, FORWARD, BACKWARD = 0.01, 3.0, 1.5


@njit
def _work(p, position, speed):
    """Return the work done against friction up to each place, starting with straight contacts."""
    slow = slow_factors(p, 0.0)
    z = (0.0, 0.0, 0.0, 0.0)
    work = np.zeros(len(position))
    for k in range(1, len(position)):
        travel = position[k] - position[k - 1]
        side = math.copysign(1.0, travel)
        w = side * speed[k]
        ratio = weakening_ratio(p, w, position[k], 0.0, slow, 0.0)
        _, before = bristles(p, z, 0.0, ratio)
        z, after = bristles(p, z, travel, ratio)
        first = friction_torque(p, side, w, 0.0, position[k - 1], 0.0, slow, 0.0, before)
        last = friction_torque(p, side, w, 0.0, position[k], 0.0, slow, 0.0, after)
        work[k] = work[k - 1] + 0.5 * (first + last) * travel
    return work


def _swings(rng):
    """Return positions and speeds: slides, each followed by closed swings of one width, each way at its own speed."""
    position, speed = [0.0], [0.0]
    for _ in range(40):
        slide = rng.choice([-1, 1]) * WIDTH * rng.uniform(1, 5)
        swing = rng.choice([-1, 1]) * WIDTH * 10 ** rng.uniform(-2, 0)
        fast, slow = 10 ** rng.uniform(-2, 0.5, 2)
        legs = [(slide, fast), *([(swing, slow), (-swing, fast)] * 20)]
        for length, at in legs:
            position.extend(position[-1] + length * np.linspace(0, 1, 41)[1:])
            speed.extend([at] * 40)
    return np.array(position), np.array(speed)


@pytest.mark.parametrize("kind", [DAHL, LUGRE, MAXWELL_SLIP])
@pytest.mark.parametrize("fall", [0.0, 10.0])
def test_no_swing_draws_more_from_a_contact_than_it_stores(kind, fall):
    """Harder one way than the other, and with friction that falls with speed: at most F·width/2 comes back."""
    p = np.zeros(1, PHYSICS).view(np.recarray)
    p.motor_share = p.motor_inertia = p.stribeck_speed = p.ageing_distance = p.ageing_time = 1.0
    p.presliding, p.elastic_width, p.step_time = kind, WIDTH, np.inf
    p.coulomb_forward, p.coulomb_backward = FORWARD, BACKWARD
    if fall:
        p.rise_forward = p.rise_backward = 1.0
        p.fall_forward = p.fall_backward = fall
    most = 0.5 * (FORWARD + (fall > 0)) * WIDTH
    for seed in range(4):
        work = _work(p[0], *_swings(np.random.default_rng(seed)))
        given_back = np.max(np.maximum.accumulate(work) - work)
        assert given_back <= 1.02 * most
        assert work[-1] > 10 * most
