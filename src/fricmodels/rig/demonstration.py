"""The drive of ``fricmodels demo``: a robot joint with an effect that its model does not have."""

from __future__ import annotations

from fricmodels.rig.rig import Rig


def hidden() -> Rig:
    """Return a geared robot joint whose motor cogs 7.3 times a turn, and whose friction falls with speed near rest."""
    return Rig.model_validate(
        {
            "name": "robot joint",
            "inertia": 1.8,
            "friction": {"viscous": 6.0, "coulomb": 9.0},
            "effects": [
                {"name": "cogging", "harmonics": [{"order": 7.3, "amplitude": 2.2, "phase": 0.6}]},
                {"name": "stribeck", "rise": 5.0, "speed": 0.12, "exponent": 1.5},
            ],
            "excitation": {"kind": "tracking", "velocity": 1.2, "frequency": 0.15, "lines": 5, "bandwidth": 6.0},
            "sensors": {"velocity_noise_percent": 1.0, "encoder_step": 1e-5},
            "rate": 500,
            "samples": 15_000,
            "seed": 7,
        }
    )
