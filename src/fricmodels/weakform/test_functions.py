r"""The equation of motion in weak form: multiplied by test functions that vanish at their ends, and integrated.

.. math:: \int \varphi\,(\tau_m - \tau_L - \tau_F)\,dt
          = J \int \varphi\,\dot\omega\,dt = -J \int \dot\varphi\,\omega\,dt

The derivative stands on the test function, which is known, and not on the velocity, which is measured: nothing smears
the Coulomb step at a reversal, and nothing amplifies noise. How torques are integrated: :mod:`.quadrature`. A resting
drive fulfils the equation whatever its friction is, so samples at rest contribute to neither side.

The test function is what makes the change of velocity exact. If the velocity is measured it is constant within a cell:
the change from one sample to the next is the integral of the acceleration over the cell. If only positions are, it is a
straight line within a cell: the change between the mean velocities of two neighbouring cells is the integral of the
acceleration under a hat over both, and hats add up to straight lines. By the trapezium rule instead, a torque of phase
θ per sample would be too small by θ²/12 and θ²/6, which at 100 Hz is more than noise.
"""

from __future__ import annotations

from copy import copy
from functools import lru_cache

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.recording import Recording
from fricmodels.signals.segments import stretches
from fricmodels.weakform.quadrature import Quadrature

HOPS = 8
"""Neighbouring test functions are an eighth of a test function apart: finer ones say nothing new."""
_TOGETHER = 8
"""Rows that are integrated together, so that memory stays bounded."""


def mean_velocity(recording: Recording, position: Array) -> Array:
    """Return the mean velocity from each sample to the next, shape (N,): what positions say without any smoothing.

    At the last sample of a run there is none; 0 stands there, and no test function reaches it.
    """
    step = np.diff(recording.time)
    within = (np.diff(recording.run) == 0) & (step > 0)
    velocity = np.zeros(len(recording))
    velocity[:-1][within] = np.diff(position)[within] / step[within]
    return velocity


@lru_cache(maxsize=64)
def _cells(width: int, over_cells: bool) -> tuple[Array, Array]:
    """Return a test function's weights of the changes of velocity, and of everything else in each cell, each of sum 1.

    The change between the mean velocities of two cells weighs the acceleration by a hat over both.
    """
    inner = width - 1 if over_cells else width
    x = 2.0 * np.arange(1, inner) / inner - 1.0
    changes = (1.0 - x**2) ** 2
    changes /= changes.sum()
    if not over_cells:
        return np.pad(changes, 1), np.pad(changes, 1)
    return np.pad(changes, (1, 2)), np.pad(np.convolve(changes, [0.5, 0.5]), 1)


