"""Simulates a whole recording again and again, with other parameters: in one piece, or in windows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fricmodels.arrays import Array, Mask
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.kernels import Interpreted
from fricmodels.loop import PREFIX, Loop
from fricmodels.motion.start import SAMPLES, State, state_at
from fricmodels.recording import Recording
from fricmodels.simulation import PHASES, Between, checked, stepping, stepping_rows, width_of_rest
from fricmodels.stick_slip import MOTION, phase_of_step, pushing_signals

_GREATEST = 1e75
"""A motion beyond this has no end; its square would be no number."""


@dataclass(frozen=True)
class _Window:
    """A piece that is simulated at one go: its first sample, the samples it predicts, and the state it starts from."""

    first: int
    predicted: slice
    start: State


class Simulator:
    r"""The motion of a drive along a recording, for whatever parameters.

    Every run is simulated from its own first state; with a ``horizon`` it starts anew from the measured state every so
    many samples, and each sample is predicted from the last start (multi-step prediction). Steps, sticking and sliding
    are those of :func:`fricmodels.simulation.simulate`. Internal states start as declared at the beginning of a run,
    and in a later window as they are along the measured motion.

    Args:
        drive: the model, and its inertia or ``None``.
        recording: prepared (:func:`fricmodels.weakform.prepared.ready`), with a position or a velocity.
        loop: what pushes the drive, in place of the recorded torque.
        horizon: samples of a window; each run in one piece if not given (free run).
        substeps: steps of integration per sampling interval.
        between_samples: ``linear`` or ``held``.
        initial_samples: from which the state is estimated that a window starts from, see
            :func:`fricmodels.motion.start.state_at`; if not given 20, or as many as a noisy position is smoothed over.
        compiled: whether the recursion is compiled, once for a machine, which takes a second or more; where not, a step
            takes some microseconds.

    Raises:
        InputError: for a channel that is missing, a run of one sample, or times that do not increase.
    """

    def __init__(
        self,
        drive: Drive,
        recording: Recording,
        *,
        loop: Loop | None = None,
        horizon: int | None = None,
        substeps: int = 1,
        between_samples: Between = "linear",
        initial_samples: int | None = None,
        compiled: bool = True,
    ) -> None:
        if horizon is not None and horizon < 1:
            raise InputError(f"a horizon is at least one sample, got {horizon}")
        if substeps < 1:
            raise InputError(f"substeps must be at least 1, got {substeps}")
        _require(drive, loop, recording)
        self.drive, self.recording, self.loop, self.horizon = drive, recording, loop, horizon
        self.between_samples: Between = between_samples
        self.keys = (*drive.keys, *(f"{PREFIX}{p.symbol}" for p in (() if loop is None else loop.free)))
        if initial_samples is None:
            initial_samples = max(SAMPLES, 2 * recording.derived_over + 1)
        self._substeps, self._windows, first = substeps, list[_Window](), list[int]()
        self._scan = stepping(drive, loop) if compiled else Interpreted(phase_of_step(drive, loop))
        for number in recording.run_numbers:
            index = np.flatnonzero(recording.run == number)
            run = recording.select(index)
            if len(run) < 2 or not np.all(np.diff(run.time) > 0):
                raise InputError(f"run {number} of '{recording.name}' needs two increasing sample times to simulate it")
            first.append(int(index[0]))
            if index[-1] - index[0] + 1 != len(index):
                raise InputError(f"the samples of run {number} of '{recording.name}' do not follow each other")
            edges = [*range(0, len(run) - 1, horizon or len(run)), len(run) - 1]
            for begin, end in pairwise(edges):
                start = state_at(run, begin, initial_samples)
                predicted = slice(int(index[0]) + begin + 1, int(index[0]) + end + 1)
                self._windows.append(_Window(int(index[0]) + begin, predicted, start))
        self.scored: Mask = np.ones(len(recording), dtype=bool)
        self.scored[first] = False
        cut = recording.origin is not None  # what remembers does so through what was cut out
        self._later = [cut or window.first not in set(first) for window in self._windows]
        self._first = [window.first in set(first) for window in self._windows]
        self._rows = self._rows_of(recording)

    @property
    def drive_given(self) -> dict[str, float]:
        """What is known and not fitted, by key: the inertia, and parameters of the loop."""
        given = {} if self.drive.inertia is None else {self.drive.inertia_key: self.drive.inertia}
        loop = self.loop
        return given if loop is None else {**given, **{f"{PREFIX}{name}": x for name, x in loop.fixed.items()}}

    @property
    def starts(self) -> list[tuple[slice, State]]:
        """The samples that each window predicts, and the state that it starts from."""
        return [(window.predicted, window.start) for window in self._windows]

    def _rows_of(self, recording: Recording) -> list[Array]:
        """Return what drives each window, and what a step of it needs beside its state."""
        rows, stride = [], PHASES * self._substeps
        for number in recording.run_numbers:
            index = np.flatnonzero(recording.run == number)
            own = stepping_rows(self.drive, recording.select(index), self.between_samples, self._substeps, self.loop)
            for window in self._windows:
                if index[0] <= window.first <= index[-1]:
                    begin = window.first - int(index[0])
                    end = begin + window.predicted.stop - window.predicted.start
                    rows.append(own[stride * begin : stride * end])
        return rows

    def _timed(self, values: Mapping[str, float]) -> tuple[list[Array], Mapping[str, float]]:
        """Return the rows with the torques at the time of the motion, and the values with no delay left.

        A controller answers the motion that it is told, late or not: beside a loop a delay stays what the term says.
        """
        if self.loop is not None:
            return self._rows, values
        recording, timed = self.drive.timed(self.recording, values)
        if recording is self.recording:
            return self._rows, timed
        return self._rows_of(recording), timed

    def __call__(
        self, values: Mapping[str, float], moved_position: float = 0.0, moved_velocity: float = 0.0
    ) -> tuple[Array, Array]:
        """Return position and velocity at every sample, each of shape (N,); not a number where a simulation ended.

        Args:
            values: parameters of the model by key, the inertia unless the drive has one, and those of the loop.
            moved_position: what is added to the position that every window starts from.
            moved_velocity: what is added to the velocity there.

        Raises:
            InputError: for a value that is missing, or an inertia that is not positive.
        """
        checked(self.drive, values)
        rows, values = self._timed(values)
        inertia, parameters = self.drive.split(values)
        around = [] if self.loop is None else self.loop.values(values)
        constants = [inertia, *parameters, width_of_rest(self.recording, inertia), *around]
        declared = [state.initial for state in self.drive.model.states]
        own = [] if self.loop is None else [state.initial for state in self.loop.states]
        along = self.drive.states(self.recording, parameters) if declared and any(self._later) else ()
        position, velocity = np.empty(len(self.recording)), np.empty(len(self.recording))
        scan, stride = self._scan, PHASES * self._substeps
        for window, own_rows, later, begins in zip(self._windows, rows, self._later, self._first, strict=True):
            at = (window.start.velocity + moved_velocity, window.start.position + moved_position)
            states = [float(state[window.first]) for state in along] if later else declared
            _, outputs, done = scan([*at, *states, *own, 0.0], own_rows, constants, stride=stride)
            outputs[done // stride :] = np.nan
            outputs[~(np.abs(outputs) < _GREATEST).all(axis=1)] = np.nan
            velocity[window.predicted], position[window.predicted] = outputs.T
            if begins:
                velocity[window.first], position[window.first] = at
        return position, velocity


def _require(drive: Drive, loop: Loop | None, recording: Recording) -> None:
    said = set() if loop is None else {"motor_torque", *(["load_torque"] if loop.load else [])}
    recording.require(frozenset(drive.model.required - {*MOTION, "load_torque"} - said), drive.model.name)
    if "load_torque" in drive.model.required and not (loop is not None and loop.load):
        recording.require(frozenset({"load_torque"}), drive.model.name)
    if "velocity" not in recording:
        raise InputError(f"recording '{recording.name}' has no velocity, nor a position to derive it from")
    if loop is not None:
        for name in loop.channels:
            if name not in pushing_signals(drive, loop):
                continue
            recording.require(frozenset({name}), f"controller '{loop.name}'")
