r"""The torque error: what the equation of motion leaves over (eq. 21).

.. math:: T_e = \tau_m - \tau_L - J\dot\omega - \tau_F(\omega)

At rest the friction torque is no function of the velocity: it is whatever holds the drive, between two limits. There
the error is how far the torque that would be needed lies outside these limits, and zero inside.

All errors are in the torque as it was recorded; see :mod:`.proportional`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.drive import Drive
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.score.holding import holding_interval, unseen_at_rest
from fricmodels.score.proportional import applied_torque, in_recorded_torque, of_acceleration, proportional_torque
from fricmodels.score.sampling import about_reversals, slowest_certain, without_shift

if TYPE_CHECKING:
    from fricmodels.signals import Noise


_INTERVALS = 1 << 17
"""Intervals whose friction is found together, so that memory stays bounded."""
_WIDEST = 256
"""Largest half width that is tried for the acceleration, in samples."""


def torque_error(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Array:
    """Return the torque error T_e of eq. 21 at every sample, shape (N,), in SI units.

    Args:
        drive: model and inertia.
        values: parameters by key; the inertia among them unless the drive has one.
        prepared: recording with ``velocity`` and ``acceleration``, from :func:`fricmodels.signals.prepare`.

    Raises:
        InputError: when the recording lacks a channel that the model needs.
    """
    way = unseen_at_rest(drive, prepared)
    prepared, values = drive.timed(prepared, values)
    inertia, _ = drive.split(values)
    needed = prepared.driving_torque - inertia * prepared["acceleration"]
    error = needed - _friction(drive, values, prepared, needed, way)
    return error * in_recorded_torque(drive, values)


def _friction(drive: Drive, values: Mapping[str, float], prepared: Recording, needed: Array, way: float) -> Array:
    """Return the model's friction torque; at rest the one nearest to what is needed."""
    from fricmodels.signals import resting

    friction = drive.friction(prepared, values)
    rest = resting(prepared)
    if rest.any():
        least, greatest = holding_interval(drive, prepared, values, way=way)
        friction[rest] = np.clip(needed[rest], least[rest], greatest[rest])
    return friction


def filtered_torque_error(
    drive: Drive,
    values: Mapping[str, float],
    recording: Recording,
    half_width: int | None = None,
    *,
    beyond_sampling: bool = False,
) -> Array:
    r"""Return eq. 21 with every term of it filtered alike, shape (N,), in SI units.

    Lanczos's differentiator of half width h is a weighted mean of the slopes from sample to sample:

    .. math::
        D\omega_k = \sum_j c_{kj}\,\frac{\omega_{j+1} - \omega_j}{t_{j+1} - t_j}, \qquad
        c_{kj} \propto (h + \tfrac12)^2\,\overline{\Delta t}^2 - (t_{j+1/2} - t_k)^2 \ge 0, \quad \sum_j c_{kj} = 1.

    Where the friction torque jumps within the window, at a reversal, this is the mean of two accelerations, and eq. 21
    with the friction torque of one instant would blame the law for it. So all terms are averaged with these weights:

    .. math:: T_{e,k} = \sum_j c_{kj} \Bigl[\overline{\tau_m - \tau_L}_j - J\,\frac{\omega_{j+1} - \omega_j}
              {t_{j+1} - t_j} - \overline{\tau_F}_j\Bigr]

    The bracket is the balance of momentum over one sampling interval, exact for any window. The mean friction torque
    of an interval is the trapezium rule, in two parts where the velocity passes zero, each on its side. At rest it
    is the torque applied, as far as the sticking interval goes. Where the velocity is within three standard errors of
    zero, the drive may slide that way, rest, or slide where the torque pushes it: any mean between is possible, and the
    error is the distance to the nearest. What is left is the law's error and the noise of the
    differentiator, :math:`J\sigma\sqrt{3/[h(h+1)(2h+1)]}/\Delta t`.

    The friction torque is taken at the velocity smoothed over the same window. At the borders of a run the window
    stays within it.

    Args:
        drive: model and inertia.
        values: parameters by key.
        recording: with ``velocity``.
        half_width: h; :func:`sliding_half_width` if not given.
        beyond_sampling: leave out what sampling hides; see :mod:`.sampling`.
    """
    from fricmodels.signals import stretches

    way = unseen_at_rest(drive, recording)
    recording, values = drive.timed(recording, values)
    width = sliding_half_width(recording) if half_width is None else half_width
    moving, rest, doubtful = _smoothed(recording, width)
    if beyond_sampling:
        doubtful = doubtful | (np.abs(moving.velocity) <= slowest_certain(drive, values, moving))
    error, rate = np.zeros(len(recording)), np.zeros(len(recording) if beyond_sampling else 0)
    inertia, parameters = drive.split(values)
    inertia += of_acceleration(drive, values)
    states = drive.states(moving, parameters)
    for part in stretches(recording.time, recording.run):
        one = moving.select(part)
        if len(one) < 2:
            continue
        needed = _mean(applied_torque(drive, values, one)) - inertia * np.diff(recording.velocity[part]) / np.diff(
            one.time
        )
        least, greatest = np.empty((2, len(needed)))
        for some, low, high in friction_moments(
            drive, values, one, [state[part] for state in states], rest[part], doubtful[part], way
        ):
            least[some], greatest[some] = low.sum(axis=0), high.sum(axis=0)
        if beyond_sampling:
            limits = drive.sticking_interval(one, values, states=[state[part] for state in states])
            less, more = about_reversals(one.velocity, share_before_zero(one.velocity), *limits)
            least, greatest = least + less, greatest + more
            (rate[part],) = _window_means([np.diff(one.torque) / np.diff(one.time)], one.time, width)
        balance, lower, upper = _window_means([needed, least, greatest], one.time, width)
        error[part] = balance - np.clip(balance, lower, upper)
    error *= in_recorded_torque(drive, values)
    return without_shift(error, np.where(error == 0.0, 0.0, rate), recording.interval)[0] if beyond_sampling else error


