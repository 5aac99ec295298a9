"""The drive as filters and simulations see it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class StateSpace:
    """The drive as ``dx/dt = g(x, u)``, ``y = h(x)``, for filters and simulation (CasADi ``SX``).

    ``x`` is velocity, then the model's internal states, then the parameters, whose rates are zero; ``u`` holds the
    signals named in :attr:`inputs`.
    """

    x: Any
    u: Any
    width: Any
    rate: Any
    output: Any
    inputs: tuple[str, ...]
    states: tuple[str, ...]
