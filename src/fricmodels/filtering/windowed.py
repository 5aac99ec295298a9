"""Recursive least squares on windows of the last samples, as plain numbers: what is needed to write it elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from fricmodels.arrays import Array
from fricmodels.drive import Drive

RESTING = 0.01
"""Speed below which a sample counts as standing still, as a fraction of the peak speed."""


@dataclass(frozen=True)
class WindowedRegression:
    """The torque equation over a window that ends at each sample, times a test function, and a recursion over its rows.

    Attributes:
        drive: whose equation it is.
        keys: estimated parameters, in the order of a row. fixed: SI values of the others.
        window: samples of the test function (1 − s²)³.
        value, slope: weights of the local cubic that give velocity and its change from sample to sample, shape (m,).
        resting: speed of rest [rad/s or m/s]: two samples in a row below it make the window one of standstill.
        torque: size of the torque, which rows are in. size: SI size of one unit of each estimated parameter.
        step: CasADi function ``(memory, [row, right side, use], [forgetting]) → (memory, …)``.
        forgetting: λ. memory: before the first sample: parameters and lower triangle of their covariance.
    """

    drive: Drive
    keys: tuple[str, ...]
    fixed: Mapping[str, float]
    window: int
    value: Array
    slope: Array
    resting: float
    torque: float
    size: Array
    step: Any
    forgetting: float
    memory: Array


@runtime_checkable
class Windowed(Protocol):
    """A filter beside a drive that is recursive least squares on windows."""

    @property
    def windowed(self) -> WindowedRegression:
        """What it computes with, before its first sample."""
