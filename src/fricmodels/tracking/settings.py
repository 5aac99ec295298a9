"""The controller of the rig, as it is asked for: a PD at a fixed rate, late, with an encoder that counts."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fricmodels.dimension import Motion
from fricmodels.documents import NotNegative, Positive, first_problem
from fricmodels.errors import InputError
from fricmodels.rig.closed_loop import Control

_LATE = 0.25
"""Angle [rad] by which all delays together may turn the phase at the bandwidth: a margin of about 45° is left."""
_FILTER = 10.0
"""Corner of the velocity's low-pass over the bandwidth."""
_COUNTS = 256
"""Counts of the encoder in a sample at full speed, at least, where its step is not given."""


class Settings(BaseModel):
    """How a drive is controlled and moved; what is left out follows from the drive.

    ``rate`` [Hz]; ``delay`` in samples, from reading the encoder to the torque; ``bandwidth`` [Hz] of the controlled
    position, at most what the delays allow and the excitation of the rig has; ``encoder_step`` [rad or m], 0 for a
    perfect encoder. ``at`` says where friction is compensated: along the reference, or at the measured motion, where
    ``at_rest`` and ``turn`` (a share of the reference's peak speed) say how.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    rate: Positive = 1000.0
    delay: Annotated[float, Field(ge=0, le=50)] = 1.0
    bandwidth: Positive | None = None
    damping_ratio: Positive = 0.8
    encoder_step: NotNegative | None = None
    at: Literal["reference", "measured"] = "reference"
    at_rest: Literal["none", "reference", "smooth"] = "reference"
    turn: Positive = 0.02
    motion: Literal["both", "multisine", "trapezoid"] = "both"
    seed: Annotated[int, Field(ge=0)] = 0

    def widest(self) -> float:
        """Return the greatest bandwidth [Hz] that the delays allow.

        Reading to torque, half a sample of hold, half a sample of differencing, and the velocity's low-pass together
        turn the phase at the bandwidth by 0.25 rad.
        """
        late = (self.delay + 1.0) / self.rate
        return (_LATE - 1 / _FILTER) / late / (2 * math.pi)

    def step(self, peak: float, motion: Motion) -> float:
        """Return the encoder's step: as given, or a whole fraction of a turn (of a metre) that shows the peak speed."""
        if self.encoder_step is not None:
            return self.encoder_step
        whole = 2 * math.pi if motion is Motion.ROTARY else 1.0
        return float(whole * 2.0 ** math.floor(math.log2(peak / self.rate / _COUNTS / whole)))

    def control(self, inertia: float, bandwidth: float, step: float) -> Control:
        """Return the controller of a drive: gains from the stated inertia, bandwidth and damping ratio."""
        natural = 2 * math.pi * bandwidth
        return Control(
            interval=1 / self.rate,
            delay=self.delay / self.rate,
            proportional=inertia * natural**2,
            derivative=2 * self.damping_ratio * inertia * natural,
            smoothing=-math.expm1(-_FILTER * natural / self.rate),
            encoder_step=step,
        )


def settings_of(**given: object) -> Settings:
    """Return settings from options.

    Raises:
        InputError: for a value out of range, naming the option.
    """
    try:
        return Settings.model_validate(given)
    except ValidationError as error:
        raise InputError(first_problem(error, Settings).replace("key '", "option '--").replace("_", "-")) from None