class TestFunctions:
    """Test functions of one width along a recording, an eighth of their width apart.

    Args:
        recording: gives the stretches without a gap.
        width: samples that a test function spans; rounded to a multiple of 8.
        resting: samples at rest, or otherwise of no use.
        least_moving: share of a test function's weight that must be in motion; a test function with less is left out.
        over_cells: whether the velocity is the mean over each cell, see :func:`mean_velocity`.
        counts: by how much an equation counts that begins at each sample, shape (N,); all as much if not given.
    """

    def __init__(
        self,
        recording: Recording,
        width: int,
        resting: Mask,
        *,
        least_moving: float = 0.5,
        over_cells: bool = False,
        counts: Array | None = None,
    ) -> None:
        self.hop = max(1, round(width / HOPS))
        self.width = self.hop * HOPS
        self.over_cells = over_cells
        self._resting, self._asked = resting, width
        changes, between = _cells(self.width, over_cells)
        self.changes = changes[:-1]
        self._mean = 0.5 * (between[:-1] + between[1:])
        self._cell = between[1:]
        self._fall = between[:-1] - between[1:]
        self._velocity_fall = changes[:-1] - changes[1:]
        pieces = [piece for piece in stretches(recording.time, recording.run) if piece.stop - piece.start >= self.width]
        self._first = np.array([piece.start for piece in pieces], dtype=np.int64)
        self._per_stretch = np.array([(p.stop - p.start) // self.hop - HOPS + 1 for p in pieces], dtype=np.int64)
        self.counts: Array | None = None
        self._keep(np.arange(self._per_stretch.sum()))
        moving = self._apply((~resting).astype(float)[None], self._mean)[0]
        self._keep(np.flatnonzero(moving >= least_moving - 1e-12))
        self.counts = counts

    def _keep(self, kept: Index) -> None:
        """Take some of all test functions, ascending, in runs of neighbours."""
        from fricmodels.weakform.cells import runs_of

        begins, lengths = np.empty_like(kept), np.empty_like(kept)
        runs = runs_of(kept, self._first, self._per_stretch, self.hop, begins, lengths)
        self._kept, self.count = kept, len(kept)
        self._runs = begins[:runs].copy(), lengths[:runs].copy()

    def counting(self, counts: Array) -> TestFunctions:
        """Return them with equations that count otherwise, shape (N,)."""
        other = copy(self)
        other.counts = counts
        return other

    def clear_of(self, samples: Mask) -> TestFunctions:
        """Return the test functions that none of some samples lies within."""
        other = copy(self)
        other._asked = 0
        other._keep(self._kept[self.integrals(samples.astype(float)[None])[0] == 0.0])
        return other

    def is_of(self, width: int, resting: Mask) -> bool:
        """Whether they were made for a width and samples of no use."""
        return self._asked == width and np.array_equal(self._resting, resting)

    def in_common(self, other: TestFunctions) -> Index:
        """Return which of them another set along the same recording has, too; none where carriers go with them."""
        if (
            self.each > 1
            or other.each > 1
            or self.width != other.width
            or not np.array_equal(self._first, other._first)
        ):
            return np.zeros(0, dtype=np.int64)
        there = np.zeros(int(self._per_stretch.sum()), dtype=bool)
        there[other._kept] = True
        return np.flatnonzero(there[self._kept])

    each = 1
    """Rows of each test function."""

    @property
    def left_out(self) -> Mask:
        """Samples at rest, or otherwise of no use, shape (N,)."""
        return self._resting

    def covered(self, count: int) -> Mask:
        """Mark the samples that lie within a test function, shape (N,)."""
        marks = np.zeros(count + 1)
        np.add.at(marks, self.begins, 1.0)
        np.add.at(marks, self.begins + self.width, -1.0)
        return np.asarray(np.cumsum(marks[:-1]) > 0.5)

    @property
    def begins(self) -> Index:
        """The sample at which each test function begins, shape (number of test functions,)."""
        starts = [a + self.hop * np.arange(n) for a, n in zip(self._first, self._per_stretch, strict=True)]
        return np.concatenate([np.zeros(0, dtype=np.int64), *starts])[self._kept]

    @property
    def weights(self) -> Array:
        """Weight of each sample in a mean over a test function, of sum 1."""
        return self._mean

    def integrals(self, integrand: Array) -> Array:
        """Return ∫φ f dt for rows f, shape (k, number of test functions)."""
        return self._apply(integrand, self._mean)

    def torques(self, quadrature: Quadrature, rows: Array) -> Array:
        """Return ∫φ f dt of rows, shape (k, N + two for each split cell) → (k, number of test functions)."""
        if not self.over_cells:
            found = quadrature.sums_along_cubics(rows, *self._runs, self._parts(self._cell), len(self._kept))
            return self._counted(found)
        if len(rows) > _TOGETHER:
            some = [rows[start : start + _TOGETHER] for start in range(0, len(rows), _TOGETHER)]
            return np.concatenate([self.torques(quadrature, each) for each in some])
        return self._counted(self._apply(quadrature.under_hats(rows), self.changes))

    def driving(self, quadrature: Quadrature, torque: Array) -> Array:
        """Return ∫φ f dt of what a drive is driven by, shape (N + two for each split cell,) → (test functions,)."""
        return np.asarray(self.torques(quadrature, torque[None])[0] + self._bent_at_reversals(quadrature, torque))

    def _bent_at_reversals(self, quadrature: Quadrature, torque: Array) -> Array:
        bent = quadrature.bent_at_reversals(torque[: len(quadrature.half) + 1])[None]
        if self.over_cells:  # a half of each cell lies under the hat about its first sample, a half under the next
            return np.asarray(self.of_steps(0.5 * (bent + np.roll(bent, 1)))[0])
        return np.asarray(self.of_cells(bent)[0])

    def of_cells(self, impulses: Array) -> Array:
        """Return Σ φ I over the cells, shape (k, number of test functions), of what is known to happen in each cell.

        Args:
            impulses: of each cell, shape (k, N), weighted by the mean of the test function there.
        """
        return self._counted(self._apply(impulses, self._cell))

    def momentum(self, velocity: Array) -> Array:
        """Return ∫φ dω = −∫φ' ω dt, shape (number of test functions,)."""
        return np.asarray(self._counted(self._apply(velocity[None], self._velocity_fall))[0])

    def change(self, values: Array) -> Array:
        """Return ∫φ df = −∫φ' f dt of what was measured, shape (number of test functions,)."""
        return np.asarray(self._counted(self._apply(values[None], self._fall))[0])

    def of_steps(self, steps: Array) -> Array:
        """Return Σ φ x over the samples, shape (k, test functions), of what is centred as velocity changes are.

        Args:
            steps: shape (k, N); the first of a test function belongs to the change from its first sample to its second.
        """
        return self._counted(self._apply(steps, self.changes))

    def _counted(self, rows: Array) -> Array:
        """Return rows, shape (k, number of test functions), each as far as it counts."""
        return rows if self.counts is None else rows * self.counts[self.begins]

    def _parts(self, kernel: Array) -> Array:
        """Return the weights of a test function, a row each part."""
        return kernel.reshape(HOPS, self.hop)

    def _apply(self, rows: Array, kernel: Array) -> Array:
        from fricmodels.weakform.cells import weighted_sums

        sums = np.empty((len(rows), len(self._kept)))
        rows = np.ascontiguousarray(rows, dtype=float)
        weighted_sums(rows, *self._runs, self._parts(kernel), sums)
        return sums


def rows_of(
    recording: Recording, smooth: Array, width: int, unclear: Mask, counts: Array | None
) -> tuple[Quadrature, TestFunctions]:
    """Return how a recording is integrated, and the test functions that lie within clear motion.

    Args:
        recording: prepared.
        smooth: velocity freed of noise, shape (N,).
        width: samples that a test function spans.
        unclear: samples that none of them may reach, shape (N,).
        counts: see :class:`TestFunctions`.
    """
    over_cells = recording.derived_over > 0
    test_functions = TestFunctions(recording, width, unclear, least_moving=1.0, over_cells=over_cells, counts=counts)
    return Quadrature.of(recording, smooth, unclear), test_functions
