"""A study of compensation in a terminal: the answer, a table, how sure, what next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median
from typing import TYPE_CHECKING

from fricmodels.compensation.study import COULOMB, NONE, TRUE, Study, Way
from fricmodels.diagnosis.present import say
from fricmodels.dimension import Motion
from fricmodels.terminal import Column, plain, show_table

if TYPE_CHECKING:
    from rich.console import Console

_TITLES = {
    NONE: "no compensation",
    COULOMB: "Coulomb and viscous",
    "improved": "improved model",
    TRUE: "the true drive",
}

_BY_LOOP = (
    "It swings because the loop goes through the model: at the measured motion a torque that is wrong, or late, feeds "
    "itself. --at reference has no such loop."
)


def show(console: Console, studies: Sequence[Study], files: Sequence[str], seed: int | None = None) -> None:
    """Print studies, one in full or several in a table.

    Args:
        console: where to print. studies: at least one. files: the rig files, for the next command.
        seed: of the rigs, where it was given.
    """
    if len(studies) == 1:
        _show_one(console, studies[0], files[0], seed)
        return
    say(console, _answer_of_several(studies), "bold")
    console.print()
    show_table(
        console,
        [
            Column("rig", tuple(study.rig.name for study in studies)),
            Column("compensated by", tuple(study.best.model for study in studies)),
            Column("Coulomb and viscous", tuple(_share(s, s.way(COULOMB)) for s in studies), True),
            Column("model", tuple(_share(s, s.best) for s in studies), True),
            Column("true drive", tuple(_share(s, s.way(TRUE)) for s in studies), True),
            Column("at rest", tuple("swings" if s.best.limit_cycle else "still" for s in studies)),
        ],
        "RMS tracking error, in % of that without compensation",
    )
    console.print()
    say(console, f"How sure: {motions_of(studies[0])} of each drive; the true drive is the bound.")
    if studies[0].experiments[0].settings.at == "measured" and any(study.best.limit_cycle for study in studies):
        say(console, _BY_LOOP)
    say(console, "Next: one rig alone shows its figures in full; --out keeps them all.")


def motions_of(study: Study) -> str:
    """Say along how many motions a study tried a model."""
    count = len(study.experiments)
    return f"{count} motion{'s' * (count != 1)}"


def _show_one(console: Console, study: Study, file: str, seed: int | None) -> None:
    say(console, _answer(study), "bold")
    console.print()
    size, unit = _scale(study)
    first = study.experiments[0]
    torque = "force [N]" if study.rig.motion is Motion.LINEAR else "torque [N m]"
    ways = study.ways
    show_table(
        console,
        [
            Column("compensation", tuple(_TITLES.get(way.name, way.name) for way in ways)),
            Column(f"RMS error [{unit}]", tuple(_figure(size * way.rms_error) for way in ways), True),
            Column("of none", tuple(_share(study, way) for way in ways), True),
            Column(f"largest [{unit}]", tuple(_figure(size * way.largest_error) for way in ways), True),
            Column(f"RMS {torque}", tuple(_effort(way) for way in ways), True),
            Column("at rest", tuple(_rest(way) for way in ways)),
        ],
    )
    console.print()
    for way in ways:
        if way.message:
            say(console, f"{_TITLES.get(way.name, way.name)}: not run: {way.message}.")
    share, least, most = study.best.over(study.way(NONE))
    tried = motions_of(study)
    part = f"{_percent(least)} to {_percent(most)}" if len(study.experiments) > 1 else _percent(share)
    bound = study.way(TRUE).over(study.way(NONE))[0]
    say(
        console,
        f"How sure: {tried} that took no part in the identification; in each the model leaves "
        f"{part} of the error without compensation. Nothing can leave less than about "
        f"{_percent(bound)}: that is what delay and encoder leave where the drive is known completely. "
        f"A simulated drive has no hysteresis or noise of the amplifier: a real one leaves more.",
    )
    late = first.settings.delay
    say(
        console,
        f"Controller: PD at {first.settings.rate:g} Hz, {late:g} sample{'' if late == 1 else 's'} late, bandwidth "
        f"{first.bandwidth:.3g} Hz, encoder step {first.encoder_step:.3g} "
        f"{'m' if study.rig.motion is Motion.LINEAR else 'rad'}; friction compensated "
        f"{'along the reference' if first.settings.at == 'reference' else 'at the measured motion'}.",
    )
    if study.best.limit_cycle and first.settings.at == "measured":
        say(console, _BY_LOOP)
    if study.named and math.isfinite(share):
        say(console, "Next: keep this model in a file, and write it for the controller:")
        data = f"{study.rig.name.replace(' ', '-')}.csv"
        drawn = "" if seed is None else f" --seed {seed}"
        lines = (
            f"fricmodels simulate {file}{drawn} --out {data}",
            f"fricmodels fit {data} --model {study.best.model} --inertia {study.rig.inertia!r}"
            f"{' --linear' if study.rig.motion is Motion.LINEAR else ''} --out joint.model.json",
            "fricmodels export joint.model.json --to c --out joint.h",
        )
        for line in lines:
            console.print(plain(f"  {line}"), markup=False, highlight=False, soft_wrap=True)
    else:
        say(console, "Next: try another model with --model, or another motion with --motion.")


def _answer(study: Study) -> str:
    share, coulomb = study.best.over(study.way(NONE))[0], study.way(COULOMB).over(study.way(NONE))[0]
    swings = " It swings on at rest." if study.best.limit_cycle else ""
    if not math.isfinite(share):
        return f"{study.rig.name}: {study.best.model} cannot be used for compensation here.{swings}"
    text = f"{study.rig.name}: compensated by {study.best.model}, {_percent(share)} of the tracking error is left"
    more = f"; Coulomb and viscous friction alone leave {_percent(coulomb)}."
    worse = " That is worse than no compensation." if share > 1 else ""
    return f"{text}{more}{worse}{swings}"


def _answer_of_several(studies: Sequence[Study]) -> str:
    shares = [study.best.over(study.way(NONE))[0] for study in studies]
    coulomb = [study.way(COULOMB).over(study.way(NONE))[0] for study in studies]
    worse = sum(share > 1 for share in shares)
    swings = sum(study.best.limit_cycle for study in studies)
    return (
        f"{len(studies)} drives: in the median the model leaves {_percent(median(shares))} of the tracking error, "
        f"Coulomb and viscous friction alone {_percent(median(coulomb))}. Worse than no compensation: {worse}. "
        f"Swinging on at rest: {swings}."
    )


def _scale(study: Study) -> tuple[float, str]:
    """Return a factor and a unit in which the error without compensation is a handy number."""
    unit = "m" if study.rig.motion is Motion.LINEAR else "rad"
    for factor, prefix in ((1.0, ""), (1e3, "m"), (1e6, "µ")):
        if factor * study.way(NONE).rms_error >= 1:
            return factor, prefix + unit
    return 1e9, f"n{unit}"


def _figure(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "–"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %" if math.isfinite(share) else "no part"


def _share(study: Study, way: Way) -> str:
    share = way.over(study.way(NONE))[0] if way.figures else math.inf
    return _percent(share) if math.isfinite(share) else "–"


def _effort(way: Way) -> str:
    return _figure(max((one.rms_torque for one in way.figures), default=math.inf))


def _rest(way: Way) -> str:
    if not way.figures:
        return "–"
    counts = max(one.rest_counts for one in way.figures)
    if way.limit_cycle:
        return f"swings, {counts:.3g} counts" if math.isfinite(counts) else "swings"
    return "still"
