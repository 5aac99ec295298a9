"""The figures of one fit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from fricmodels.arrays import Array
from fricmodels.drive import Drive
from fricmodels.fit import Fit
from fricmodels.recording import Recording
from fricmodels.score.balance import source
from fricmodels.score.bands import Band, torque_errors
from fricmodels.score.criteria import information_criteria
from fricmodels.score.cycles import last_cycles, torque_amplitude
from fricmodels.score.torque import filtered_torque_error, torque_error
from fricmodels.score.zeroed import zeroed

Measure: TypeAlias = Literal["torque", "paper"]


@dataclass(frozen=True)
class Score:
    """Figures of one fit; errors in SI units and in percent.

    Attributes:
        rms_torque_error: on what was fitted [N m or N], over the window of :attr:`rms_torque_error_band_ms`.
        rms_torque_error_percent: of the RMS motor torque, or of the torque amplitude (``measure="paper"``, eq. 22).
        held_out_rms_torque_error, held_out_rms_torque_error_percent: on what was not fitted; not a number without it.
        simulated_velocity_error: RMS of recorded minus simulated velocity [rad/s or m/s], held out where there is
            such a part; every run is simulated from its first sample under the recorded torque alone.
        simulated_velocity_error_percent: of the RMS velocity.
        aic, bic: information criteria of the torque error on what was fitted; see :func:`information_criteria`.
        effective_samples: how many independent samples the torque error is worth.
        samples, held_out_samples: how many samples were scored.
        measure: what the percentages are of.
        rms_torque_error_band_ms: window of the torque error [ms]; ``None`` with ``measure="paper"`` or ``decimate``.
        rms_torque_error_bands: the torque error over other windows too, that per sample first.
    """

    rms_torque_error: float
    rms_torque_error_percent: float
    held_out_rms_torque_error: float
    held_out_rms_torque_error_percent: float
    simulated_velocity_error: float
    simulated_velocity_error_percent: float
    aic: float
    bic: float
    effective_samples: float
    samples: int
    held_out_samples: int
    measure: Measure = "torque"
    rms_torque_error_band_ms: float | None = None
    rms_torque_error_bands: tuple[Band, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return the figures by name."""
        return asdict(self)


def score(
    drive: Drive,
    fit: Fit,
    prepared_train: Recording,
    prepared_test: Recording | None = None,
    *,
    measure: Measure = "torque",
    simulate: bool = True,
    decimate: int = 1,
) -> Score:
    """Score a fit on what it was fitted to and on what it was not.

    Args:
        drive: the drive that was fitted.
        fit: its parameters.
        prepared_train, prepared_test: recordings with velocity and acceleration, from
            :func:`fricmodels.signals.prepare`.
        measure: ``torque`` is the torque error over a stated window (:func:`fricmodels.score.torque_errors`) in percent
            of the RMS motor torque; ``paper`` is that over the last two cycles in percent of the torque's amplitude
            (eq. 22), with all terms filtered alike.
        simulate: whether to simulate the velocity.
        decimate: score every so many-th sample only, after the same low-pass filter on the torque error and on the
            motor torque, as is usual in the identification of robots. (Decimating the recording beforehand would
            smooth the torque at a reversal, but not the model's.)
    """
    if prepared_test is not None and not len(prepared_test):
        prepared_test = None
    values = fit.parameters
    if prepared_test is not None:
        prepared_test = zeroed(drive, values, prepared_test)
    bands: tuple[Band, ...] = ()
    if measure == "torque" and decimate == 1:
        errors, error = torque_errors(drive, values, prepared_train, prepared_test)
        own, bands = errors.headline, errors.bands
        train = (own.SI, own.percent, len(prepared_train))
        test = (own.held_out_SI, own.held_out_percent, 0 if prepared_test is None else len(prepared_test))
        band_ms = own.window_ms
    else:
        error = _one_error(drive, values, prepared_train)
        train, test, band_ms = _rms(error, prepared_train, measure, decimate), (math.nan, math.nan, 0), None
        if prepared_test is not None:
            test = _rms(_one_error(drive, values, prepared_test), prepared_test, measure, decimate)
    scored = prepared_test if prepared_test is not None and len(prepared_test) > 1 else prepared_train
    velocity_error = velocity_percent = math.nan
    if simulate:
        velocity_error, velocity_percent = _simulated(drive, values, scored)
    aic, bic, effective = information_criteria(error, prepared_train.run, len(fit.estimated))
    return Score(
        *train[:2],
        *test[:2],
        velocity_error,
        velocity_percent,
        aic,
        bic,
        effective,
        train[2],
        test[2],
        measure,
        band_ms,
        bands,
    )


def _one_error(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Array:
    """Return the torque error of the paper's eq. 22, or the one that is decimated.

    Where the velocity was measured and its slope derived, all terms are filtered alike: a law that imitates the smear
    of the differentiator at reversals would come out above the true one. Elsewhere eq. 21 is taken at its word.
    """
    if source(prepared) == "velocity":
        return filtered_torque_error(drive, values, prepared)
    return torque_error(drive, values, prepared)


def _rms(error: Array, prepared: Recording, measure: Measure, decimate: int) -> tuple[float, float, int]:
    """Return an RMS torque error, in SI units and in percent, and how many samples it is of."""
    if measure == "paper":
        chosen = last_cycles(prepared, 2)
        amplitude = torque_amplitude(prepared)
        rms = float(np.sqrt(np.mean(error[chosen] ** 2)))
        return rms, 100 * rms / amplitude, int(np.count_nonzero(chosen))
    from fricmodels.signals.preparation import decimated

    kept = decimated(prepared.with_channels(torque_error=error), decimate)
    rms = float(np.sqrt(np.mean(kept["torque_error"] ** 2)))
    reference = kept.rms_torque
    return rms, 100 * rms / reference if reference > 0 else math.nan, len(kept)


def _simulated(drive: Drive, values: Mapping[str, float], prepared: Recording) -> tuple[float, float]:
    from fricmodels.simulation import simulated_velocity_error

    error = simulated_velocity_error(drive, values, prepared)
    rms = float(np.sqrt(np.mean(error**2)))
    reference = float(np.sqrt(np.mean(prepared.velocity**2)))
    return rms, 100 * rms / reference if reference > 0 else math.nan
