r"""The weak form: signals tested against bumps, so that no signal has to be differentiated.

For a compact bump φ with :math:`\int\varphi\,dt = 1` an equation :math:`J\,d\omega/dt = \tau` becomes

.. math:: -J\int \dot\varphi\,\omega\,dt = \int \varphi\,\tau\,dt .

Each signal is taken as straight between samples, and both integrals are then exact, by the antiderivatives of
:math:`\varphi \propto (1-u^2)^p`: on any grid the derivative of a constant is 0 and that of the time is 1. On an even
grid all windows share the same weights.

Source: D. A. Messenger and D. M. Bortz, *Weak SINDy*, Multiscale Model. Simul. 19 (2021) 1474; EFFECTS notes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fricmodels.signals.segments import Array, Runs, is_even, stretches

EXPONENT = 4
_BLOCK = 1 << 21


@dataclass(frozen=True)
class WeakForm:
    """Integrals over windows of ``width + 1`` samples.

    Attributes:
        time: sample times [s], shape (N,).
        first: first sample of each window, shape (K,).
        width: intervals in a window.
        even: whether all windows share the same weights.
    """

    time: Array
    first: NDArray[np.int64]
    width: int
    even: bool
    _shared: dict[str, Array] = field(default_factory=dict, repr=False, compare=False)

    def __len__(self) -> int:
        return len(self.first)

    @property
    def centre(self) -> NDArray[np.int64]:
        """Middle sample of each window."""
        return self.first + self.width // 2

    def integrate(self, signal: Array, *, held: bool = False) -> Array:
        """Return ``∫ φ signal dt`` of each window: a local mean, in the unit of the signal.

        Args:
            signal: shape (N,), or (N, m) for several at once.
            held: whether each sample holds until the next one, as a commanded torque does.
        """
        return self._apply("held" if held else "value", signal)

    def differentiate(self, signal: Array) -> Array:
        """Return ``−∫ φ' signal dt`` of each window: a local mean of the derivative."""
        return self._apply("slope", signal)

    def smooth(self, signal: Array) -> Array:
        """Return :meth:`integrate` of a signal at every sample, interpolated over the time of window centres."""
        if not len(self):
            return np.asarray(signal, dtype=float)
        return np.interp(self.time, self.time[self.centre], self.integrate(signal))

    def _apply(self, kind: str, signal: Array) -> Array:
        signal = np.asarray(signal, dtype=float)
        if len(signal) != len(self.time):
            raise ValueError(f"the signal has {len(signal)} samples, the weak form {len(self.time)}")
        columns = signal[:, None] if signal.ndim == 1 else signal
        result = np.empty((len(self), columns.shape[1]))
        for rows, window in self._blocks():
            weights = self._weights(kind, window)
            for j in range(columns.shape[1]):
                values = columns[:, j][window]
                base = values[:, :1]
                result[rows, j] = np.einsum("ij,ij->i", values - base, np.broadcast_to(weights, values.shape))
                if kind != "slope":
                    result[rows, j] += base[:, 0]
        return result[:, 0] if signal.ndim == 1 else result

    def _blocks(self) -> Iterator[tuple[slice, NDArray[np.int64]]]:
        rows = max(1, _BLOCK // (self.width + 1))
        offsets = np.arange(self.width + 1)
        for start in range(0, len(self), rows):
            part = slice(start, start + rows)
            yield part, self.first[part, None] + offsets

    def _weights(self, kind: str, window: NDArray[np.int64]) -> Array:
        if self.even:
            if kind not in self._shared:
                self._shared[kind] = _weights(kind, self.time[window[:1]])
            return self._shared[kind]
        return _weights(kind, self.time[window])


def weak_form(
    time: Array,
    runs: Runs | None,
    width: int,
    *,
    step: int | None = None,
    where: NDArray[np.bool_] | None = None,
) -> WeakForm:
    """Return the weak form on windows that cross neither runs nor gaps.

    Args:
        time: sample times [s], shape (N,).
        runs: run of each sample.
        width: intervals that a bump spans.
        step: samples from one window to the next; a quarter of the width if not given, which loses hardly anything.
        where: windows lie wholly where this mask holds, such as where the drive slides without reversal. Windows are
            laid out anew in each such stretch, so that short ones are used too.
    """
    if width < 2:
        raise ValueError(f"a bump must span two intervals or more, got {width}")
    stride = max(1, width // 4) if step is None else step
    parts = stretches(time, runs)
    first = []
    for part in parts:
        for start, stop in _masked(part, where):
            spare = stop - start - (width + 1)
            if spare >= 0:
                first.append(start + (spare % stride) // 2 + np.arange(0, spare + 1, stride))
    starts = np.concatenate(first) if first else np.empty(0, dtype=np.int64)
    intervals = {round((time[p.stop - 1] - time[p.start]) / max(p.stop - p.start - 1, 1), 12) for p in parts}
    even = all(is_even(time[part]) for part in parts) and (max(intervals) <= min(intervals) * (1 + 1e-6))
    return WeakForm(np.asarray(time, dtype=float), starts.astype(np.int64), width, bool(even))


def _masked(part: slice, where: NDArray[np.bool_] | None) -> list[tuple[int, int]]:
    if where is None:
        return [(part.start, part.stop)]
    edges = np.diff(np.r_[0, where[part].astype(np.int8), 0])
    starts, stops = np.flatnonzero(edges == 1) + part.start, np.flatnonzero(edges == -1) + part.start
    return list(zip(starts.tolist(), stops.tolist(), strict=True))


def _bump(exponent: int) -> tuple[Array, Array]:
    """Return the first and second antiderivative of the unit bump on [−1, 1], as power series in u."""
    polynomial = np.polynomial.Polynomial([1.0, 0.0, -1.0]) ** exponent
    first = polynomial.integ(lbnd=-1.0)
    total = first(1.0)
    return (first / total).coef, (first.integ(lbnd=-1.0) / total).coef


def _weights(kind: str, time: Array) -> Array:
    """Return the weight of each sample, shape like ``time`` (windows, samples)."""
    once, twice = _bump(EXPONENT)
    half = 0.5 * (time[:, -1:] - time[:, :1])
    u = (time - time[:, :1]) / half - 1.0
    area = np.diff(np.polynomial.polynomial.polyval(u, once), axis=1)
    if kind == "held":
        return np.concatenate([area, np.zeros_like(half)], axis=1)
    interval = np.diff(u, axis=1)
    weights = np.zeros_like(u)
    if kind == "slope":
        mean = area / interval
        weights[:, :-1] -= mean
        weights[:, 1:] += mean
        return weights / half
    first = np.polynomial.polynomial.polyval(u, once)
    rise = np.diff(np.polynomial.polynomial.polyval(u, twice), axis=1) / interval
    weights[:, :-1] += rise - first[:, :-1]
    weights[:, 1:] += first[:, 1:] - rise
    return weights
