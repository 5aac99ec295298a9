"""The newest window of a drive that is being recorded: each sample is looked at once."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np

from estimators.regression import Design, cubic, span
from fricmodels.arrays import Array
from fricmodels.kernels import Scan
from fricmodels.recording import channel_of


def at_sample(design: Design) -> Scan:
    """Return what gives regressors and rest of the friction torque of one sample, compiled.

    Input: one value for each signal of the model. Constants: what is held, and the width of rest.
    """
    import casadi

    linear = design.drive.linear_function
    signals = casadi.SX.sym("signals", len(design.drive.model.signals))
    constants = casadi.SX.sym("constants", len(design.nonlinear) + 1)
    held, width = constants[:-1], constants[-1]
    nothing = casadi.SX(0, 1)
    found = casadi.vertcat(*linear(*casadi.vertsplit(signals), held, nothing, width))
    return Scan(casadi.Function("at_sample", [nothing, signals, constants], [nothing, found]))


class NewestWindow:
    """The last samples of one run, and the row of the window that ends at the newest.

    What a sample is by itself, its regressors and its smoothed velocity, is found once, when it is taken; memory and
    work per sample are those of one window. The rows are those of :meth:`.Design.windows`, but for the width of rest,
    which is that of the recording that the estimator was scaled with.

    Args:
        design: the regression. channels: of a sample, in order.
    """

    def __init__(self, design: Design, channels: tuple[str, ...]) -> None:
        self.design, self.channels = design, channels
        self.samples: deque[dict[str, float]] = deque(maxlen=design.length)
        self._span = span(design.smoothing)
        self._weights = cubic(design.smoothing)
        self._place = {name: i for i, name in enumerate(channels)}
        needs = design.drive.model.needs
        listed = [(i, name) for i, name in enumerate(design.drive.model.signals) if name in needs]
        derived = ("velocity", "acceleration")
        self._smoothed = {name: i for i, name in listed if name in derived}
        self._given = [(i, self._place[channel_of(name)]) for i, name in listed if name not in derived]
        self._scan = at_sample(design)
        self._constants = np.array([*design.nonlinear, 1e-6 * design.peak or 1e-9])
        self._signals = np.zeros((1, len(design.drive.model.signals)))
        self._output = np.zeros((1, self._scan.n_outputs))
        self._latest = np.zeros((len(channels), self._span))
        self._inner = np.zeros((self._scan.n_outputs + 3, design.window))

    def clear(self) -> None:
        """Forget all samples: a new run begins."""
        self.samples.clear()

    def take(self, sample: Mapping[str, float]) -> Array | None:
        """Take a sample, and return the row of the window that ends with it, or ``None`` before the first whole one."""
        self.samples.append(dict(sample))
        latest = self._latest
        latest[:, :-1] = latest[:, 1:]
        for i, name in enumerate(self.channels):
            latest[i, -1] = sample[name]
        if len(self.samples) < self._span:
            return None
        self._look_at_middle()
        if len(self.samples) < self.design.length:
            return None
        inner = self._inner
        row: Array = self.design.rows(inner[0], inner[1], inner[2:])[0]
        return row

    def _look_at_middle(self) -> None:
        """Add what the middle one of the latest samples is by itself."""
        place, latest, half = self._place, self._latest, self._span // 2
        time, velocity = latest[place["time"]], latest[place["velocity"]]
        level, slope = self._weights
        smoothed = float(level @ velocity)
        signals: Any = self._signals[0]
        for to, come in self._given:
            signals[to] = latest[come, half]
        if "velocity" in self._smoothed:
            signals[self._smoothed["velocity"]] = smoothed
        if "acceleration" in self._smoothed:
            signals[self._smoothed["acceleration"]] = float(slope @ velocity) * 2 * half / (time[-1] - time[0])
        self._scan((), self._signals, self._constants, outputs=self._output)
        inner, found = self._inner, self._output[0]
        inner[:, :-1] = inner[:, 1:]
        inner[0, -1], inner[1, -1] = time[half], velocity[half]
        inner[2:-2, -1] = found[:-1]
        inner[-2, -1] = latest[place["torque"], half] - latest[place["load_torque"], half] - found[-1]
        inner[-1, -1] = smoothed
