"""A diagnosis in plain words."""

from __future__ import annotations

import numpy as np

from fricmodels.diagnosis.candidate_tests import CandidateTest
from fricmodels.diagnosis.diagnose import Diagnosis, Finding
from fricmodels.diagnosis.floor import beyond_sampling_percent, is_seen_above_noise
from fricmodels.diagnosis.ladder import Ladder, added
from fricmodels.diagnosis.predictability import AUTOREGRESSIVE
from fricmodels.diagnosis.ripple import FastRipple
from fricmodels.dimension import DISPLACEMENT, FORCE, Motion
from fricmodels.results.words import (
    LINE,
    SAMPLING,
    about_noise,
    chance_in_words,
    figures,
    look_alikes,
    of_motion,
    share_text,
    with_spread,
)
from fricmodels.weakform.ripple import relations

_FEW = 2
"""Coefficients that are read in a sentence."""

IN_NO_CHANNEL = (
    "The error is far above the noise, but no recorded channel predicts it. Something acts on the drive that was not "
    "recorded, or that happened only once, or that acts about standstill, which is too unclear to be tested."
)


def explain(diagnosis: Diagnosis, ladder: Ladder | None = None) -> str:
    """Return what was found and what it means, in a few sentences."""
    comparison = diagnosis.comparison
    name = comparison.drive.model.name
    opening = (
        f"The model '{name}' leaves an RMS torque error of {comparison.errors.held_out_percent:.3g} % of the RMS motor "
        f"torque on data that it was not fitted to, {comparison.errors.averaged}; sensor noise alone would leave "
        f"{about_noise(comparison.noise_floor_percent, 2)}."
    )
    parts = [opening]
    if diagnosis.verdict == "adequate":
        left = (
            f"Nothing that could be predicted and comes to {100 * diagnosis.policy.least_torque:.2g} % of the torque "
            "is left in the residual"
            if diagnosis.view is None
            else "What could be predicted of it is too small a part to be noticed"
        )
        parts.append(
            f"{left}: the model is adequate for this recording. This does not exclude effects that the recording could "
            "not have shown."
            if diagnosis.noise is None
            else f"What is left lasts for a while, but no recorded channel predicts it and its size goes with nothing: "
            f"{diagnosis.noise}. No effect can be added for it; the model is adequate for this recording."
        )
        parts.extend(_hidden_by_sampling(diagnosis))
    elif diagnosis.verdict == "unknown-effect":
        parts.append(unknown(diagnosis))
    else:
        findings = list(diagnosis.findings) if ladder is None else added(ladder)
        parts.extend(sentence(finding, comparison.drive.motion) for finding in findings[:1])
        parts.extend(_further(findings[1:]))
    if diagnosis.ripple is not None:
        parts.append(fast_waves(diagnosis.ripple, comparison.drive.motion))
    if ladder is not None and len(ladder.rungs) > 1:
        last = ladder.rungs[-1]
        parts.append(f"With '{last.model}' the test error falls to {last.comparison.errors.held_out_percent:.3g} %.")
        if ladder.last.verdict == "unknown-effect":
            parts.append(unknown(ladder.last))
    if ladder is not None and ladder.note:
        parts.append(ladder.note + ".")
    return of_motion(" ".join(parts), comparison.drive.motion)


def _hidden_by_sampling(diagnosis: Diagnosis) -> list[str]:
    """Return why an adequate model leaves an error far above the noise, if it does."""
    comparison = diagnosis.comparison
    if not is_seen_above_noise(comparison, diagnosis.policy):
        return []
    return [
        f"The error is far above the noise because of the sampling: {SAMPLING}, are not known. Without what these can "
        "make, "
        f"{figures(beyond_sampling_percent(comparison))} % is left. Sampled faster, the drive would show more."
    ]


def fast_waves(ripple: FastRipple, motion: Motion) -> str:
    """Return in words which waves over position stand out of the error from sample to sample, and how they relate."""
    rotary = motion is Motion.ROTARY
    length, torque = DISPLACEMENT.unit(motion), FORCE.unit(motion)
    related = relations(ripple.waves)
    told = []
    for line in ripple.waves.lines:
        per_turn = f", {line.k:.4g} a turn" if rotary else ""
        relation = f" = {related[line.k]}" if line.k in related else ""
        told.append(
            f"k = {line.k:.4g}{relation} 1/{length} (one each {2 * np.pi / line.k:.3g} {length}{per_turn}; "
            f"{line.torque:.2g} {torque} RMS)"
        )
    several = len(told) > 1
    text = f"From sample to sample the error has {'waves' if several else 'a wave'} over position: {'; '.join(told)}."
    unknown = "" if ripple.found is not None else f" No known effect explains {'them' if several else 'it'}."
    return text + unknown


