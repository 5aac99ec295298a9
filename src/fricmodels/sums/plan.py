"""What the rows of sums are: laid down once, so that sums of different files can be added."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, PositiveInt

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording, channel_of
from fricmodels.signals import lanczos_derivative, quantum, standstill, velocity_noise
from fricmodels.signals.beginnings import with_true_beginnings
from fricmodels.signals.coasting import coasting
from fricmodels.signals.counted import step_of_counts
from fricmodels.signals.creeping import creeping_speed
from fricmodels.signals.lanczos import even_weights
from fricmodels.weakform.estimate import estimate
from fricmodels.weakform.kinks import share_of_kinks
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.test_functions import HOPS
from fricmodels.weakform.unclear import CERTAIN, creeping

_SIGNALS = frozenset({"velocity", "position", "load_torque", "temperature"})
"""Signals that stand in a block of samples by themselves."""

Size = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class Plan(BaseModel):
    """What the rows of sums are.

    Attributes:
        model: name of a model that is linear in its parameters. motion: rotary or linear.
        interval: sampling interval [s]; a new stretch begins where a fit sees a gap.
        width: samples that a test function spans. half_width: of the filter that smooths the velocity.
        derived_over: half width of the differentiator where the velocity comes from the position; 0 where it does not.
        error: standard error of the smoothed velocity. slow: speed at which the direction of motion is not certain.
        standstill: speed below which the smoothed velocity is zero.
        peak: largest speed of the recording that the plan was made from.
        friction: parameters of a first fit, which tell where a drive may stick between two samples.
        row_noise: mean square that noise of the velocity adds to ∫φ dω of a row.
        counts: velocity of one count to a sample, where the position is the sum of them; 0 where it is not.
        wrap: period by which the recorded position jumps back; 0 where it does not.
        jump: by how much the motor torque jumps with the sign of the velocity; see :mod:`fricmodels.weakform.jumps`.
        creep: speed up to which the drive may creep; see :mod:`fricmodels.signals.creeping`.
        kinks: share of what smoothing takes away at reversals that is given back; see :mod:`fricmodels.weakform.kinks`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    model: str
    motion: Motion
    interval: PositiveFloat
    width: PositiveInt
    half_width: PositiveInt
    derived_over: Annotated[int, Field(ge=0)]
    error: Size
    slow: Size
    standstill: Size
    peak: PositiveFloat
    friction: dict[str, float]
    row_noise: Size
    counts: Size = 0.0
    wrap: Size = 0.0
    jump: float = 0.0
    kinks: Size = 0.0
    creep: Size = 0.0

    @property
    def hop(self) -> int:
        """Samples from one test function to the next."""
        return self.width // HOPS

    @property
    def drive(self) -> Drive:
        """The model, its inertia not given: the sums serve both."""
        return _drive(self.model, self.motion)

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that the rows are made of, beside a load torque that a file may have."""
        moved = "position" if self.derived_over and not self.counts else "velocity"
        needed = {channel_of(signal) for signal in self.drive.model.needs} - {"velocity"}
        needed -= {"position"} if self.counts else set()
        return tuple(sorted({"time", "torque", moved, *needed}))


@lru_cache(maxsize=32)
def _drive(model: str, motion: Motion) -> Drive:
    return Drive(linear_model(model), None, motion)


def linear_model(name: str) -> Model:
    """Return a model by name.

    Raises:
        InputError: where sums cannot say all that it asks of a recording.
    """
    model = Model.parse(name)
    for curved in model.nonlinear_parameters:
        raise InputError(
            f"'{name}' is not linear in '{curved.key}', so that no sums can stand for a recording; "
            f"fit it without sums, or take a law that is linear in its parameters, such as coulomb-viscous"
        )
    further = sorted(model.needs - _SIGNALS)
    if model.states or model.delay or further:
        what = "a memory" if model.states else f"'{further[0] if further else 'delay'}'"
        raise InputError(f"'{name}' needs {what}, which sums over blocks of samples do not have; fit it without sums")
    return model


def plan_for(recording: Recording, model: str, inertia: float | None = None) -> Plan:
    """Return what the rows of sums are, from one recording: as a fit of it in weak form has them.

    Width of the test functions, smoothing and the noise of the velocity are this recording's, as is the friction that
    tells where the drive may stick at a reversal.

    Args:
        recording: of the same kind of drive and sampling as all that will be summed.
        model: name of a model that is linear in its parameters.
        inertia: where it is known [kg m² or kg]; it is estimated if not. The sums serve both.

    Raises:
        InputError: where the model is not linear, the recording moves too little, or a channel has no sign.
    """
    linear_model(model)
    for channel, register in recording.provenance.get("registers", {}).items():
        raise InputError(
            f"the {channel} was written without its sign, as a register of {register}; sums read blocks as they are: "
            f"write it with its sign, or fit without sums"
        )
    prepared = ready(coasting(recording, inertia))
    drive = Drive(linear_model(model), inertia, prepared.motion)
    problem, found = estimate(drive, prepared, model_velocity=False)
    part, width = problem.recording, problem.half_width
    smooth, _ = lanczos_derivative(part.time, part.velocity, width, part.run)
    rounding = 8.0 * float(np.spacing(np.abs(part.velocity).max()))
    still = standstill(smooth)
    error = max(float(velocity_noise(part).after(even_weights(width)[0])), rounding, still / CERTAIN)
    steps = 0.0 if part.derived_over else 1.01 * quantum(part.velocity)
    limits, slow = drive.sticking_interval(part, found.parameters), creeping(part, problem.test_functions.width)
    return Plan(
        model=model,
        motion=part.motion,
        interval=part.interval,
        width=problem.test_functions.width,
        half_width=width,
        derived_over=part.derived_over,
        error=error,
        slow=max(CERTAIN * error, steps),
        standstill=still,
        peak=part.peak_speed,
        friction=dict(found.parameters),
        row_noise=problem.momentum_noise / max(problem.rows, 1),
        jump=problem.quadrature.jump,
        creep=creeping_speed(smooth),
        kinks=share_of_kinks(
            part, np.where(np.abs(smooth) <= still, 0.0, smooth), width, slow, limits, drive.split(found.parameters)[0]
        ),
        counts=step_of_counts(with_true_beginnings(recording)) if part.derived_over else 0.0,
        wrap=float(recording.provenance.get("unwrapped", {}).get("period", 0.0)),
    )
