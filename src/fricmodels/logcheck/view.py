"""A recording as the checks look at it: what several of them need, found once."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.dimension import DISPLACEMENT, Motion
from fricmodels.readers import units
from fricmodels.recording import Recording, word
from fricmodels.results.words import figures
from fricmodels.signals import segments
from fricmodels.signals.noise_level import quantum
from fricmodels.signals.one_way import goes_one_way

UNITS = {
    "time": "s",
    "torque": "{force}",
    "load_torque": "{force}",
    "velocity": "{length}/s",
    "position": "{length}",
    "acceleration": "{length}/s^2",
    "temperature": "degC",
    "current": "A",
}
"""SI unit of each channel."""
_PIECES = 16
_PIECE = 4096
"""Tests that fit something look at so many pieces of so many samples, spread over the record; a long record has no
better answer, and the time that it takes stays the same."""


@dataclass(frozen=True)
class Log:
    """A recording with what the checks share.

    Attributes:
        recording: as read.
    """

    recording: Recording

    @property
    def rotary(self) -> bool:
        """Whether the drive turns."""
        return self.recording.motion is Motion.ROTARY

    @property
    def length_unit(self) -> str:
        """``rad`` or ``m``."""
        return DISPLACEMENT.unit(self.recording.motion)

    @property
    def force_unit(self) -> str:
        """``N*m`` or ``N``, as an option writes it."""
        return "N*m" if self.rotary else "N"

    @cached_property
    def measured(self) -> dict[str, Array]:
        """Channels that were measured, without time."""
        derived = self.recording.derived | {"time"}
        return {name: values for name, values in self.recording.channels.items() if name not in derived}

    @cached_property
    def steps(self) -> Array:
        """Sampling intervals [s], shape (N − 1,)."""
        return np.diff(self.recording.time)

    @cached_property
    def joined(self) -> Mask:
        """Whether a sample and the next one belong together: one run, no gap between; shape (N − 1,)."""
        return segments.joined(self.recording.time, self.recording.run)

    @cached_property
    def usual_steps(self) -> Array:
        """The median step of the run that each step lies in [s], shape (N − 1,)."""
        return segments.usual_steps(self.recording.time, self.recording.run)

    @cached_property
    def part(self) -> Index:
        """Number of the uninterrupted stretch that each sample lies in, shape (N,)."""
        return np.cumsum(np.r_[0, ~self.joined])

    @cached_property
    def parts(self) -> list[slice]:
        """The uninterrupted stretches, in order."""
        return segments.stretches(self.recording.time, self.recording.run)

    @cached_property
    def excerpt(self) -> Recording:
        """The recording, or pieces spread over it, each a run of its own, where it is long."""
        size = len(self.recording)
        if size <= _PIECES * _PIECE:
            return self.recording
        starts = np.linspace(0, size - _PIECE, _PIECES).astype(np.int64)
        index = (starts[:, None] + np.arange(_PIECE)).ravel()
        pieces = np.repeat(np.arange(_PIECES), _PIECE)
        _, runs = np.unique(self.recording.run[index], return_inverse=True)
        recording = self.recording.select(index)
        return Recording(
            recording.name,
            recording.motion,
            recording.channels,
            (pieces * (int(runs.max()) + 1) + runs).astype(np.int64),
            recording.derived,
            recording.provenance,
        )

    @cached_property
    def short(self) -> Log:
        """The log of the excerpt; itself where that is the whole."""
        return self if self.excerpt is self.recording else Log(self.excerpt)

    @cached_property
    def resolution(self) -> dict[str, float]:
        """Step of the grid on which each measured channel stands; 0 where there is none."""
        return {name: quantum(self.excerpt.channels[name]) for name in self.measured}

    @cached_property
    def velocity(self) -> Array:
        """The measured velocity; else that of the position, over as many samples as its rounding asks for."""
        if "velocity" in self.measured:
            return self.measured["velocity"]
        return self._of_position(self._lag())

    def _of_position(self, half: int) -> Array:
        position, time = self.recording["position"], self.recording.time
        part = self.part
        index = np.arange(len(time))
        after, before = np.minimum(index + half, len(time) - 1), np.maximum(index - half, 0)
        after = np.where(part[after] == part, after, index)
        before = np.where(part[before] == part, before, index)
        span = time[after] - time[before]
        return np.asarray(np.where(span > 0, (position[after] - position[before]) / np.where(span > 0, span, 1.0), 0.0))

    def _lag(self) -> int:
        """Return half the distance [samples] at which a change of position is ten times its error, as a rule."""
        position, joined = self.excerpt["position"], self.short.joined
        third = np.diff(position, 3)[joined[2:] & joined[1:-1] & joined[:-2]]
        rounding = self.resolution["position"] / np.sqrt(12.0)
        error = max(float(np.sqrt(np.mean(third**2) / 20.0)) if len(third) else 0.0, rounding)
        half = 1
        while half < 64:
            change = np.abs(position[2 * half :] - position[: -2 * half])
            if not len(change) or np.sqrt(np.mean(change**2)) > 10.0 * np.sqrt(2.0) * error:
                break
            half *= 2
        return half

    @cached_property
    def position(self) -> Array:
        """The integral of the measured velocity, from zero on; without one, the measured position.

        Of the velocity even where the position is there, for that may be wrapped, coarse, or of another side of a gear.
        """
        return self.area(self.velocity) if "velocity" in self.measured else self.recording["position"]

    def work(self, torque: Array) -> tuple[float, float]:
        """Return the work of a torque [J] along the motion, held from each sample on or up to it, which is not known.

        By the positions themselves where these were measured: a velocity that is derived from coarse ones is smoothed,
        and of a motion of few steps it keeps next to nothing.
        """
        change = np.where(self.joined, np.diff(self.position), 0.0)
        return float(torque[:-1] @ change), float(torque[1:] @ change)

    def area(self, values: Array) -> Array:
        """Return the integral of a signal over time, from zero; over gaps it stands still."""
        steps = np.where(self.joined, 0.5 * (values[1:] + values[:-1]) * self.steps, 0.0)
        return np.asarray(np.r_[0.0, np.cumsum(steps)])

    @cached_property
    def one_way(self) -> bool:
        """Whether the drive hardly ever turns back: there a constant torque and Coulomb friction are the same."""
        return goes_one_way(self.velocity)

    def called(self, channel: str) -> str:
        """Return how a channel is called in a sentence: its name, and its column if it has another name."""
        columns = self.recording.provenance.get("columns", {})
        named = word(channel, self.recording.motion)
        if channel == "torque" and "torque" not in columns and "current" in columns:
            return f"{named} ({columns['current']})"
        return f"{named} ({columns[channel]})" if channel in columns else named

    def column(self, channel: str) -> tuple[str, str]:
        """Return the column of a channel and the unit that it was read in, empty where none was given."""
        written = str(self.recording.provenance.get("columns", {}).get(channel, f"{channel}=COLUMN"))
        column, _, unit = written.partition("=")[2].rpartition(":")
        return (column, unit) if column and units.known(unit) else (written.partition("=")[2], "")

    def factor(self, channel: str) -> float:
        """Return how much SI is one of the unit that a channel was read in."""
        given = self.column(channel)[1]
        if self.recording.motion not in (units.fits(given, channel) if given else ()):
            return 1.0
        return units.conversion(given, channel, self.recording.motion).factor

    def option(self, channel: str, unit: str) -> str:
        """Return the option that reads a channel in another unit, quoted for a shell."""
        return "--column " + shlex.quote(f"{channel}={self.column(channel)[0]}:{unit}")

    def exchanged(self, one: str, other: str) -> str:
        """Return the options that read each of two channels from the other's column."""
        pairs = ((one, other), (other, one))
        return " ".join("--column " + shlex.quote(f"{channel}={self.column(of)[0]}") for channel, of in pairs)

    def turned(self, channel: str) -> str:
        """Return the option that turns the sign of a channel."""
        unit = self.column(channel)[1] or UNITS[channel].format(length=self.length_unit, force=self.force_unit)
        return self.option(channel, unit.removeprefix("-1 ") if unit.startswith("-1 ") else f"-1 {unit}")

    def unit(self, channel: str) -> str:
        """Return the SI unit of a channel, as it is printed."""
        written = UNITS.get(channel) or self.recording.units.get(channel, "")
        return written.format(length=self.length_unit, force=self.force_unit).replace("*", " ")

    def size(self, channel: str, value: float) -> str:
        """Return a value of a channel with its unit: in that of its column first, where that is another."""
        plain = f"{figures(value, 4)} {self.unit(channel)}".rstrip()
        if channel not in UNITS:
            return plain
        given = self.column(channel)[1].removeprefix("-1 ")
        if self.recording.motion not in units.fits(given, channel):  # none, or one of a current
            return plain
        factor = units.conversion(given, channel, self.recording.motion).factor
        times = " × " if given[:1].isdigit() else " "
        return plain if abs(factor - 1.0) < 1e-12 else f"{figures(value / factor, 4)}{times}{given} ({plain})"
