r"""The torque balance as a linear regression without bounds, averaged over windows.

.. math:: \tau = J\dot\omega + K_v\omega + K_c\,\mathrm{sgn}\,\omega + c_0 + c_1 q + c_2\sin q + c_3\cos q + c_4\tau_L

Each row is that equation multiplied by a triangle φ(t) over two neighbouring cells of W samples and integrated. Under
it :math:`\int\varphi\,\dot\omega\,dt` is the difference between the mean velocities of the two cells, so that nothing
is differentiated twice. What depends on the position (gravity, a spring) and on the load is let free, so that it is
not taken for inertia or friction. W is the one whose rows are explained best.

Errors of coefficients are those of clusters: rows of the same 32nd of the record, or of a larger part of a short one,
may go together in any way (Liang and Zeger 1986); with G clusters a coefficient over its error is compared with
Student's t of G − 1 (Bester, Conley and Hansen 2011).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.logcheck.view import Log
from fricmodels.signals.clusters import clusters

CLUSTERS = 32
"""Parts of a record; of a short one as many fewer as leave four rows in each, but no fewer than :data:`_FEWEST`."""
_FEWEST = 16
_ROWS_OF_EACH = 4
_WIDTHS = (4, 16, 64, 256)
_APART = 2
"""Cells between those of a row and those beside it: one lies between, for positions share the edges of theirs."""


@dataclass(frozen=True)
class Balance:
    """The regression.

    Attributes:
        names: of the columns.
        columns: shape (rows, columns).
        target: torque of each row, shape (rows,).
        cluster: of each row, shape (rows,).
        beside: acceleration between the cells two before and two after those of each row, which have no sample in
            common with them; nan where there are none, shape (rows,).
        start: first sample of each row, shape (rows,).
        width: W [samples].
        mean_square, mean_speed: of the velocity.
    """

    names: tuple[str, ...]
    columns: Array
    target: Array
    cluster: Index
    beside: Array
    start: Index
    width: int
    mean_square: float
    mean_speed: float

    @cached_property
    def _solved(self) -> tuple[Array, Array, Array]:
        scale = np.sqrt(np.mean(self.columns**2, axis=0))
        scale[scale == 0.0] = 1.0
        scaled = self.columns / scale
        inverse = np.linalg.pinv(scaled.T @ scaled, rcond=1e-10, hermitian=True)
        solution = inverse @ (scaled.T @ self.target)
        left = self.target - scaled @ solution
        scores = scaled * left[:, None]
        count = self.clusters
        sums = np.stack([np.bincount(self.cluster, scores[:, j], count) for j in range(scores.shape[1])], axis=1)
        covariance = inverse @ (sums.T @ sums) @ inverse * count / max(count - 1, 1)
        return solution / scale, covariance / np.outer(scale, scale), left

    @property
    def clusters(self) -> int:
        """Number of the clusters."""
        return int(self.cluster.max()) + 1

    @property
    def left(self) -> Array:
        """What is left of the torque in each row, shape (rows,)."""
        return self._solved[2]

    @property
    def unexplained(self) -> float:
        """Share of the torque's variance that is left."""
        spread = float(np.var(self.target))
        return float(np.mean(self.left**2)) / spread if spread > 0 else 1.0

    @property
    def power(self) -> float:
        """Power that friction takes up, K_v ω² + K_c |ω| on average, over its standard error."""
        return self.ratio({"K_v": self.mean_square, "K_c": self.mean_speed})

    def share(self, name: str) -> float:
        """Return the RMS value of one term about its mean, over that of the torque."""
        j, spread = self.names.index(name), float(np.std(self.target))
        return abs(float(self._solved[0][j])) * float(np.std(self.columns[:, j])) / spread if spread > 0 else 0.0

    def explained_alone(self, name: str) -> float:
        """Return the share of the torque's variance that one column explains without the others."""
        target, own = (x - np.mean(x) for x in (self.target, self.columns[:, self.names.index(name)]))
        whole = float(target @ target) * float(own @ own)
        return float(target @ own) ** 2 / whole if whole > 0.0 else 0.0

    def ratio(self, weights: dict[str, float]) -> float:
        """Return a weighted sum of coefficients over its standard error."""
        w = np.array([weights.get(name, 0.0) for name in self.names])
        error = float(np.sqrt(max(w @ self._solved[1] @ w, 0.0)))
        value = float(w @ self._solved[0])
        return value / error if error > 0 else float(np.sign(value)) * np.inf if value else 0.0


def balances(log: Log) -> list[Balance]:
    """Return the balance of an excerpt at each width at which there are rows enough; of a short log at the least."""
    short = log.short
    signals = _signals(short)
    found = [one for width in _WIDTHS if (one := _at(short, width, signals, CLUSTERS)) is not None]
    least = None if found else _at(short, _WIDTHS[0], signals, _FEWEST)
    return found if least is None else [least]


