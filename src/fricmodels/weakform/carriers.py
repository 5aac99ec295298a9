r"""Test functions that carry a wave over position: what sees a torque that alternates faster than they are wide.

A test function averages such a torque away. Multiplied by a wave of the same wave number k it does not:

.. math:: \int\varphi\sqrt2\cos(kq)\,(\tau_m-\tau_L-\tau_F)\,dt = J\int\varphi\sqrt2\cos(kq)\,d\omega

and alike with the sine. The two rows of a wave have its RMS torque together, and what is slow cancels in them.

Between two samples the wave goes on by :math:`\theta=k\,\Delta q`. A change of velocity is the integral of the torque,
which is the wave at the middle times :math:`\sin(\theta/2)/(\theta/2)`; the trapezium rule of the torques has
:math:`\cos(\theta/2)`. So changes of velocity are weighted by :math:`r=(\theta/2)/\tan(\theta/2)`, those of mean
velocities (see :func:`.test_functions.mean_velocity`) by :math:`r^2`, and both sides agree for every speed. What passes
half a wave or more between samples is left out.

Noise of the velocity alternates as fast as a carrier, and a test function averages it away: rows with a carrier may be
fifty times as noisy as those without. So they are divided by how much noisier they are (weighted least squares), or an
inertia that is estimated would be that of noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.recording import Recording
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.row_noise import momentum_noise, noise_impulses
from fricmodels.weakform.test_functions import TestFunctions


def at_steps(impulses: Array, over_cells: bool) -> Array:
    """Return integrals over cells, shape (k, N), as the changes of velocity are centred.

    The change from sample i − 1 to i belongs to the cell between them; that between the mean velocities of two
    neighbouring cells to half of each.
    """
    before = np.zeros_like(impulses)
    before[:, 1:] = impulses[:, :-1]
    return 0.5 * (before + impulses) if over_cells else before


def step_positions(position: Array, over_cells: bool) -> tuple[Array, Array]:
    """Return at which position each change of velocity is centred, and what the drive passes between samples, (N,)."""
    passed = np.diff(position, prepend=position[:1])
    if not over_cells:
        return position - 0.5 * passed, passed
    following = np.append(passed[1:], 0.0)
    return position, 0.5 * (passed + following)


def step_response(half: Array) -> Array:
    r"""Return :math:`r=(\theta/2)/\tan(\theta/2)`, what stands for 1 in the trapezium rule; 0 beyond half a wave."""
    carried = np.abs(half) < 0.5 * np.pi
    tangent = np.tan(np.where(carried, half, 0.0))
    seen = np.abs(tangent) > 1e-9
    return np.where(seen, half / np.where(seen, tangent, 1.0), 1.0) * carried


class CarrierFunctions(TestFunctions):
    """Test functions with carriers: each by itself where that is wanted, then cosine and sine of each carrier.

    Args:
        plain: the test functions.
        recording: gives the position.
        carriers: wave numbers.
        alone: whether the test functions without a carrier are left out.
    """

    def __init__(
        self, plain: TestFunctions, recording: Recording, carriers: Sequence[float], *, alone: bool = False
    ) -> None:
        self.__dict__.update(plain.__dict__)
        self._plain, self._alone = plain, alone
        place, passed = step_positions(recording["position"], plain.over_cells)
        half = 0.5 * np.asarray(carriers)[:, None] * passed
        carried = np.abs(half) < 0.5 * np.pi
        waves = np.sqrt(2.0) * np.exp(1j * np.asarray(carriers)[:, None] * place) * carried
        self._waves = np.stack([waves.real, waves.imag], axis=1).reshape(-1, len(recording))
        self._inertial = np.repeat(step_response(half) ** (2 if plain.over_cells else 1), 2, axis=0) * self._waves
        self.each = len(self._waves) + (not alone)
        self.count = plain.count * self.each

    def weighted(self, quadrature: Quadrature, recording: Recording, inertia: float) -> CarrierFunctions:
        """Return them with the rows of each carrier no noisier than those of the test functions.

        Args:
            quadrature, recording: of the test functions.
            inertia: J [kg m²] or M [kg], with which noise of the velocity counts beside that of the torque.
        """
        if not self.count:
            return self
        noise = inertia * momentum_noise(self, recording), noise_impulses(self, quadrature, recording)
        power = np.mean(np.sum(np.square(noise), axis=0).reshape(-1, self.each), axis=0)
        carried = power[1:].reshape(-1, 2).mean(axis=1)
        weights = np.sqrt(power[0] / np.maximum(carried, power[0])) if power[0] > 0.0 else np.ones(len(carried))
        other = copy(self)
        other._waves, other._inertial = (np.repeat(weights, 2)[:, None] * w for w in (self._waves, self._inertial))
        return other

    def clear_of(self, samples: Mask) -> CarrierFunctions:
        """Return the test functions that none of some samples lies within."""
        other = copy(self)
        other._plain = self._plain.clear_of(samples)
        other._keep(other._plain._kept)
        other.count = other._plain.count * self.each
        return other

    def integrals(self, integrand: Array) -> Array:
        """Return the means under the test functions, the same for every row of one, shape (k, number of rows)."""
        return np.repeat(self._plain.integrals(integrand), self.each, axis=1)

    def torques(self, quadrature: Quadrature, rows: Array) -> Array:
        """Return ∫φ f dt of rows, shape (k, N + two for each split cell) → (k, number of rows).

        Beside a carrier by the trapezium rule, for which :func:`step_response` stands on the other side.
        """
        steps = at_steps(quadrature.impulses(rows), self._plain.over_cells)
        return self._carried(None if self._alone else self._plain.torques(quadrature, rows), steps, self._waves)

    def _bent_at_reversals(self, quadrature: Quadrature, torque: Array) -> Array:
        """Nothing beside a carrier, where there are no cubics."""
        rows = np.zeros((self.count // self.each, self.each))
        if not self._alone:
            rows[:, 0] = self._plain._bent_at_reversals(quadrature, torque)
        return rows.ravel()

    def of_cells(self, impulses: Array) -> Array:
        """Return Σ φ I over the cells, shape (k, number of rows), of what happens within each cell."""
        steps = at_steps(impulses, self._plain.over_cells)
        return self._carried(None if self._alone else self._plain.of_cells(impulses), steps, self._waves)

    def momentum(self, velocity: Array) -> Array:
        """Return ∫φ dω, shape (number of rows,)."""
        steps = np.diff(velocity, prepend=velocity[:1])[None]
        plain = None if self._alone else self._plain.momentum(velocity)[None]
        return np.asarray(self._carried(plain, steps, self._inertial)[0])

    def change(self, values: Array) -> Array:
        """Return ∫φ df of what was measured, shape (number of rows,)."""
        steps = at_steps(np.diff(values, append=values[-1:])[None], self._plain.over_cells)
        plain = None if self._alone else self._plain.change(values)[None]
        return np.asarray(self._carried(plain, steps, self._waves)[0])

    def _carried(self, plain: Array | None, steps: Array, waves: Array) -> Array:
        rows = np.empty((len(steps), self.count // self.each, self.each))
        if plain is not None:
            rows[:, :, 0] = plain
        for place, wave in enumerate(waves, self.each - len(waves)):
            rows[:, :, place] = self._plain.of_steps(steps * wave)
        return rows.reshape(len(steps), self.count)
