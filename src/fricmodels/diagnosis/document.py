"""Comparisons, diagnoses and ladders as documents, and the file ``diagnosis.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fricmodels import plugins
from fricmodels.diagnosis.beyond_range import beyond_range
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.constancy import changes
from fricmodels.diagnosis.correlation import correlation
from fricmodels.diagnosis.diagnose import Diagnosis, Finding
from fricmodels.diagnosis.errors_table import samples_of
from fricmodels.diagnosis.explain import explain, sentence, unknown
from fricmodels.diagnosis.floor import beyond_sampling_percent, is_seen_above_noise
from fricmodels.diagnosis.in_its_place import in_its_place
from fricmodels.diagnosis.ladder import Ladder, added
from fricmodels.diagnosis.passive import drives_from
from fricmodels.diagnosis.remarks import remarks_on
from fricmodels.diagnosis.runs_apart import runs_apart
from fricmodels.diagnosis.shift import shift_within_sampling
from fricmodels.diagnosis.verdict import torque_share
from fricmodels.dimension import INERTIA, Motion
from fricmodels.files import write_text
from fricmodels.model import Known, Model
from fricmodels.once import once
from fricmodels.results import comparison as facts
from fricmodels.results import diagnosis as typed
from fricmodels.results.comparison import ComparisonDocument
from fricmodels.results.diagnosis import DiagnosisDocument
from fricmodels.term import Effect
from fricmodels.weakform.regression import to_order_by

FILE = "diagnosis.json"


def document(diagnosis: Diagnosis, ladder: Ladder | None = None) -> DiagnosisDocument:
    """Return the diagnosis of a model, and the ladder that improved it, as a document.

    With a ladder, ``effects`` lists what it added, in order, with the look-alikes that each has beside the others; the
    verdict is that of the model that was given, by these; what remains on the last rung that no known effect explains
    is ``unknown``.
    """
    comparison = diagnosis.comparison
    findings = diagnosis.findings if ladder is None else added(ladder)
    final = diagnosis if ladder is None else ladder.last
    last = comparison if ladder is None else ladder.rungs[-1].comparison
    places = {} if ladder is None else in_its_place(ladder)
    return DiagnosisDocument(
        **_facts(comparison, [finding.tested.effect for finding in findings], last),
        verdict=diagnosis.verdict,
        effects=tuple(_effect(finding, comparison.drive.motion, places) for finding in findings),
        unknown=_unknown(final),
        remaining=_remaining(final),
        candidates=_candidates(diagnosis),
        correlation=_correlation(last),
        coloured_noise=_coloured_noise(final),
        beyond_sampling_percent=_beyond_sampling(final),
        shift=shift_within_sampling(final),
        could_have_been_seen={
            name: typed.Visible(
                smallest_percent=row.smallest_percent,
                smallest_torque=row.smallest_torque,
                missing=row.missing,
                **({"band": row.band} if row.band else {}),
            )
            for name, row in final.visibility.items()
        },
        changes=() if ladder is None else _changes(ladder),
        explanation=explain(diagnosis, ladder),
        ladder=_ladder(diagnosis, ladder),
        note="" if ladder is None else ladder.note,
        partial=ladder is not None and ladder.partial,
    )


@once
def _changes(ladder: Ladder) -> tuple[typed.Change, ...]:
    """Return which of the effects that a ladder added are not the same throughout the motion."""
    kept = {finding.tested.name for finding in added(ladder)}
    found = changes(ladder.rungs[-1].comparison, ladder.last.policy)
    return tuple(typed.Change(**asdict(each), text=each.text) for each in found if each.effect in kept)


def comparison_document(comparison: Comparison) -> ComparisonDocument:
    """Return a comparison as a document: model, parameters, errors, where these lie, what was recorded."""
    return ComparisonDocument(**_facts(comparison))


def _facts(comparison: Comparison, found: Sequence[Effect] = (), last: Comparison | None = None) -> dict[str, Any]:
    """Return the fields of :class:`ComparisonDocument`; what was found beside the model's own effects counts too."""
    drive, estimate, errors = comparison.drive, comparison.estimate, comparison.errors
    over_position = any("position" in Model.only(term).needs for term in (*drive.model.terms, *found))
    return {
        "dataset": comparison.train.name,
        "model": drive.model.name,
        "motion": drive.motion,
        "inertia": facts.Inertia(
            value=estimate.parameters[drive.inertia_key],
            unit=INERTIA.unit(drive.motion),
            estimated=drive.inertia is None,
        ),
        "parameters": dict(estimate.parameters),
        "standard_errors": estimate.own_errors,
        "not_identified": dict(estimate.not_identified),
        "remarks": remarks_on(comparison),
        "held": drive.model.known.fixed,
        **_promised(drive.model.known),
        "beyond_range": beyond_range(comparison),
        "friction_drives_from": drives_from(last or comparison),
        "offsets_of_runs": comparison.offsets_of_runs,
        "runs_apart": runs_apart(last or comparison),
        "integrated_position": over_position and "position" in comparison.train.derived,
        "rms_torque_error": facts.TorqueError(
            SI=errors.SI,
            percent=errors.percent,
            held_out_percent=errors.held_out_percent,
            band_ms=errors.headline.window_ms,
            bands=tuple(facts.Band(**asdict(band)) for band in errors.bands),
        ),
        "noise_floor_percent": comparison.noise_floor_percent,
        "noise_channel": comparison.noise_channel,
        "where": tuple(facts.RegimeShare(**asdict(row)) for row in comparison.where),
        "recording": _recording(comparison),
        "versions": plugins.versions(),
    }


