"""One trial of each kind: a recording drawn, diagnosed by this program and by its peers, and what came out."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from fricmodels.diagnosis import Comparison, Diagnosis, examine, improve
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.ladder import added
from fricmodels.diagnosis.policy import POLICY
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model
from fricmodels.rig import Rig, random_rig, strength
from fricmodels.weakform.regression import compare
from hidden import look_alikes, peers
from hidden.draw import (
    EFFECTS,
    MATTERS,
    Case,
    blank,
    case,
    fitted,
    generator,
    grown,
    held_out,
    helping,
    mattering,
    with_effect,
)

Row = dict[str, Any]
SMALLER = (0.125, 0.25, 0.5, 1.0)


def trial(kind: str, effect: str, index: int, seed: int) -> Row:
    """Run one trial; deterministic by kind, effect, index and seed."""
    rng = generator(seed, kind, effect, index)
    began = time.perf_counter()
    row = KINDS[kind](rng, effect, index)
    return {"status": "ok", **row, "seconds": time.perf_counter() - began}


def described(rig: Rig) -> Row:
    return {
        "law": rig.friction.law,
        "motion": rig.motion.value,
        "inertia": rig.inertia,
        "excitation": rig.excitation.kind,
        "noise": rig.sensors.velocity_noise_percent,
        "hold": rig.hold,
        "loaded": rig.load is not None,
        "hidden": [{"name": e.name, **e.parameters()} for e in rig.effects],
        "strength": strength(rig),
    }


def sized(drawn: Case) -> Row:
    return {
        "ratio": drawn.ratio,
        "size_percent": drawn.size_percent,
        "base_percent": drawn.comparison.sliding.held_out_percent,
        "floor_percent": drawn.comparison.sliding.noise_percent,
        "unmet": list(drawn.unmet),
    }


def said(diagnosis: Diagnosis) -> Row:
    first = diagnosis.findings[0] if diagnosis.findings else None
    return {
        "verdict": diagnosis.verdict,
        "names": list(diagnosis_names(diagnosis)),
        "further": [list(f.names) for f in diagnosis.findings[1:]],
        "p_value": first.tested.adjusted if first else None,
        "gain": first.tested.evidence.gain if first else None,
        "parameters": dict(first.tested.parameters) if first else {},
        "view": diagnosis.view.channels if diagnosis.view else "",
        "view_gain": diagnosis.view.evidence.gain if diagnosis.view else None,
    }


def single(rng: np.random.Generator, effect: str, index: int) -> Row:
    """One hidden effect that matters."""
    drawn = mattering(rng, effect)
    if drawn is None:
        return {"status": "no size matters"}
    began = time.perf_counter()
    diagnosis = examine(drawn.comparison)
    seconds = time.perf_counter() - began
    named = diagnosis_names(diagnosis)
    truth = _evidence(drawn.comparison, effect)
    without, out = _removed(
        drawn.comparison, {effect, *(named if effect in named else ())}, truth.get("explained", 1.0)
    )
    return {
        **described(drawn.rig),
        **sized(drawn),
        **said(diagnosis),
        "examine_seconds": seconds,
        "truth": truth,
        "after": _after(drawn, diagnosis),
        "removed": {
            **said(without),
            "left_out": sorted(out),
            "after": _after(drawn, without),
            "ladder": _ladder(drawn, out) if diagnosis_names(without) else {},
        },
        "too_small": [_small(c) for c in drawn.too_small],
        "peers": peers.first_named(drawn.rig, drawn.recording),
    }


def _small(drawn: Case) -> Row:
    """What is said of a size that matters to the drive, though adding the true effect hardly lowers the error."""
    diagnosis = examine(drawn.comparison)
    return {
        "excitation": drawn.rig.excitation.kind,
        "ratio": drawn.ratio,
        "verdict": diagnosis.verdict,
        "names": list(diagnosis_names(diagnosis)),
    }


def diagnosis_names(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the class that is named first."""
    return diagnosis.findings[0].names if diagnosis.findings else ()


def _evidence(comparison: Comparison, effect: str) -> Row:
    """Return what the evidence for the true effect was, for looking into failures."""
    result = candidate_tests(comparison.problem, comparison.estimate.parameters)
    if effect in result.untested:
        return {"untested": result.untested[effect]}
    names = [t.name for t in result.tested]
    tested = result.tested[names.index(effect)]
    return {
        "rank": names.index(effect) + 1,
        "explained": tested.evidence.explained,
        "before": names[: names.index(effect)][:3],
        "adjusted": tested.adjusted,
        "gain": tested.evidence.gain,
        "gain_p_value": tested.evidence.gain_p_value,
        "parameters": tested.parameters,
    }


def _removed(comparison: Comparison, out: set[str], explained: float) -> tuple[Diagnosis, set[str]]:
    """Diagnose without the true effect and without what explains the data as well: that is no wrong name."""
    while True:
        diagnosis = examine(comparison, leave_out=out)
        first = diagnosis.findings[0].tested if diagnosis.findings else None
        if first is None or first.evidence.explained < (1 - look_alikes.SAME) * explained:
            return diagnosis, out
        out = out | {first.name}


def _after(drawn: Case, diagnosis: Diagnosis) -> Row:
    """Return held-out errors with what was named and with the true effect, both refitted."""
    first = diagnosis.findings[0].tested if diagnosis.findings else None
    named = with_effect(drawn.comparison, first.name, first.parameters) if first else drawn.comparison
    if drawn.true is None or named is None:
        return {"ratio": None, "message": "the model with the effect could not be fitted"}
    true = held_out(drawn.true)
    return {"named": held_out(named), "true": true, "base": drawn.error, "ratio": held_out(named) / true}


