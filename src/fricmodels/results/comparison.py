"""A model fitted to a recording, typed: its parameters, how far off it is, and where.

Errors in percent are RMS torque errors, of the RMS motor torque (force on a linear axis). SI units are N m, or N on a
linear axis.
"""

from __future__ import annotations

from typing import Final, Literal

from pydantic import Field

from fricmodels.dimension import FORCE, Motion
from fricmodels.results.part import Number, Numbers, Part, ResultDocument

SCHEMA: Final = "fricmodels/diagnosis/1"

_FEW_RUNS = 4
"""Runs that are named one by one."""


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
    """What sensor noise alone would leave of the test error [% of the RMS motor torque]."""
    fit_noise_percent: Number = None
    """What it would leave of the fit error [% of the RMS motor torque]."""


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
    kept_back_runs: tuple[str, ...] = ()
    """Names of the runs that were kept back whole; none where parts of runs were."""

    @property
    def in_the_test_error(self) -> str:
        """In words: how many, and which runs they are, where they are whole runs."""
        runs = self.kept_back_runs
        if not runs:
            return f"{self.kept_back} for the test error"
        named = f"run{'s' if len(runs) > 1 else ''} {', '.join(runs)}"
        return (
            f"{self.kept_back} for the test error ({named if len(runs) <= _FEW_RUNS else f'{len(runs)} runs'}, whole)"
        )

    @property
    def total(self) -> int:
        """All of them."""
        return self.fitted + self.kept_back


class RecordingFacts(Part):
    """A recording: its file, its channels, its samples."""

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

    def of_first_file(self) -> RecordingFacts:
        """Return the same without all files but the first; itself where there is one."""
        return self.model_copy(update={"files": self.files[:1]}) if self.files and len(self.files) > 1 else self


class BeyondRange(Part):
    """A channel of a model that is taken further than where its numbers were fitted."""

    channel: str
    """Its name."""
    share_of_samples: Number
    """That lie beyond [1]."""
    least: Number
    """Where the numbers were fitted, in ``unit``."""
    greatest: Number
    """The same."""
    unit: str
    """Of both."""


class OfRuns(Part):
    """A parameter that runs of one recording, each fitted by itself, do not agree on."""

    key: str
    """Its key."""
    unit: str
    """Its unit."""
    least: Number
    """Its least value."""
    least_run: str
    """The run that has it: a file, or a name."""
    greatest: Number
    """Its greatest value."""
    greatest_run: str
    """The run that has it."""


class RunsApart(Part):
    """Runs that leave much less of a model if each has parameters of its own."""

    runs: int
    """How many there are."""
    fitted: int
    """How many of them were fitted, spread over all."""
    together_percent: Number
    """Error of what was fitted, and of whole runs kept back, with the parameters of all [% of the RMS torque]."""
    percent: Number
    """The same with one set for each run [% of the RMS torque]."""
    parameters: tuple[OfRuns, ...] = ()
    """Those that differ most, the most certain first."""


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
    """By key, in the units of the parameters; none of what was given, 0 of what is not known."""
    not_identified: dict[str, str] = Field(default_factory=dict)
    """Why the recording does not determine a parameter, by key; empty in files of old versions."""
    remarks: dict[str, str] = Field(default_factory=dict)
    """What tables of the parameters say beside a value, by key; empty in files of old versions."""
    noise_floor_percent: Number = None
    """Test error that noise alone would leave [% of the RMS motor torque]: it grows with the inertia of the model."""
    noise_channel: str = ""
    """The channel whose noise makes most of that; empty in files of old versions."""


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
    """By key, in the units of the parameters; none of what was given, 0 of what is not known."""
    not_identified: dict[str, str] = Field(default_factory=dict)
    """Why the recording does not determine a parameter, by key; empty in files of old versions."""
    remarks: dict[str, str] = Field(default_factory=dict)
    """What tables of the parameters say beside a value, by key; empty in files of old versions."""
    held: bool = False
    """Whether the numbers are those that a file has, and none was fitted to this recording."""
    promised_percent: Number = None
    """Test error that the model's file says, where its numbers are held [% of the RMS motor torque]."""
    promised_band_ms: Number = None
    """Window over which that is averaged [ms]."""
    beyond_range: tuple[BeyondRange, ...] = ()
    """What is taken further than where held numbers were fitted."""
    friction_drives_from: Number = None
    """Speed beyond the recorded ones from which the friction of the last model would drive [rad/s or m/s]."""
    offsets_of_runs: int = 0
    """Of so many runs the offset is taken from the run itself: the model is not known to have been fitted to them."""
    runs_apart: RunsApart | None = None
    """What is left of the last model if each run has parameters of its own, where that is much less."""
    integrated_position: bool = False
    """Whether what is in the model, or missing, goes with a position that is the integral of the velocity."""
    rms_torque_error: TorqueError
    """How far off the model is."""
    noise_floor_percent: Number
    """Test error that sensor noise alone would leave [% of the RMS motor torque]."""
    noise_channel: str = ""
    """The channel whose noise makes most of that; empty in files of old versions."""
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
                not_identified=self.not_identified,
                remarks=self.remarks,
                noise_floor_percent=self.noise_floor_percent,
                noise_channel=self.noise_channel,
            ),
        )

    @property
    def reference(self) -> str:
        """Of whose RMS errors are percentages: the motor torque, or that of the inertia where the drive coasts."""
        coasts = any(finding.kind == "coasting" for finding in self.recording.findings)
        return f"{self.quantity} of the inertia" if coasts else f"motor {self.quantity}"

    @property
    def last_noise_floor_percent(self) -> float | None:
        """Error that sensor noise alone would leave of the last model; of the given one in files of old versions."""
        last = self.steps[-1].noise_floor_percent
        return self.noise_floor_percent if last is None else last

    @property
    def quantity(self) -> str:
        """Torque, or force on a linear axis."""
        return "force" if self.motion is Motion.LINEAR else "torque"

    @property
    def unit(self) -> str:
        """Unit of the torque or force."""
        return FORCE.unit(self.motion)