def _smoothed(recording: Recording, half_width: int) -> tuple[Recording, Mask, Mask]:
    """Return a recording with its velocity smoothed, where it rests, and where it may rest: once for each width."""
    from fricmodels.signals import resting, standstill, velocity_noise
    from fricmodels.signals.lanczos import even_weights, lanczos_value

    known = _known_widths(recording)
    found = known.get(half_width)
    if found is None:
        smooth, rest = lanczos_value(recording.time, recording.velocity, half_width, recording.run), resting(recording)
        noise = velocity_noise(recording)
        # Beside a bend a parabola swings over, and where the drive creeps it may turn the direction of its motion.
        apart = np.abs(recording.velocity - smooth) > 3 * noise.deviation
        turned = apart & (recording.velocity * smooth < 0.0)
        smooth = np.where(turned, recording.velocity, smooth)
        smooth[rest | (np.abs(smooth) <= standstill(smooth))] = 0.0
        spread = noise.slow.after(even_weights(half_width)[0])
        doubtful = np.abs(smooth) <= 3 * np.where(turned, noise.deviation, spread)
        known.clear()  # one width at a time is asked for
        found = known[half_width] = recording.with_channels(velocity=smooth), rest, doubtful
    return found


@once
def _known_widths(_: Recording) -> dict[int, tuple[Recording, Mask, Mask]]:
    return {}


def _mean(values: Array) -> Array:
    return (values[:-1] + values[1:]) / 2


def moments(first: Array, last: Array) -> Array:
    """Return the integrals of straight lines over a unit interval, weighted by 1 − x and by x, shape (2, N).

    Their sum is the mean; each alone is what an interval adds to a weight that falls, or rises, along it.
    """
    return np.stack([first / 3 + last / 6, first / 6 + last / 3])


def friction_moments(
    drive: Drive,
    values: Mapping[str, float],
    one: Recording,
    states: Sequence[Array],
    rest: Mask,
    doubtful: Mask,
    way: float,
) -> Iterator[tuple[slice, Array, Array]]:
    """Yield :func:`moments` of the least and the greatest friction torque of some intervals after the other.

    They are equal while sliding. Where the velocity is zero, though not long enough for a rest, the friction lies
    anywhere in the sticking interval. What goes with the acceleration or the motor torque everywhere is left out, see
    :func:`.proportional_torque`. For ``way`` see :func:`.holding_interval`.

    Yields:
        Which intervals they are, and the moments, shape (2, intervals) each.
    """
    count = len(one) - 1
    for start in range(0, count, _INTERVALS):
        stop = min(start + _INTERVALS, count)
        part, before = slice(start, stop + 1), max(start - 1, 0)
        some = one.select(part)
        vars(some).update(peak_speed=one.peak_speed)  # by which the width of rest is known, of all and not of a part
        share = share_before_zero(one.velocity[before : stop + 2])[start - before :][: stop - start]
        known = [state[part] for state in states]
        found = _moments_of(drive, values, some, known, rest[part], doubtful[part], share, way)
        yield slice(start, stop), *found


