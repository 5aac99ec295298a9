"""What plain stepwise regression and PySINDy name on the same recordings.

Both get what a careful user would give them: the derivative by Lanczos' filter, samples at rest left out, the base
law's columns, and a library with a column (or a few) of every effect, periodic ones at the strongest period of the
base law's residual.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.signals import best_half_width, lanczos_derivative, resting

Array = NDArray[np.float64]
LEVEL = 0.01
"""Significance at which stepwise regression lets a column in."""
THRESHOLDS = (0.003, 0.01, 0.03, 0.1)
"""Of sparse regression, relative to the RMS torque; the one with the least held-out error is taken."""
MOST = 2_000
"""Samples that the ensemble is fitted to."""


def first_named(rig: Rig, recording: Recording) -> dict[str, str]:
    """Return the effect that each peer names first; empty where it names none."""
    target, base, library = rows(rig, recording)
    return {"stepwise": stepwise(target, base, library), "pysindy": sparse(target, base, library)}


def rows(rig: Rig, recording: Recording) -> tuple[Array, Array, list[tuple[str, Array]]]:
    """Return the torque less inertia and load torque, the base law's columns, and the library."""
    t, tau, load = recording.time, recording.torque, recording.load_torque
    omega, alpha = _derivative(t, recording.velocity)
    moving = ~resting(recording)
    s = np.sign(omega)
    base = [s, omega]
    if rig.friction.asymmetric:
        base += [np.ones_like(s), np.abs(omega)]
    if rig.friction.stick is not None:
        base.append(s * np.exp(-np.max(rig.friction.fall) * np.abs(omega)))
    target = tau - load - rig.inertia * alpha
    columns = np.array(base)[:, moving]
    left = np.zeros_like(target)
    left[moving] = _residual(target[moving], columns)
    named = _library(recording, omega, alpha, left, moving)
    kept = [(name, column[moving]) for name, column in named if np.ptp(column[moving]) > 0]
    return target[moving], columns, kept


def stepwise(target: Array, base: Array, library: list[tuple[str, Array]]) -> str:
    """Return the effect of the column that forward selection lets in first, by the F test of ordinary regression."""
    from scipy.stats import f as fisher

    left = _residual(target, base)
    total = float(left @ left)
    best, best_sum = "", 0.0
    for name, column in library:
        free = _residual(column, base)
        size = float(free @ free)
        if size > 1e-10 * float(column @ column):
            explained = float(left @ free) ** 2 / size
            if explained > best_sum:
                best, best_sum = name, explained
    freedom = len(target) - len(base) - 1
    statistic = best_sum / max(total - best_sum, 1e-300) * freedom
    return best if fisher.sf(statistic, 1, freedom) < LEVEL else ""