def _further(findings: list[Finding]) -> list[str]:
    if not findings:
        return []
    named = ", ".join(f"'{finding.tested.name}' ({finding.tested.effect.formula})" for finding in findings)
    return [f"Beside it {named} {'is' if len(findings) == 1 else 'are'} missing."]


def sentence(finding: Finding, motion: Motion = Motion.ROTARY) -> str:
    """Return one finding in words: the physics, the equation, the evidence, and what would tell look-alikes apart."""
    tested = finding.tested
    effect = tested.effect
    text = (
        f"'{tested.name}' is missing: {effect.physics} ({effect.formula}). Its mark in "
        f"the residual: {effect.signature}. It explains {share_text(tested.evidence.explained)} of the residual and "
        f"lowers it by {share_text(tested.evidence.gain)} on blocks that were not used for fitting (p "
        f"{chance_in_words(tested.once)} after correction for all effects tested).{_size(tested, motion)}"
    )
    if len(finding.names) > 1:
        others = ", ".join(f"'{name}'" for name in finding.names[1:])
        text += f" {look_alikes(others, finding.separated_by)}"
    return text


def _size(tested: CandidateTest, motion: Motion) -> str:
    """Return the coefficients with their standard errors, where these are few and all linear; others need a table."""
    declared, spread = tested.effect.parameters, tested.standard_errors
    if len(declared) > _FEW or any(p.symbol not in spread for p in declared):
        return ""
    sizes = (
        f"{p.symbol} = {with_spread(tested.parameters[p.symbol], spread[p.symbol])} "
        f"{_unit(p.unit_for(motion))}".rstrip()
        for p in declared
    )
    return f" {', '.join(sizes)}."


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def unknown(diagnosis: Diagnosis) -> str:
    """Return in words what remains that no effect was named for: how much, what predicts it, where, what comes near."""
    rest = diagnosis.remaining
    if rest is None:
        return ""
    unit = FORCE.unit(diagnosis.comparison.drive.motion)
    size = f": {figures(rest.SI)} {unit} RMS, {figures(rest.percent)} % of the motor torque"
    if not rest.SI > 0:
        size = ", no larger than what noise alone would leave"
    parts = [f"Something is missing that no known effect explains{size}. {_predicted(diagnosis)}"]
    if diagnosis.refused is not None:
        parts.append(f"'{diagnosis.refused.name}' explains part of it, but the test error does not fall with it.")
    if rest.place is not None:
        parts.append(f"It is largest {rest.where}.")
    elif diagnosis.view is not None:
        parts.append(f"{rest.where}.")
    if rest.nearest:
        here = diagnosis.comparison.errors.held_out_percent
        near = ", ".join(
            f"'{one.name}' ({here:.3g} → {one.held_out_percent:.3g} %{f'; {one.against}' if one.against else ''})"
            for one in rest.nearest
        )
        first = next((one for one in rest.nearest if not one.against), rest.nearest[0])
        parts.append(
            f"The known effects that come nearest, with the test error that each would give: {near}. To take one "
            f"anyway: --model {first.model}."
        )
    return " ".join(parts)


def _predicted(diagnosis: Diagnosis) -> str:
    view, comparison = diagnosis.view, diagnosis.comparison
    if view is None:
        if diagnosis.place is not None:
            return "No smooth function of one channel predicts it, but it has a mean of its own at one place."
        worst = comparison.where[0]
        return (
            f"{IN_NO_CHANNEL} {100 * worst.share_of_squared_error:.0f} % of the squared error lies in '{worst.regime}'."
        )
    falls = f"(it falls by {100 * view.evidence.gain:.0f} % on blocks that were not used for fitting)"
    if view.channels in AUTOREGRESSIVE:
        return (
            f"It lasts or rings: it can be predicted from {view.channels} {falls}, but from no recorded channel. Look "
            "for what was not recorded: another joint, a temperature, a load."
        )
    if view.channels.startswith(LINE):
        return (
            f"It comes and goes in {view.channels}, whatever the drive does {falls}: a pump, a fan or another machine "
            "does so, and no friction."
        )
    return f"It can be predicted from {view.channels} {falls}."
