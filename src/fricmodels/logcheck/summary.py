"""What a recording is: sampling, coverage, and how good its signals are; with what is the matter with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmodels.arrays import Array, Mask, widened
from fricmodels.logcheck.check import findings_of
from fricmodels.logcheck.colour import channel_noise, wanders
from fricmodels.logcheck.finding import Finding
from fricmodels.logcheck.stamps import missing
from fricmodels.logcheck.view import Log
from fricmodels.recording import Recording
from fricmodels.results.words import figures
from fricmodels.signals.clusters import LEVEL
from fricmodels.signals.counted import with_counted_position
from fricmodels.signals.in_place import BAND
from fricmodels.signals.noise_level import noise_of
from fricmodels.signals.preparation import prepare
from fricmodels.signals.rest import resting, smoothed_velocity
from fricmodels.signals.stamps import unevenness
from fricmodels.signals.switched import is_switched

SCHEMA = "fricmodels/info/1"
_EVEN = 1e-6
"""Jitter, as a share of the interval, up to which it is that of the stamps' own digits."""
_OTHER_RATE = 1.01
"""Ratio from which two runs were not sampled at the same rate."""

_OUTSTANDING = 3.5
"""Standard deviations from which on a third difference is no noise: of noise one in two thousand is."""


@dataclass(frozen=True)
class Channel:
    """One channel: its unit and range, the step of its grid (0 if there is none) and its noise, all in that unit."""

    unit: str
    least: float
    greatest: float
    resolution: float
    noise: float


@dataclass(frozen=True)
class Summary:
    """Figures about one recording in SI units; shares are between 0 and 1, ``None`` is what does not apply.

    Attributes:
        name, motion, samples, runs: what it is.
        channels: what was measured.
        duration: of all runs together, without gaps [s].
        rate: of sampling, the inverse of the median interval [Hz].
        rates: the least and the greatest of a run [Hz].
        jitter: standard deviation of the intervals over their median, gaps and lost samples aside.
        gaps, gap_time: number of gaps within runs, and their duration [s].
        missing: samples that an even clock should have given, too few together for a gap.
        rest: share of samples at standstill.
        forward: share of the moving samples that go forward.
        reversals: number of changes of direction.
        travel: distance between the ends of the position [rad or m].
        band: frequency below which nine tenths of the power of the velocity lie [Hz].
        feedback: whether the torque answers the noise of the velocity, as in a closed loop.
        findings: what is the matter, the gravest first.
    """

    name: str
    motion: str
    samples: int
    runs: int
    channels: dict[str, Channel]
    duration: float
    rate: float
    rates: tuple[float, float]
    jitter: float
    gaps: int
    gap_time: float
    missing: int
    rest: float
    forward: float
    reversals: int
    travel: float | None
    band: float
    feedback: bool
    findings: tuple[Finding, ...]

    def rows(self) -> list[tuple[str, str]]:
        """Return what to print: label and value with unit."""
        length = "rad" if self.motion == "rotary" else "m"
        loop = "closed: the torque answers the noise of the velocity" if self.feedback else "no feedback of noise seen"
        low, high = self.rates
        rate = f"{figures(self.rate, 6)} Hz"
        if high > _OTHER_RATE * low:
            rate = f"{figures(low, 4)} to {figures(high, 4)} Hz, not the same in each run"
        jitter = f"jitter {figures(100 * self.jitter)} %" if self.jitter > _EVEN else "evenly sampled"
        jitter += " but for what is missing" if self.missing and self.jitter <= _EVEN else ""
        count = f"{self.missing} sample{'s' * (self.missing != 1)}"
        share = 100.0 * self.missing / (self.samples + self.missing)
        turns = f"{self.reversals} reversal{'s' * (self.reversals != 1)}"
        rows = [
            ("motion", self.motion),
            (
                "samples",
                f"{self.samples} in {self.runs} run{'s' if self.runs != 1 else ''}, {figures(self.duration, 4)} s",
            ),
            ("rate", f"{rate}, {jitter}"),
            ("gaps", f"{self.gaps}, {figures(self.gap_time, 3)} s" if self.gaps else "none"),
            *([("missing", f"{count} ({figures(share)} %)")] if self.missing else []),
            ("at rest", f"{figures(100 * self.rest, 3)} % of the samples"),
            ("moving", f"{figures(100 * self.forward, 3)} % forward, {turns}"),
            ("excites", f"nine tenths of the velocity's power below {figures(self.band, 3)} Hz"),
            ("loop", loop),
        ]
        if self.travel is not None:
            turns = f" ({figures(self.travel / (2 * np.pi), 4)} turns)" if length == "rad" else ""
            rows.insert(len(rows) - 2, ("travel", f"{figures(self.travel, 4)} {length}{turns}"))
        return rows

    def to_json(self) -> dict[str, Any]:
        """Return plain data, as ``info.json`` holds it."""
        return {
            "schema": SCHEMA,
            "dataset": self.name,
            "motion": self.motion,
            "channels": {name: vars(channel) for name, channel in self.channels.items()},
            "rate_Hz": self.rate if np.isfinite(self.rate) else None,
            "rates_Hz": [one if np.isfinite(one) else None for one in self.rates],
            "samples": self.samples,
            "runs": self.runs,
            "duration_s": self.duration,
            "jitter": self.jitter,
            "gaps": self.gaps,
            "gap_time_s": self.gap_time,
            "missing_samples": self.missing,
            "rest": self.rest,
            "forward": self.forward,
            "reversals": self.reversals,
            "travel": self.travel,
            "band_Hz": self.band,
            "closed_loop": self.feedback,
            "findings": [finding.to_json() for finding in self.findings],
        }