def sparse(target: Array, base: Array, library: list[tuple[str, Array]]) -> str:
    """Return the effect of the largest term that an ensemble of sequentially thresholded regressions keeps."""
    try:
        import pysindy
    except ImportError:
        return "not installed"
    every = max(1, len(target) // MOST)
    names = ["" for _ in base] + [name for name, _ in library]
    theta = np.vstack([base, *(column for _, column in library)])[:, ::every].T
    scale = np.sqrt(np.mean(theta**2, axis=0))
    theta, y = theta / scale, target[::every, None]
    y = y / np.sqrt(np.mean(y**2))
    cut = 2 * len(y) // 3
    best, least = None, np.inf
    np.random.seed(0)  # noqa: NPY002 - the ensemble draws its bags from the global generator
    for threshold in THRESHOLDS:
        single = pysindy.STLSQ(threshold=threshold, alpha=1e-6)
        optimizer = pysindy.EnsembleOptimizer(single, bagging=True, n_models=20)
        try:
            optimizer.fit(theta[:cut], y[:cut])
        except (ValueError, np.linalg.LinAlgError):  # everything was cut away
            continue
        error = float(np.mean((y[cut:] - theta[cut:] @ optimizer.coef_.T) ** 2))
        if error < least:
            best, least = np.abs(optimizer.coef_[0]), error
    if best is None:
        return ""
    effects = [i for i, name in enumerate(names) if name and best[i] > 0]
    return names[max(effects, key=lambda i: best[i])] if effects else ""


def _residual(values: Array, columns: Array) -> Array:
    return np.asarray(values - np.linalg.lstsq(columns.T, values, rcond=1e-10)[0] @ columns)


def _derivative(time: Array, values: Array) -> tuple[Array, Array]:
    return lanczos_derivative(time, values, best_half_width(time, values))


def _library(
    recording: Recording, omega: Array, alpha: Array, left: Array, moving: NDArray[np.bool_]
) -> list[tuple[str, Array]]:
    t, tau, load = recording.time, recording.torque, recording.load_torque
    s, speed = np.sign(omega), np.abs(omega)
    top = float(np.quantile(speed, 0.95))
    torque_rate = _derivative(t, tau)[1]
    jerk = _derivative(t, alpha)[1]
    late = (t - t[0]) / (t[-1] - t[0])
    named = [("torque-offset", np.ones_like(s)), ("asymmetry", speed), ("torque-gain", tau), ("inertia-error", alpha)]
    named += [("stribeck", s * np.exp(-((speed / (x * top)) ** n))) for x in (0.05, 0.1, 0.2) for n in (1, 2)]
    named += [("nonlinear-viscous", s * speed**p) for p in (0.5, 2 / 3, 2.0, 3.0)]
    named += [("frictional-lag", alpha * np.exp(-speed / (x * top))) for x in (0.05, 0.1, 0.2)]
    named += [("sensor-delay", torque_rate), ("joint-compliance", _derivative(t, jerk)[1])]
    named += [("drift", late * omega), ("drift", late * s)]
    named += [("step-change", s * (late > x)) for x in np.arange(1, 10) / 10]
    if np.any(load):
        named += [("load-friction", s * np.abs(load))]
        named += [("directional-efficiency", s * np.abs(load) * (omega * load > 0))]
    if "temperature" in recording:
        warm = recording["temperature"] - np.mean(recording["temperature"])
        named += [("thermal", warm * omega), ("thermal", warm * s)]
    if "position" in recording:
        named += _of_position(recording["position"], s, tau, left, moving, late)
    return named


def _of_position(
    q: Array, s: Array, tau: Array, left: Array, moving: NDArray[np.bool_], late: Array
) -> list[tuple[str, Array]]:
    named = [("stiffness", q), ("gravity", np.cos(q)), ("gravity", np.sin(q))]
    kinds: Mapping[str, Array] = {"cogging": np.ones_like(s), "position-friction": s, "torque-ripple": tau}
    for name, amplitude in kinds.items():
        k = _strongest(q[moving], (left * amplitude)[moving])
        named += [(name, amplitude * np.cos(k * q)), (name, amplitude * np.sin(k * q))]
    turned = np.concatenate([[True], s[1:] != s[:-1]])
    start = np.maximum.accumulate(np.where(turned, np.arange(len(s)), 0))
    since = np.abs(q - q[start])
    far = float(np.quantile(since, 0.9))
    rested = np.concatenate([[0.0], np.diff(np.flatnonzero(turned))]) if np.any(turned) else np.zeros(1)
    pause = rested[np.cumsum(turned) - 1] * (late[1] - late[0])
    for x in (0.02, 0.05, 0.15):
        decay = np.exp(-since / (x * far))
        named += [
            ("presliding", s * decay),
            ("backlash", s * (since < x * far)),
            ("rising-stiction", s * pause * decay),
        ]
    return named


def _strongest(q: Array, values: Array) -> float:
    """Return the wave number of the largest peak in the periodogram over position."""
    span = float(np.ptp(q)) or 1.0
    bins = 4096
    place = np.minimum(((q - q.min()) / span * bins).astype(int), bins - 1)
    summed = np.bincount(place, weights=values - values.mean(), minlength=bins)
    power = np.abs(np.fft.rfft(summed)) ** 2
    return float(2 * np.pi / span * (3 + np.argmax(power[3 : bins // 8])))
