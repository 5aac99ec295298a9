"""What noise of the velocity leaves in the rows, and how wide test functions must be for it."""

from __future__ import annotations

import math
from weakref import WeakKeyDictionary

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.score import noise
from fricmodels.signals import lanczos_derivative, motion_noise, velocity_noise
from fricmodels.signals.lanczos import lanczos_value
from fricmodels.signals.switched import torque_noise
from fricmodels.signals.unlike_files import NoiseOfFiles
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.rates import UNEXPLAINED, relative_intervals, weights_of_rows
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.test_functions import HOPS, TestFunctions, mean_velocity

_NARROWEST, WIDEST = 16, 128
"""Samples that a test function spans, at the least and at the most."""
FEWEST, FEWEST_WHERE_ALL_COUNT = 40, 20
"""Widths that all runs have at least for each that is lost at the end of one, so that some are clear of what is
uncertain; and where none need be."""
_DERIVED = 6
"""A test function spans at least so many half widths of the derivation of the velocity, where friction is evaluated."""
_FEWEST_FOR_INERTIA, _OF_MOMENTUM = 8, 0.01
"""Widths that it has at least where noise would make an estimated inertia too small by more than this share."""
NOISE_SHARE, NOISE_SHARE_WHERE_ALL_COUNT = 0.01, 0.005
"""The test function is widened until the noise of the velocity adds less than this share of the RMS torque to a row.
Where no row need be clear of uncertain motion, a wide one loses no rows: it is widened until that is half as much."""


def velocity_noise_like(recording: Recording, rng: np.random.Generator) -> Array:
    """Return noise as the velocity has it, shape (N,): where it was derived, the derivative of the position's."""
    if not recording.derived_over:
        return velocity_noise(recording).like(len(recording), rng)
    drawn = motion_noise(recording).like(len(recording), rng)
    return lanczos_value(recording.time, drawn, recording.derived_over, recording.run, order=1)


def noisier(recording: Recording, smooth: Array, half_width: int) -> tuple[Array, Array]:
    """Return a smoothed velocity and its acceleration with as much noise again, shape (N,) each; no sign is another.

    Args:
        recording: with the velocity as measured.
        smooth: its smoothed velocity, shape (N,).
        half_width: of the filter that smoothed it.
    """
    noise = velocity_noise_like(recording, np.random.default_rng(0))
    time, run = recording.time, recording.run
    moved = smooth + lanczos_derivative(time, noise, half_width, run)[0]
    acceleration = lanczos_derivative(time, recording.velocity + noise, half_width, run)[1]
    return np.where(moved * smooth > 0, moved, smooth), acceleration


def momentum_noise(test_functions: TestFunctions, recording: Recording) -> Array:
    """Return the momentum per inertia that noise alone would show, shape (rows,).

    Args:
        test_functions: of the recording.
        recording: whose position or velocity is noisy.
    """
    return test_functions.momentum(_noise_of_cells(recording))


@once
def _noise_of_cells(recording: Recording) -> Array:
    """Return noise as the velocity has it whose changes are the momentum, shape (N,): always the same."""
    rng = np.random.default_rng(0)
    if not recording.derived_over:
        return velocity_noise_like(recording, rng)
    return mean_velocity(recording, motion_noise(recording).like(len(recording), rng))


def beyond_noise(momentum: Array, noise: Array, derived: Array, derived_again: Array) -> tuple[Array, Array]:
    """Return what the momentum has beyond the integral of a derived acceleration, and the same with noise again.

    A derivative is too small by what its filter takes away, and has less noise than the momentum for the same reason.
    Of the difference d that share counts that is not noise n, 1 − n'n/d'd, as of any signal in noise (Wiener).

    Args:
        momentum, noise: the momentum, and what noise alone makes of it, shape (rows,).
        derived, derived_again: integral of the derived acceleration, and the same with that noise in the velocity.
    """
    own, again = momentum - derived, momentum + noise - derived_again
    size, change = float(own @ own), again - own
    share = max(1.0 - float(change @ change) / size, 0.0) if size > 0.0 else 0.0
    return share * own, share * again


