"""The figures of one fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.fit import Fit
from fricmodels.recording import Recording
from fricmodels.score.criteria import information_criteria
from fricmodels.score.cycles import last_cycles, torque_amplitude
from fricmodels.score.torque import filtered_torque_error, torque_error

Array: TypeAlias = NDArray[np.float64]
Measure: TypeAlias = Literal["torque", "paper"]


@dataclass(frozen=True)
class Score:
    """Figures of one fit; errors in SI units and in percent.

    Attributes:
        rms_torque_error: on what was fitted [N m or N].
        rms_torque_error_percent: of the RMS motor torque, or of the torque amplitude (``measure="paper"``, eq. 22).
        held_out_rms_torque_error, held_out_rms_torque_error_percent: on what was not fitted; not a number without it.
        simulated_velocity_error: RMS of recorded minus simulated velocity [rad/s or m/s], held out where there is
            such a part; every run is simulated from its first sample under the recorded torque alone.
        simulated_velocity_error_percent: of the RMS velocity.
        aic, bic: information criteria of the torque error on what was fitted; see :func:`information_criteria`.
        effective_samples: how many independent samples the torque error is worth.
        samples, held_out_samples: how many samples were scored.
        measure: what the percentages are of.
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
        measure: ``torque`` is the torque error over all samples in percent of the RMS motor torque; ``paper`` is that
            over the last two cycles in percent of the torque's amplitude (eq. 22).
        simulate: whether to simulate the velocity.
        decimate: score every so many-th sample only, after the same low-pass filter on the torque error and on the
            motor torque, as is usual in the identification of robots. (Decimating the recording beforehand would
            smooth the torque at a reversal, but not the model's.)
    """
    error = _error(drive, fit.parameters, prepared_train)
    rms, percent, samples = _rms(error, prepared_train, measure, decimate)
    held_out = (float("nan"), float("nan"), 0)
    if prepared_test is not None and len(prepared_test):
        held_out = _rms(_error(drive, fit.parameters, prepared_test), prepared_test, measure, decimate)
    scored = prepared_test if prepared_test is not None and len(prepared_test) > 1 else prepared_train
    velocity_error = velocity_percent = float("nan")
    if simulate:
        velocity_error, velocity_percent = _simulated(drive, fit.parameters, scored)
    aic, bic, effective = information_criteria(error, prepared_train.run, len(fit.estimated))
    return Score(
        rms,
        percent,
        held_out[0],
        held_out[1],
        velocity_error,
        velocity_percent,
        aic,
        bic,
        effective,
        samples,
        held_out[2],
        measure,
    )


def _error(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Array:
    """Return the torque error: all terms filtered alike where the velocity was measured and its slope derived.

    There the differentiator is ours, and must not be held against the law: a law that imitates its smear at reversals
    would come out above the true one. Where the acceleration was measured, or the velocity derived by a filter of the
    user's choice, eq. 21 is taken at its word.
    """
    if "velocity" not in prepared.derived and "acceleration" in prepared.derived:
        return filtered_torque_error(drive, values, prepared)
    return torque_error(drive, values, prepared)


def _rms(error: Array, prepared: Recording, measure: Measure, decimate: int) -> tuple[float, float, int]:
    if measure == "paper":
        chosen = last_cycles(prepared, 2)
        amplitude = torque_amplitude(prepared)
        rms = float(np.sqrt(np.mean(error[chosen] ** 2)))
        return rms, 100 * rms / amplitude, int(np.count_nonzero(chosen))
    torque = prepared.torque
    if decimate > 1:
        from fricmodels.signals.preparation import decimated

        kept = decimated(prepared.with_channels(torque_error=error), decimate)
        error, torque = kept["torque_error"], kept.torque
    rms = float(np.sqrt(np.mean(error**2)))
    reference = float(np.sqrt(np.mean(torque**2)))
    return rms, 100 * rms / reference if reference > 0 else float("nan"), len(torque)


def _simulated(drive: Drive, values: Mapping[str, float], prepared: Recording) -> tuple[float, float]:
    from fricmodels.simulation import simulated_velocity_error

    error = simulated_velocity_error(drive, values, prepared)
    rms = float(np.sqrt(np.mean(error**2)))
    reference = float(np.sqrt(np.mean(prepared.velocity**2)))
    return rms, 100 * rms / reference if reference > 0 else float("nan")