def _promised(known: Known) -> dict[str, float]:
    """Return the test error that a held model's file says, and its window [ms]; nothing where none is known."""
    if not known.fixed or known.promised is None:
        return {}
    percent, window = known.promised
    return {"promised_percent": percent, "promised_band_ms": window}


def _recording(comparison: Comparison) -> facts.RecordingFacts:
    """Return what was compared: the file with its checksum and how it was read, samples, channels."""
    train, test = comparison.train, comparison.test
    known = train.provenance
    columns, files = known.get("columns", {}), known.get("files")
    return facts.RecordingFacts(
        source=known.get("source"),
        files=None if files is None else tuple(files),
        sha256=known.get("sha256"),
        reader=known.get("reader"),
        columns=tuple(columns[channel] for channel in sorted(columns)),
        torque_constant=known.get("torque_constant"),
        channels=tuple(name for name in train.channels if name not in train.derived),
        derived=tuple(sorted(train.derived)),
        samples=samples_of(train, test),
        interval=train.interval,
        true_model=known.get("true_model"),
        findings=tuple(facts.LogFinding(**finding) for finding in known.get("findings", ())),
    )


def _unknown(diagnosis: Diagnosis) -> typed.Predictor | None:
    view, result = diagnosis.view, diagnosis.result
    if view is None:
        return None
    return typed.Predictor(
        channels=view.channels,
        p_value=view.p_value,
        held_out_gain=view.evidence.gain,
        torque_percent=None if result is None else 100.0 * torque_share(result, view.evidence),
    )


def _beyond_sampling(diagnosis: Diagnosis) -> float | None:
    """Return the error without what sampling hides, where it is far above noise and nothing predicts it."""
    hidden = diagnosis.verdict == "adequate" and is_seen_above_noise(diagnosis.comparison, diagnosis.policy)
    return beyond_sampling_percent(diagnosis.comparison) if hidden else None


