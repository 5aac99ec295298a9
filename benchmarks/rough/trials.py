"""One trial: a drive drawn, recorded, diagnosed and improved, and what came out beside what was hidden."""

from __future__ import annotations

import time
import zlib
from collections.abc import Iterable
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from fricmodels import plugins
from fricmodels.diagnosis import Comparison, Diagnosis, compare_fit, improve, ready
from fricmodels.diagnosis import compare as compared
from fricmodels.diagnosis import comparison as comparisons
from fricmodels.diagnosis.candidate_tests import candidate_tests
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.ladder import Ladder
from fricmodels.errors import FricmodelsError
from rough.drives import drive, nominal
from rough.effects import (
    LISTED,
    NEEDS_INERTIA,
    NEEDS_LOAD,
    NEEDS_POSITION,
    NEEDS_TEMPERATURE,
    TWO_MASSES,
    change,
    without,
)
from rough.judge import LAG
from rough.record import Case, record, simulated

Row = dict[str, Any]
BASE = "coulomb-viscous"
MATTERS = 0.9
"""A test error with what is hidden over that without it at which it matters."""
UNDELAYED = 0.501
"""Delay by the sensors [samples] up to which a recording counts as not delayed."""
DRAWS = 60


def trial(kind: str, name: str, index: int, seed: int) -> Row:
    """Run one trial; deterministic by its arguments."""
    began, used = time.perf_counter(), time.process_time()
    case, listed, unlisted = case_of(kind, name, index, seed)
    try:
        row = {"status": "ok", **examined(case, frozenset(listed), frozenset(unlisted))}
    except FricmodelsError as refused:
        row = {"status": "refused", "message": str(refused)}
    return {**described(case), **row, "seconds": time.perf_counter() - began, "cpu": time.process_time() - used}


def case_of(kind: str, name: str, index: int, seed: int) -> tuple[Case, list[str], list[str]]:
    """Return the drive of a trial, and the names of what is hidden in it, listed and unlisted."""
    rng = np.random.default_rng([seed, zlib.crc32(f"{kind}:{name}".encode()), index])
    listed, unlisted = hidden(rng, kind, name)
    return drawn(rng, listed, unlisted, delayed=kind in ("several", "beside")), listed, unlisted


def hidden(rng: np.random.Generator, kind: str, name: str) -> tuple[list[str], list[str]]:
    """Return the names of what is hidden, listed and unlisted."""
    if kind == "null":
        return [], []
    if kind == "single":
        return [name], []
    if kind == "unlisted":
        return [], [name]
    if kind == "beside":
        return [str(rng.choice(list(LISTED)))], [name]
    while True:
        names = [str(n) for n in rng.choice(list(LISTED), int(rng.integers(2, 5)), replace=False)]
        if len(set(names) & set(TWO_MASSES)) < 2:
            return names, []


def drawn(rng: np.random.Generator, listed: Iterable[str], unlisted: Iterable[str], *, delayed: bool = False) -> Case:
    """Draw a drive that moves as it should, and has the channels that what is hidden needs.

    Args:
        rng: source of what is random.
        listed, unlisted: names of what is hidden.
        delayed: whether sensors may delay the motion by more than half a sample. That is ``sensor-delay``, which is
            listed; less than a sample always comes from holding and sampling.
    """
    names = (*listed, *unlisted)
    has = {what: bool(set(names) & set(group)) for what, group in GROUPS.items()}
    for _ in range(DRAWS):
        here = drive(
            rng,
            loaded=has["load"],
            stated=True if has["inertia"] else None,
            turning="gravity" in names,
        )
        if (has["position"] and not here.sensors.position) or (has["temperature"] and here.runs > 1):
            continue
        if "rising-stiction" in names and here.motion not in ("point-to-point", "jogging", "trapezoids", "sweeps"):
            continue
        seed = int(rng.integers(2**31))
        asked = nominal(np.random.default_rng([seed, 1]), here, here.motion)
        case = Case(here, tuple(change(rng, n, here, asked) for n in names), here.motion, seed)
        if not delayed and abs(case.lag * here.sensors.rate) > UNDELAYED:
            continue
        if runs_well(case) and runs_well(other(case)):
            return case
    raise RuntimeError(f"no drive moves with {', '.join(names) or 'nothing'} in {DRAWS} draws")


GROUPS = {
    "load": NEEDS_LOAD,
    "inertia": NEEDS_INERTIA,
    "position": NEEDS_POSITION,
    "temperature": (*NEEDS_TEMPERATURE, "drift", "step-change"),
}


def other(case: Case) -> Case:
    """Return the same drive in another motion."""
    return replace(case, motion=case.drive.other_motion, seed=case.seed + 1)


def cleared(case: Case, names: Iterable[str]) -> Case:
    """Return the same drive in the same motion without some of what is hidden."""
    return replace(case, changes=without(case.changes, frozenset(names)))


def runs_well(case: Case) -> bool:
    """Whether the drive follows roughly, and moves in both directions."""
    speed = np.concatenate([course.velocity for _, _, course in simulated(case)])
    most, slow = float(np.max(np.abs(speed))), 0.01 * case.drive.speed
    both = min(np.mean(speed > slow), np.mean(speed < -slow))
    return bool(np.isfinite(most) and 0.3 < most / case.drive.speed < 2.0 and both > 0.1)


