"""How well a fitted drive explains a recording.

The torque error is what the equation of motion leaves over (eq. 21):

.. math:: T_e = \\tau_m - \\tau_L - J\\dot\\omega - \\tau_F(\\omega)

At rest the friction torque is no function of the velocity: it is whatever holds the drive, between two limits. There
the error is how far the torque that would be needed lies outside these limits, and zero inside.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels.drive import Drive, rest_width
from fricmodels.errors import InputError
from fricmodels.fit import Fit
from fricmodels.recording import Recording
from fricmodels.term import SIGNALS

if TYPE_CHECKING:
    from fricmodels.kernels import Scan

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
) -> Score:
    """Score a fit on what it was fitted to and on what it was not.

    Args:
        drive: the drive that was fitted.
        fit: its parameters.
        prepared_train, prepared_test: recordings with velocity and acceleration, from
            :func:`fricmodels.signals.prepare`.
        measure: percentages are of the RMS motor torque (``torque``), or, over the last two cycles, of the amplitude
            of the motor torque (``paper``, eq. 22).
        simulate: whether to simulate the velocity.
    """
    error = torque_error(drive, fit.parameters, prepared_train)
    rms, percent, samples = _rms(error, prepared_train, measure)
    held_out = (float("nan"), float("nan"), 0)
    if prepared_test is not None and len(prepared_test):
        held_out = _rms(torque_error(drive, fit.parameters, prepared_test), prepared_test, measure)
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


def torque_error(drive: Drive, values: Mapping[str, float], prepared: Recording) -> Array:
    """Return the torque error T_e of eq. 21 at every sample, shape (N,), in SI units.

    Args:
        drive: model and inertia.
        values: parameters by key; the inertia among them unless the drive has one.
        prepared: recording with ``velocity`` and ``acceleration``, from :func:`fricmodels.signals.prepare`.

    Raises:
        InputError: when the recording lacks a channel that the model needs.
    """
    from fricmodels.signals import resting

    inertia, _ = drive.split(values)
    needed = prepared.torque - prepared.load_torque - inertia * prepared["acceleration"]
    if drive.model.states:
        return needed - drive.friction(prepared, values, states=internal_states(drive, values, prepared))
    error = needed - drive.friction(prepared, values)
    rest = resting(prepared)
    if rest.any():
        resting_part = prepared.select(rest)
        least, greatest = drive.sticking_interval(resting_part, values)
        error[rest] = needed[rest] - np.clip(needed[rest], least, greatest)
    return error


def internal_states(drive: Drive, values: Mapping[str, float], prepared: Recording) -> tuple[Array, ...]:
    """Integrate a model's internal states along the measured motion, one array of shape (N,) for each.

    Every run starts from the declared initial states. The rule is the linearly implicit trapezium one, which stays
    stable for states much faster than the sampling.
    """
    scan = _state_scan(drive)
    _, parameters = drive.split(values)
    prepared.require(drive.model.needs - {"load_torque"}, drive.model.name)
    used = {name: prepared.signal(name) if name in drive.model.needs else np.zeros(len(prepared)) for name in SIGNALS}
    first = [state.initial for state in drive.model.states]
    states = np.empty((len(prepared), len(first)))
    for number in np.unique(prepared.run):
        mask = prepared.run == number
        signals = np.column_stack([values_[mask] for values_ in used.values()])
        steps = np.diff(prepared.time[mask])
        rows = np.column_stack([steps, signals[:-1], signals[1:]])
        _, outputs, _ = scan(first, rows, [*parameters, rest_width(prepared)])
        states[mask] = np.vstack([first, outputs])
    return tuple(states.T)


def _state_scan(drive: Drive) -> Scan:
    import casadi

    from fricmodels.kernels import Scan

    e = drive.model.expression()
    signals = casadi.vertcat(*e.signals.values())
    ends = [casadi.SX.sym(name, signals.numel()) for name in ("begin", "end")]
    length = casadi.SX.sym("length")
    at_begin, at_end = (casadi.substitute(e.rates, signals, end) for end in ends)
    slope = casadi.substitute(casadi.jacobian(e.rates, e.states), signals, ends[1])
    matrix = casadi.SX.eye(e.states.numel()) - length / 2 * slope
    following = e.states + casadi.solve(matrix, length / 2 * (at_begin + at_end))
    constants = casadi.vertcat(e.parameters, e.width)
    inputs = casadi.vertcat(length, *ends)
    return Scan(casadi.Function("states", [e.states, inputs, constants], [following, following]))


def _rms(error: Array, prepared: Recording, measure: Measure) -> tuple[float, float, int]:
    if measure == "paper":
        chosen = last_cycles(prepared, 2)
        amplitude = torque_amplitude(prepared)
        rms = float(np.sqrt(np.mean(error[chosen] ** 2)))
        return rms, 100 * rms / amplitude, int(np.count_nonzero(chosen))
    rms = float(np.sqrt(np.mean(error**2)))
    reference = float(np.sqrt(np.mean(prepared.torque**2)))
    return rms, 100 * rms / reference if reference > 0 else float("nan"), len(prepared)


def _simulated(drive: Drive, values: Mapping[str, float], prepared: Recording) -> tuple[float, float]:
    from fricmodels.simulation import simulated_velocity_error

    error = simulated_velocity_error(drive, values, prepared)
    rms = float(np.sqrt(np.mean(error**2)))
    reference = float(np.sqrt(np.mean(prepared.velocity**2)))
    return rms, 100 * rms / reference if reference > 0 else float("nan")


def information_criteria(error: Array, run: NDArray[np.int64], parameters: int) -> tuple[float, float, float]:
    r"""Return AIC, BIC and the effective number of samples of a torque error.

    Neighbouring samples of a torque error are alike, and do not count as one piece of evidence each. With the
    integrated autocorrelation time of the residual (Sokal's window: the least m with m ≥ 5 τ)

    .. math:: \tau = 1 + 2\sum_{k=1}^{m} \rho_k, \qquad N_e = N/\max(\tau, 1)

    .. math:: \mathrm{AIC} = N_e\ln\overline{T_e^2} + 2p, \qquad \mathrm{BIC} = N_e\ln\overline{T_e^2} + p\ln N_e

    Args:
        error: torque error, shape (N,).
        run: run number of each sample; no correlation is counted from one run to the next.
        parameters: number p of estimated parameters.

    Source: A. Sokal, "Monte Carlo methods in statistical mechanics", 1989; H. Akaike, 1974; G. Schwarz, 1978.
    """
    count = len(error)
    mean_square = float(np.mean(error**2))
    if not mean_square > 0 or not np.isfinite(mean_square):
        return float("nan"), float("nan"), float(count)
    covariance = np.zeros(count)
    for number in np.unique(run):
        part = error[run == number]
        spectrum = np.fft.rfft(part, 2 * len(part))
        covariance[: len(part)] += np.fft.irfft(np.abs(spectrum) ** 2)[: len(part)]
    times = 2 * np.cumsum(covariance / covariance[0]) - 1
    wide_enough = np.flatnonzero(np.arange(count) >= 5 * times)
    time = times[wide_enough[0]] if len(wide_enough) else times[-1]
    effective = count / max(float(time), 1.0)
    evidence = effective * np.log(mean_square)
    return float(evidence + 2 * parameters), float(evidence + parameters * np.log(effective)), effective


def torque_amplitude(recording: Recording) -> float:
    """Return the amplitude K_I of the motor torque: √2 times its RMS about its mean, over the last two cycles."""
    torque = recording.torque[last_cycles(recording, 2)]
    return float(np.sqrt(2 * np.mean((torque - np.mean(torque)) ** 2)))


def last_cycles(recording: Recording, cycles: int) -> NDArray[np.bool_]:
    """Mark the samples of the last cycles of the motor torque, from its upward passages through zero.

    The end of the recording counts as a passage where it is within half a sampling interval of one.

    Raises:
        InputError: when the recording has fewer cycles.
    """
    torque = recording.torque
    time = recording.time
    rising = np.flatnonzero((torque[:-1] < 0) & (torque[1:] >= 0))
    if len(rising) == 0:
        raise InputError(f"recording '{recording.name}' has no cycles of torque; use `score: torque`")
    share = torque[rising] / (torque[rising] - torque[rising + 1])
    passages = time[rising] + share * (time[rising + 1] - time[rising])
    period = float(np.median(np.diff(passages))) if len(passages) > 1 else float(time[-1] - passages[-1])
    begin = time[-1] + recording.interval - cycles * period
    if begin < time[0] - 0.5 * recording.interval:
        raise InputError(f"recording '{recording.name}' has fewer than {cycles} cycles of torque; use `score: torque`")
    return np.asarray(time > begin - 0.5 * recording.interval)
