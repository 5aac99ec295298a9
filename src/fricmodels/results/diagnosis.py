"""``diagnosis.json``: a comparison, what it lacks, and the ladder that improved it, typed.

Errors in percent are RMS torque errors, of the RMS motor torque (force on a linear axis). SI units are N m, or N on a
linear axis.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from fricmodels.results.comparison import ComparisonDocument, Step
from fricmodels.results.part import Number, Numbers, Part

Verdict = Literal["adequate", "missing-effect", "undecided", "unknown-effect"]


class InItsPlace(Part):
    """The final model with a look-alike in the place of an effect."""

    name: str
    """Of the look-alike."""
    model: str
    """The model with it."""
    held_out_percent: Number
    """Its test error [% of the RMS motor torque]."""
    parameters: Numbers
    """By key, each in its SI unit."""
    standard_errors: Numbers = Field(default_factory=dict)
    """By key, in the same units; none of what was given."""


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
    in_its_place: tuple[InItsPlace, ...] = ()
    """Look-alikes in its place, and which values hold with them: at the end of a ladder, of those without a search."""


class Predictor(Part):
    """What predicts the residual, whatever the physics."""

    channels: str
    """In words."""
    p_value: Number
    """Corrected for the number of channels [1]."""
    held_out_gain: Number
    """Share by which it lowers the residual on blocks that were not used for fitting [1]."""
    torque_percent: Number = None
    """RMS torque that it predicts [% of the RMS motor torque]; null in documents of older versions."""


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
    against: str = ""
    """What speaks against it, in words; empty where nothing is known to."""


class Shift(Part):
    """A shift of torque against motion that sampling alone may make, and that no effect is named for."""

    seconds: Number
    """Time by which motion was recorded after the torque [s]; negative where it was the torque."""
    samples: Number
    """The same in sampling intervals."""
    model: str
    """The model that takes it away."""
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

    @property
    def over(self) -> str:
        """Over which channel to show it: ``position``, ``load_torque`` or ``speed``."""
        named = self.channel.partition(",")[0].replace(" ", "_") if self.place is None else self.place.channel
        return named if named in ("position", "load_torque") else "speed"


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


class Change(Part):
    """An effect of the last model that is not the same throughout the motion."""

    effect: str
    """Its name."""
    half: str
    """The half of the motion in which it is larger or smaller, in words."""
    change: Number
    """By how much, in units of the effect as it was fitted; positive where it is larger there [1]."""
    standard_error: Number
    """Of that [1]."""
    p_value: Number
    """That it is the same throughout, corrected for all halves and effects."""
    text: str
    """How it differs, in words."""


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
    shift: Shift | None = None
    """A shift within sampling that makes much of that error; null where none is known to."""
    could_have_been_seen: dict[str, Visible] = Field(default_factory=dict)
    """Every effect that was not found, by name."""
    changes: tuple[Change, ...] = ()
    """Effects that were added and are not the same throughout the motion; a name of which this is so is doubtful."""
    explanation: str = ""
    """What was found and what it means, in words."""
    ladder: tuple[Step, ...] = Field(min_length=1)
    """The models on the way, the given one first."""
    note: str = ""
    """Why the ladder ended where it did, if not because the model became adequate."""
    partial: bool = False
    """Whether it was stopped before its end: what remains on the last step was not looked at."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """The models on the way with their parameters, the given one first."""
        names = ("parameters", "standard_errors", "not_identified", "remarks")
        own = {name: getattr(self, name) for name in names}
        return tuple(step if step.parameters else step.model_copy(update=own) for step in self.ladder)

    @property
    def seen(self) -> dict[str, Visible]:
        """Effects that were not found and would have been, by name."""
        return {name: row for name, row in self.could_have_been_seen.items() if not row.missing}

    @property
    def not_seen(self) -> dict[str, str]:
        """Effects that the recording could not have shown, each with the reason."""
        return {name: row.missing for name, row in self.could_have_been_seen.items() if row.missing}

    @property
    def ranked(self) -> list[Candidate]:
        """The candidates, that with the least error on test blocks first."""
        return sorted(self.candidates, key=lambda one: one.change or 0.0)

    def plain(self) -> dict[str, Any]:
        """Return the content of the file; where the numbers come from stands at its end."""
        content = super().plain()
        return content | {key: content.pop(key) for key in ("recording", "versions")}
