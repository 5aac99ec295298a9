"""A filter beside the drive, one sample at a time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.errors import InputError
from fricmodels.estimator import OnlineFilter
from fricmodels.filtering.covariance import unpack
from fricmodels.filtering.preparation import REST_WIDTH
from fricmodels.filtering.problem import FilterProblem
from fricmodels.filtering.stored_problem import SCHEMA, problem_document
from fricmodels.filtering.windowed import RESTING
from fricmodels.recording import CHANNELS, Recording, channel_of


def resting_speed(problem: FilterProblem) -> float:
    """Return the speed [rad/s or m/s] below which a sample is one of rest."""
    return RESTING / REST_WIDTH * float(problem.known[0])


def checked_sample(
    sample: Mapping[str, float], channels: Sequence[str], previous: Mapping[str, float] | None, who: str
) -> dict[str, float]:
    """Return the channels of a sample and the number of its run; a load torque that is not given is zero.

    Args:
        sample: as it was given. channels: that are needed. previous: the sample before it. who: needs them, in words.

    Raises:
        InputError: when a channel is missing, a value is not finite, or time does not increase within a run.
    """
    given = {"load_torque": 0.0, **sample}
    missing = [name for name in channels if name not in given]
    if missing:
        raise InputError(f"the sample has no '{missing[0]}', which this {who} needs")
    present = {name: float(given[name]) for name in channels} | {"run": float(sample.get("run", 0))}
    if not all(map(math.isfinite, present.values())):
        raise InputError(f"the sample at time {present['time']} has a value that is not finite; leave it out")
    if previous is not None and present["run"] == previous["run"] and not present["time"] > previous["time"]:
        raise InputError(f"time must increase: {present['time']} follows {previous['time']}")
    return present


class ProblemOnline(OnlineFilter):
    """A filter beside the drive: the same compiled step, one sample at a time.

    A sample has ``time``, ``torque``, ``velocity`` and the channels that the model needs, in SI; ``run`` is optional:
    where it changes, velocity and internal states begin anew.

    Rest says nothing of the parameters. A filter that lets them walk would grow ever less certain there and jump at the
    next motion (wind-up); after a rest of one cycle of the recording that it was scaled with, they walk no further.

    Args:
        problem: the filter. estimator: whose it is. state: to go on from; see :attr:`state`.
    """

    def __init__(self, problem: FilterProblem, estimator: str, state: Mapping[str, Any] | None = None) -> None:
        self._problem = problem
        self._estimator = estimator
        self._memory = problem.initial_memory() if state is None else np.array(state["memory"], dtype=float)
        self._previous: dict[str, float] | None = None if state is None else state["previous"]
        self._rested = 0.0 if state is None else float(state["rested"])
        self._resting_speed = resting_speed(problem)
        self._constants = problem.constants
        self._at_rest = self._constants.copy()
        walks = len(problem.known) + 1
        self._at_rest[walks + problem.moving : walks + problem.order] = 0.0
        space_inputs = [channel_of(name) for name in problem.space.inputs]
        self._channels = tuple(dict.fromkeys(["time", "torque", "velocity", *space_inputs]))

    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take one sample and return the parameters.

        Raises:
            InputError: when a channel is missing, a value is not finite, or time does not increase.
        """
        problem, previous = self._problem, self._previous
        present = checked_sample(sample, self._channels, previous, "filter")
        if previous is None or present["run"] != previous["run"]:
            velocity = present["velocity"] / problem.scales.of(CHANNELS["velocity"])
            self._memory = problem.restarted(self._memory, velocity)
        else:
            pair = {name: np.array([previous[name], present[name]]) for name in self._channels}
            run = Recording("online", problem.drive.motion, pair, np.zeros(2, dtype=np.int64)).scaled(problem.scales)
            slow = float(np.max(np.abs(pair["velocity"]))) <= self._resting_speed
            self._rested = self._rested + present["time"] - previous["time"] if slow else 0.0
            constants = self._at_rest if self._rested > 2 * np.pi * problem.scales.time else self._constants
            self._memory, _, _ = problem.scan(self._memory, problem.rows(run), constants, stride=problem.substeps)
        self._previous = present
        return self.parameters

    @property
    def problem(self) -> FilterProblem:
        """The filter: its step, its numbers, where it starts."""
        return self._problem

    @property
    def state(self) -> dict[str, Any]:
        """All that it knows and remembers, as plain data."""
        return {
            "schema": SCHEMA,
            "estimator": self._estimator,
            "problem": problem_document(self._problem),
            "memory": self._memory.tolist(),
            "previous": None if self._previous is None else dict(self._previous),
            "rested": self._rested,
        }

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
