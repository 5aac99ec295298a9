"""What the figures of a comparison share: every sample in order, its error, and its friction torque."""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fricmodels.arrays import Array, Mask
from fricmodels.dimension import FORCE, Motion
from fricmodels.once import once
from fricmodels.processes import give_back
from fricmodels.recording import RUN, Recording
from fricmodels.report.figures.style import label, unit_of, words
from fricmodels.score.holding import holding_interval, unseen_at_rest

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.drive import Drive


_Pieces: TypeAlias = tuple[tuple[bool, slice], ...]

_joined_before: weakref.WeakValueDictionary[tuple[int, int], _Joined] = weakref.WeakValueDictionary()


@dataclass(frozen=True, eq=False)
class _Joined:
    """The two parts of a recording put together again; all models of a ladder share it.

    Attributes:
        train, test: the parts.
        recording, place, consecutive, kept_back, velocity, resting: as of :class:`Samples`.
        pieces: what follows one another in the whole: whether it was kept back, and where it stands in its part.
    """

    train: Recording
    test: Recording
    recording: Recording
    place: Array
    consecutive: bool
    kept_back: Mask
    velocity: Array
    resting: Mask
    pieces: _Pieces

    @classmethod
    def of(cls, train: Recording, test: Recording) -> _Joined:
        """Join two parts, once for all models of them."""
        key = (id(train), id(test))
        known = _joined_before.get(key)  # it holds the parts: as long as it is there, so are their numbers
        if known is None:
            known = _joined_before[key] = _together(train, test)
        return known

    def in_order(self, train: Array, test: Array) -> Array:
        """Return what was found of each sample of the two parts, in the order of the whole, shape (N,)."""
        return _in_order(self.pieces, train, test)


@dataclass(frozen=True)
class Samples:
    """Samples of a comparison, what was fitted and what was kept back together.

    Attributes:
        comparison: where they come from.
        joined: its two parts in the order of the whole.
        recording: all channels, in order; ``run`` numbers uninterrupted pieces.
        place: time on the axis of a figure; runs whose times overlap stand one after another.
        consecutive: whether they do.
        kept_back: which samples took no part in the fit.
        error: torque error over the window of the headline; see :func:`fricmodels.score.torque_error_over`.
        smoothed_error: torque error over a window as wide as the noise asks for, so that a figure shows what happens
            fast where that is seen; see :func:`fricmodels.score.filtered_torque_error`.
        velocity: freed of noise, zero at rest.
        resting: samples at rest.
    """

    comparison: Comparison
    joined: _Joined

    @cached_property
    def error(self) -> Array:
        """Torque error over the window of the headline."""
        from fricmodels.score import headline_window, torque_error_over

        train, test = self.joined.train, self.joined.test
        window = headline_window(train, self.drive.inertia)
        found = [torque_error_over(self.drive, self.parameters, part, window) for part in (train, test)]
        give_back(len(self.recording))
        return self.joined.in_order(*found)

    @cached_property
    def smoothed_error(self) -> Array:
        """Torque error over a window as wide as the noise asks for."""
        from fricmodels.score import filtered_torque_error, sliding_half_width

        train, test = self.joined.train, self.joined.test
        width = sliding_half_width(train)
        found = [filtered_torque_error(self.drive, self.parameters, part, width) for part in (train, test)]
        give_back(len(self.recording))
        return self.joined.in_order(*found)

    @staticmethod
    @once
    def of(comparison: Comparison) -> Samples:
        """Return the samples of a comparison, the same for all its figures; what these need is evaluated once."""
        # The samples hold what they need of the comparison, not the comparison itself, or it would never be freed.
        return Samples(replace(comparison), _Joined.of(comparison.train, comparison.test))

    @property
    def recording(self) -> Recording:
        """All channels, in order."""
        return self.joined.recording

    @property
    def place(self) -> Array:
        """Time on the axis of a figure."""
        return self.joined.place

    @property
    def consecutive(self) -> bool:
        """Whether runs stand one after another."""
        return self.joined.consecutive

    @property
    def kept_back(self) -> Mask:
        """Samples that took no part in the fit."""
        return self.joined.kept_back

    @property
    def velocity(self) -> Array:
        """Velocity freed of noise, zero at rest."""
        return self.joined.velocity

    @property
    def resting(self) -> Mask:
        """Samples at rest."""
        return self.joined.resting

    @property
    def drive(self) -> Drive:
        """The model and its motion."""
        return self.comparison.drive

    @property
    def parameters(self) -> Mapping[str, float]:
        """Estimated parameters by key."""
        return self.comparison.estimate.parameters

    @property
    def motion(self) -> Motion:
        """Rotary or linear."""
        return self.recording.motion

    @property
    def subtitle(self) -> str:
        """Recording and model."""
        return f"{self.recording.name}: {self.drive.model.name}"

    @cached_property
    def friction_drive(self) -> Drive:
        """The part of the model that is friction: the law, and the effects whose equation has the velocity in it."""
        from fricmodels.drive import Drive
        from fricmodels.model import Model

        model = self.drive.model
        kept = [effect for effect in model.effects if "velocity" in Model.only(effect).needs]
        return Drive(Model(model.law, kept), self.drive.inertia, self.drive.motion)

    @property
    def modelled_friction(self) -> Array:
        """Friction torque of the model at every sample; at rest the one nearest to what is applied."""
        drive = self.friction_drive
        moving = self.recording.with_channels(velocity=self.velocity)
        friction = drive.friction(moving, self.parameters)
        if self.resting.any():
            still = self.resting
            held = holding_interval(drive, moving, self.parameters, way=unseen_at_rest(drive, self.recording))
            least, greatest = (limit[still] for limit in held)
            friction[still] = np.clip(moving.driving_torque[still], least, greatest)
        return friction

    @property
    def measured_friction(self) -> Array:
        """Measured torque less every part of the model that is not friction: the model's friction plus the error.

        Known in regression as partial residuals (component plus residual). The error is filtered alike on both sides
        of the torque equation, so that no differentiated noise and no smeared reversal is added.
        """
        friction = self.modelled_friction
        friction += self.smoothed_error
        return friction

    @property
    def torque_unit(self) -> str:
        """``N m`` or ``N``."""
        return unit_of(FORCE, self.motion)

    def axis(self, channel: str) -> str:
        """Return the title of an axis that shows a channel."""
        return label(words(channel, self.motion), unit_of(channel, self.motion))

    def unit(self, channel: str) -> str:
        """Return the printed unit of a channel."""
        return unit_of(channel, self.motion)

    def torque_axis(self, what: str) -> str:
        """Return the title of an axis that shows a torque: ``friction torque [N m]``, ``friction force [N]``."""
        return label(words(what, self.motion), self.torque_unit)

    @property
    def time_axis(self) -> str:
        """Title of the axis of :attr:`place`."""
        return label("time, runs one after another" if self.consecutive else "time", "s")


