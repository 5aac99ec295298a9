"""The drive's state space in normalised units (eq. 6), as symbols, whatever the numbers of one drive are.

The equations are kept in SI and the normalised quantities multiplied by their sizes where they enter: a term such as
gravity, ``b sin q``, has the radian built in and is no longer true when angles are counted in another unit. The sizes
are symbols, so that one compiled step serves every drive with the same model.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import DIMENSIONLESS, VELOCITY, Scales
from fricmodels.drive import Drive
from fricmodels.term import SIGNALS


@dataclass(frozen=True)
class NormalisedSpace:
    """``dx/dr = g(x, u)``, ``y = h(x)`` in normalised units, as CasADi ``SX``.

    Attributes:
        x: velocity, internal states, parameters. u: inputs. rate: g. output: h.
        known: column of numbers that do not change while filtering; :meth:`values` gives them.
        creeping: normalised speed that stands for the limit of rest, in each direction.
        inputs: names of the inputs. states: names of velocity and internal states, and of the position where it is one.
        measured: the place in x of what is measured: the velocity, or the position.
    """

    x: Any
    u: Any
    known: Any
    creeping: Any
    rate: Any
    output: Any
    inputs: tuple[str, ...]
    states: tuple[str, ...]
    measured: int = 0

    @property
    def moving(self) -> int:
        """How many of x are no parameters."""
        return len(self.states)

    def values(self, drive: Drive, scales: Scales, width: float) -> Array:
        """Return the numbers of :attr:`known` for one drive: its width of rest [velocity] and scales."""
        states = [scales.of(state.dimension) for state in drive.model.states]
        inputs = [scales.of(SIGNALS.get(name, DIMENSIONLESS)) for name in self.inputs]
        inertia = drive.inertia if drive.inertia is not None else 1.0
        sizes = [scales.of(VELOCITY), *states, *drive.parameter_scales(scales), *inputs]
        return np.array([width, inertia, scales.time, *sizes])


def normalised_space(drive: Drive, *, by_position: bool = False) -> NormalisedSpace:
    """Build the state space of a drive in normalised units.

    Args:
        drive: the drive.
        by_position: whether the position, counted from where a run begins, is a state and measured, not the velocity.
    """
    import casadi

    space = Drive(drive.model, None, drive.motion).state_space()
    moving = len(space.states)
    kept = [i for i in range(space.x.numel()) if i != moving or drive.inertia is None]
    x, u = casadi.SX.sym("x", len(kept)), casadi.SX.sym("u", space.u.numel())
    given, time = casadi.SX.sym("given_inertia"), casadi.SX.sym("time_scale")
    sizes = casadi.SX.sym("sizes", len(kept) + space.u.numel())
    size = sizes[: len(kept)]
    present = x * size
    complete = present if drive.inertia is None else casadi.vertcat(present[:moving], given, present[moving:])
    old = casadi.vertcat(space.x, space.u)
    new = casadi.vertcat(complete, u * sizes[len(kept) :])
    rate, output = casadi.substitute([space.rate, space.output], [old], [new])
    found = NormalisedSpace(
        x=x,
        u=u,
        known=casadi.vertcat(space.width, given, time, sizes),
        creeping=1e-3 * space.width / size[0],
        rate=rate[kept] * time / size,
        output=output / size[0],
        inputs=space.inputs,
        states=space.states,
    )
    return _with_position(found) if by_position else found


def _with_position(space: NormalisedSpace) -> NormalisedSpace:
    """Return the space with the integral of the velocity as its last state, which is measured."""
    import casadi

    position, moving = casadi.SX.sym("position"), space.moving
    return replace(
        space,
        x=casadi.vertcat(space.x[:moving], position, space.x[moving:]),
        rate=casadi.vertcat(space.rate[:moving], space.x[0], space.rate[moving:]),
        output=position,
        states=(*space.states, "position"),
        measured=moving,
    )
