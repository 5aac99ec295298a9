"""Ways to spoil a good recording, each with what should be said of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from fricmodels.dimension import Motion
from fricmodels.recording import Recording

Array = np.ndarray
DEGREES = 180.0 / math.pi
RPM = 30.0 / math.pi


@dataclass(frozen=True)
class Way:
    """One way to spoil a recording.

    Attributes:
        name: what is done.
        spoil: does it; ``None`` where it cannot be done to this recording.
        says: kinds of finding of which one names it.
        told: what must be known besides: ``inertia`` where one is given, as by ``--inertia``.
        times: how many times the true inertia that is.
    """

    name: str
    spoil: Callable[[Recording, np.random.Generator], Recording | None]
    says: tuple[str, ...]
    told: str = ""
    times: float = 1.0


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def changed(recording: Recording, **channels: Array) -> Recording:
    return replace(recording, channels={**recording.channels, **channels})


def scaled(**factors: float) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Multiply channels; angles only where there are any."""
    turning = any(abs(abs(factor) - 1.0) > 1e-9 for name, factor in factors.items() if name not in ("torque", "time"))

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if not set(factors) <= set(recording.channels) or (turning and recording.motion is Motion.LINEAR):
            return None
        return changed(recording, **{name: factor * recording[name] for name, factor in factors.items()})

    return spoil


def with_both(spoil: Callable[[Recording, np.random.Generator], Recording | None]) -> Callable[..., Recording | None]:
    """Only where position and velocity are both there."""
    return lambda recording, rng: spoil(recording, rng) if {"position", "velocity"} <= set(recording.channels) else None


def alone(factor: float) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Take the position away and scale the velocity."""

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if "velocity" not in recording or recording.motion is Motion.LINEAR:
            return None
        kept = {name: values for name, values in recording.channels.items() if name != "position"}
        return replace(recording, channels={**kept, "velocity": factor * recording.velocity})

    return spoil


def as_it_is(recording: Recording, rng: np.random.Generator) -> Recording:
    """Leave the recording as it is: what is told of it is wrong."""
    return recording


def without_position(times: float) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Take the position away where there is a velocity, and scale the time."""

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if "velocity" not in recording:
            return None
        kept = {name: values for name, values in recording.channels.items() if name != "position"}
        return replace(recording, channels={**kept, "time": times * recording.time})

    return spoil


def swapped(one: str, other: str) -> Callable[[Recording, np.random.Generator], Recording | None]:
    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if not {one, other} <= set(recording.channels):
            return None
        return changed(recording, **{one: recording[other], other: recording[one]})

    return spoil


def wrapped(period: float, factor: float) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Let an encoder begin anew at the middle of the travel."""

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if "position" not in recording or recording.motion is Motion.LINEAR:
            return None
        position = factor * recording["position"]
        return changed(recording, position=np.mod(position - np.median(position), period))

    return spoil


def late(samples: int, *names: str) -> Callable[[Recording, np.random.Generator], Recording | None]:
    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if not set(names) <= set(recording.channels):
            return None
        return changed(
            recording, **{n: np.r_[np.full(samples, recording[n][0]), recording[n][:-samples]] for n in names}
        )

    return spoil


def clipped(recording: Recording, rng: np.random.Generator) -> Recording:
    low, high = np.quantile(recording.torque, [0.1, 0.9])
    return changed(recording, torque=np.clip(recording.torque, low, high))


def stopped(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Let the drive end at a stop that it meets in full motion, three times or more."""
    if "position" not in recording:
        return None
    position, fastest, limit = recording["position"], 0.0, None
    for share in np.arange(0.55, 0.95, 0.05):
        at = np.quantile(position, share)
        met = np.flatnonzero((position[:-1] < at) & (position[1:] >= at))
        met = met[(met > 16) & (met < len(position) - 17)]
        beyond = position[np.minimum(met + 16, len(position) - 1)] > at
        if np.count_nonzero(beyond) < 3:
            continue
        speed = float(np.median(position[met + 4] - position[met - 4]))
        if speed > fastest:
            fastest, limit = speed, float(at)
    if limit is None:
        return None
    channels = {"position": np.minimum(position, limit)}
    if "velocity" in recording:
        channels["velocity"] = np.where(position > limit, 0.0, recording.velocity)
    return changed(recording, **channels)


def false_stamps(recording: Recording, rng: np.random.Generator) -> Recording:
    wander = recording.interval * rng.uniform(-0.2, 0.2, len(recording))
    return changed(recording, time=recording.time + wander)