def _moments_of(
    drive: Drive,
    values: Mapping[str, float],
    one: Recording,
    states: Sequence[Array],
    rest: Mask,
    doubtful: Mask,
    share: Array,
    way: float,
) -> tuple[Array, Array]:
    """Return :func:`friction_moments` of a part of a stretch, with the share of each interval before a reversal."""
    velocity = one.velocity
    at = drive.friction(one, values, states=states)
    below, above = drive.sticking_interval(one, values, states=states)
    least_held, most_held = holding_interval(drive, one, values, states, (below, above), way)
    applied = applied_torque(drive, values, one)
    smooth = proportional_torque(drive, values, one)
    if smooth is not None:
        whole = (at, below, above, least_held, most_held)
        at, below, above, least_held, most_held = (torque - smooth for torque in whole)
    low, high = np.where(velocity == 0, least_held, at), np.where(velocity == 0, most_held, at)
    holding = np.clip(applied, least_held, most_held)
    first, last = velocity[:-1], velocity[1:]
    passes = (first * last < 0) & ~rest[:-1] & ~rest[1:]
    leaving, entering = np.where(first > 0, above[:-1], below[:-1]), np.where(first > 0, below[1:], above[1:])
    in_two = _moments_in_two(share, moments(at[:-1], leaving), moments(entering, at[1:]))
    one_rests = rest[:-1] ^ rest[1:]
    held = moments(holding[:-1], holding[1:])
    may_rest = rest | doubtful
    at_rest = rest[:-1] & rest[1:]
    either = may_rest[:-1] | may_rest[1:]

    def sliding(limit: Array) -> Array:
        moving = np.where(rest[:-1], limit[1:], limit[:-1])
        whole = np.where(one_rests, moments(moving, moving), moments(limit[:-1], limit[1:]))
        return np.where(passes, in_two, whole)

    least, greatest = sliding(low), sliding(high)
    less, more = held.sum(axis=0) < least.sum(axis=0), held.sum(axis=0) > greatest.sum(axis=0)
    least = np.where(at_rest | (either & less), held, least)
    greatest = np.where(at_rest | (either & more), held, greatest)
    return least, greatest


def _moments_in_two(share: Array, before: Array, after: Array) -> Array:
    """Return the moments of an interval from those of its two parts, of which the first is a share of it."""
    rest = 1 - share
    late = share**2 * before[1] + rest * (share * after.sum(axis=0) + rest * after[1])
    early = share * before.sum(axis=0) + rest * after.sum(axis=0) - late
    return np.stack([early, late])


def share_before_zero(velocity: Array) -> Array:
    """Return the share of each interval before the velocity passes zero, from the slopes before and after it."""
    first, last = np.abs(velocity[:-1]), np.abs(velocity[1:])
    slope = np.abs(np.diff(velocity))
    before, after = np.append(slope[:1], slope[:-1]), np.append(slope[1:], slope[-1:])
    to_zero, from_zero = first * after, last * before
    total = to_zero + from_zero
    share: Array = np.divide(to_zero, total, out=np.full(len(total), 0.5), where=total > 0)
    return share


