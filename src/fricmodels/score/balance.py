r"""The torque error of eq. 21 at every sample, and averaged over windows, from balances of momentum.

The acceleration and the friction torque both jump at a reversal, and a differentiator smears the one jump and not the
other. Their sum has no jump, and its integral is known at every sample without differentiation: the momentum
:math:`p = J\omega + \int\tau_F\,dt` that motor and load must have brought up. The error at a sample is eq. 21 with the
slope of this momentum, from a cubic spline through it:

.. math:: T_e = \tau_m - \tau_L - \frac{dp}{dt}, \qquad p = J\omega + \int\tau_F\,dt.

The error over a window w is the mean of the same balance with triangular weights of width w at half height, which reach
from −w to w:

.. math:: \overline{T_e}(t) = \frac1w\int_{-w}^{w}\Bigl(1 - \frac{|s|}{w}\Bigr)\,
          \Bigl[\tau_m - \tau_L - \frac{dp}{dt}\Bigr]_{t+s} ds.

It needs the mean momentum of the two halves of the window only. (A rectangular window needs the momentum at its two
ends, where one noisy sample each decides: with an encoder the noise is some ten times larger.)

Where the velocity was derived, the positions themselves take its place: the mean velocity of a sampling interval stands
at its middle, and between two middles it changes by the acceleration weighted by a triangle; all other terms are then
weighted alike. Where the acceleration was measured, or the velocity derived by a filter of the user's choice, eq. 21 is
taken at its word at each sample.

A missing torque of frequency f enters the error per sample whole if it shows in the motor torque. If it shows in the
motion, it enters with :math:`3\sin x/[x(2 + \cos x)]`, :math:`x = 2\pi f/f_s`: 95 % at a quarter of the sampling rate
f_s; from positions 91 %. It enters the error over w with :math:`[\sin(\pi fw)/(\pi fw)]^2`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, TypeAlias

import numpy as np

from fricmodels.arrays import Array, widened
from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.score.holding import holding_interval, unseen_at_rest
from fricmodels.score.noise import noise_like
from fricmodels.score.proportional import applied_torque, in_recorded_torque, of_acceleration
from fricmodels.score.torque import friction_moments, moments, torque_error
from fricmodels.signals.creeping import creeping_speed, creeping_stretches, held_while_creeping

Source: TypeAlias = Literal["acceleration", "velocity", "position"]

_BLOCK = 1 << 18
"""Samples over which windows are moved together, so that memory stays bounded."""
_OVERLAP = 256
"""Knots by which parts of a spline overlap; steps within a stretch differ by a factor of five at most."""
_SHORTEST = 4
"""Samples that a stretch must have: those of a cubic."""


@dataclass(frozen=True)
class Balance:
    """The balances of momentum along one stretch without a gap.

    Attributes:
        part: which samples of the recording.
        time: their time stamps [s], shape (N,).
        edges: instants between which momentum is balanced [s], shape (n + 1,).
        most, least: mean error between two instants with the least and with the greatest friction torque that is
            possible there, shape (n,); equal while the drive slides.
        at_samples: error at each sample, shape (N,).
    """

    part: slice
    time: Array
    edges: Array
    most: Array
    least: Array
    at_samples: Array

    def over(self, window: float) -> Array:
        """Return the error over a window about each sample, shape (N,); at the ends that of the nearest whole window.

        Args:
            window: w [s]; a stretch shorter than 2 w is one window. 0 for the error per sample.
        """
        if not window:
            return self.at_samples
        edges, error = self.edges, np.empty(len(self.time))
        half = min(window, (edges[-1] - edges[0]) / 2)
        for start in range(0, len(error), _BLOCK):
            block = slice(start, start + _BLOCK)
            centre = np.clip(self.time[block], edges[0] + half, edges[-1] - half)
            twice = self._twice_integrated(centre[0] - half, centre[-1] + half)
            most, least = ((twice(centre + half) - 2 * twice(centre) + twice(centre - half)) / half**2).T
            error[block] = np.maximum(least, 0.0) + np.minimum(most, 0.0)
        return error

    def times(self, factor: float) -> Balance:
        """Return the balances with every error multiplied by a positive factor."""
        return replace(self, **{name: factor * getattr(self, name) for name in ("most", "least", "at_samples")})

    def _twice_integrated(self, begin: float, end: float) -> Callable[[Array], Array]:
        """Return the second integral of the mean errors, from a common instant, between two instants."""
        from scipy.interpolate import PPoly

        first = max(int(np.searchsorted(self.edges, begin, side="right")) - 1, 0)
        last = min(max(int(np.searchsorted(self.edges, end)), first + 1), len(self.most))
        both = np.stack([self.most[first:last], self.least[first:last]], axis=-1)
        twice: Callable[[Array], Array] = PPoly(both[None], self.edges[first : last + 1]).antiderivative(2)
        return twice


def over_windows(
    found: Iterable[Balance], count: int, windows: Sequence[float], kept: float | None = None
) -> tuple[dict[float, float], Array]:
    """Return the RMS error over each window, and one of these errors about each sample, shape (count,).

    Stretches without a balance count as zeros. One balance, and its error over one window, are in memory at a time.

    Args:
        found: balances of some of the stretches of a recording.
        count: how many samples it has.
        windows: see :meth:`Balance.over`.
        kept: the window whose errors are returned; none if not given, an empty array then.
    """
    squares, errors = dict.fromkeys(windows, 0.0), np.zeros(0 if kept is None else count)
    for balance in found:
        for window in windows:
            error = balance.over(window)
            squares[window] += float(np.sum(np.square(error)))  # a dot product sums in the processor's own order
            if window == kept:
                errors[balance.part] = error
            del error
        del balance  # before the next one is made
    return {window: float(np.sqrt(square / count)) for window, square in squares.items()}, errors


def source(prepared: Recording) -> Source:
    """Return the channel that says how the momentum changes."""
    if prepared.derived_over:
        return "position"
    measured = prepared.channels.keys() - prepared.derived
    return "velocity" if "velocity" in measured and "acceleration" not in measured else "acceleration"


def balances(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Iterator[Balance]:
    """Yield the balances of momentum of every stretch of a recording.

    The friction torque is taken at the velocity freed of noise, and integrated by :func:`friction_moments`: at a
    reversal on both sides, at rest as what is applied. Where the drive may slide or rest, or creeps under less friction
    than slides, any friction torque between the two is possible, and the error is the distance to the nearest.

    Args:
        drive: model and inertia.
        values: parameters by key; the inertia among them unless the drive has one.
        prepared: recording with ``velocity`` and ``acceleration``, from :func:`fricmodels.signals.prepare`.

    Raises:
        InputError: when the recording lacks a channel that the model needs.
    """
    from fricmodels.signals import resting, smoothed_velocity, smoothing_half_width, standstill, velocity_noise

    of = source(prepared)
    if of == "acceleration":
        error = torque_error(drive, values, prepared)
        yield from (_at_its_word(part, prepared.time[part], error[part]) for part in _parts(prepared))
        return
    smooth, spread = smoothed_velocity(prepared)
    rest = resting(prepared)
    # Where the slope of the velocity jumps, at a reversal or a stop, smoothing changes it by more than noise does. As
    # far as its window reaches from there, what noise could make of the sample itself may be no motion.
    certain = 3 * velocity_noise(prepared).deviation
    apart = prepared.velocity - smooth
    bent = np.abs(apart, out=apart) > certain
    del apart
    velocity = np.where(bent, prepared.velocity, smooth)
    velocity[rest | (np.abs(velocity) <= standstill(velocity))] = 0.0
    beside = widened(bent | rest, smoothing_half_width(prepared)) & (np.abs(prepared.velocity) <= certain)
    doubtful = beside | (np.abs(velocity) <= 3 * spread)
    del bent, beside
    recording, values = drive.timed(prepared, values)
    moving = recording.with_channels(velocity=velocity)
    inertia, parameters = drive.split(values)
    inertia += of_acceleration(drive, values)
    recorded = in_recorded_torque(drive, values)
    states, way = drive.states(moving, parameters), unseen_at_rest(drive, prepared)
    if not states:
        creeps = creeping_stretches(recording, velocity, rest, creeping_speed(velocity))
        limits = partial(drive.sticking_interval, moving, values)
        doubtful |= held_while_creeping(recording, velocity, creeps, inertia, limits)
    for part in _parts(prepared):
        one = moving.select(part)
        memory = [state[part] for state in states]
        applied = applied_torque(drive, values, one)
        found = friction_moments(drive, values, one, memory, rest[part], doubtful[part], way)
        friction = _in_balance(found, np.diff(one.time), of)
        balance = _balance(part, one.time, applied, inertia * prepared[of][part], friction, of)
        del friction
        if rest[part].any():
            below, above = holding_interval(drive, one, values, memory, way=way)
            driving = one.driving_torque
            balance.at_samples[rest[part]] = (driving - np.clip(driving, below, above))[rest[part]]
            del below, above, driving
        del applied
        yield balance if recorded == 1.0 else balance.times(recorded)


def noise_balances(prepared: Recording) -> Iterator[Iterator[Balance]]:
    """Yield the balances of noise alone, of the torque, and then of the motion of a drive of inertia 1.

    Noise with its colour, always the same; see :func:`fricmodels.score.noise.noise_like`. That of an acceleration which
    a filter of the user's choice has derived is not known: not a number.
    """
    of = source(prepared)
    rng = np.random.default_rng(0)
    nothing = np.broadcast_to(0.0, len(prepared))

    def of_noise(applied: Array, moved: Array) -> Iterator[Balance]:
        for part in _parts(prepared):
            time = prepared.time[part]
            if of == "acceleration":
                yield _at_its_word(part, time, applied[part] - moved[part])
            else:
                none = np.broadcast_to(0.0, len(time) - (2 if of == "position" else 1))
                yield _balance(part, time, applied[part], moved[part], [none, none], of)

    yield of_noise(noise_like(prepared, "torque", rng), nothing)
    unknown = of == "acceleration" and of in prepared.derived
    yield of_noise(nothing, np.full(len(prepared), np.nan) if unknown else noise_like(prepared, of, rng))


def _parts(prepared: Recording) -> list[slice]:
    from fricmodels.signals import stretches

    return [part for part in stretches(prepared.time, prepared.run) if part.stop - part.start >= _SHORTEST]


def _at_its_word(part: slice, time: Array, error: Array) -> Balance:
    middles = (time[:-1] + time[1:]) / 2
    edges = np.concatenate([2 * time[:1] - middles[:1], middles, 2 * time[-1:] - middles[-1:]])
    return Balance(part, time, edges, error, error, error)


def _balance(part: slice, time: Array, applied: Array, motion: Array, friction: Sequence[Array], of: Source) -> Balance:
    """Balance one stretch.

    Args:
        part: which samples of the recording.
        time: time stamps [s], shape (N,).
        applied: τ_m − τ_L at the samples.
        motion: velocity or position times inertia.
        friction: least and greatest, of :func:`friction_moments`, as :func:`_in_balance` gives them.
        of: what ``motion`` is.
    """
    step = np.diff(time)
    (needed,) = _in_balance(_moments(applied), step, of)
    if of == "position":
        edges, change = (time[:-1] + time[1:]) / 2, np.diff(np.diff(motion) / step)
    else:
        edges, change = time, np.diff(motion)
    needed -= change
    least, greatest = friction
    change += np.clip(needed, least, greatest)
    momentum = np.empty(len(edges))
    momentum[0] = 0.0
    np.cumsum(change, out=momentum[1:])
    del change, step
    if not np.all(np.isfinite(momentum)):  # parameters of a fit that diverged
        unknown = np.full(len(needed), np.nan)
        return Balance(part, time, edges, unknown, unknown, np.full(len(time), np.nan))
    error = applied - _slope_of_spline(edges, momentum, time)
    error[[0, -1]] = error[[1, -2]]  # a slope at the end of a spline is noisy
    del momentum
    length, most = np.diff(edges), needed - least
    most /= length
    needed -= greatest
    needed /= length
    return Balance(part, time, edges, most, needed, error)


def _moments(values: Array) -> Iterator[tuple[slice, Array]]:
    """Yield the moments of straight lines between values, of some intervals after the other."""
    for start in range(0, len(values) - 1, _BLOCK):
        part = values[start : start + _BLOCK + 1]
        yield slice(start, start + len(part) - 1), moments(part[:-1], part[1:])


def _in_balance(found: Iterable[tuple[slice, *tuple[Array, ...]]], step: Array, of: Source) -> list[Array]:
    """Return :func:`moments` of intervals of some length, that come some after the other, as they enter a balance.

    Of positions each weighs the end of an interval and the beginning of the next one, else a whole interval.
    """
    sums: list[Array] = []
    for part, *several in found:
        sums = sums or [np.empty(len(step)) for _ in several]
        for total, each in zip(sums, several, strict=True):
            each *= step[part]
            if of == "position":
                total[part] = each[1]
                total[part.start - 1 if part.start else 0 : part.stop - 1] += each[0, 0 if part.start else 1 :]
            else:
                total[part] = each.sum(axis=0)
    return [total[:-1] for total in sums] if of == "position" else sums


def _slope_of_spline(edges: Array, values: Array, time: Array) -> Array:
    """Return the slope of the cubic spline through values at the samples, part by part.

    What a value does to the spline falls to 0.27 of it from knot to knot on even ones: parts overlap so far that
    nothing is left of where they end.
    """
    from scipy.interpolate import CubicSpline

    slope = np.empty(len(time))
    for start in range(0, len(time), _BLOCK):
        stop = min(start + _BLOCK, len(time))
        at = np.clip(time[start:stop], edges[0], edges[-1])
        knots = slice(max(start - _OVERLAP, 0), stop + _OVERLAP)
        slope[start:stop] = CubicSpline(edges[knots], values[knots])(at, 1)
    return slope