def noise_impulses(test_functions: TestFunctions, quadrature: Quadrature, recording: Recording) -> Array:
    """Return what noise of the motor torque alone would drive in the rows, shape (rows,)."""
    drawn = noise.noise_like(recording, "torque", np.random.default_rng(0))
    cell = quadrature.cell
    at_points = np.concatenate([drawn, drawn[cell], drawn[cell + 1]])
    return np.asarray(test_functions.torques(quadrature, at_points[None])[0])


def row_counts(recording: Recording, inertia: float, width: int) -> Array | None:
    """Return by how much a row counts that begins at each sample, shape (N,).

    ``None`` where all runs have one rate and alike noise.

    Args:
        recording: with velocity and torque.
        inertia: of the drive.
        width: samples that a test function spans.
    """
    sizes = row_sizes(recording, inertia, width)
    return None if sizes is None else counts_of(recording, sizes)


def counts_of(recording: Recording, sizes: tuple[Array, Array], unexplained: float = 0.0) -> Array:
    """Return by how much rows count, shape (N,), by their noise and by what no model explains.

    Args:
        recording: whose rows they are.
        sizes: see :func:`row_sizes`.
        unexplained: RMS of a row that no model explains, at the recording's own interval, if more than usual.
    """
    usual = UNEXPLAINED * recording.rms_torque * recording.interval
    return weights_of_rows(relative_intervals(recording), *sizes, max(usual, unexplained))


def row_sizes(recording: Recording, inertia: float, width: int) -> tuple[Array, Array] | None:
    """Return the RMS that noise of the velocity leaves in a row that begins at each sample, and noise of the torque.

    Shape (N,) each, in the row's own file, the second at the recording's own interval; ``None`` where all runs have one
    rate and alike noise.
    """
    relative, which = relative_intervals(recording), alike_samples(recording)
    if which is None and np.all(relative == 1.0):
        return None
    everywhere = np.zeros(len(recording), dtype=bool)
    of = np.zeros(len(recording), dtype=np.int64) if which is None else which
    test_functions = TestFunctions(recording, width, everywhere, over_cells=recording.derived_over > 0)
    momentum = inertia * momentum_noise(test_functions, recording)
    torque = noise_impulses(test_functions, Quadrature.of(recording, recording.velocity, everywhere), recording)
    at = test_functions.begins

    def size(rows: Array) -> Array:
        """Return the RMS of the rows that begin in samples alike, and where none do that of all, shape (N,)."""
        count, squares = np.bincount(of[at], minlength=of.max() + 1), np.bincount(of[at], rows**2, of.max() + 1)
        every = float(np.mean(rows**2)) if len(rows) else 0.0
        return np.asarray(np.sqrt(np.where(count > 0, squares / np.maximum(count, 1), every))[of])

    return size(momentum), size(torque / relative[at])


def alike_samples(recording: Recording) -> Index | None:
    """Return a number of the samples whose noise is alike, shape (N,); ``None`` where that of all is."""
    noises = (motion_noise(recording), torque_noise(recording))
    unlike = [noise.which for noise in noises if isinstance(noise, NoiseOfFiles)]
    return np.unique(np.stack(unlike), axis=1, return_inverse=True)[1].ravel().astype(np.int64) if unlike else None


def noise_in_columns(
    regression: Regression, columns: Array, change: Array, momentum: Array | None, noise: Array
) -> Array:
    """Return what noise of the velocity makes of columns that the base directions were projected out of, (k, rows).

    Noise is in the columns, and in the momentum where that is a base direction: a column of which as much is projected
    out as goes with the momentum gets its noise.

    Args:
        regression: gives the base directions.
        columns: shape (k, rows).
        change: of the columns by noise, shape (k, rows).
        momentum: as it is among the base directions; ``None`` where the inertia is given.
        noise: of the momentum, shape (rows,).
    """
    found = regression.project_out(change)
    if momentum is None:
        return found
    own, left = _of_momentum(regression, momentum, noise)
    share = columns @ own / float(own @ own)
    return np.asarray(found - share[:, None] * left)


