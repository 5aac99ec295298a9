"""A filter beside the drive, one sample at a time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricmodels.arrays import Array
from fricmodels.errors import InputError
from fricmodels.estimator import OnlineFilter
from fricmodels.filtering.covariance import unpack
from fricmodels.filtering.problem import FilterProblem
from fricmodels.recording import CHANNELS, Recording, channel_of


class ProblemOnline(OnlineFilter):
    """A filter beside the drive: the same compiled step, one sample at a time.

    A sample has ``time``, ``torque``, ``velocity`` and the channels that the model needs, in SI; ``run`` is optional:
    where it changes, velocity and internal states begin anew.
    """

    def __init__(self, problem: FilterProblem) -> None:
        self._problem = problem
        self._memory = problem.initial_memory()
        self._previous: dict[str, float] | None = None
        space_inputs = [channel_of(name) for name in problem.space.inputs]
        self._channels = tuple(dict.fromkeys(["time", "torque", "velocity", *space_inputs]))

    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take one sample and return the parameters.

        Raises:
            InputError: when a channel is missing, a value is not finite, or time does not increase.
        """
        problem = self._problem
        defaults = {"load_torque": 0.0, **sample}
        missing = [name for name in self._channels if name not in defaults]
        if missing:
            raise InputError(f"the sample has no '{missing[0]}', which this filter needs")
        present = {name: float(defaults[name]) for name in self._channels}
        if not all(np.isfinite(list(present.values()))):
            raise InputError(f"the sample at time {present['time']} has a value that is not finite; leave it out")
        present["run"] = float(sample.get("run", 0))
        previous = self._previous
        if previous is None or present["run"] != previous["run"]:
            velocity = present["velocity"] / problem.scales.of(CHANNELS["velocity"])
            self._memory = problem.restarted(self._memory, velocity)
        elif not present["time"] > previous["time"]:
            raise InputError(f"time must increase: {present['time']} follows {previous['time']}")
        else:
            pair = {name: np.array([previous[name], present[name]]) for name in self._channels}
            run = Recording("online", problem.drive.motion, pair, np.zeros(2, dtype=np.int64)).scaled(problem.scales)
            self._memory, _, _ = problem.scan(
                self._memory, problem.rows(run), problem.constants, stride=problem.substeps
            )
        self._previous = present
        return self.parameters

    @property
    def parameters(self) -> dict[str, float]:
        """The present estimate in SI."""
        return self._problem.named(self._problem.parameters(self._memory[: self._problem.order]))

    @property
    def covariance(self) -> Array:
        """The filter's own covariance of the estimated parameters in SI."""
        problem = self._problem
        covariance = unpack(self._memory[problem.order :], problem.order)[problem.moving :, problem.moving :]
        size = problem.drive.parameter_scales(problem.scales)
        return np.asarray(covariance * np.outer(size, size))
