"""RMS torque errors of a fitted model in bands, and which of them ranks it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.once import once
from fricmodels.recording import Recording
from fricmodels.results.words import about_noise, noise_text
from fricmodels.score.balance import balances, noise_balances, over_windows
from fricmodels.score.noise import apparent_inertia
from fricmodels.score.proportional import recorded_inertia
from fricmodels.signals.segments import stretches

WINDOWS = (0.005, 0.020, 0.100)
"""Windows over which torque errors are averaged [s], beside the error per sample."""
_WIDER = 1.01
"""Times the sampling interval from which a window is wider."""
CLEAR = 0.05
"""Most noise of the error that is named first, as a share of the RMS torque; see docs/decisions/torque-error.md."""


@dataclass(frozen=True)
class Band:
    """RMS torque error over one window.

    Attributes:
        window_ms: width of the window [ms]; of the error per sample, the sampling interval.
        SI, held_out_SI: on what was fitted and on what was kept back [N m or N]; not a number without it.
        percent, held_out_percent: of the RMS motor torque there.
        noise_floor_percent: what sensor noise alone would leave of the test error; of the fit error without test data.
        fit_noise_percent: what it would leave of the fit error. Where what was fitted is livelier than what was kept
            back, or quieter, the same noise is another percentage of its RMS motor torque.
    """

    window_ms: float
    SI: float
    percent: float
    held_out_SI: float
    held_out_percent: float
    noise_floor_percent: float
    fit_noise_percent: float = float("nan")

    def above_noise(self) -> float:
        """Return the mean square beyond noise of fit and test error, or of the test error if less [%²]."""
        fitted = self.percent**2 - self.fit_noise_percent**2
        kept = self.held_out_percent**2 - self.noise_floor_percent**2
        return min(0.5 * (fitted + kept), kept)


@dataclass(frozen=True)
class Errors:
    """RMS torque errors of a fitted model.

    Attributes:
        headline: the band that ranks a leaderboard.
        bands: all bands, the error per sample first, then wider and wider windows.
    """

    headline: Band
    bands: tuple[Band, ...]

    @property
    def per_sample(self) -> Band:
        """The error per sample."""
        return self.bands[0]

    @property
    def averaged(self) -> str:
        """Over which window the headline is averaged, in words."""
        return averaged(self.headline.window_ms, self.per_sample.window_ms)

    def in_words(self, unit: str) -> str:
        """Return the error of the headline and that per sample, each with what noise alone would leave."""
        line, sample = self.headline, self.per_sample
        noise = about_noise(line.noise_floor_percent)
        text = (
            f"RMS torque error {self.averaged}: {line.SI:.3g} {unit}, {line.percent:.3g} % of the RMS motor torque; "
            f"test error {line.held_out_percent:.3g} %; noise alone would leave {noise}."
        )
        if line is sample:
            return text
        return (
            f"{text} Per sample ({sample.window_ms:.3g} ms): {sample.percent:.3g} %; test error "
            f"{sample.held_out_percent:.3g} %; noise alone {noise_text(sample.noise_floor_percent)}."
        )

    @property
    def SI(self) -> float:
        """Of the headline, on what was fitted [N m or N]."""
        return self.headline.SI

    @property
    def percent(self) -> float:
        """Of the headline, on what was fitted, in % of the RMS motor torque."""
        return self.headline.percent

    @property
    def held_out_percent(self) -> float:
        """Of the headline, on what was kept back, in % of the RMS motor torque."""
        return self.headline.held_out_percent


def averaged(window_ms: float, sample_ms: float) -> str:
    """Return in words over which window an error is averaged."""
    if not window_ms > 0:
        return "as scored"
    return f"per sample ({window_ms:.3g} ms)" if window_ms <= sample_ms else f"averaged over {window_ms:.3g} ms"


def windows(recording: Recording) -> tuple[float, ...]:
    """Return the windows [s] of a recording: 0 for the error per sample, then all that are wider.

    A window is left out where it is no wider than the sampling interval, to the last digits of its stamps, or half of
    the samples lie in stretches that are too short for it.
    """
    time = recording.time
    parts = stretches(time, recording.run)
    room = np.repeat([(time[p.stop - 1] - time[p.start]) / 2 for p in parts], [p.stop - p.start for p in parts])
    most = float(np.median(room)) if len(room) else 0.0
    return (0.0, *(window for window in WINDOWS if _WIDER * recording.interval < window <= most))


def headline_window(prepared: Recording, inertia: float | None = None) -> float:
    """Return the window [s] that ranks: the narrowest in which noise leaves less than a twentieth of the RMS torque.

    It is the same for all models: it depends on the recording, and on the inertia that is given for all of them. Where
    none is, it is that which the recording shows by itself; beside a friction that the velocity does not tell, this may
    be a third too small. Where noise leaves more in every window it is the widest. What noise leaves of an acceleration
    that a filter of the user's choice has derived is not known; then it is the error per sample.

    Args:
        prepared: as it was fitted.
        inertia: the given one.
    """
    every, inertia = windows(prepared), apparent_inertia(prepared) if inertia is None else inertia
    most = CLEAR * prepared.rms_torque
    for window in every:
        torque, motion = noise_floors(prepared)[window]
        if not float(np.hypot(torque, inertia * motion if motion else 0.0)) > most:
            return window
    return every[-1]


def torque_error_over(drive: Drive, values: Mapping[str, float], prepared: Recording, window: float) -> Array:
    """Return the torque error over a window about each sample, shape (N,), in SI units.

    Args:
        drive: model and inertia.
        values: parameters by key; the inertia among them unless the drive has one.
        prepared: recording with ``velocity`` and ``acceleration``, from :func:`fricmodels.signals.prepare`.
        window: see :func:`windows`.
    """
    return over_windows(balances(drive, values, prepared), len(prepared), (window,), window)[1]


def torque_errors(
    drive: Drive, values: Mapping[str, float], train: Recording, test: Recording | None = None
) -> tuple[Errors, Array]:
    """Return the RMS torque errors in all bands, and that of the headline at each sample of what was fitted.

    The bands are those of ``train``, whatever the model is.

    Args:
        drive: model and inertia.
        values: parameters by key; the inertia among them unless the drive has one.
        train, test: what was fitted and what was kept back, prepared.
    """
    inertia = recorded_inertia(drive, values)
    every, floors, headline = windows(train), noise_floors(train), headline_window(train, drive.inertia)
    kept = {} if test is None else over_windows(balances(drive, values, test), len(test), every)[0]
    fitted, error = over_windows(balances(drive, values, train), len(train), every, headline)
    reference, kept_back = train.rms_torque, 0.0 if test is None else test.rms_torque
    found = {}
    for window in every:
        own, other = fitted[window], kept.get(window, float("nan"))
        torque, motion = floors[window]
        floor = float(np.hypot(torque, inertia * motion))
        found[window] = Band(
            1000 * (window or train.interval),
            own,
            _percent(own, reference),
            other,
            _percent(other, kept_back),
            _percent(floor, reference if test is None else kept_back),
            _percent(floor, reference),
        )
    return Errors(found[headline], tuple(found.values())), error


@once
def noise_floors(prepared: Recording) -> dict[float, tuple[float, float]]:
    """Return what noise leaves by window: of the torque [N m or N], and of the motion per unit of inertia."""
    every = windows(prepared)
    torque, motion = (over_windows(found, len(prepared), every)[0] for found in noise_balances(prepared))
    return {window: (torque[window], motion[window]) for window in every}


def _percent(value: float, reference: float) -> float:
    return 100 * value / reference if reference > 0 else float("nan")