def _in_order(pieces: _Pieces, train: NDArray[Any], test: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([(test if later else train)[piece] for later, piece in pieces])


def _cut_from(train: Recording, test: Recording, pieces: _Pieces) -> Recording | None:
    """Return the recording of which pieces of two parts are all samples, in its order; its arrays are not copied."""
    if train.origin is None or test.origin is None or train.origin.whole is not test.origin.whole:
        return None
    whole, names = train.origin.whole, [name for name in train.channels if name in test]
    if len(train) + len(test) != len(whole) or any(name not in whole for name in train.channels):
        return None
    begin = 0
    for later, piece in pieces:
        part, index = (test, test.origin.index) if later else (train, train.origin.index)
        there = slice(begin, begin + piece.stop - piece.start)
        if not np.array_equal(index[piece], np.arange(there.start, there.stop)):
            return None
        if not all(np.array_equal(whole[name][there], part[name][piece]) for name in names):
            return None
        begin = there.stop
    return whole


def _together(train: Recording, test: Recording) -> _Joined:
    """Put two parts of a recording together again, by time where that says the order."""
    from fricmodels.signals import resting, smoothed_velocity, stretches

    parts = [*((train, False, piece) for piece in stretches(train.time, train.run))]
    parts += [(test, True, piece) for piece in stretches(test.time, test.run)]
    starts = np.array([part.time[piece.start] for part, _, piece in parts])
    stops = np.array([part.time[piece.stop - 1] for part, _, piece in parts])
    by_time = np.argsort(starts, kind="stable")
    consecutive = bool(np.any(starts[by_time][1:] < stops[by_time][:-1]))
    chosen = np.arange(len(parts)) if consecutive else by_time
    pieces: _Pieces = tuple(parts[i][1:] for i in chosen)
    sizes = np.array([piece.stop - piece.start for _, piece in pieces])
    whole = _cut_from(train, test, pieces)
    channels = {
        name: _in_order(pieces, train[name], test[name]) if whole is None else whole[name]
        for name in train.channels
        if name in test
    }
    if whole is not None and RUN not in whole and len(whole.run_numbers) == 1:  # one number for all samples
        channels[RUN] = np.broadcast_to(whole.run[:1].astype(float), len(whole))
    else:
        channels[RUN] = _in_order(pieces, train.signal(RUN), test.signal(RUN))
    run = np.repeat(np.arange(len(pieces)), sizes)
    recording = Recording(train.name, train.motion, channels, run, derived=train.derived, units=train.units)
    place = recording.time
    if consecutive:
        lengths = stops - starts + train.interval
        place = place + np.repeat(np.cumsum(lengths) - lengths - starts, sizes)
    still = _in_order(pieces, resting(train), resting(test))
    velocity = _in_order(pieces, smoothed_velocity(train)[0], smoothed_velocity(test)[0])
    velocity[still] = 0.0
    kept_back = np.repeat([later for later, _ in pieces], sizes)
    return _Joined(train, test, recording, place, consecutive, kept_back, velocity, still, pieces)
