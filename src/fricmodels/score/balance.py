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
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.recording import Recording
from fricmodels.score.noise import noise_like
from fricmodels.score.torque import friction_moments, moments, torque_error

Array: TypeAlias = NDArray[np.float64]
Source: TypeAlias = Literal["acceleration", "velocity", "position"]

_BLOCK = 1 << 18
"""Samples over which windows are moved together, so that memory stays bounded."""
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
        twice = self._twice_integrated
        for start in range(0, len(error), _BLOCK):
            block = slice(start, start + _BLOCK)
            centre = np.clip(self.time[block], edges[0] + half, edges[-1] - half)
            most, least = ((twice(centre + half) - 2 * twice(centre) + twice(centre - half)) / half**2).T
            error[block] = np.maximum(least, 0.0) + np.minimum(most, 0.0)
        return error

    @cached_property
    def _twice_integrated(self) -> Callable[[Array], Array]:
        from scipy.interpolate import PPoly

        constant: Callable[[Array], Array] = PPoly(
            np.stack([self.most, self.least], axis=-1)[None], self.edges
        ).antiderivative(2)
        return constant


def over_windows(found: Iterable[Balance], count: int, windows: Sequence[float]) -> dict[float, Array]:
    """Return the error over each window about each sample, shape (count,); zero in stretches without a balance.

    One balance is in memory at a time: with what it needs for windows it takes ten times as much as its errors.

    Args:
        found: balances of some of the stretches of a recording.
        count: how many samples it has.
        windows: see :meth:`Balance.over`.
    """
    errors = {window: np.zeros(count) for window in windows}
    for balance in found:
        for window, error in errors.items():
            error[balance.part] = balance.over(window)
        del balance  # before the next one is made
    return errors


def source(prepared: Recording) -> Source:
    """Return the channel that says how the momentum changes."""
    if prepared.derived_over:
        return "position"
    measured = prepared.channels.keys() - prepared.derived
    return "velocity" if "velocity" in measured and "acceleration" not in measured else "acceleration"


def balances(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Iterator[Balance]:
    """Yield the balances of momentum of every stretch of a recording.

    The friction torque is taken at the velocity freed of noise, and integrated by :func:`friction_moments`: at a
    reversal on both sides, at rest as what is applied. Where the drive may slide or rest, any friction torque between
    the two is possible, and the error is the distance to the nearest.

    Args:
        drive: model and inertia.
        values: parameters by key; the inertia among them unless the drive has one.
        prepared: recording with ``velocity`` and ``acceleration``, from :func:`fricmodels.signals.prepare`.

    Raises:
        InputError: when the recording lacks a channel that the model needs.
    """
    from fricmodels.signals import resting, smoothed_velocity, standstill, velocity_noise

    of = source(prepared)
    if of == "acceleration":
        error = torque_error(drive, values, prepared)
        yield from (_at_its_word(part, prepared.time[part], error[part]) for part in _parts(prepared))
        return
    smooth, spread = smoothed_velocity(prepared)
    rest = resting(prepared)
    # At a reversal the slope of the velocity jumps; there smoothing may change it by more than noise does.
    bent = np.abs(prepared.velocity - smooth) > 3 * velocity_noise(prepared).deviation
    velocity = np.where(bent, prepared.velocity, smooth)
    velocity[rest | (np.abs(velocity) <= standstill(velocity))] = 0.0
    doubtful = np.abs(velocity) <= 3 * spread
    recording, values = drive.timed(prepared, values)
    moving = recording.with_channels(velocity=velocity)
    inertia, parameters = drive.split(values)
    states = drive.states(moving, parameters)
    for part in _parts(prepared):
        one = moving.select(part)
        memory = [state[part] for state in states]
        friction = friction_moments(drive, values, one, memory, rest[part], doubtful[part])
        applied = one.torque - one.load_torque
        balance = _balance(part, one.time, applied, inertia * prepared[of][part], friction, of)
        below, above = drive.sticking_interval(one, values, states=memory)
        balance.at_samples[rest[part]] = (applied - np.clip(applied, below, above))[rest[part]]
        yield balance


def noise_balances(prepared: Recording) -> tuple[Iterator[Balance], Iterator[Balance]]:
    """Return the balances of noise alone: of the torque, and of the motion of a drive of inertia 1.

    Noise with its colour, always the same; see :func:`fricmodels.score.noise.noise_like`. That of an acceleration which
    a filter of the user's choice has derived is not known: not a number.
    """
    of = source(prepared)
    rng = np.random.default_rng(0)
    torque, motion = (noise_like(prepared, channel, rng) for channel in ("torque", of))
    if of == "acceleration" and of in prepared.derived:
        motion = np.full(len(prepared), np.nan)
    nothing = np.zeros(len(prepared))

    def of_noise(applied: Array, moved: Array) -> Iterator[Balance]:
        for part in _parts(prepared):
            time = prepared.time[part]
            if of == "acceleration":
                yield _at_its_word(part, time, applied[part] - moved[part])
            else:
                none = [np.zeros((2, len(time) - 1))] * 2
                yield _balance(part, time, applied[part], moved[part], none, of)

    return of_noise(torque, nothing), of_noise(nothing, motion)


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
        friction: least and greatest, see :func:`friction_moments`.
        of: what ``motion`` is.
    """
    from scipy.interpolate import CubicSpline

    step = np.diff(time)
    driving, least, greatest = (step * each for each in (moments(applied[:-1], applied[1:]), *friction))
    if of == "position":
        edges, change = (time[:-1] + time[1:]) / 2, np.diff(np.diff(motion) / step)
        driving, least, greatest = (each[1, :-1] + each[0, 1:] for each in (driving, least, greatest))
    else:
        edges, change = time, np.diff(motion)
        driving, least, greatest = (each.sum(axis=0) for each in (driving, least, greatest))
    needed, length = driving - change, np.diff(edges)
    momentum = np.append(0.0, np.cumsum(change + np.clip(needed, least, greatest)))
    if not np.all(np.isfinite(momentum)):  # parameters of a fit that diverged
        unknown = np.full(len(needed), np.nan)
        return Balance(part, time, edges, unknown, unknown, np.full(len(time), np.nan))
    error = applied - CubicSpline(edges, momentum)(np.clip(time, edges[0], edges[-1]), 1)
    error[[0, -1]] = error[[1, -2]]  # a slope at the end of a spline is noisy
    return Balance(part, time, edges, (needed - least) / length, (needed - greatest) / length, error)
