r"""The residual of a model as the diagnosis sees it: weak form, base directions, nuisances.

Each row is one test function φ on the recording. The target is
:math:`\int\varphi(\tau_m-\tau_L)\,dt - J\int\varphi\,d\omega`, the columns are the integrals of what a model is linear
in. Candidate effects give columns of the same kind, so that testing an effect is a question of linear regression,
whatever the effect is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.once import FieldsOnly
from fricmodels.recording import Recording
from fricmodels.signals.creeping import held_while_creeping
from fricmodels.signals.lost_samples import as_held
from fricmodels.term import Effect
from fricmodels.weakform.carriers import CarrierFunctions
from fricmodels.weakform.explained import explained_torque, torque_by_acceleration
from fricmodels.weakform.friction_limits import limits_of_friction
from fricmodels.weakform.kinks import with_kinks
from fricmodels.weakform.motion_states import MotionStates
from fricmodels.weakform.quadrature import Quadrature
from fricmodels.weakform.rates import relative_intervals
from fricmodels.weakform.remembered import INTEGRALS, Part, Remembered
from fricmodels.weakform.repeats import parts_of, phase_of
from fricmodels.weakform.row_noise import beyond_noise, least_width, momentum_noise, noise_impulses, noisier, row_counts
from fricmodels.weakform.smoothed import smoothed
from fricmodels.weakform.test_functions import HOPS, TestFunctions, mean_velocity, rows_of
from fricmodels.weakform.unclear import creeping, direction_unclear
from fricmodels.weakform.weighing import counts_as_left

_OF_ROWS = {"momentum", "noise_of_momentum", "driving", "torque_rate", "sign_change", "target", "centre", "integrated"}
"""What is computed once for the same rows."""
_FEW = 16.0
"""Independent rows below which a variance hardly has the eight cosines that it is estimated from: two to each."""


@dataclass(frozen=True)
class WeakFormProblem(FieldsOnly):
    """A drive, a recording, and its rows.

    Attributes:
        drive: the model under test, with its inertia given or not.
        recording: prepared; ``velocity`` as measured, torques at its time, see :meth:`fricmodels.drive.Drive.timed`.
        smooth, half_width: velocity freed of noise, with its :mod:`.kinks`, for friction; half width of that filter.
        resting: samples at rest.
        quadrature, test_functions, friction_limits: see the modules of these names.
        estimated: parameters of the drive's fit, once there is one; see :attr:`motor_torque`.
        delay: by which the model's own delay, if it has one, was taken out of the recording [s].
        carriers: wave numbers that the test functions carry, see :mod:`.carriers`.
        shift: time [s] by which an earlier fit saw motion recorded after the torque; see :attr:`torque_rate`.
        made_for: the parameters that :meth:`of` was given.
        held: whether the motor torque keeps each sample's value until the next; else it is joined by cubics.
        kept: parameters by key that stay at their bound, see :func:`fricmodels.diagnosis.at_bounds.beyond_bounds`.
    """

    drive: Drive
    recording: Recording
    smooth: Array
    resting: Mask
    quadrature: Quadrature
    test_functions: TestFunctions
    half_width: int
    friction_limits: tuple[float, float]
    estimated: Mapping[str, float] | None = None
    delay: float = 0.0
    carriers: tuple[float, ...] = ()
    shift: float = 0.0
    made_for: Mapping[str, float] = field(default_factory=dict)
    held: bool = False
    kept: frozenset[str] = frozenset()

    @classmethod
    def of(
        cls,
        drive: Drive,
        recording: Recording,
        parameters: Mapping[str, float],
        width: int | None = None,
        like: WeakFormProblem | None = None,
        *,
        guessed: bool = False,
    ) -> WeakFormProblem:
        """Choose the test functions, and evaluate what all candidates share.

        Args:
            drive: the model under test.
            recording: with ``velocity``.
            parameters: the model's estimated parameters by key, and the inertia.
            width: samples that a test function spans; as the noise asks for if not given. Where strokes are so short
                that only few rows have room in them, rows may be half as wide as usual.
            like: another problem of this drive; where its rows are the same, they are not evaluated anew.
            guessed: whether the parameters are no estimate yet, and tell no kinks.
        """
        inertia, _ = drive.split(parameters)
        delay, made_for = parameters[drive.model.delay] if drive.model.delay else 0.0, dict(parameters)
        recording, parameters = drive.timed(recording, parameters)
        motion = smoothed(recording)
        part, at_rest = motion.recording, motion.resting
        limits = drive.sticking_interval(part, parameters)
        plain = like is not None and like.estimated is None and not like.carriers and like.delay == delay

        def over(width: int) -> WeakFormProblem:
            slow = creeping(part, width)
            smooth = with_kinks(part, motion.velocity, motion.half_width, slow, limits, 0.0 if guessed else inertia)
            if not (guessed or drive.model.states):
                slow = slow | held_while_creeping(part, motion.velocity, motion.creeps, inertia, lambda: limits)
            unclear = direction_unclear(part, smooth, at_rest | slow, limits)
            same = like is not None and plain and like.recording is part and np.array_equal(like.smooth, smooth)
            if like is not None and same and like.test_functions.is_of(width, unclear):
                return like
            rows, half = rows_of(part, smooth, width, unclear, row_counts(part, inertia, width)), motion.half_width
            return cls(drive, part, smooth, at_rest, *rows, half, (0.0, 0.0), delay=delay, made_for=made_for)

        estimated = drive.inertia is None
        problem = over(width or least_width(part, inertia, estimated=estimated))
        if width is None and problem.independent < _FEW:
            narrower = least_width(part, inertia, estimated=estimated, narrow=True)
            problem = over(narrower) if narrower < problem.test_functions.width else problem
        problem = problem if guessed else problem._weighed(parameters, inertia)
        return problem.at(friction_limits=limits_of_friction(drive, part, parameters))

    def _weighed(self, parameters: Mapping[str, float], inertia: float) -> WeakFormProblem:
        """Return it with rows that count by what is left of them, too; see :mod:`.weighing`."""
        if self.test_functions.counts is None or not self.rows:
            return self
        columns, _ = self.columns(self.drive, self.drive.model.nonlinear_of(parameters))
        own = [] if self.drive.inertia is not None else [self.momentum]
        design = np.vstack([columns, self.sign_change, self.torque_rate, *own])
        counts = counts_as_left(self.recording, self.test_functions, inertia, self.target, design)
        return self if counts is None else replace(self, test_functions=self.test_functions.counting(counts))

    def at(self, **changes: Any) -> WeakFormProblem:
        """Return it with another known ``shift`` [s], other ``friction_limits``, or ``held`` or not; the rest stays."""
        other = replace(self, **changes)
        same = _OF_ROWS - (set() if other.shift == self.shift else {"torque_rate"})
        same -= set() if other.held == self.held else {"driving", "target"}
        other.__dict__.update({name: self.__dict__[name] for name in same & self.__dict__.keys()})
        return other

    @cached_property
    def perturbed(self) -> WeakFormProblem:
        """The same problem with as much noise again on the velocity: what a column differs by, noise makes of it."""
        velocity, acceleration = self._noisier
        at = self.quadrature.at_velocity(velocity, acceleration)
        changed = self.recording.with_channels(acceleration=acceleration)
        other = replace(self, recording=changed, smooth=velocity, quadrature=at)
        other.__dict__["derived_too_little"] = self._beyond_derivative[1]
        return other

    @cached_property
    def _noisier(self) -> tuple[Array, Array]:
        return noisier(self.recording, self.smooth, self.half_width)

    @cached_property
    def including_uncertain_motion(self) -> WeakFormProblem:
        """The same problem on all motion, also where a drive without memory may have stuck or turned between samples.

        An effect with memory may do most of what it does there, and need not know the direction at every instant: the
        torque of a contact that bends, or of a gap, comes from the way that was covered.
        """
        width, counts = self.test_functions.width, self.test_functions.counts
        unclear = self.resting | creeping(self.recording, width)
        quadrature, test_functions = rows_of(self.recording, self.smooth, width, unclear, counts)
        return replace(self, quadrature=quadrature, test_functions=test_functions).carrying(self.carriers)

    def clear_of(self, samples: Mask) -> WeakFormProblem:
        """Return the same problem with the rows that none of some samples lies within."""
        other = replace(self, test_functions=self.test_functions.clear_of(samples))
        if self.test_functions.each == 1:  # what is known of the rows is known of fewer
            chosen = self.test_functions.in_common(other.test_functions)
            same = (_OF_ROWS - {"integrated"}) & self.__dict__.keys()
            other.__dict__.update({name: self.__dict__[name][chosen] for name in same})
            other.__dict__["integrated"] = Part(self.integrated, chosen)
        return other

    def carrying(self, carriers: tuple[float, ...]) -> WeakFormProblem:
        """Return the same problem with rows beside its own that carry waves over position."""
        if not carriers:
            return self
        inertia, _ = self.drive.split(self.made_for)
        alike = CarrierFunctions(self.test_functions, self.recording, carriers)
        weighted = alike.weighted(self.quadrature, self.recording, inertia)
        return replace(self, test_functions=weighted, carriers=carriers)

    def along(self, velocity: Array, resting: Mask, width: int | None = None) -> WeakFormProblem:
        """Return the same problem with friction evaluated at another velocity, on all samples that do not rest by it.

        Args:
            velocity, resting: shape (N,).
            width: samples that a test function spans; as before if not given.
        """
        over_cells = self.recording.derived_over > 0
        width, counts = width or self.test_functions.width, self.test_functions.counts
        test_functions = TestFunctions(self.recording, width, resting, over_cells=over_cells, counts=counts)
        quadrature = Quadrature.of(self.recording, velocity, resting)
        moved = replace(self, smooth=velocity, resting=resting, quadrature=quadrature, test_functions=test_functions)
        return moved.carrying(self.carriers)

    @property
    def rows(self) -> int:
        """Number of test functions."""
        return self.test_functions.count

    @property
    def independent(self) -> float:
        """About how many of the rows are independent: two to the width of a test function."""
        return 2.0 * self.rows / (HOPS * self.test_functions.each)

    @cached_property
    def momentum(self) -> Array:
        """∫φ dω, shape (rows,); where the velocity was derived, by the positions themselves."""
        return self.test_functions.momentum(self.cell_velocity)

    @property
    def cell_velocity(self) -> Array:
        """The velocity whose changes are the momentum, shape (N,): as measured, or the mean of each cell."""
        recording = self.recording
        return mean_velocity(recording, recording["position"]) if recording.derived_over else recording.velocity

    @cached_property
    def noise_of_momentum(self) -> Array:
        """What noise may add to :attr:`momentum`, shape (rows,)."""
        return momentum_noise(self.test_functions, self.recording)

    @property
    def momentum_noise(self) -> float:
        """Sum of squares that noise adds to :attr:`momentum`."""
        return float(self.noise_of_momentum @ self.noise_of_momentum)

    @cached_property
    def torque_noise(self) -> float:
        """Sum of squares that noise of the motor torque adds to :attr:`driving`."""
        return float(np.sum(noise_impulses(self.test_functions, self.quadrature, self.recording) ** 2))

    @cached_property
    def driving(self) -> Array:
        """∫φ (τ_m − τ_L) dt, shape (rows,)."""
        points = self.quadrature.recording
        if self.held:
            impulses = as_held(self.recording).torque * self.quadrature.moving_time
            driving = self.test_functions.of_cells(impulses[None])[0]
            return np.asarray(driving - self.integrals(points.load_torque[None])[0])
        return self.test_functions.driving(self.quadrature, points.driving_torque)

    @cached_property
    def torque_rate(self) -> Array:
        """∫φ dτ_m while the drive moves, (rows,), half-way over the known shift s: s of it is one to second order.

        For [τ_m(t) − τ_m(t − s)] / s is dτ_m/dt at t − s/2, but for terms of s². Where runs have rates of their own, s
        is as many samples in each: that is how a torque that is held between samples comes late.
        """
        torque, relative = self.recording.torque, relative_intervals(self.recording)
        if self.shift:
            torque = torque - 0.5 * self.shift * relative * self.recording.signal("motor_torque_rate")
        change = self.quadrature.change_while_moving(torque)
        return np.asarray(self.test_functions.of_cells((relative * change)[None])[0])

    @cached_property
    def sign_change(self) -> Array:
        """What a shift by a sample of every reversal would add, per unit of Coulomb torque, shape (rows,)."""
        shift = self.quadrature.turns * self.recording.interval * relative_intervals(self.recording)
        return np.asarray(self.test_functions.of_cells(shift[None])[0])

    @cached_property
    def target(self) -> Array:
        """Left side of the torque equation: driving torque less known inertia torque, shape (rows,)."""
        return self.driving if self.drive.inertia is None else self.driving - self.drive.inertia * self.momentum

    @cached_property
    def centre(self) -> Index:
        """Index of the sample at the middle of each test function."""
        samples = np.arange(len(self.recording))
        index, ones = self.test_functions.integrals(np.vstack([samples, np.ones(len(samples))]))
        return np.asarray(np.rint(index / ones), dtype=np.int64)

    @cached_property
    def repeats(self) -> Index | None:
        """In which part of a motion that repeats each row lies, shape (rows,); ``None`` where none repeats."""
        hop = self.test_functions.width / HOPS
        return parts_of(self.recording, self.centre, hop) if phase_of(self.recording) else None

    def integrals(self, rows: Array, derivatives: Array | None = None) -> Array:
        """Return ∫φ f dt of rows evaluated at the quadrature's samples, shape (k, rows).

        Args:
            rows: shape (k, samples).
            derivatives: constant ones of each row by acceleration and motor torque, shape (2, k): of an acceleration,
                also of that in :attr:`motor_torque`, the integral is the momentum.
        """
        found = self.test_functions.torques(self.quadrature, rows)
        if derivatives is not None and np.any(derivatives):
            of_torque = torque_by_acceleration(self.drive, self.estimated) if self.estimated else 0.0
            found = found + (derivatives[0] + of_torque * derivatives[1])[:, None] * self.derived_too_little
        return found

    @cached_property
    def derived_too_little(self) -> Array:
        """What the momentum has beyond the integral of the derived acceleration, shape (rows,), as far as not noise."""
        return self._beyond_derivative[0]

    @cached_property
    def _beyond_derivative(self) -> tuple[Array, Array]:
        """:attr:`derived_too_little`, and the same with as much noise again."""
        both = self.quadrature, self.quadrature.at_velocity(self.smooth, self._noisier[1])
        derived, again = (self.test_functions.torques(at, at.recording["acceleration"][None])[0] for at in both)
        return beyond_noise(self.momentum, self.noise_of_momentum, derived, again)

    def columns(self, drive: Drive, nonlinear: Sequence[float] = (), delay: float = 0.0) -> tuple[Array, Array]:
        """Return the integrals of a drive's linear columns, shape (k, rows), and of the rest of its torque, (rows,)."""

        def compute() -> Array:
            design, offset = self.evaluate(drive, nonlinear, delay)
            rows = np.vstack([design, offset[None]]) if np.any(offset) else design
            return self.integrals(rows, drive.constant_derivatives[:, : len(rows)])

        rows = self.integrated((drive, tuple(nonlinear), delay), compute)
        linear = sum(drive.model.linear)
        return rows[:linear], rows[linear] if len(rows) > linear else np.zeros(self.rows)

    @cached_property
    def integrated(self) -> Remembered:
        """Integrals of this problem that do not depend on a regression, by what they are of."""
        return Remembered(INTEGRALS)

    def evaluate(self, drive: Drive, nonlinear: Sequence[float] = (), delay: float = 0.0) -> tuple[Array, Array]:
        """Evaluate a drive's linear columns at the quadrature's samples; internal states follow the smooth motion.

        Args:
            drive, nonlinear: whose columns, and values of its nonlinear parameters.
            delay: time over which the rate of the torque is taken [s]; with a coefficient of as much, a whole shift.
        """
        points = self.quadrature.recording
        if delay:
            points = points.with_channels(torque_rate=self.recording.change_over(delay, points) / delay)
        if "motor_torque" in drive.model.needs:
            points = points.with_channels(torque=self.motor_torque)
        return self._regressors(drive, nonlinear, points)

    @property
    def points(self) -> Recording:
        """The quadrature's samples as the problem's own drive takes them: its motor torque is what a fit explains."""
        points = self.quadrature.recording
        return points.with_channels(torque=self.motor_torque) if "motor_torque" in self.drive.model.needs else points

    @cached_property
    def states_of(self) -> MotionStates:
        """What gives the internal states of a model, or of a term of it, at the quadrature's samples."""
        known = self.estimated or self.made_for
        return MotionStates(self.drive, known, self.recording, self.smooth, self.resting, self.quadrature.cell)

    def _regressors(self, drive: Drive, nonlinear: Sequence[float], points: Recording) -> tuple[Array, Array]:
        if not drive.model.states:
            return drive.regressors(points, nonlinear)
        given = iter(nonlinear)
        parameters = [0.0 if is_linear else next(given) for is_linear in drive.model.linear]
        return drive.regressors(points, nonlinear, states=self.states_of(drive.model, parameters))

    @cached_property
    def motor_torque(self) -> Array:
        r"""Motor torque at the quadrature's samples for use in columns: as the fitted model explains it.

        The recorded torque is what the rows are to explain. As a regressor it would explain them, its own error
        included, with a gain of one and nothing else. The model's :math:`\tau_L + J\dot\omega + \tau_F`, solved for the
        motor torque where the friction depends on it, stands for it (two-stage least squares). Before there is a fit it
        is the recorded torque, and of a drive that coasts none.
        """
        points = self.quadrature.recording
        if self.estimated is None or not points.torque.any():
            return points.torque
        nonlinear = self.drive.model.nonlinear_of(self.estimated)
        theta = np.array(self.drive.model.linear_of(self.estimated, delay=False))

        def friction(torque: Array) -> Array:
            design, offset = self._regressors(self.drive, nonlinear, points.with_channels(torque=torque))
            return np.asarray(theta @ design + offset)

        unmoved = points.load_torque + self.drive.split(self.estimated)[0] * points["acceleration"]
        return explained_torque(unmoved, points.torque, friction)

    def alone(self, effect: Effect) -> Drive:
        """Return a drive with nothing but the effect."""
        return _alone(effect, self.drive.motion)


@lru_cache(maxsize=256)
def _alone(effect: Effect, motion: Motion) -> Drive:
    return Drive(Model.only(effect), 1.0, motion)