def _candidates(diagnosis: Diagnosis) -> tuple[typed.Candidate, ...]:
    """Return every effect that was tested on the given model, the one with the least error on held-out blocks first.

    What was found beside a law that keeps its bounds is one of them.
    """
    if diagnosis.result is None:
        return ()
    found = [finding.tested for finding in diagnosis.findings]
    passing = {tested.name for tested in (*diagnosis.passing, *found)}
    others = [tested for tested in diagnosis.result.tested if tested.name not in {one.name for one in found}]
    return tuple(
        typed.Candidate(
            name=tested.name,
            p_value=tested.once,
            share_of_residual=tested.evidence.explained,
            held_out_gain=tested.evidence.gain,
            gates=tested.name in passing,
        )
        for tested in sorted([*found, *others], key=lambda tested: to_order_by(1.0 - tested.evidence.gain))
    )


def _correlation(comparison: Comparison) -> typed.Correlation | None:
    known = correlation(comparison)
    if known is None:
        return None
    return typed.Correlation(parameters=known[0], matrix=tuple(tuple(row) for row in known[1].tolist()))


def _remaining(diagnosis: Diagnosis) -> typed.Remaining | None:
    rest = diagnosis.remaining
    if rest is None:
        return None
    place = None if rest.place is None else typed.Place(**asdict(rest.place))
    nearest = tuple(typed.Nearest(**asdict(one)) for one in rest.nearest)
    return typed.Remaining(**{**vars(rest), "place": place, "nearest": nearest}, text=unknown(diagnosis))


def _effect(finding: Finding, motion: Motion, places: Mapping[str, Sequence[Comparison]]) -> typed.Effect:
    tested = finding.tested
    return typed.Effect(
        name=tested.name,
        names=tuple(finding.names),
        p_value=tested.once,
        share_of_residual=tested.evidence.explained,
        held_out_gain=tested.evidence.gain,
        parameters=dict(tested.parameters),
        standard_errors=dict(tested.standard_errors),
        units={p.symbol: p.unit_for(motion) for p in tested.effect.parameters},
        separated_by=finding.separated_by,
        equation=tested.effect.formula,
        explanation=sentence(finding, motion),
        in_its_place=tuple(map(_in_its_place, places.get(tested.name, ()))),
    )


def _in_its_place(other: Comparison) -> typed.InItsPlace:
    return typed.InItsPlace(
        name=other.drive.model.effects[-1].name,
        model=other.drive.model.name,
        held_out_percent=other.errors.held_out_percent,
        parameters=dict(other.estimate.parameters),
        standard_errors=dict(other.estimate.own_errors),
    )


def _coloured_noise(diagnosis: Diagnosis) -> typed.NoiseLeft | None:
    """Return what is left as noise of the torque that lasts; ``None`` where it is not that."""
    noise = diagnosis.noise
    if noise is None:
        return None
    return typed.NoiseLeft(SI=noise.deviation, percent=noise.percent, correlation_time_s=noise.lasts)


def _ladder(diagnosis: Diagnosis, ladder: Ladder | None) -> tuple[facts.Step, ...]:
    if ladder is None:
        comparison = diagnosis.comparison
        errors, name = comparison.errors, comparison.drive.model.name
        return (
            facts.Step(
                model=name,
                rms_percent=errors.percent,
                held_out_rms_percent=errors.held_out_percent,
                added="",
                noise_floor_percent=comparison.noise_floor_percent,
                noise_channel=comparison.noise_channel,
            ),
        )
    return tuple(
        facts.Step(
            model=rung.model,
            rms_percent=rung.comparison.errors.percent,
            held_out_rms_percent=rung.comparison.errors.held_out_percent,
            added=rung.added,
            removed=rung.removed,
            parameters=dict(rung.comparison.estimate.parameters),
            standard_errors=dict(rung.comparison.estimate.own_errors),
            not_identified=dict(rung.comparison.estimate.not_identified),
            remarks=remarks_on(rung.comparison),
            noise_floor_percent=rung.comparison.noise_floor_percent,
            noise_channel=rung.comparison.noise_channel,
        )
        for rung in ladder.rungs
    )


def write(data: DiagnosisDocument, directory: Path) -> Path:
    """Write ``diagnosis.json`` into a directory, whole or not at all."""
    return write_text(directory / FILE, data.to_json())
