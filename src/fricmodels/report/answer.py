"""The answer to a diagnosis in a few sentences: what is missing, how sure, what remains, and what to do next."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fricmodels import plugins
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE
from fricmodels.diagnosis.where import in_words
from fricmodels.dimension import Motion
from fricmodels.readers.standard_names import STANDARD
from fricmodels.report.error_words import error_words, noise_left, of_noise, within_noise
from fricmodels.report.reliability import CHANGING, ONE_SINE, RECORDS
from fricmodels.report.wording import counted, listed, listed_classes, percent, share, shows_no_inertia, small
from fricmodels.results.words import END_STOP, HELD_AT_REST, LINE, SAMPLING, figures, form, predictor

if TYPE_CHECKING:
    from fricmodels.report.page import Tone
    from fricmodels.results.comparison import ComparisonDocument
    from fricmodels.results.diagnosis import DiagnosisDocument, Effect, Nearest, Remaining, Shift


_WORTH_A_TRY = 0.5
"""Share that an effect must explain of the squared test error above noise to be worth a try; no name hangs on it. On
twelve logs whose cause is on no list, those that resemble it explain 0.7 to 0.9, those that any other would do as well
0.2 to 0.4."""
_OF_LAWS = frozenset({"speed", "motor torque", "load torque"})
"""Channels that the listed laws are functions of."""
_MUCH, _DENSE = 1 / 3, 4.0
"""Share of the squared error, and times the share of the samples, from which a regime of motion is where to look."""
_NO_MODEL = 90.0
"""Test error [%] from which a model without friction has nothing of the torque: all of it is 100."""
_MINUS = re.compile(r"(?<![\w.])-(?=\d)")
FAR_ABOVE = 2.0
"""Times the noise above which the error that remains is said with the answer: first, if something still predicts it."""


@dataclass(frozen=True)
class Answer:
    """What a user reads first.

    Attributes:
        sentence: the answer.
        tone: good, warn or bad.
        error: one number for how much it matters: the test error before and after, beside that of noise.
        sure: the evidence, and how often such an answer was wrong where the truth was known.
        remains: what is left that nothing explains.
        next: what to do, in words.
        command: that does it; empty where it is an experiment.
        details: what else follows, to be folded.
    """

    sentence: str
    tone: Tone
    error: str
    sure: str
    remains: str
    next: str
    command: str
    details: tuple[str, ...] = ()


def answer(data: DiagnosisDocument, options: Sequence[str] = ()) -> Answer:
    """Return the answer of a diagnosis or a ladder.

    Args:
        data: the diagnosis.
        options: more options of its command, for the next one.
    """
    following, command = _next(data, options)
    sentence = f"Stopped before the end, so far: {_sentence(data)}" if data.partial else _sentence(data)
    return Answer(
        sentence, tone(data), error_words(data), sure(data), _remains(data), following, command, _details(data)
    )


def tone(data: DiagnosisDocument) -> Tone:
    """Return whether the answer is good news."""
    if data.verdict == "adequate":
        return "warn" if _noticed_above_noise(data) else "good"
    return "bad" if data.verdict == "unknown-effect" or _much_remains(data) else "warn"


def _sentence(data: DiagnosisDocument) -> str:
    model = data.model
    left = f"{percent(data.ladder[-1].held_out_rms_percent)} of the {data.reference} remains"
    if data.verdict == "adequate":
        nothing = "nothing that could be predicted is left"
        why = (
            nothing
            if data.unknown is None
            else "what could be predicted is too small a part of the error to be noticed"
        )
        more = f" Yet {left}, more than noise ({noise_left(data)})." if _noticed_above_noise(data) else ""
        return f"The model {model} is adequate: {why}.{more}"
    if data.verdict == "unknown-effect":
        return f"Something is missing from the model {model} that no known effect explains."
    names = listed_classes(effect.names for effect in data.effects)
    if _much_remains(data):
        most = f"{left} unexplained, far above noise ({noise_left(data)})"
        return f"{most}. Part of what {model} lacks was found: {names}."
    text = f"The model {model} lacks {counted(len(data.effects), 'effect')}: {names}."
    if len(data.ladder) > 1 and data.remaining is not None and data.remaining.percent:
        rest = f"{percent(data.remaining.percent)} of the {data.reference}, beyond noise, remains unexplained"
        text += f" With {'it' if len(data.effects) == 1 else 'them'} {rest}."
    elif len(data.ladder) > 1 and not data.partial and _noticed_above_noise(data):
        text += f" With {'it' if len(data.effects) == 1 else 'them'} {left}, more than noise ({noise_left(data)})."
    return text


def _noticed_above_noise(data: DiagnosisDocument) -> bool:
    """Whether the error that remains is more than noise, and not so small that no effect is named in it."""
    end = data.ladder[-1].held_out_rms_percent or 0.0
    return _far_above_noise(data) and end > 100 * POLICY.least_torque


def _much_remains(data: DiagnosisDocument) -> bool:
    """Whether a ladder ends far above noise, and something is said to be missing still."""
    return len(data.ladder) > 1 and data.remaining is not None and _far_above_noise(data)


def _far_above_noise(data: DiagnosisDocument) -> bool:
    end, noise = data.ladder[-1].held_out_rms_percent, data.last_noise_floor_percent
    return end is not None and noise is not None and end > FAR_ABOVE * noise


def sure(data: DiagnosisDocument) -> str:
    """Say what speaks for the answer, and how often such an answer was wrong where the truth was known."""
    parts = []
    if data.effects:
        least = max((effect.p_value for effect in data.effects if effect.p_value is not None), default=None)
        whom = "" if len(data.effects) == 1 else " for each of them"
        chance = small(least)
        alone = len(data.effects) == 1 or chance.startswith("below")
        most = _equals(chance) if alone else f"is at most {chance}"
        parts.append(f"p {most}{whom}, corrected for all effects tested.")
    elif data.unknown is not None:
        chance, channel = small(data.unknown.p_value), predictor(data.unknown.channels)
        channel = channel[:1].upper() + channel[1:]
        what = "the error" if data.verdict == "unknown-effect" else "a small part of the error"
        parts.append(f"{channel} {_predicts(channel)} {what}, and not by chance: p {_equals(chance)}.")
    known = [RECORDS[data.verdict]] if data.verdict in RECORDS else []
    if data.effects and any(finding.kind == "one-frequency" for finding in data.recording.findings):
        known.append(ONE_SINE)
    doubt = "is not the same throughout the motion"
    parts.extend(f"But {c.effect} {doubt}: {c.text}. It may stand for something else." for c in data.changes)
    known.extend([CHANGING] if data.changes else [])
    return " ".join([*parts, *(record.said for record in known)])


def _predicts(channel: str) -> str:
    return "predict" if " and " in channel.partition("(")[0] else "predicts"


def _equals(chance: str) -> str:
    return f"is {chance}" if chance.startswith("below") else f"= {chance}"


def _remains(data: DiagnosisDocument) -> str:
    rest = data.remaining
    if data.partial:
        return "not looked at yet: the work was stopped before."
    if rest is None:
        last = data.ladder[-1].held_out_rms_percent
        floor = data.last_noise_floor_percent
        if data.verdict == "adequate" or len(data.ladder) > 1:
            beyond = data.beyond_sampling_percent
            why = "nothing predicts the rest."
            if data.unknown is not None:
                channel, part = predictor(data.unknown.channels), data.unknown.torque_percent
                much = "" if part is None else f" ({percent(part)})"
                why = f"what {channel} {_predicts(channel)} of it{much} is too small a part to be noticed."
            if beyond is not None and last is not None and beyond < last and percent(beyond) != percent(last):
                why = f"all but {percent(beyond)} may be sampling: {SAMPLING}."
            if data.shift is not None:
                left = percent(data.shift.held_out_percent)
                why = f"{_shifted(data.shift)}, as sampling may do; with that in the model {left} remains."
            noise = f"of which noise makes {of_noise(data)}"
            if within_noise(data):
                noise = f"no more than the {percent(floor)} that noise was estimated to leave"
            elif last is not None and floor is not None and last <= floor:
                noise = f"as much as noise makes ({of_noise(data)})"
            return f"{percent(last)}, {noise}; {why}"
        return ""
    size = f"{percent(rest.percent)} of the {data.reference} beyond noise ({form(rest.SI, '.2g')} {data.unit} RMS)"
    if not rest.percent:
        size = f"No more than the noise was estimated to leave ({percent(data.last_noise_floor_percent)})"
    shown = _predicted(data, rest)
    where = _MINUS.sub("−", rest.where)
    place = f"; largest {where}" if rest.place else f"; {where}" if where else ""
    return f"{size}{shown}{', whatever the drive does' if rest.channel.startswith(LINE) else ''}{place}."


def _predicted(data: DiagnosisDocument, rest: Remaining) -> str:
    """Return what predicts the rest, and how much of it, where that is less than half of its square."""
    if not rest.channel:
        return ", predicted from no recorded channel"
    channel, part = predictor(rest.channel), None if data.unknown is None else data.unknown.torque_percent
    if part is None or 2.0 * part**2 >= (rest.percent or 0.0) ** 2:
        return f", predicted from {channel}"
    return f", of which {channel} {_predicts(channel)} {percent(part)}"


def _next(data: DiagnosisDocument, options: Sequence[str]) -> tuple[str, str]:
    """Return what to do next, and the command that does it, if one does."""
    alike = [effect for effect in data.effects if len(effect.names) > 1]
    rest, improved = data.remaining, len(data.ladder) > 1
    model = data.ladder[-1].model
    if data.partial:
        return "Let the same command run to its end:", command_line(data, "improve", data.model, options)
    if _drives_nothing(data):
        what = "force" if data.motion == "linear" else "torque"
        return (
            f"Check the column of the {what}: no friction shows in it, and the error is that of no model. It may be of "
            "another joint, of another time, or of the other sign."
        ), ""
    if alike and data.verdict == "undecided" and rest is None and not improved:
        return _apart(alike[0]), ""
    if data.effects and not improved:
        text = "Add what is missing, refit, and see whether more is:"
        return text, command_line(data, "improve", data.model, options)
    if rest is not None and rest.channel.startswith(LINE):
        often = rest.channel.removeprefix(LINE).strip()
        text = f"Find what goes at {often} (a pump, a fan, another machine), and record it or stop it. To see it:"
        return text, command_line(data, "compare", model, [*_common(options), "--report", "error.html"])
    if rest is not None and data.runs_apart is not None:
        alone = data.model_copy(update={"recording": data.recording.of_first_file()})
        text = "Diagnose each run by itself, or record what differs between them (a temperature, a load)."
        if alone.recording == data.recording:
            return text, ""
        return f"{text} For the first file:", command_line(alone, "diagnose", data.model, options)
    if rest is not None:
        best, laws = _worth_a_try(data, rest), _laws(rest)
        if best is not None:
            fall = f"{percent(data.ladder[-1].held_out_rms_percent)} → {percent(best.held_out_percent)}"
            nearest = f"{best.name} comes nearest to what remains ({fall}), though it does not pass."
            text = f"{nearest}{laws} To try it anyway:"
            return text, command_line(data, "compare", best.model, _common(options))
        text = "Record what this log lacks (another joint, a temperature, a load). To see where the error lies:"
        if rest.where.endswith(END_STOP):
            text = "Leave out what touches an end stop, and look again. To see where the error lies:"
        elif rest.where.endswith(HELD_AT_REST):
            text = "Find out whether something else holds it at rest, and leave that out. To see where the error lies:"
        if rest.channel and rest.channel not in AUTOREGRESSIVE:
            text = (
                f"What remains goes with {predictor(rest.channel)}, in a form that no effect on the list has; "
                f"'fricmodels new effect NAME' begins one of your own.{laws} To see that form:"
            )
        return text, command_line(data, "compare", model, [*_common(options), "--report", "error.html"])
    if data.shift is not None:
        return _without_shift(data, data.shift), command_line(data, "compare", data.shift.model, _common(options))
    text = "Use the model. This keeps its parameters, standard errors and provenance in a file, to call or to export:"
    if _noticed_above_noise(data):
        text = f"{_first_look(data)} To use the model as it is:"
    elif alike:
        text = f"{_apart(alike[0])} To use the model as it is:"
    elif data.effects and shows_no_inertia(data.steps[-1].parameters, data.steps[-1].standard_errors):
        text = (
            f"Give the inertia (--inertia), or record faster motion: while no inertia shows, {data.effects[0].name} "
            "may be the course of the command itself. To use the model as it is:"
        )
    elif data.effects and (in_one := _in_one_law(data)):
        text = f"{in_one} To use the model as it is:"
    kept = f"{Path(data.dataset).name}.model.json"
    return text, command_line(data, "fit", model, [*_common(options), "--out", kept])


def _first_look(data: DiagnosisDocument) -> str:
    """Return what tells more of a rest that nothing predicts: where much of it lies, or else a better record."""
    regimes = data.where if len(data.ladder) == 1 else ()
    shares = [(row.share_of_squared_error or 0.0, row.share_of_samples or 1.0, row.regime) for row in regimes]
    much = [row for row in shares if row[0] >= max(_MUCH, _DENSE * row[1])]
    if not much:
        return "Record it faster or with less noise to see what the rest is."
    lies, inside, regime = max(much, key=lambda row: row[0] / row[1])
    return (
        f"Look first {in_words(regime)}: {share(lies)} of the squared error lie there, in {share(inside)} of the "
        "samples."
    )


def _drives_nothing(data: DiagnosisDocument) -> bool:
    """Whether the torque has no part in it that any friction explains, beside an inertia that was given."""
    last = data.steps[-1]
    friction = [value for key, value in last.parameters.items() if key not in ("J", "M")]
    left = last.held_out_rms_percent
    return not data.inertia.estimated and bool(friction) and not any(friction) and left is not None and left > _NO_MODEL


def _worth_a_try(data: DiagnosisDocument, rest: Remaining) -> Nearest | None:
    """Return the effect that explains most of what remains, if that is a good part and nothing speaks against it."""
    here, noise = data.ladder[-1].held_out_rms_percent, data.last_noise_floor_percent or 0.0
    if here is None:
        return None
    least = here**2 - _WORTH_A_TRY * max(here**2 - noise**2, 0.0)
    near = [one for one in rest.nearest if one.held_out_percent is not None and not one.against]
    return next((one for one in near if (one.held_out_percent or 0.0) ** 2 < least), None)


def _laws(rest: Remaining) -> str:
    """Say that a law may have the form of what remains, where laws are functions of the channel that predicts it."""
    if rest.channel.partition(",")[0] not in _OF_LAWS:
        return ""
    return " A law may have that form, too: 'fricmodels list laws', then 'fricmodels compare --model LAW'."


def _in_one_law(data: DiagnosisDocument) -> str:
    """Say which law has several of the named effects in one; empty where none has."""
    named = {effect.name.partition("(")[0] for effect in data.effects}
    laws = plugins.load().laws
    for name in (name for name in laws if name != data.model.partition("+")[0]):
        common = sorted(laws[name].combines & named)
        if len(common) > 1:
            return f"The law {name} has {listed(common)} in one; 'fricmodels compare --model {name}' tells its error."
    return ""


def _apart(effect: Effect) -> str:
    """Say which experiment tells the effects of a class apart."""
    which = listed(effect.names, "from" if len(effect.names) == 2 else "and")
    return f"To tell {which} apart: {effect.separated_by}."


def _without_shift(data: DiagnosisDocument, shift: Shift) -> str:
    """Say by how much torque and motion are shifted, and what the error is without that."""
    fall = f"{percent(data.ladder[-1].held_out_rms_percent)} → {percent(shift.held_out_percent)}"
    return f"T{_shifted(shift)[1:]}, as sampling may do; with that in the model the test error falls ({fall}):"


def _shifted(shift: Shift) -> str:
    first, second = ("motion", "torque") if (shift.seconds or 0.0) > 0.0 else ("torque", "motion")
    late, samples = (abs(value or 0.0) for value in (shift.seconds, shift.samples))
    return f"the {first} was recorded {figures(1000 * late)} ms ({figures(samples)} samples) after the {second}"


def _common(options: Sequence[str]) -> list[str]:
    """Return the options that every command on a recording has: not the effects that are left out."""
    kept, skip = [], False
    for option in options:
        if skip or option == "--leave-out":
            skip = not skip
        else:
            kept.append(option)
    return kept


def _details(data: DiagnosisDocument) -> tuple[str, ...]:
    details = []
    if data.verdict == "adequate" and data.coloured_noise:
        details.append(data.explanation)
    if data.remaining is not None:
        details.append(data.remaining.text)
    if data.note:
        details.append(f"The ladder ends there: {data.note}.")
    return tuple(details)


def command_line(data: ComparisonDocument, command: str, model: str, options: Sequence[str] = ()) -> str:
    """Return a command on the same recording, read in the same way.

    Args:
        data: a comparison or a diagnosis.
        command: of ``fricmodels``.
        model: its ``--model``.
        options: more of its options.
    """
    known = data.recording
    parts = ["fricmodels", command, *(known.paths or ["DATA"]), "--model", model]
    if not data.inertia.estimated and data.inertia.value is not None:
        parts += ["--inertia", repr(data.inertia.value)]
    by_name = {f"{channel}={column}" for channel, column in STANDARD[Motion(data.motion)].items()}
    if not by_name.issuperset(known.columns):
        parts += [part for column in known.columns for part in ("--column", column)]
    if known.torque_constant is not None:
        parts += ["--torque-constant", repr(known.torque_constant)]
    if data.motion == "linear":
        parts.append("--linear")
    return shlex.join([*parts, *options])
