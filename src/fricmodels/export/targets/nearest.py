"""The model nearest to a fitted one that a target can express: refitted, not truncated; and what it leaves out."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import rms
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.export.targets.laws import PolynomialDamping, Viscous
from fricmodels.export.targets.validity import combined_within, doubtful, friction_over, motion_over
from fricmodels.model import Model, NoFriction
from fricmodels.recording import Recording
from fricmodels.saved import FittedModel
from fricmodels.term import Effect, Law, Term

OF_RECORDING = {
    "sensor-delay": "a delay of the recording, not of the drive",
    "run-offset": "a zero of the torque sensor in each run, not of the drive",
}
"""Effects that say nothing of the drive: they are fitted with it, and not written."""
OF_LINKS = {
    "gravity": "give the link its mass and its centre",
    "other-gravity": "give the links their masses",
    "chain-gravity": "give the links their masses",
    "other-inertia": "give the links their inertias",
    "proximal-coupling": "give the links their masses and inertias",
    "inertia-error": "it is added to the inertia",
}
"""Effects of rigid bodies, which a simulator computes by itself: they are fitted with the rest, and not written."""
_NONE = "the target has nothing of its kind"


@dataclass(frozen=True)
class Dialect:
    """What a target can express.

    Attributes:
        law: the law, or the name of one, that is fitted where the model's own cannot be expressed.
        same: for a law of the model by name, its parameters → those of ``law``: these are the same law.
        own: laws of a model that the target has as they are. effects: effects that it has.
        constants: of these the ones with a constant; the first is fitted beside the law where a model has none of them
            and its friction is not the same in both directions.
    """

    law: type[Law] | str
    same: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    own: frozenset[str] = frozenset()
    effects: frozenset[str] = frozenset()
    constants: tuple[str, ...] = ()

    def make(self) -> Law:
        """Return the law that is fitted."""
        return plugins.load().laws[self.law]() if isinstance(self.law, str) else self.law()

    def with_one_constant(self, effects: Sequence[Effect], friction: Sequence[Term]) -> list[Effect]:
        """Return the effects that are fitted beside the law in the place of a friction: of constants only the sum is
        known, and the same friction in both directions has none."""
        last = [name for name in self.constants if name in {effect.name for effect in effects}][-1:]
        kept = [effect for effect in effects if effect.name not in self.constants or effect.name in last]
        needed = self.constants and not last and any(term.symmetry != "odd" for term in friction)
        return [*kept, plugins.load().effects[self.constants[0]]()] if needed else kept


_KV_KC = {"coulomb-viscous": {"K_v": "K_v", "K_c": "K_c"}}
COULOMB_VISCOUS = Dialect("coulomb-viscous", _KV_KC)
VISCOUS = Dialect(Viscous)
MUJOCO = Dialect(
    PolynomialDamping,
    {"coulomb-viscous": {"K_v": "d_1", "K_c": "K_c"}},
    frozenset({"lugre"}),
    frozenset({"cogging", "torque-offset", "stiffness"}),
    ("torque-offset", "stiffness"),
)


@dataclass(frozen=True)
class LeftOut:
    """A term of a model that a target does not get.

    Attributes:
        name: of the term. torque: RMS over the motion of what it adds to the torque [N m or N]; not a number where only
            a recording tells it.
        reason: why, or what to do instead.
    """

    name: str
    torque: float
    reason: str


_ROUNDING = 1e-9
"""Share of the friction torque below which a difference is one of rounding."""


@dataclass(frozen=True)
class Nearest:
    """What is written for a target.

    Attributes:
        drive: the model that is written, and its inertia. parameters: by key, the inertia among them.
        how: whether it is ``exact``, ``refitted`` to a recording, or ``projected`` over the range of validity.
        left_out: terms that are not written. cost: RMS of what the torque is changed by, after the refit [N m or N].
        torque: RMS of the whole model's friction. over: the motion, in words.
        test_percent: test errors of the whole model and of what is written, in %, where it was refitted.
        not_identified: key → reason.
    """

    drive: Drive
    parameters: Mapping[str, float]
    how: Literal["exact", "refitted", "projected"]
    left_out: tuple[LeftOut, ...]
    cost: float
    torque: float
    over: str
    test_percent: tuple[float, float] | None
    not_identified: Mapping[str, str]

    def notes(self, unit: str) -> list[str]:
        """Return in sentences what was left out, what that costs, and what is not determined."""
        lines = [
            f"left out: {one.name} (RMS {one.torque:.3g} {unit} {self.over}); {one.reason}"
            if np.isfinite(one.torque)
            else f"left out: {one.name}; {one.reason}; what it does hangs on how the drive accelerates: give the "
            "recording to know what that costs"
            for one in self.left_out
        ]
        if self.how == "refitted":
            lines.append(f"'{self.drive.model.name}' was refitted along the recording, nothing was cut off")
        if self.how == "projected":
            lines.append(
                f"'{self.drive.model.name}' was projected over the range of validity, not refitted: give the "
                f"recording, and it will be"
            )
        what = "cost" if all(np.isfinite(one.torque) for one in self.left_out) else "cost of the rest"
        share = 100 * self.cost / self.torque if self.torque > 0 else 0.0
        if share < 100 * _ROUNDING:
            lines += [f"{what}: none, what is written has the same torque"] * (self.how != "exact")
        else:
            lines.append(
                f"{what}: RMS {self.cost:.3g} {unit} {self.over}, {share:.3g} % of the model's friction torque"
            )
        if self.test_percent is not None:
            full, here = self.test_percent
            lines.append(f"test error {here:.4g} % of the RMS motor torque; the whole model has {full:.4g} %")
        lines += [f"NOT DETERMINED by the recording: {key}: {why}" for key, why in self.not_identified.items()]
        return lines


def nearest(model: FittedModel, dialect: Dialect, recording: Recording | None = None) -> Nearest:
    """Return the model nearest to a fitted one that a target can express.

    Args:
        model: the fitted one.
        dialect: what the target can express.
        recording: to refit to, as read; projected over the range of validity without one.

    Raises:
        InputError: where the recording is of another kind of drive, or lacks what the model needs.
    """
    if recording is not None and recording.motion is not model.motion:
        raise InputError(
            f"the model is of a {model.motion.value} drive, the recording of a {recording.motion.value} one"
        )
    effects = {kind: [e for e in model.model.effects if _kind(e, dialect) == kind] for kind in _KINDS}
    law, same = model.model.law, dialect.same.get(model.model.law.name)
    exact = not effects["friction"] and (same is not None or law.name in dialect.own)
    motion, over = _motion(model, recording)
    aside = [*effects["bodies"], *effects["links"], *effects["recording"]]
    if exact:
        chosen = law if law.name in dialect.own else dialect.make()
        drive = Drive(Model(chosen, effects["written"]), model.inertia, model.motion)
        names = same or {}
        values = dict.fromkeys((p.key for p in drive.model.parameters), 0.0)
        values |= {names.get(k, k): v for k, v in model.parameters.items() if names.get(k, k) in values}
        values[drive.inertia_key] = model.inertia
        unknown = {names.get(k, k): why for k, why in undetermined(model).items() if names.get(k, k) in values}
        errors = None
    else:
        written = dialect.with_one_constant(effects["written"], [law, *effects["friction"]])
        drive = Drive(Model(dialect.make(), written), model.inertia, model.motion)
        values, unknown = _fitted(model, drive, motion, aside)
        errors = None if recording is None else _test_errors(model, drive, values, aside, recording)
    whole = Drive(Model(law, [e for e in model.model.effects if e not in aside]), model.inertia, model.motion)
    full = friction_over(whole, model.parameters, motion)
    keys = {drive.inertia_key, *(p.key for p in drive.model.parameters)}
    written_drive = Drive(drive.model, values[drive.inertia_key], model.motion)
    cost = 0.0 if exact else rms(full - friction_over(written_drive, values, motion))
    inertia = values[drive.inertia_key] + model.parameters.get("inertia-error.dJ", 0.0)
    return Nearest(
        Drive(drive.model, inertia, model.motion),
        {**{k: v for k, v in values.items() if k in keys}, drive.inertia_key: inertia},
        "exact" if exact else "projected" if recording is None else "refitted",
        _left_out(model, effects, motion, law if not exact else None, dialect, driven=recording is not None),
        cost,
        rms(full),
        over,
        errors,
        {k: why for k, why in unknown.items() if k in keys},
    )


_KINDS = ("written", "friction", "bodies", "links", "recording")
"""What becomes of an effect: it is written; the friction that is written does what it did; or it is left out, as it was
fitted beside the friction, which would have absurd values if it were to make a spring's or a body's torque, too."""


def _kind(effect: Effect, dialect: Dialect) -> str:
    name = effect.name.partition("(")[0]
    if name in dialect.effects:
        return "written"
    if name in OF_RECORDING:
        return "recording"
    if name in OF_LINKS:
        return "links"
    of_bodies = {"position", "acceleration"} & Model(NoFriction(), [effect]).needs
    return "bodies" if of_bodies and not effect.friction else "friction"


def _test_errors(
    model: FittedModel, drive: Drive, values: Mapping[str, float], aside: Sequence[Effect], recording: Recording
) -> tuple[float, float]:
    """Return the test errors [%] of the whole model and of what is written, with what is not written beside it."""
    from fricmodels.diagnosis import compare
    from fricmodels.model import Known

    beside = Model(drive.model.law, [*drive.model.effects, *aside])
    parts = (model.model, model.parameters), (beside, {**model.parameters, **values})
    own, found = (
        compare(recording, part.knowing(Known(numbers, fixed=True)), model.drive.inertia) for part, numbers in parts
    )
    return own.errors.held_out_percent, found.errors.held_out_percent


def _fitted(
    model: FittedModel, drive: Drive, motion: Recording, aside: Collection[Effect]
) -> tuple[dict[str, float], dict[str, str]]:
    """Return the parameters nearest to a model's friction over a motion, by least squares within their bounds.

    The model stands for the recording: noise, which it was freed of, is no friction. Without the effects that are set
    ``aside``: what is not written takes no part. And key → reason of what is not determined.
    """
    from fricmodels.filtering.preparation import bounded_least_squares

    held = {p.key: model.parameters[p.key] for p in drive.model.nonlinear_parameters}
    design, offset = drive.regressors(motion, list(held.values()))
    chosen = drive.model.linear_parameters
    shown = Model(model.model.law, [effect for effect in model.model.effects if effect not in aside])
    right = friction_over(Drive(shown, model.inertia, model.motion), model.parameters, motion) - offset
    moving = np.abs(motion.velocity) > 1e-3 * motion.peak_speed
    found = bounded_least_squares(design[:, moving], right[moving], chosen)
    parts = np.sqrt(np.mean((found[:, None] * design) ** 2, axis=1))
    found[parts < _ROUNDING * rms(right)] = 0.0
    values = {**held, **dict(zip((p.key for p in chosen), found.tolist(), strict=True))}
    values[drive.inertia_key] = model.inertia
    inside = {p.key for p in shown.parameters}
    vague = {k: why for k, why in undetermined(model).items() if not combined_within(why, inside)}
    kept = {k: why for k, why in vague.items() if k in values}
    idle = {one.name for one in shown.effects if _adds(model, one, motion) < _ROUNDING * rms(right)}
    idle |= {one.name for one in aside}
    behind = ", ".join(
        f"the model's {k}" for k in vague if "." not in k or (k not in values and k.split(".")[0] not in idle)
    )
    law = sorted(p.symbol for p in drive.model.law.parameters)
    return values, {**kept, **(dict.fromkeys(law, f"it stands for {behind}") if behind else {})}


def _of_its_course(effects: Iterable[Effect]) -> list[Effect]:
    """Return the effects whose memory takes in the acceleration: no motion but one that was driven shows what they do.

    Over a range of validity each channel goes at its own pace, so that the acceleration is not the rate of the
    velocity. A gap that is crossed so is crossed as no drive can.
    """
    alone = ((effect, Model(NoFriction(), [effect])) for effect in effects if effect.states)
    return [effect for effect, one in alone if "acceleration" in one.needs]


def undetermined(model: FittedModel) -> dict[str, str]:
    """Return key → reason of the parameters of a model's friction that the recording did not determine.

    Not of links, nor of a recording.
    """
    aside = {*OF_RECORDING, *OF_LINKS, "J", "M"}
    return {k: why for k, why in doubtful(model).items() if k.partition(".")[0].partition("(")[0] not in aside}


def _left_out(
    model: FittedModel,
    effects: Mapping[str, list[Effect]],
    motion: Recording,
    law: Law | None,
    dialect: Dialect,
    *,
    driven: bool,
) -> tuple[LeftOut, ...]:
    """Return what is left out; where no drive was ``driven`` so, of some without what that costs."""
    found = []
    if law is not None and law.name not in dialect.same:
        shape = model.document.terms[0].equation
        torque = rms(friction_over(Drive(Model(law), model.inertia, model.motion), model.parameters, motion))
        found.append(LeftOut(law.name, torque, f"'{dialect.make().name}' stands for {shape}"))
    reasons = {**OF_RECORDING, **OF_LINKS}
    apart = [] if driven else _of_its_course(effects["bodies"])
    for kind in _KINDS[1:]:
        for effect in effects[kind]:
            reason = reasons.get(effect.name.partition("(")[0], _NONE)
            if kind == "friction":
                reason = f"'{dialect.make().name}' stands for it"
            found.append(LeftOut(effect.name, np.nan if effect in apart else _adds(model, effect, motion), reason))
    return tuple(found)


def _adds(model: FittedModel, effect: Effect, motion: Recording) -> float:
    """Return the RMS torque that an effect of a model adds over a motion."""
    alone = Drive(Model(NoFriction(), [effect]), model.inertia, model.motion)
    return rms(friction_over(alone, model.parameters, motion))


def _motion(model: FittedModel, recording: Recording | None) -> tuple[Recording, str]:
    if recording is not None:
        from fricmodels.weakform.prepared import ready

        return ready(recording), "on the recording"
    return motion_over(model), "over the range of validity"
