"""Presliding gives back no more than it took, though the drive runs harder in one direction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fricmodels.model import Model

MODEL = Model.parse("asymmetric-coulomb-viscous+presliding")


def _friction() -> tuple[Any, list[str]]:
    """Return friction torque and dz/dt as a function of velocity, z and the parameters, and the parameters' symbols."""
    import casadi

    e = MODEL.expression()
    others = casadi.vertcat(*(symbol for name, symbol in e.signals.items() if name != "velocity"))
    both = casadi.substitute(casadi.vertcat(e.torque, e.rates), others, casadi.DM.zeros(others.numel()))
    function = casadi.Function("friction", [e.signals["velocity"], e.states, e.parameters, e.width], [both])
    return function, [p.declared.symbol for p in MODEL.parameters]


@pytest.mark.parametrize("seed", range(3))
def test_what_is_not_stored_is_lost(seed: int) -> None:
    """Power less the change of W = F_z x_s z²/2 is nowhere negative, whatever velocity, deflection and parameters."""
    rng = np.random.default_rng(seed)
    friction, symbols = _friction()
    for _ in range(300):
        forward, backward, damping = 10 ** rng.uniform(-2, 2, 3)
        width = 10 ** rng.uniform(-5, 0)
        own = {"K_c1": forward, "K_c2": backward, "F_1": forward, "F_2": backward, "D": damping, "x_s": width}
        z, velocity = rng.uniform(-1, 1), float(rng.choice([-1, 1])) * 10 ** rng.uniform(-3, 2)
        torque, rate = friction(velocity, z, [own.get(s, 0.0) for s in symbols], 1e-9).full().ravel()
        stored = (forward if z >= 0 else backward) * width * z * rate
        assert torque * velocity - stored >= -1e-9 * abs(torque * velocity)