def _of_momentum(regression: Regression, momentum: Array, noise: Array) -> tuple[Array, Array]:
    """Return what the other base directions leave of the momentum, (rows,), and all of them of its noise, (1, rows).

    Found once for all columns that a regression is asked for.
    """
    known = _momentum_of.get(regression)
    if known is None or known[0] is not momentum or known[1] is not noise:
        rest = regression.base[np.abs(regression.base @ momentum) < (1.0 - 1e-9) * np.linalg.norm(momentum)]
        basis = np.linalg.svd(rest, full_matrices=False)[2]
        own = momentum - (momentum @ basis.T) @ basis
        known = _momentum_of[regression] = (momentum, noise, own, regression.project_out(noise[None]))
    return known[2], known[3]


_momentum_of: WeakKeyDictionary[Regression, tuple[Array, Array, Array, Array]] = WeakKeyDictionary()


def least_width(
    recording: Recording,
    inertia: float,
    fewest: int = FEWEST,
    share: float = NOISE_SHARE,
    *,
    estimated: bool = False,
    narrow: bool = False,
) -> int:
    r"""Return the least width at which velocity noise adds less than the stated share of the RMS torque to a row.

    An inertia that is estimated is too small by the share λ of noise in the squared momentum, whatever it is. Then a
    test function is widened, beyond what leaves many, until that is less than a hundredth.

    Args:
        recording: with velocity and torque.
        inertia: of the drive.
        fewest: times what is lost at the ends of runs that all samples are at least, see :func:`_widest`.
        share: of the RMS torque.
        estimated: whether the inertia is estimated from the same rows.
        narrow: whether it may be half as wide as usual, if it is strokes that are short and not the record.
    """
    torque, runs = _torque_and_runs(recording)
    wanted = share * torque * recording.interval
    least = -(-_DERIVED * recording.derived_over // HOPS) * HOPS
    half = narrow and _widest(runs, fewest) >= _NARROWEST
    usual, narrowest = (max(width, least) for width in (_NARROWEST, _NARROWEST // 2 if half else _NARROWEST))
    widest = max(usual, _widest(runs, fewest))
    most = max(widest, _widest(runs, _FEWEST_FOR_INERTIA)) if estimated else widest
    for width in range(narrowest, most, HOPS):
        count, squares, momentum = _momentum(recording, width)
        quiet = width >= widest or not count or inertia * math.sqrt(squares / count) <= wanted
        if quiet and not (estimated and squares > _OF_MOMENTUM * momentum):
            return width
    return most


@once
def _torque_and_runs(recording: Recording) -> tuple[float, Array]:
    """Return the RMS torque, and the number of samples of each run."""
    return recording.rms_torque, np.bincount(recording.run - recording.run.min()).astype(float)


def _widest(runs: Array, fewest: int) -> int:
    r"""Return the largest width, a multiple of :data:`HOPS`, at which enough is left of all runs together.

    A test function that would reach beyond the end of a run is none: a run of N samples loses w of them, and all if it
    has no more. The largest w is taken with :math:`\sum N \ge f \sum \min(N, w)`. Of runs of one length that is N/f.
    One short run beside a long one is no reason for narrow test functions.

    Args:
        runs: number of samples of each run, N.
        fewest: f.
    """
    widths = np.arange(HOPS, WIDEST + 1, HOPS)
    lost = np.minimum(runs[:, None], widths).sum(axis=0)
    return int(max(widths[fewest * lost <= runs.sum()], default=0))


def _momentum(recording: Recording, width: int) -> tuple[int, float, float]:
    """Return the number of test functions of a width, and the sums of squares of noise and of all momentum in them."""
    known = _momenta(recording)
    if width not in known:
        nothing, over_cells = np.zeros(len(recording), dtype=bool), recording.derived_over > 0
        test_functions = TestFunctions(recording, width, nothing, over_cells=over_cells)
        velocity = mean_velocity(recording, recording["position"]) if over_cells else recording.velocity
        noise, momentum = momentum_noise(test_functions, recording), test_functions.momentum(velocity)
        known[width] = len(noise), float(noise @ noise), float(momentum @ momentum)
    return known[width]


@once
def _momenta(_: Recording) -> dict[int, tuple[int, float, float]]:
    return {}
