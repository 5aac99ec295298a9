"""One recording: named channels in SI units over sample times, and where they came from."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmodels.arrays import Array, Index, rms
from fricmodels.dimension import (
    ACCELERATION,
    DIMENSIONLESS,
    DISPLACEMENT,
    FORCE,
    TEMPERATURE,
    TIME,
    VELOCITY,
    Dimension,
    Motion,
    Scales,
)
from fricmodels.display import Displayed
from fricmodels.errors import InputError
from fricmodels.results.words import lacks

CHANNELS: Mapping[str, Dimension] = {
    "time": TIME,
    "torque": FORCE,
    "velocity": VELOCITY,
    "position": DISPLACEMENT,
    "acceleration": ACCELERATION,
    "load_torque": FORCE,
    "temperature": TEMPERATURE,
    "current": DIMENSIONLESS,
    "torque_rate": FORCE * TIME**-1,
}
"""The channels that a recording may have. On a linear axis ``torque`` and ``load_torque`` are forces."""

SIGNAL_CHANNEL: Mapping[str, str] = {
    "velocity": "velocity",
    "position": "position",
    "acceleration": "acceleration",
    "motor_torque": "torque",
    "motor_torque_rate": "torque_rate",
    "load_torque": "load_torque",
    "temperature": "temperature",
    "time": "time",
}
"""Signal of a term → channel that measures it."""


OTHER = "other."
"""What the names of further channels begin with: another joint's acceleration is ``other.j2_acceleration``."""

RATE = "rate of "
"""What the name of a signal begins with that is the rate of a further channel, as ``rate of other.j2_velocity``."""

_COUNTS = 1e-6
"""Share of the sampling interval from which the rounding of stamps to floats counts."""
_FOUND_IN = {"run_numbers": None, "interval": "time", "rounding_of_time": "time", "peak_speed": "velocity"}
"""What is found once of a recording, and the channel whose change changes it."""

RUN = "run"
"""The number of the run that a sample was recorded in, as a signal of a term."""


def channel_of(signal: str) -> str:
    """Return the channel that measures a signal; a further channel measures itself."""
    return SIGNAL_CHANNEL.get(signal, signal)


def word(channel: str, motion: Motion) -> str:
    """Return what a channel is called in a sentence: the ``torque`` of a linear axis is a force."""
    text = channel.replace("_", " ")
    return text.replace("torque", "force") if motion is Motion.LINEAR else text


@dataclass(frozen=True)
class Origin:
    """The recording that another one was cut from: what remembers does so through what was cut out.

    Attributes:
        whole: the recording before it was cut.
        index: place of each sample in it, shape (N,).
    """

    whole: Recording
    index: Index


