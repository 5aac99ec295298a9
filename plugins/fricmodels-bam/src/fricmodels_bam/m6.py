"""M6: directional friction with a part that grows with the square of the load."""

from __future__ import annotations

from fricmodels import Parameter
from fricmodels.expressions import Expression, absolute, where
from fricmodels.term import Parameters, Signals
from fricmodels_bam.m5 import Directional


class Quadratic(Directional):
    r"""A wedge: near rest, a gearbox squeezed between motor and load holds with the square of the smaller torque.

    .. math::
        \tau_{dry} = K_c + |K_m\tau_m + K_e\tau_L| + S\,(K_{cs} + |K_{ms}\tau_m + K_{es}\tau_L| + Q), \qquad
        Q = \begin{cases} K_{eq}\tau_L^2 & |\tau_m| > |\tau_L| \\ K_{mq}\tau_m^2 & |\tau_m| < |\tau_L| \end{cases}

    while the motor works against the load, τ_m τ_L > 0; otherwise Q = 0.

    Source: Duclusaud et al. (2025), model M6, where τ_e = −τ_L; the condition on the signs is in the authors' program.
    """

    name = "bam-m6"
    formula = (
        "τ_F = K_v·ω + (K_c + |K_m·τ_m + K_e·τ_L| + S·(K_cs + |K_ms·τ_m + K_es·τ_L| + Q))·sgn ω, "
        "S = exp(−|ω/ω_s|^α), where τ_m·τ_L > 0: Q = K_eq·τ_L² for |τ_m| > |τ_L|, else K_mq·τ_m²"
    )
    K_mq = Parameter("K_mq", unit="1/N/m", lower=0.0, meaning="friction torque per square of the motor torque")
    K_eq = Parameter("K_eq", unit="1/N/m", lower=0.0, meaning="friction torque per square of the load torque")

    def sticking(self, s: Signals, p: Parameters) -> Expression:
        """Return that of M5 and the square of the smaller torque."""
        driving = absolute(s.motor_torque) > absolute(s.load_torque)
        square = where(driving, p.K_eq * s.load_torque**2, p.K_mq * s.motor_torque**2)
        opposed = s.motor_torque * s.load_torque > 0
        return super().sticking(s, p) + where(opposed, square, 0)
