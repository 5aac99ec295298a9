"""``diagnosis.json``: a comparison, what it lacks, and the ladder that improved it, typed.

Errors in percent are RMS torque errors, of the RMS motor torque (force on a linear axis). SI units are N m, or N on a
linear axis.
"""

from __future__ import annotations

from typing import Any, Final, Literal

from pydantic import Field

from fricmodels.dimension import FORCE, Motion
from fricmodels.results.part import Number, Numbers, Part, ResultDocument

SCHEMA: Final = "fricmodels/diagnosis/1"
Verdict = Literal["adequate", "missing-effect", "undecided", "unknown-effect"]


class Inertia(Part):
    """Inertia of a drive, or mass of a linear axis."""

    value: Number
    """In ``unit``."""
    unit: str
    """kg m^2, or kg."""
    estimated: bool
    """Whether it was estimated, not given."""


class Band(Part):
    """Torque error over one window."""

    window_ms: Number
    """Width of the window [ms]; of the error per sample, the sampling interval."""
    SI: Number
    """Of what was fitted [N m or N]."""
    percent: Number
    """Of what was fitted [% of the RMS motor torque]."""
    held_out_SI: Number
    """Test error [N m or N]."""
    held_out_percent: Number
    """Test error [% of the RMS motor torque]."""
    noise_floor_percent: Number
    """What sensor noise alone would leave [% of the RMS motor torque]."""


class TorqueError(Part):
    """RMS torque error of a model."""

    SI: Number
    """Of what was fitted [N m or N]."""
    percent: Number
    """Of what was fitted [% of the RMS motor torque]."""
    held_out_percent: Number
    """Test error, on what was kept back [% of the RMS motor torque]."""
    band_ms: Number = None
    """Window over which these are averaged [ms]."""
    bands: tuple[Band, ...] = ()
    """The error over every window, that per sample first."""


class RegimeShare(Part):
    """How much of the squared error lies in one regime of motion."""

    regime: str
    """Its name, such as ``reversal``."""
    share_of_squared_error: Number
    """Of all that was fitted [1]."""
    samples: int
    """How many lie in it."""
    share_of_samples: Number = None
    """Of all that was fitted [1]."""
    rms_torque_error: Number = None
    """In this regime [N m or N]."""


class LogFinding(Part):
    """One thing that is the matter with a recording."""

    kind: str
    """What, in one or two words, such as ``torque-sign``."""
    severity: str
    """``stop``, ``warn`` or ``note``."""
    channel: str = ""
    """Where."""
    text: str
    """What was seen, and the likely cause."""
    remedy: str = ""
    """What mends it; empty where nothing is to be done."""


class Samples(Part):
    """How many samples took part."""

    fitted: int
    """In the fit."""
    kept_back: int
    """In the test error."""

    @property
    def total(self) -> int:
        """All of them."""
        return self.fitted + self.kept_back


class RecordingFacts(Part):
    """What was recorded, and how it was read."""

    source: str | None
    """The file, or several, separated by commas; null for a recording that was made in a program."""
    files: tuple[str, ...] | None = None
    """Each file, where there are several."""
    sha256: str | None
    """Checksum of the file; of several, that of their checksums one after the other."""
    reader: str | None
    """What read the file."""
    columns: tuple[str, ...]
    """CHANNEL=COLUMN[:UNIT], as ``--column`` takes it."""
    torque_constant: Number
    """By which the current was multiplied [N m/A or N/A]; null where the torque was recorded."""
    channels: tuple[str, ...]
    """That were recorded."""
    derived: tuple[str, ...]
    """That were computed from these."""
    samples: Samples
    """How many were fitted and kept back."""
    interval: Number
    """Sampling interval [s]."""
    true_model: str | None
    """The model that a simulation was made with; null where that is not known."""
    findings: tuple[LogFinding, ...] = ()
    """What is the matter with it."""

    @property
    def paths(self) -> tuple[str, ...]:
        """The files that it was read from; none where it was made in a program."""
        return self.files or ((self.source,) if self.source else ())