def _window_means(errors: Sequence[Array], time: Array, half_width: int) -> list[Array]:
    """Average errors over the intervals of each sample's window with the weights of Lanczos's differentiator.

    Args:
        errors: each of shape (N − 1,), of each interval.
        time, half_width: shape (N,), and h.

    Returns:
        Each of shape (N,).
    """
    from fricmodels.kernels.windows import window_means
    from fricmodels.signals import is_even

    samples = len(time)
    width = min(half_width, (samples - 1) // 2)
    if width < 1:
        return [np.append(error, error[-1]) for error in errors]
    at = np.clip(np.arange(samples) - width, 0, samples - 2 * width - 1)
    if is_even(time):
        offset = np.arange(2 * width) + 0.5 - width
        weight = (width + 0.5) ** 2 - offset**2
        return [np.convolve(error, weight / weight.sum(), mode="valid")[at] for error in errors]
    inner = np.empty((len(errors), samples - 2 * width))
    window_means(np.ascontiguousarray(time, dtype=float), np.array(errors), width, inner)
    return [row[at] for row in inner]


@once
def sliding_half_width(recording: Recording) -> int:
    r"""Return the half width of Lanczos's differentiator that estimates the acceleration best while sliding.

    Per sample, noise of autocovariance R behind the weights d, and a third derivative of the velocity, give a mean
    squared error of

    .. math:: d_h^T R\,d_h + \Bigl(\frac{3h^2+3h-1}{30}\Bigr)^2 \overline{(\Delta^3\omega)^2},

    and h is where it is least; of white noise the first term is :math:`3\sigma^2/[h(h+1)(2h+1)]`. The mean square of
    the third derivative is taken from cubics through the widest window that is tried, less their noise, over the
    samples around which the drive slides in one direction for this window; it is such that a quarter of all sliding
    samples are. Reversals are left out because the acceleration jumps there, which :func:`filtered_torque_error` allows
    for: they would keep the window short and the rest noisy.

    Source: the plug-in rule of D. Ruppert, S. J. Sheather, M. P. Wand, J. Amer. Statist. Assoc. 90 (1995), for the
    derivative.
    """
    from fricmodels.signals import velocity_noise

    noise = velocity_noise(recording)
    free = _free_of_reversals(recording)
    if not np.any(free > 1):
        return 1
    widest = int(min(_WIDEST, max(2, np.quantile(free[free > 1], 0.75))))
    offset = np.arange(-widest, widest + 1) / widest
    cubic = 6 * np.linalg.pinv(np.vander(offset, 4, increasing=True))[3] / widest**3
    third = np.convolve(recording.velocity, cubic[::-1], mode="same")[free >= widest]
    share = _share_while_sliding(recording, free, noise)
    bend = max(float(np.mean(third**2)) - share * noise.product(cubic, cubic), 0.0)
    h = np.arange(1, widest + 1, dtype=float)
    error = share * _slope_variance(noise, h) + ((3 * h**2 + 3 * h - 1) / 30) ** 2 * bend
    return int(h[np.argmin(error)])


def _share_while_sliding(recording: Recording, free: Index, noise: Noise) -> float:
    """Return the share of the noise's square that fourth differences show clear of reversals, at most 1.

    The estimate reckons with as much noise as jumps at reversals may hide; where there are none, less is seen. No less
    is reckoned with than the finest steps of a sensor make: a window for noise of 1e-12 hangs on the last digits.
    """
    from fricmodels.signals import motion_noise
    from fricmodels.signals.noise_level import finest_noise

    source = recording["position"] if recording.derived_over else recording.velocity
    finest = (finest_noise(source) / max(motion_noise(recording).deviation, 1e-300)) ** 2
    weights = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
    seen = np.diff(recording.velocity, 4)[free[2:-2] > 2]
    whole = noise.product(weights, weights)
    return min(1.0, max(float(np.mean(seen**2)) / whole, finest)) if len(seen) and whole > 0.0 else 1.0


def _slope_variance(noise: Noise, half_widths: Array) -> Array:
    """Return the variance of the slope of noise by half width, per sample; of coloured noise between a few of them."""
    from fricmodels.signals.lanczos import even_weights

    h = half_widths
    if noise.is_white:
        return np.asarray(3 * noise.white**2 / (h * (h + 1) * (2 * h + 1)))
    some = np.unique(np.round(np.geomspace(1.0, h[-1], 24)).astype(int))
    variance = [max(noise.product(weights, weights), 1e-300) for weights in (even_weights(int(k))[1] for k in some)]
    return np.asarray(np.exp(np.interp(np.log(h), np.log(some), np.log(variance))))


def _free_of_reversals(recording: Recording) -> Index:
    """Return how far, in samples, each sample is from the next one at which the direction is not certain."""
    from fricmodels.signals.rest import smoothed_velocity

    velocity, error = smoothed_velocity(recording)
    uncertain = np.abs(velocity) <= 3 * error
    border = (velocity[1:] * velocity[:-1] < 0) | (np.diff(recording.run) != 0)
    uncertain[1:] |= border
    uncertain[:-1] |= border
    uncertain[[0, -1]] = True
    at = np.flatnonzero(uncertain)
    index = np.arange(len(velocity))
    after = np.searchsorted(at, index)
    return np.asarray(np.minimum(at[after] - index, index - at[np.maximum(after - 1, 0)]).clip(0), dtype=np.int64)