def _noise(log: Log, channel: str) -> float:
    """Return the noise of a channel, at the least that of its rounding; none of a torque that is switched.

    Of a short log, whose spectra have too few pieces, and of one whose intervals differ, which makes noise of a motion
    that has none, it is what every fit takes but for what lasts over many samples: that is not told from a slow change
    of the channel.
    """
    short = log.short.recording
    values, found = short[channel], channel_noise(log.short, short[channel])
    if channel in ("torque", "current") and is_switched(values):
        return 0.0
    size = found.size
    if not found.pieces or wanders(log, channel, found):
        size = replace(noise_of(short.time, values, short.run), lasting=0.0, samples=0.0).deviation
    return max(size, log.resolution[channel] / float(np.sqrt(12.0)))


def summary(recording: Recording, inertia: float | None = None) -> Summary:
    """Return what a recording is, and what is the matter with it.

    Args:
        recording: as read.
        inertia: the stated one [kg m² or kg], by which units are judged.
    """
    log = Log(recording)
    moved = _as_fitted(recording)
    velocity = log.velocity if moved is recording else moved.velocity
    within = np.diff(recording.run) == 0
    lost, usual = log.steps[within & ~log.joined], log.usual_steps[within]
    noise = {name: _noise(log, name) for name in log.measured}
    moving = ~resting(moved) & (velocity != 0.0)
    position = log.measured.get("position")
    return Summary(
        name=recording.name,
        motion=str(recording.motion),
        samples=len(recording),
        runs=len(recording.run_numbers),
        channels={
            name: Channel(
                log.unit(name),
                float(values.min()),
                float(values.max()),
                log.resolution[name],
                noise[name],
            )
            for name, values in log.measured.items()
        },
        duration=float(log.steps[log.joined].sum()),
        rate=1.0 / recording.interval,
        rates=(1.0 / float(usual.max()), 1.0 / float(usual.min())) if len(usual) else (np.nan, np.nan),
        jitter=_jitter(recording),
        gaps=len(lost),
        gap_time=float(lost.sum()),
        missing=missing(log).samples,
        rest=1.0 - float(np.mean(moving)),
        forward=float(np.mean(velocity[moving] > 0.0)) if moving.any() else 0.0,
        reversals=_reversals(moved),
        travel=None if position is None else float(np.ptp(position)),
        band=_band(log),
        feedback=_feedback(log.short),
        findings=findings_of(log, inertia),
    )


def _as_fitted(recording: Recording) -> Recording:
    """Return the recording with the velocity of its counts, where their differences are all that was recorded."""
    counted = with_counted_position(recording)
    if counted is recording:
        return recording
    channels = {name: values for name, values in counted.channels.items() if name != "velocity"}
    return prepare(replace(counted, channels=channels))


def _jitter(recording: Recording) -> float:
    """Return how uneven the stamps are, none where that is no more than their rounding to floats."""
    found = unevenness(recording)
    return found if found * recording.interval > recording.rounding_of_time else 0.0


def _reversals(recording: Recording) -> int:
    """Return how often the velocity changes its sign, where noise does not decide on that."""
    velocity, error = smoothed_velocity(recording)
    sure = np.abs(velocity) > BAND * error
    turned = np.diff(np.sign(velocity[sure])) != 0.0
    return int(np.count_nonzero(turned & (np.diff(recording.run[sure]) == 0)))


def _band(log: Log) -> float:
    """Return the frequency below which nine tenths of the power lie by which the velocity varies [Hz].

    In the longest stretch; a steady part of the speed excites nothing.
    """
    part = max(log.short.parts, key=lambda one: one.stop - one.start)
    values = log.short.velocity[part]
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(len(values)))) ** 2
    total = np.cumsum(power)
    if total[-1] <= 0.0:
        return 0.0
    return float(np.searchsorted(total, 0.9 * total[-1]) / (len(values) * log.recording.interval))


def _feedback(log: Log) -> bool:
    """Judge whether the torque answers the noise of the velocity, now or up to three samples later.

    Third differences of both have nothing left but noise, and kinks: of a start, a stop or a corner of a profile, which
    torque and velocity have together however noise goes. So what stands out of either is left out, with all differences
    that have a sample in common with it. The correlation of the others times the root of the number of independent
    samples (a third of them, for third differences) is compared with the normal distribution, four lags at once, at the
    level of :data:`~fricmodels.signals.clusters.LEVEL`. A controller's answer is against the noise. A torque that is
    the same from sample to sample mostly answers none.
    """
    from scipy.special import ndtr

    if "velocity" not in log.measured or len(log.recording) < 64:
        return False
    torque, velocity = (np.diff(values, 3) for values in (log.recording.torque, log.recording.velocity))
    quiet = ~widened(_stands_out(torque) | _stands_out(velocity), 3)
    least = 0.0
    for lag in (0, 1, 2, 3):
        both = quiet[lag:] & quiet[: len(quiet) - lag]
        answer, noise = torque[lag:][both], velocity[: len(velocity) - lag][both]
        size = float(np.sqrt(np.sum(answer**2) * np.sum(noise**2)))
        if size > 0.0:
            least = min(least, float(answer @ noise) / size * float(np.sqrt(len(noise) / 3.0)))
    return bool(4.0 * ndtr(least) < LEVEL)


def _stands_out(differences: Array) -> Mask:
    """Mark differences that are no noise, whose size the median tells; all of them where most are nothing."""
    from scipy.stats import median_abs_deviation

    usual = max(float(median_abs_deviation(differences, scale="normal")), 1e-300)
    return np.asarray(np.abs(differences) >= _OUTSTANDING * usual)