class Step(Part):
    """One step of the ladder: a model and its errors."""

    model: str
    """Its name."""
    rms_percent: Number
    """Error of what was fitted [% of the RMS motor torque]."""
    held_out_rms_percent: Number
    """Test error [% of the RMS motor torque]."""
    added: str
    """The effect that was added to come here; empty of the first step."""
    removed: str = ""
    """The effect that was removed to come here; empty where none was."""
    parameters: Numbers = Field(default_factory=dict)
    """By key, each in its SI unit."""
    standard_errors: Numbers = Field(default_factory=dict)
    """By key, in the units of the parameters; none of what was given."""


class ComparisonDocument(ResultDocument):
    """A model fitted to a recording: its parameters, how far off it is, and where."""

    schema_: Literal["fricmodels/diagnosis/1"] = Field(SCHEMA, validation_alias="schema", serialization_alias="schema")
    """What the document is, with its version."""
    dataset: str
    """Name of the recording."""
    model: str
    """The model that was given: ``LAW+EFFECT+…``."""
    motion: Motion
    """Rotary or linear."""
    inertia: Inertia
    """Of the drive."""
    parameters: Numbers
    """By key, each in its SI unit."""
    standard_errors: Numbers
    """By key, in the units of the parameters; none of what was given."""
    rms_torque_error: TorqueError
    """How far off the model is."""
    noise_floor_percent: Number
    """Error that sensor noise alone would leave [% of the RMS motor torque]."""
    where: tuple[RegimeShare, ...]
    """By regime of motion, the greatest excess of error over samples first."""
    recording: RecordingFacts
    """What was recorded, and how it was read."""
    versions: dict[str, str]
    """Of all programs that took part."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """The models on the way with their parameters, the given one first: here that alone."""
        errors = self.rms_torque_error
        return (
            Step(
                model=self.model,
                rms_percent=errors.percent,
                held_out_rms_percent=errors.held_out_percent,
                added="",
                parameters=self.parameters,
                standard_errors=self.standard_errors,
            ),
        )

    @property
    def quantity(self) -> str:
        """Torque, or force on a linear axis."""
        return "force" if self.motion is Motion.LINEAR else "torque"

    @property
    def unit(self) -> str:
        """Unit of the torque or force."""
        return FORCE.unit(self.motion)


class Effect(Part):
    """An effect that was found missing."""

    name: str
    """Its name."""
    names: tuple[str, ...] = Field(validation_alias="class", serialization_alias="class")
    """It and its look-alikes, which this recording cannot tell from it."""
    p_value: Number
    """Chance of such evidence without the effect, corrected for all effects tested [1]."""
    share_of_residual: Number
    """Of the squared residual that it explains [1]."""
    held_out_gain: Number
    """Share by which it lowers the residual on blocks that were not used for fitting [1]."""
    parameters: Numbers
    """By symbol, as far as the test found them, each in its unit."""
    standard_errors: Numbers = Field(default_factory=dict)
    """By symbol, in the same units; none of parameters that enter nonlinearly."""
    units: dict[str, str] = Field(default_factory=dict)
    """SI unit by symbol."""
    separated_by: str
    """What would tell the look-alikes apart; empty where there are none."""
    equation: str = ""
    """In plain text."""
    explanation: str = ""
    """In words: the physics, the evidence, and what would tell look-alikes apart."""


class Predictor(Part):
    """What predicts the residual, whatever the physics."""

    channels: str
    """In words."""
    p_value: Number
    """Corrected for the number of channels [1]."""
    held_out_gain: Number
    """Share by which it lowers the residual on blocks that were not used for fitting [1]."""


class Place(Part):
    """A stretch of a channel in which the residual has a mean of one sign."""

    channel: str
    """``position``, ``speed`` or ``load_torque``."""
    direction: str
    """Of the motion: ``forward``, ``backward`` or ``both``."""
    low: Number
    """Where it begins, in the SI unit of the channel."""
    high: Number
    """Where it ends, in the SI unit of the channel."""
    torque: Number
    """Mean residual there [N m or N]."""
    passes: int
    """Least number of passes through a part of it."""
    p_value: Number
    """Corrected for all places of all channels [1]."""
    share: Number
    """Of the squared residual [1]."""


class Nearest(Part):
    """A known effect that was not named, but comes near to what remains."""

    name: str
    """Of the effect."""
    model: str
    """The model with it."""
    held_out_percent: Number
    """Its test error [% of the RMS motor torque]."""


class Remaining(Part):
    """What remains that no known effect explains."""

    percent: Number
    """Test error beyond noise [% of the RMS motor torque]."""
    SI: Number
    """Test error beyond noise [N m or N]."""
    channel: str
    """That predicts it best, in words; empty where none does."""
    where: str
    """The place, or the regime in which most of it lies, in words."""
    place: Place | None = None
    """The same place as numbers; null where it lies in none."""
    nearest: tuple[Nearest, ...]
    """Known effects that come nearest, the least test error first."""
    text: str = ""
    """All of it in words."""


class Candidate(Part):
    """An effect that was tested on the given model by itself."""

    name: str
    """Of the effect."""
    p_value: Number
    """Corrected for all effects tested [1]."""
    share_of_residual: Number
    """Of the squared residual that it explains [1]."""
    held_out_gain: Number
    """Share by which it lowers the residual on blocks that were not used for fitting [1]."""
    gates: bool
    """Whether it passes all three tests by itself; most that do only resemble the first."""

    @property
    def change(self) -> float | None:
        """Change of the error on test blocks [1], negative where it falls."""
        return None if self.held_out_gain is None else -self.held_out_gain


class Correlation(Part):
    """How the estimates of the parameters of the last model are correlated."""

    parameters: tuple[str, ...]
    """Keys of rows and columns."""
    matrix: tuple[tuple[Number, ...], ...]
    """Correlation of each with each [1]."""


class NoiseLeft(Part):
    """What is left where it is noise of the torque with a colour."""

    SI: Number
    """Standard deviation [N m or N]."""
    percent: Number
    """Standard deviation [% of the RMS motor torque]."""
    correlation_time_s: Number
    """How long it lasts [s]."""


class Visible(Part):
    """What the recording could have shown of an effect that was not found."""

    smallest_percent: Number
    """RMS torque from which it would have been found [% of the RMS motor torque]; null where it could not be seen."""
    smallest_torque: Number
    """The same [N m or N]."""
    missing: str
    """What the recording lacks to show it; empty where it could have been seen."""
    band: tuple[Number, Number] | None = None
    """Least and greatest wave number of which this is true [1/rad or 1/m]; left out of effects that are no wave."""


class DiagnosisDocument(ComparisonDocument):
    """What a model lacks, as far as a recording can tell; with a ladder, what was added to it.

    With a ladder, effects are those that it added, in order; the verdict is that of the given model; what concerns the
    residual is that of the last model.
    """

    verdict: Verdict
    """``undecided``: effects that this recording cannot tell apart; ``unknown-effect``: none that is known."""
    effects: tuple[Effect, ...]
    """That are missing, the best first."""
    unknown: Predictor | None = None
    """What predicts a residual that no known effect explains."""
    remaining: Remaining | None = None
    """What remains that no known effect explains; null where nothing does."""
    candidates: tuple[Candidate, ...] = ()
    """Every effect that was tested on the given model, the least error on test blocks first."""
    correlation: Correlation | None = None
    """Of the estimates of the parameters; null where it is not known."""
    coloured_noise: NoiseLeft | None = None
    """What is left, where it is noise that lasts; null where it is not."""
    beyond_sampling_percent: Number = None
    """Error without what sampling hides, where it is far above noise and nothing predicts it [% of the RMS torque]."""
    could_have_been_seen: dict[str, Visible] = Field(default_factory=dict)
    """Every effect that was not found, by name."""
    explanation: str = ""
    """What was found and what it means, in words."""
    ladder: tuple[Step, ...] = Field(min_length=1)
    """The models on the way, the given one first."""
    note: str = ""
    """Why the ladder ended where it did, if not because the model became adequate."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """The models on the way with their parameters, the given one first."""
        own = {"parameters": self.parameters, "standard_errors": self.standard_errors}
        return tuple(step if step.parameters else step.model_copy(update=own) for step in self.ladder)

    @property
    def ranked(self) -> list[Candidate]:
        """The candidates, that with the least error on test blocks first."""
        return sorted(self.candidates, key=lambda one: one.change or 0.0)

    def plain(self) -> dict[str, Any]:
        """Return the content of the file; where the numbers come from stands at its end."""
        content = super().plain()
        return content | {key: content.pop(key) for key in ("recording", "versions")}