@dataclass(frozen=True, repr=False)
class Recording(Displayed):
    """Measured (or simulated) motion of one drive under a known torque.

    Attributes:
        name: what it is called in leaderboards.
        motion: rotary or linear.
        channels: arrays of equal length N in SI units (rad or m, N m or N, s, °C as measured); ``time`` and ``torque``
            are always there. Further ones, such as other joints', are called ``other.NAME``; see :attr:`units`.
        run: run number of each sample, shape (N,); time increases within a run, and nothing connects two runs.
        derived: names of channels that were computed, not measured.
        provenance: source file, column mapping, checksum of the file, true parameters of a simulation, …
        origin: what it was cut from, if that is to be remembered; see :meth:`remembering`.
        units: SI unit of each further channel, by its name with ``other.``; empty where none was given.
        derived_over: half width [samples] of the differentiator that gave the velocity from the position; 0 where none
            did.
        reference_torque: what errors are told in percent of where the motor has no torque [N m or N]; see
            :func:`fricmodels.signals.coasting.coasting`.
    """

    name: str
    motion: Motion
    channels: Mapping[str, Array]
    run: Index
    derived: frozenset[str] = frozenset()
    provenance: Mapping[str, Any] = field(default_factory=dict)
    origin: Origin | None = field(default=None, compare=False)
    derived_over: int = 0
    units: Mapping[str, str] = field(default_factory=dict)
    reference_torque: float = 0.0

    def __post_init__(self) -> None:
        for required in ("time", "torque"):
            if required not in self.channels:
                raise InputError(f"recording '{self.name}' has no channel '{required}'")
        sizes = {name: np.shape(values) for name, values in self.channels.items()}
        if len({*sizes.values(), self.run.shape}) != 1:
            raise InputError(f"recording '{self.name}' has channels of different lengths: {sizes}")
        if self.origin is not None and self.origin.index.shape != self.run.shape:
            raise ValueError(f"recording '{self.name}' has {len(self.run)} samples, its origin another number")

    def __len__(self) -> int:
        return len(self.time)

    def __contains__(self, channel: object) -> bool:
        return channel in self.channels

    def measures(self, channel: str) -> bool:
        """Whether a channel is there, and was not computed from others."""
        return channel in self.channels and channel not in self.derived

    def __getitem__(self, channel: str) -> Array:
        try:
            return self.channels[channel]
        except KeyError:
            known = ", ".join(self.channels)
            raise InputError(f"recording '{self.name}' has no channel '{channel}'; it has {known}") from None

    @property
    def time(self) -> Array:
        """Sample times [s]."""
        return self.channels["time"]

    @property
    def torque(self) -> Array:
        """Motor torque [N m], or drive force [N]."""
        return self.channels["torque"]

    @property
    def velocity(self) -> Array:
        """Velocity [rad/s or m/s]."""
        return self["velocity"]

    @cached_property
    def rms_torque(self) -> float:
        """RMS motor torque [N m or N], in percent of which errors are told; where it is 0, :attr:`reference_torque`."""
        return rms(self.torque) or self.reference_torque

    @property
    def load_torque(self) -> Array:
        """Known load torque [N m or N], zero where none was given."""
        known = self.channels.get("load_torque")
        return np.zeros(len(self)) if known is None else known

    @property
    def driving_torque(self) -> Array:
        """Motor torque less known load torque [N m or N]."""
        known = self.channels.get("load_torque")
        return self.torque if known is None else self.torque - known

    def signal(self, name: str) -> Array:
        """Return the channel that measures a term's signal.

        A load that was not given is zero; a rate that was not given is the central difference; the run is that of the
        recording before it was cut.

        Raises:
            InputError: when the recording does not have it.
        """
        if name == "load_torque":
            return self.load_torque
        if name == "motor_torque_rate" and "torque_rate" not in self.channels:
            return self._torque_rate
        if name == RUN and RUN not in self.channels:
            return (self.run if self.origin is None else self.origin.whole.run[self.origin.index]).astype(float)
        if name.startswith(RATE) and name not in self.channels:
            return self._rate(self[name.removeprefix(RATE)])
        return self[channel_of(name)]

    @property
    def further(self) -> tuple[str, ...]:
        """The further channels, in order of their names."""
        return tuple(sorted(name for name in self.channels if name.startswith(OTHER)))

    @cached_property
    def _torque_rate(self) -> Array:
        return self._rate(self.torque)

    def _rate(self, values: Array) -> Array:
        if len(self) > 1 and len(self.run_numbers) == 1:
            return _gradient(values, self.time)
        rate = np.zeros(len(self))
        for number in self.run_numbers:
            inside = np.flatnonzero(self.run == number)
            if len(inside) > 1:
                rate[inside] = _gradient(values[inside], self.time[inside])
        return rate

    def retimed(self, delay: float) -> Recording:
        r"""Return the record with its torques at the time of its motion: as they were T before.

        .. math:: T > 0:\ \tau_m(t - T),\ \tau_L(t - T), \qquad T < 0:\ \tau_m(t - T),\ \tau_L(t)

        With T > 0 the motion was recorded late, after both torques; with T < 0 the motor torque was, after load torque
        and motion. Between samples torques are straight lines, beyond the ends of a run constant. The torque rate
        becomes that of what is shifted.

        Args:
            delay: T [s].
        """
        channels = {name: self._before(name, delay, self) for name in self._late(delay)}
        shifted = self.with_channels(derived=False, **channels)
        pushing = shifted.with_channels(torque=shifted.torque - channels.get("load_torque", 0.0))
        return shifted.with_channels(torque_rate=pushing._torque_rate)

    def change_over(self, delay: float, at: Recording) -> Array:
        r"""Return by how much what pushes the drive, :math:`\tau_m - \tau_L`, differs from that of the retimed record.

        Args:
            delay: T [s]; see :meth:`retimed`.
            at: samples at which it is wanted, of the same runs.
        """
        change = np.zeros(len(at))
        for name, sign in zip(self._late(delay), (1, -1), strict=False):
            change += sign * (at.channels[name] - self._before(name, delay, at))
        return change

    def _late(self, delay: float) -> list[str]:
        return ["torque", *(["load_torque"] if delay > 0 and "load_torque" in self else [])]

    def _before(self, name: str, delay: float, at: Recording) -> Array:
        order, numbers, first, last = self._one_after_another
        # On an axis on which every run begins where the one before has ended.
        shift = np.cumsum(last - first + 1.0) - last
        of, wanted = (np.searchsorted(numbers, run) for run in (self.run[order], at.run))
        time = np.clip(at.time - delay, first[wanted], last[wanted]) + shift[wanted]
        return np.asarray(np.interp(time, self.time[order] + shift[of], self.channels[name][order]))

    @cached_property
    def _one_after_another(self) -> tuple[Index, Index, NDArray[Any], NDArray[Any]]:
        """Samples in order of their runs, the numbers of the runs, and when each begins and ends."""
        order = np.argsort(self.run, kind="stable")
        numbers, first, count = np.unique(self.run[order], return_index=True, return_counts=True)
        return order, numbers, self.time[order[first]], self.time[order[first + count - 1]]

    def require(self, signals: frozenset[str], wanted_by: str) -> None:
        """Check that every signal that a model touches is there.

        Raises:
            InputError: naming the missing channel. A term that uses the load torque needs one that was given.
        """
        for signal in sorted(signals):
            channel = channel_of(signal).removeprefix(RATE)
            if signal in ("motor_torque_rate", RUN):
                continue
            if channel not in self.channels:
                raise InputError(
                    f"'{wanted_by}' needs the channel '{channel}', {lacks(channel, self.name)} or leave that model out"
                )

    def select(self, mask: NDArray[Any] | slice, name: str | None = None) -> Recording:
        """Return the samples that a boolean mask, an index array or a slice picks."""
        return replace(
            self,
            name=name or self.name,
            channels={key: values[mask] for key, values in self.channels.items()},
            run=self.run[mask],
            origin=self.origin and replace(self.origin, index=self.origin.index[mask]),
        )

    def remembering(self) -> Recording:
        """Return the recording such that what is selected from it knows the whole.

        Internal states of a model are then those of the whole motion, and do not begin anew at every cut.
        """
        return replace(self, origin=Origin(self, np.arange(len(self))))

    def whole(self) -> Recording:
        """Return what the recording was cut from, with its own samples as they are now; itself if it was not cut."""
        if self.origin is None:
            return self
        whole, index = self.origin.whole, self.origin.index
        channels = {}
        for name in whole.channels.keys() & self.channels.keys():
            channels[name] = whole[name].copy()
            channels[name][index] = self[name]
        return replace(whole, channels=channels)

    def with_channels(self, *, derived: bool = True, **channels: Array) -> Recording:
        """Return a copy with channels added or replaced."""
        marked = self.derived | set(channels) if derived else self.derived - set(channels)
        copy = replace(self, channels={**self.channels, **channels}, derived=frozenset(marked))
        same = {name for name, channel in _FOUND_IN.items() if channel not in channels} & self.__dict__.keys()
        copy.__dict__.update({name: self.__dict__[name] for name in same})
        return copy

    def scaled(self, scales: Scales) -> Recording:
        """Return the recording in normalised units: each channel divided by the size of its dimension."""
        channels = {
            name: values / scales.of(CHANNELS.get(name, DIMENSIONLESS)) for name, values in self.channels.items()
        }
        origin = self.origin and replace(self.origin, whole=self.origin.whole.scaled(scales))
        torque = self.reference_torque / scales.of(CHANNELS["torque"])
        return replace(self, channels=channels, origin=origin, reference_torque=torque)

    def runs(self) -> Iterator[Recording]:
        """Yield each run on its own, in order of run number."""
        for number in self.run_numbers:
            yield self.select(self.run == number)

    @cached_property
    def run_numbers(self) -> Index:
        """The numbers of the runs, ascending."""
        first = self.run[:1]
        return first if bool((self.run == first).all()) else np.unique(self.run)

    @cached_property
    def interval(self) -> float:
        """Median sampling interval within runs [s]; where stamps are rounded to floats that count, the mean of it."""
        steps = np.diff(self.time)[np.diff(self.run) == 0]
        if not len(steps):
            return float("nan")
        middle, rounding = float(np.median(steps)), self.rounding_of_time
        if rounding > _COUNTS * middle:
            return float(np.mean(steps[np.abs(steps - middle) <= 2.0 * rounding]))
        return middle

    @cached_property
    def rounding_of_time(self) -> float:
        """Distance of two floats at the largest time stamp [s]: seconds since 1970 are known to 0.24 µs."""
        return float(np.spacing(np.abs(self.time).max(initial=0.0)))

    @cached_property
    def peak_speed(self) -> float:
        """Largest speed [rad/s or m/s]; 0 without a velocity."""
        return float(np.max(np.abs(self.channels["velocity"]), initial=0.0)) if "velocity" in self.channels else 0.0

    @cached_property
    def checksum(self) -> str:
        """SHA-256 over channel names, values and runs: equal recordings have equal checksums."""
        digest = hashlib.sha256(self.motion.encode())
        for name in sorted(self.channels):
            digest.update(name.encode())
            digest.update(np.ascontiguousarray(self.channels[name], dtype="<f8").tobytes())
        digest.update(np.ascontiguousarray(self.run, dtype="<i8").tobytes())
        return digest.hexdigest()


def check_recording(given: object) -> None:
    """Refuse what is no recording, such as the name of its file.

    Raises:
        InputError: saying how a file is read.
    """
    if isinstance(given, Recording):
        return
    from os import PathLike

    way_out = f"read the file first: fricmodels.read({str(given)!r})" if isinstance(given, str | PathLike) else ""
    raise InputError(
        f"a recording is wanted, got {type(given).__name__}; {way_out or 'fricmodels.read(FILE) gives one'}"
    )


def _gradient(values: Array, time: Array) -> Array:
    """Return the rate of values; 0 where they stand, which on uneven stamps would be rounding."""
    stands = np.diff(values) == 0.0
    return np.where(np.append(stands, True) & np.append(True, stands), 0.0, np.gradient(values, time))
