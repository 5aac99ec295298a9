"""A case: a drive, its motion, what is hidden in it, and what its sensors do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from logs.makes import Make
from logs.motions import Motion, Signal

Kind = Literal["clean", "one", "several", "unlisted"]
KINDS: tuple[Kind, ...] = ("clean", "one", "several", "unlisted")


@dataclass(frozen=True)
class Sensors:
    """What is logged otherwise than exactly, or otherwise than the make does.

    Attributes:
        torque: the motor's at the sample, its command, or its mean until the next sample.
        torque_low_pass: corner of a first-order low-pass of the torque [Hz]; 0 is none.
        torque_clip: largest torque that is logged; 0 is any.
        torque_gain: true torque over the one that is logged.
        motion_delay: of position and speed behind the torque [s].
        stamps: ``polled`` samples at moments that wander by a quarter of the interval, and says so; ``late`` writes the
            time some moments after the sample, by a tenth of the interval.
        log_rate, speed_low_pass, resolution, bandwidth: in place of those of the make.
    """

    torque: Literal["actual", "command", "mean"] = "actual"
    torque_low_pass: float = 0.0
    torque_clip: float = 0.0
    torque_gain: float = 1.0
    motion_delay: float = 0.0
    stamps: Literal["exact", "polled", "late"] = "exact"
    log_rate: float | None = None
    speed_low_pass: float | None = None
    resolution: float | None = None
    bandwidth: float | None = None


@dataclass(frozen=True)
class Case:
    """One recording.

    Attributes:
        number: from which its random numbers come; no other case has it.
        name: by which it is asked for.
        make, motion, seconds: what moves, how, and how long.
        kind: whether nothing is hidden, one effect of the list, several, or (also) a cause that no list has.
        there: the true causes, each with the names that nobody could tell from it in this recording.
        beside: names that are there too, though nobody asks for them.
        cause: what no list has, in words.
        hidden: fields of :class:`logs.plant.Plant` that are changed.
        friction, viscous: factors of dry and of viscous friction over time.
        disturbance: torque of something that is not recorded.
        load: known load, which is logged.
        temperature: whether the oil's is logged.
        inertia_told: inertia that is told over the true one; nothing where it is not told.
        position_loop: whether a position is controlled, or a speed.
        sensors: what they do.
    """

    number: int
    name: str
    make: Make
    motion: Motion
    seconds: float
    kind: Kind
    there: tuple[tuple[str, ...], ...] = ()
    beside: tuple[str, ...] = ()
    cause: str = ""
    hidden: Mapping[str, float] = field(default_factory=dict)
    friction: Signal | None = None
    viscous: Signal | None = None
    disturbance: Signal | None = None
    load: Signal | None = None
    temperature: bool = False
    inertia_told: float | None = 1.0
    position_loop: bool = True
    sensors: Sensors = Sensors()

    @property
    def truth(self) -> str:
        """What is hidden, in words."""
        return " + ".join([*(" or ".join(names) for names in self.there), *([self.cause] if self.cause else [])])