def with_gap(recording: Recording, rng: np.random.Generator) -> Recording:
    middle = len(recording) // 2
    return recording.select(np.r_[0:middle, middle + len(recording) // 40 : len(recording)])


def slipped(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Move the position by a tenth of the travel from a sample in the middle third on, as where an encoder slips."""
    if "position" not in recording or "position" in recording.derived:
        return None
    position = recording["position"].copy()
    position[len(position) // 3 + int(rng.integers(len(position) // 3)) :] += 0.1 * float(np.ptp(position))
    return changed(recording, position=position)


def held(name: str, samples: int) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Poll a channel less often than it is logged."""

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if name not in recording:
            return None
        return changed(recording, **{name: np.repeat(recording[name][::samples], samples)[: len(recording)]})

    return spoil


def repeated(recording: Recording, rng: np.random.Generator) -> Recording:
    """Repeat one sample in ten, in all channels but time."""
    index = np.arange(len(recording))
    again = rng.random(len(recording)) < 0.1
    again[0] = False
    index[again] -= 1
    return changed(recording, **{n: v[index] for n, v in recording.channels.items() if n != "time"})


def coarse(name: str) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Round to a fifth of the RMS value."""

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if name not in recording:
            return None
        step = 0.2 * rms(recording[name])
        return changed(recording, **{name: step * np.round(recording[name] / step)})

    return spoil


def outages(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Let all channels hold their values three times, for ten to sixty samples of motion."""
    motion = next((name for name in ("position", "velocity") if name in recording), None)
    if motion is None or len(recording) < 1000:
        return None
    change = np.abs(np.diff(recording[motion], prepend=recording[motion][0]))
    moving = np.flatnonzero(change[:-61] >= np.median(change[change > 0.0]))
    found = {name: values.copy() for name, values in recording.channels.items() if name != "time"}
    for first in rng.choice(moving, 3, replace=False):
        last = first + int(rng.integers(10, 61))
        for values in found.values():
            values[first : last + 1] = values[first]
    return changed(recording, **found)


def off_within_range(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Let five single samples of the velocity be off by three to six tenths of its range, and stay within it."""
    velocity = recording["velocity"].copy()
    at = rng.choice(np.arange(2, len(velocity) - 2), 5, replace=False)
    middle = 0.5 * (velocity.max() + velocity.min())
    velocity[at] += np.where(velocity[at] > middle, -1.0, 1.0) * rng.uniform(0.3, 0.5, 5) * np.ptp(velocity)
    return changed(recording, velocity=velocity)


def spiked(name: str) -> Callable[[Recording, np.random.Generator], Recording | None]:
    """Let single samples jump to one and a half to five times the largest value, with either sign."""

    def spoil(recording: Recording, rng: np.random.Generator) -> Recording | None:
        if name not in recording.channels:
            return None
        values = recording[name].copy()
        at = rng.choice(np.arange(2, len(values) - 2), int(rng.integers(1, 4)), replace=False)
        middle = 0.5 * (values.max() + values.min())
        values[at] = middle + rng.choice([-1.0, 1.0], len(at)) * rng.uniform(1.6, 5.0) * np.ptp(values)
        return changed(recording, **{name: values})

    return spoil


def low_passed(recording: Recording, rng: np.random.Generator) -> Recording:
    """Low-pass a torque with 2 % noise at a sixtieth of the rate: a delay of nine samples."""
    torque = recording.torque + 0.02 * rms(recording.torque) * rng.standard_normal(len(recording))
    return changed(recording, torque=lfilter([0.1], [1.0, -0.9], torque - torque[0]) + torque[0])


def coloured(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Add noise with a memory of twenty samples, 5 % of the velocity."""
    if not {"position", "velocity"} <= set(recording.channels):
        return None
    noise = lfilter([math.sqrt(1 - 0.95**2)], [1.0, -0.95], rng.standard_normal(len(recording)))
    return changed(recording, velocity=recording.velocity + 0.05 * rms(recording.velocity) * noise)


def voltage(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Add a back-EMF of three to ten times the drop over the resistance."""
    if "velocity" not in recording:
        return None
    constant = rng.uniform(3.0, 10.0) * rms(recording.torque) / rms(recording.velocity)
    return changed(recording, torque=recording.torque + constant * recording.velocity)


def hardly_moving(recording: Recording, rng: np.random.Generator) -> Recording | None:
    """Shrink the motion to half of the velocity's noise."""
    if "velocity" not in recording:
        return None
    noise = 0.02 * rms(recording.velocity) * rng.standard_normal(len(recording))
    channels = {"velocity": 0.01 * recording.velocity + noise}
    if "position" in recording:
        channels["position"] = 0.01 * recording["position"]
    return changed(recording, **channels)


def without_sign(name: str) -> Callable[[Recording, np.random.Generator], Recording]:
    """Keep the size of a channel, as a converter shows it."""
    return lambda recording, rng: changed(recording, **{name: np.abs(recording[name])})


def often_wrong(recording: Recording, rng: np.random.Generator) -> Recording:
    """Let single samples of the torque be thirty times as large, one of thirty to sixty at even distances."""
    values = recording.torque.copy()
    values[int(rng.integers(1, 30)) :: int(rng.integers(30, 61))] *= 30.0
    return changed(recording, torque=values)


WAYS = (
    Way("torque with the other sign", scaled(torque=-1.0), ("torque-sign",)),
    Way("velocity in deg/s", with_both(scaled(velocity=DEGREES)), ("unit",)),
    Way("velocity in rpm", with_both(scaled(velocity=RPM)), ("unit",)),
    Way("position in degrees", with_both(scaled(position=DEGREES)), ("unit",)),
    Way(
        "both in degrees, inertia given", with_both(scaled(position=DEGREES, velocity=DEGREES)), ("inertia",), "inertia"
    ),
    Way("velocity alone, deg/s, inertia given", alone(DEGREES), ("inertia",), "inertia"),
    Way("velocity alone, rpm, inertia given", alone(RPM), ("inertia",), "inertia"),
    Way("torque in mN m, inertia given", scaled(torque=1000.0), ("inertia",), "inertia"),
    Way("inertia ten times too large", as_it_is, ("inertia",), "inertia", 10.0),
    Way("inertia a fifth of what it is", as_it_is, ("inertia",), "inertia", 0.2),
    Way("inertia in kg cm²", as_it_is, ("inertia",), "inertia", 1e4),
    Way("time in ms", scaled(time=1e3), ("unit",), "inertia"),
    Way("time in µs, without position", without_position(1e6), ("unit",), "inertia"),
    Way("velocity with the other sign", with_both(scaled(velocity=-1.0)), ("velocity-sign",)),
    Way("velocity without its sign", with_both(without_sign("velocity")), ("velocity-magnitude",)),
    Way("position with the other sign", with_both(scaled(position=-1.0)), ("velocity-sign",)),
    Way("a gear between the sensors (× 7)", with_both(scaled(velocity=7.0)), ("velocity-scale",)),
    Way("velocity two hundredths too large", with_both(scaled(velocity=1.02)), ("velocity-scale",)),
    Way("position and velocity swapped", swapped("position", "velocity"), ("swapped-columns",)),
    Way("torque and velocity swapped", swapped("torque", "velocity"), ("swapped-columns",)),
    Way("torque and position swapped", swapped("torque", "position"), ("swapped-columns",)),
    Way("position wrapped at 2π", wrapped(2.0 * math.pi, 1.0), ("wrapped-position",)),
    Way("position in degrees, wrapped at 360", wrapped(360.0, DEGREES), ("unit",)),
    Way("velocity four samples late", with_both(late(4, "velocity")), ("velocity-lag",)),
    Way("torque eight samples late", late(8, "torque"), ("torque-delay",)),
    Way("torque clipped", clipped, ("saturation",)),
    Way("an end stop", stopped, ("end-stop",)),
    Way("time stamps ± 20 %", false_stamps, ("false-stamps", "jitter")),
    Way("a gap", with_gap, ("gap",)),
    Way("an encoder that slips", slipped, ("position-jump",)),
    Way("velocity polled every third sample", held("velocity", 3), ("repeated-samples",)),
    Way("torque polled every fourth sample", held("torque", 4), ("repeated-samples",)),
    Way("one sample in ten repeated", repeated, ("repeated-samples",)),
    Way("torque in steps of a fifth", coarse("torque"), ("quantisation",)),
    Way("velocity in steps of a fifth", coarse("velocity"), ("quantisation",)),
    Way("single samples of the torque wrong", spiked("torque"), ("spike",)),
    Way("one sample of the torque in thirty to sixty wrong", often_wrong, ("spike",)),
    Way("single samples of the position wrong", spiked("position"), ("spike",)),
    Way("single samples of the velocity off within its range", with_both(off_within_range), ("spike",)),
    Way("all channels hold for a while", outages, ("repeated-samples",)),
    Way("low-passed torque", low_passed, ("filtered-torque", "torque-delay")),
    Way("coloured velocity noise", coloured, ("coloured-noise",)),
    Way("a voltage taken for a torque", voltage, ("not-a-torque",)),
    Way("hardly any motion", hardly_moving, ("little-motion",)),
)
"""All ways, those that would make every answer nonsense first."""

BOTH = (
    Way("both in degrees, nothing else known", with_both(scaled(position=DEGREES, velocity=DEGREES)), ("unit",)),
    Way("velocity alone, deg/s, nothing else known", alone(DEGREES), ("unit",)),
    Way("torque without its sign", without_sign("torque"), ("torque-magnitude",)),
)
"""Ways that most recordings cannot show, counted apart: rescaled angles obey the same equation of motion, and the size
of a torque that is nearly all Coulomb friction is a constant."""