def _ladder(drawn: Case, out: set[str]) -> Row:
    """Return what a ladder adds without some effects, and the held-out error of all of it over that of the true one.

    Several listed effects may be what one is that is not listed: a loss that depends on the sense of power is a
    friction of the load, a gain and an inertia together. Then no data tell that it is another one.
    """
    drive = drawn.comparison.drive
    last = improve(drawn.recording, drive.model, drive.inertia, leave_out=out).rungs[-1].comparison
    error, true = held_out(last), None if drawn.true is None else held_out(drawn.true)
    names = [one.name for one in last.drive.model.effects if one not in drive.model.effects]
    return {"names": names, "ratio": error / true if true else None}


def null(rng: np.random.Generator, effect: str, index: int) -> Row:
    """Nothing hidden; every other recording is of a drive whose motion and sensors would have shown some effect."""
    if index % 2:
        rig = blank(random_rig(rng, [str(rng.choice(EFFECTS))]))
    else:
        rig = random_rig(rng, ())
    recording = rig.simulate()
    comparison = fitted(rig, recording)
    row: Row = {**described(rig), **said(examine(comparison))}
    if index < 100:
        row["peers"] = peers.first_named(rig, recording)
    return row


def pair(rng: np.random.Generator, effect: str, index: int) -> Row:
    """Two hidden effects, of which each alone would matter."""
    drawn = _pair(rng)
    if drawn is None:
        return {"status": "no size matters"}
    names = [e.name for e in drawn.rig.effects]
    ladder = improve(drawn.recording, Model.parse(drawn.rig.friction.law), drawn.rig.inertia)
    final = [e.name for e in ladder.rungs[-1].comparison.drive.model.effects]
    kept = [list(finding.names) for finding in added(ladder)] if ladder.steps else []
    return {
        **described(drawn.rig),
        **sized(drawn),
        "truth": names,
        "final": final,
        "classes": kept,
        "verdict": ladder.last.verdict,
        "errors": [r.comparison.sliding.held_out_percent for r in ladder.rungs],
        "note": ladder.note,
    }


def _pair(rng: np.random.Generator) -> Case | None:
    for _ in range(12):
        names = [str(n) for n in rng.choice(EFFECTS, 2, replace=False)]
        try:
            rig = random_rig(rng, names)
        except (FricmodelsError, ValueError):  # they cannot be simulated or shown together
            continue
        alone = [helping(rig.model_copy(update={"effects": (e,)})) for e in rig.effects]
        if any(a is None for a in alone):
            continue
        both = rig.model_copy(update={"effects": tuple(a.rig.effects[0] for a in alone if a is not None)})
        try:
            drawn = case(both)
        except (FricmodelsError, ValueError):
            continue
        if drawn.ratio <= MATTERS:
            return drawn
    return None


def power(rng: np.random.Generator, effect: str, index: int) -> Row:
    """The same recording with smaller and smaller effects, and what its null could have shown."""
    drawn = mattering(rng, effect)
    if drawn is None:
        return {"status": "no size matters"}
    clean = blank(drawn.rig)
    visible = examine(fitted(clean, clean.simulate())).visibility.get(effect)
    points = []
    for factor in SMALLER:
        part = drawn if factor == 1.0 else case(drawn.rig.with_strength(factor), drawn.clean_error)
        names = said(examine(part.comparison))["names"]
        points.append({"factor": factor, "ratio": part.ratio, "size_percent": part.size_percent, "names": names})
    return {
        **described(drawn.rig),
        **sized(drawn),
        "smallest_percent": visible.smallest_percent if visible and not visible.missing else None,
        "missing": visible.missing if visible else "",
        "points": points,
    }


def alike(rng: np.random.Generator, effect: str, index: int) -> Row:
    """A recording on which members of a class explain the data equally well."""
    for _ in range(8):
        rig, members = look_alikes.SITUATIONS[effect](rng)
        drawn = next(grown(rig, both_ways=effect != look_alikes.ONE_DIRECTION), None)
        if drawn is None:
            continue
        true = rig.effects[0].name
        best = drawn.true or with_effect(drawn.comparison, true)
        if best is None:
            continue
        explained = drawn.error**2 - held_out(best) ** 2
        equal = []
        for other in members:
            fit = None if other == true else with_effect(drawn.comparison, other)
            if fit and held_out(fit) ** 2 - held_out(best) ** 2 < look_alikes.SAME * explained:
                equal.append(other)
        equal = _untold(drawn.comparison, true, equal)
        if not equal or explained <= 0:
            continue
        diagnosis = examine(drawn.comparison)
        return {**described(drawn.rig), **sized(drawn), **said(diagnosis), "truth": true, "equal": equal}
    return {"status": "data can tell"}


def _untold(comparison: Comparison, true: str, equal: list[str]) -> list[str]:
    """Return the effects that a paired test does not tell from the true one either, however little noise there is."""
    result = candidate_tests(comparison.problem, comparison.estimate.parameters)
    losses = {t.name: t.evidence.loss for t in result.tested}
    terms = result.regression.terms
    return [
        other
        for other in equal
        if true not in losses
        or other not in losses
        or compare(losses[other], losses[true], terms)[1] > POLICY.significance
    ]


KINDS = {"single": single, "null": null, "pair": pair, "power": power, "alike": alike}