def described(case: Case) -> Row:
    """Return the drive, its sensors, and what is hidden."""
    d = case.drive
    return {
        "drive": d.kind,
        "motion": case.motion,
        "control": d.control,
        "runs": d.runs,
        "load": "payload" if d.load and d.payload else "time" if d.load else "",
        "inertia_given": d.stated,
        "bandwidth": d.bandwidth * d.period,
        "sensors": asdict(d.sensors),
        "lag_samples": case.lag * d.sensors.rate,
        "range": d.travel if np.isfinite(d.travel) else None,
        "seed": case.seed,
        "hidden": [
            {k: v for k, v in asdict(one).items() if v not in (0.0, "", (), np.inf) and k != "at"}
            for one in case.changes
        ],
    }


def error(comparison: Comparison) -> float:
    """Return the test error of the headline, in % of the RMS torque."""
    return comparison.errors.held_out_percent


def examined(case: Case, listed: frozenset[str], unlisted: frozenset[str]) -> Row:
    """Diagnose and improve, and compare with the true effects."""
    recording = record(case)
    began = time.perf_counter()
    ladder = improve(recording, BASE, case.inertia)
    seconds = time.perf_counter() - began
    first = ladder.first.comparison
    row: Row = {
        "samples": len(recording),
        "turned": float(np.ptp(recording["position"])) if "position" in recording else None,
        "rests": float(np.mean(first.problem.resting)),
        "listed": sorted(listed),
        "unlisted": sorted(unlisted),
        "improve_seconds": seconds,
        "base_percent": error(first),
        "floor_percent": first.noise_floor_percent,
        "last_percent": error(ladder.rungs[-1].comparison),
        **said(ladder),
        "elsewhere": elsewhere(case, ladder),
    }
    if listed:
        row |= truth(first, listed, case)
    if unlisted:
        clean = compared(record(cleared(case, unlisted)), BASE, case.inertia)
        row["clean_percent"] = error(true_model(clean, listed) if listed else clean)
    return row


def said(ladder: Ladder) -> Row:
    """Return the answers of `diagnose` and of `improve`, as their documents have them."""
    first, last = document(ladder.first), document(ladder.first, ladder)
    return {
        "verdict": first.verdict,
        "names": [list(e.names) for e in first.effects],
        "p": [e.p_value for e in first.effects],
        "gain": [e.held_out_gain for e in first.effects],
        "unknown": first.plain()["unknown"],
        "last_verdict": ladder.last.verdict,
        "last_names": [list(e.names) for e in last.effects],
        "last_unknown": last.plain()["unknown"],
        "remaining": last.plain()["remaining"],
        "ladder": [step.model for step in last.ladder],
        "rungs": [[error(r.comparison), r.comparison.sliding.held_out_percent] for r in ladder.rungs],
        "note": last.note,
        "judged": [judged(d) for d in (ladder.first, *ladder.steps[1:], ladder.last)],
    }


def judged(diagnosis: Diagnosis) -> Row:
    """Return what spoke for each effect of the set that a diagnosis looked at."""
    judgement = diagnosis.judgement
    return {
        "model": diagnosis.comparison.drive.model.name,
        "found": [list(f.names) for f in diagnosis.findings],
        "refused": diagnosis.refused.name if diagnosis.refused else "",
        "described_by": [] if judgement is None else list(judgement.described_by),
        "floor": None if judgement is None else judgement.floor,
        "unpredicted": None if judgement is None else judgement.unpredicted,
        "one_cause": [] if judgement is None else [found.names for found in judgement.one_cause],
        "members": []
        if judgement is None
        else [{"names": found.names, **asdict(support)} for found, support in judgement.members],
    }


def elsewhere(case: Case, ladder: Ladder) -> Row | None:
    """Return the errors of the ladder's ends on another motion of the same drive; nothing if it has one rung."""
    ends = ladder.rungs[0].comparison, ladder.rungs[-1].comparison
    if ends[0].drive.model.name == ends[1].drive.model.name:
        return None
    moved = other(case)
    there = ready(record(moved))
    errors = []
    for end in ends:
        values = end.estimate.parameters
        try:
            scored = compare_fit(there, there, end.drive, values, dict.fromkeys(values, 0.0))
        except FricmodelsError as wrong:
            return {"motion": moved.motion, "message": str(wrong)}
        errors.append(scored.errors.percent)
    return {"motion": moved.motion, "first": errors[0], "last": errors[1]}


def true_model(comparison: Comparison, names: Iterable[str]) -> Comparison:
    """Add the true effects, that which explains most first; one that cannot be fitted is left out."""
    left = set(names)
    while left:
        result = candidate_tests(comparison.problem, comparison.estimate.parameters, only=sorted(left))
        found = next(iter(result.tested), None)
        name = found.name if found else min(left)
        left.discard(name)
        try:
            effect = plugins.load().effects[name]()
            comparison = comparisons.with_effect(comparison, effect, found.parameters if found else {})
        except FricmodelsError:
            continue
    return comparison


def truth(first: Comparison, listed: frozenset[str], case: Case) -> Row:
    """Return the test error with the true effects, and without each of them.

    A delay that the sensors make is one of them.
    """
    lagging = abs(case.lag * case.drive.sensors.rate) >= LAG
    best = true_model(first, {*listed, *(["sensor-delay"] if lagging else [])})
    without_it = {}
    for effect in best.drive.model.effects:
        fewer = comparisons.refitted(best, best.drive.model.minus(effect.name), best.estimate.parameters)
        without_it[effect.name] = error(fewer)
    return {
        "true_percent": error(best),
        "without_percent": without_it,
        "matter": sorted(n for n, e in without_it.items() if n in listed and error(best) <= MATTERS * e),
    }