def best(rows: list[Balance]) -> Balance | None:
    """Return the balance that explains most, or ``None`` if there is none."""
    return min(rows, key=lambda found: found.unexplained) if rows else None


def _signals(log: Log) -> dict[str, Array]:
    velocity, position = log.velocity, log.position
    signals = {"K_v": velocity, "K_c": np.sign(velocity), "position": position}
    if not log.one_way:
        signals["offset"] = np.ones(len(velocity))
    if log.rotary:
        signals["sine"], signals["cosine"] = np.sin(position), np.cos(position)
    if "load_torque" in log.recording:
        signals["load"] = log.recording.load_torque
    return signals


def _at(log: Log, width: int, signals: dict[str, Array], fewest: int) -> Balance | None:
    """Return the balance at a width, ``None`` where there are no four rows for each of so many clusters."""
    recording = log.recording
    cells = Cells.of(log, width)
    parts = min(CLUSTERS, int(np.count_nonzero(cells.whole)) // _ROWS_OF_EACH)
    if parts < fewest:
        return None
    columns = {"J": cells.rise(log.position), **{name: cells.mean(values) for name, values in signals.items()}}
    cluster = clusters(cells.start, len(recording), parts)
    matrix = np.stack(list(columns.values()), axis=1)
    speed = np.abs(signals["K_v"])
    target = cells.mean(recording.torque)
    moments = float(np.mean(speed**2)), float(np.mean(speed))
    beside = cells.beside(log.position)
    return Balance(tuple(columns), matrix, target, cluster, beside, cells.start, width, *moments)


@dataclass(frozen=True)
class Cells:
    """Triangles over pairs of neighbouring cells that lie within one stretch.

    Attributes:
        edges: first sample of each cell and the last one's end, shape (cells + 1,).
        whole: which pairs are within one stretch, shape (cells − 1,).
        up, down: triangle times the time that a sample stands for, shape (N',).
        time: of the edges.
    """

    edges: Index
    whole: Mask
    up: Array
    down: Array
    time: Array

    @classmethod
    def of(cls, log: Log, width: int) -> Cells:
        """Cut a log into cells of so many samples."""
        time = log.recording.time
        count = (len(time) - 1) // width
        edges = width * np.arange(count + 1)
        inner = time[: count * width].reshape(count, width)
        weights = np.empty(len(time))
        weights[1:-1] = 0.5 * (time[2:] - time[:-2])
        weights[0], weights[-1] = 0.5 * (time[1] - time[0]), 0.5 * (time[-1] - time[-2])
        length = np.maximum(time[edges[1:]] - time[edges[:-1]], 1e-300)[:, None]
        part = (inner - inner[:, :1]) / length
        weight = weights[: count * width].reshape(count, width)
        breaks = np.add.reduceat(np.r_[~log.joined, False][: count * width].astype(np.int64), edges[:-1])
        return cls(edges, (breaks[1:] + breaks[:-1]) == 0, part * weight, (1.0 - part) * weight, time[edges])

    @property
    def start(self) -> Index:
        """First sample of each whole pair."""
        return self.edges[:-2][self.whole]

    def inside(self, cells: int) -> Mask:
        """Return which pairs of cells stand amid so many whole ones on either side, shape (pairs − 2 cells,)."""
        return np.asarray(np.lib.stride_tricks.sliding_window_view(self.whole, 2 * cells + 1).all(axis=1))

    def mean(self, values: Array) -> Array:
        """Return the mean of a signal under each triangle."""
        cut = values[: self.edges[-1]].reshape(self.up.shape)
        rising, falling = np.einsum("ij,ij->i", self.up, cut), np.einsum("ij,ij->i", self.down, cut)
        return np.asarray(((rising[:-1] + falling[1:]) / (0.5 * (self.time[2:] - self.time[:-2])))[self.whole])

    def slope(self, values: Array) -> Array:
        """Return the mean derivative of a signal over each cell, shape (cells,)."""
        return np.asarray(np.diff(values[self.edges]) / np.diff(self.time))

    def rise(self, integral: Array) -> Array:
        """Return the mean second derivative of a signal under each triangle."""
        speed = self.slope(integral)
        return np.asarray((np.diff(speed) / (0.5 * (self.time[2:] - self.time[:-2])))[self.whole])

    def beside(self, integral: Array) -> Array:
        """Return the mean second derivative of a signal between the cells before and after those of each triangle.

        It is nan where the stretch is not long enough.
        """
        speed, middle = self.slope(integral), 0.5 * (self.time[1:] + self.time[:-1])
        result = np.full(len(self.whole), np.nan)
        inside = slice(_APART, len(self.whole) - _APART)
        before, after = slice(None, -2 * _APART - 1), slice(2 * _APART + 1, None)
        if len(speed) > 2 * _APART + 1:
            result[inside] = (speed[after] - speed[before]) / (middle[after] - middle[before])
            result[inside][~self.inside(_APART)] = np.nan
        return result[self.whole]
