"""The model nearest to a fitted one that a target can express: refitted, not truncated; and what it leaves out."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from fricmodels import plugins
from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.export.targets.laws import PolynomialDamping, Viscous
from fricmodels.model import Model, NoFriction
from fricmodels.recording import CHANNELS, OTHER, Recording
from fricmodels.saved import FittedModel
from fricmodels.term import Effect, Law

OF_RECORDING = {
    "sensor-delay": "a delay of the recording, not of the drive",
    "run-offset": "a zero of the torque sensor in each run, not of the drive",
}
"""Effects that say nothing of the drive: they are fitted with it, and not written."""
OF_LINKS = {
    "gravity": "give the link its mass and its centre",
    "other-gravity": "give the links their masses",
    "other-inertia": "give the links their inertias",
    "proximal-coupling": "give the links their masses and inertias",
    "inertia-error": "it is added to the inertia",
}
"""Effects of rigid bodies, which a simulator computes by itself: they are fitted with the rest, and not written."""
_SAMPLES = 4000


@dataclass(frozen=True)
class Dialect:
    """What a target can express.

    Attributes:
        law: the law, or the name of one, that is fitted where the model's own cannot be expressed.
        same: for a law of the model by name, its parameters → those of ``law``: these are the same law.
        own: laws of a model that the target has as they are. effects: effects that it has.
        constants: of these the ones with a constant; where a model has none, the first is fitted beside the law.
    """

    law: type[Law] | str
    same: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    own: frozenset[str] = frozenset()
    effects: frozenset[str] = frozenset()
    constants: tuple[str, ...] = ()

    def make(self) -> Law:
        """Return the law that is fitted."""
        return plugins.load().laws[self.law]() if isinstance(self.law, str) else self.law()

    def with_one_constant(self, effects: Sequence[Effect]) -> list[Effect]:
        """Return the effects that are fitted beside the law: of several constants only their sum is known."""
        last = [name for name in self.constants if name in {effect.name for effect in effects}][-1:]
        kept = [effect for effect in effects if effect.name not in self.constants or effect.name in last]
        return kept if last or not self.constants else [*kept, plugins.load().effects[self.constants[0]]()]


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
            lines.append(f"'{self.drive.model.name}' was refitted to the recording, nothing was cut off")
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
    exact = not effects["lost"] and (same is not None or law.name in dialect.own)
    motion, over = _motion(model, recording)
    apart = _of_its_course(effects["lost"]) if recording is None else []
    if exact:
        chosen = law if law.name in dialect.own else dialect.make()
        drive = Drive(Model(chosen, effects["written"]), model.inertia, model.motion)
        names = same or {}
        values = dict.fromkeys((p.key for p in drive.model.parameters), 0.0)
        values |= {names.get(k, k): v for k, v in model.parameters.items() if names.get(k, k) in values}
        values[drive.inertia_key] = model.inertia
        unknown = {names.get(k, k): why for k, why in model.not_identified.items() if names.get(k, k) in values}
        errors = None
    else:
        chosen = dialect.make()
        effects["written"] = dialect.with_one_constant(effects["written"])
        beside = [*effects["written"], *effects["links"], *effects["recording"]]
        fitted = Drive(Model(chosen, beside), model.drive.inertia, model.motion)
        values, unknown, errors = (
            _projected(model, fitted, motion, apart) if recording is None else _refitted(model, fitted, recording)
        )
        drive = Drive(Model(fitted.model.law, effects["written"]), values[fitted.inertia_key], model.motion)
    aside = [*effects["links"], *effects["recording"], *apart]
    left = _left_out(model, effects, motion, law if not exact else None, dialect, apart)
    whole = Drive(Model(law, [e for e in model.model.effects if e not in aside]), model.inertia, model.motion)
    full = _friction(whole, model.parameters, motion)
    cost = 0.0 if exact else rms(full - _friction(drive, values, motion))
    inertia = values[drive.inertia_key] + model.parameters.get("inertia-error.dJ", 0.0)
    keys = {drive.inertia_key, *(p.key for p in drive.model.parameters)}
    return Nearest(
        Drive(drive.model, inertia, model.motion),
        {**{k: v for k, v in values.items() if k in keys}, drive.inertia_key: inertia},
        "exact" if exact else "projected" if recording is None else "refitted",
        left,
        cost,
        rms(full),
        over,
        errors,
        {k: why for k, why in unknown.items() if k in keys},
    )


_KINDS = ("written", "lost", "links", "recording")


def _kind(effect: Effect, dialect: Dialect) -> str:
    name = effect.name.partition("(")[0]
    if name in dialect.effects:
        return "written"
    return "recording" if name in OF_RECORDING else "links" if name in OF_LINKS else "lost"


def _refitted(
    model: FittedModel, drive: Drive, recording: Recording
) -> tuple[dict[str, float], dict[str, str], tuple[float, float] | None]:
    from fricmodels.diagnosis import compare
    from fricmodels.model import Known

    found = compare(recording, drive.model.knowing(Known(model.parameters)), drive.inertia)
    known = Known(model.parameters, model.standard_errors, fixed=True)
    own = compare(recording, model.model.knowing(known), model.drive.inertia)
    errors = (own.errors.held_out_percent, found.errors.held_out_percent)
    return dict(found.estimate.parameters), dict(found.estimate.not_identified), errors


def _projected(
    model: FittedModel, drive: Drive, motion: Recording, apart: Collection[Effect]
) -> tuple[dict[str, float], dict[str, str], tuple[float, float] | None]:
    """Return the parameters nearest to a model's torque over a motion, by least squares within their bounds.

    Without the effects that are set ``apart``, see :func:`_of_its_course`.
    """
    from fricmodels.filtering.preparation import bounded_least_squares

    linear = drive.model.linear
    held = {p.key: model.parameters[p.key] for p, ok in zip(drive.model.parameters, linear, strict=True) if not ok}
    design, offset = drive.regressors(motion, list(held.values()))
    declared = [p for p, ok in zip(drive.model.parameters, linear, strict=True) if ok]
    lower = np.array([p.declared.lower for p in declared])
    upper = np.array([p.declared.upper for p in declared])
    shown = Model(model.model.law, [effect for effect in model.model.effects if effect not in apart])
    right = _friction(Drive(shown, model.inertia, model.motion), model.parameters, motion) - offset
    moving = np.abs(motion.velocity) > 1e-3 * motion.peak_speed
    found = bounded_least_squares(design[:, moving], right[moving], lower, upper, [])
    parts = np.sqrt(np.mean((found[:, None] * design) ** 2, axis=1))
    found[parts < _ROUNDING * rms(right)] = 0.0
    values = {**held, **dict(zip((p.key for p in declared), found.tolist(), strict=True))}
    values[drive.inertia_key] = model.inertia
    kept = {k: why for k, why in model.not_identified.items() if k in values}
    idle = {one.name for one in shown.effects if _adds(model, one, motion) < _ROUNDING * rms(right)}
    idle |= {one.name for one in apart}
    behind = ", ".join(
        f"the model's {k}"
        for k in undetermined(model)
        if "." not in k or (k not in values and k.split(".")[0] not in idle)
    )
    law = sorted(p.symbol for p in drive.model.law.parameters)
    return values, {**kept, **(dict.fromkeys(law, f"it was projected from {behind}") if behind else {})}, None


def _of_its_course(effects: Iterable[Effect]) -> list[Effect]:
    """Return the effects whose memory takes in the acceleration: no motion but one that was driven shows what they do.

    Over a range of validity each channel goes at its own pace, so that the acceleration is not the rate of the
    velocity. A gap that is crossed so is crossed as no drive can.
    """
    alone = ((effect, Model(NoFriction(), [effect])) for effect in effects if effect.states)
    return [effect for effect, one in alone if "acceleration" in one.needs]


def undetermined(model: FittedModel) -> list[str]:
    """Return the keys of a model's friction that the recording did not determine; not of links, nor of a recording."""
    aside = {*OF_RECORDING, *OF_LINKS, "J", "M"}
    return [k for k in model.not_identified if k.partition(".")[0].partition("(")[0] not in aside]


def _left_out(
    model: FittedModel,
    effects: Mapping[str, list[Effect]],
    motion: Recording,
    law: Law | None,
    dialect: Dialect,
    apart: Collection[Effect],
) -> tuple[LeftOut, ...]:
    """Return what is left out; of effects that are set ``apart`` without what that costs."""
    found = []
    if law is not None and law.name not in dialect.same:
        shape = model.document.terms[0].equation
        torque = rms(_friction(Drive(Model(law), model.inertia, model.motion), model.parameters, motion))
        found.append(LeftOut(law.name, torque, f"'{dialect.make().name}' stands for {shape}"))
    reasons = {**OF_RECORDING, **OF_LINKS}
    for kind in ("lost", "links", "recording"):
        for effect in effects[kind]:
            reason = reasons.get(effect.name.partition("(")[0], "the target has nothing of its kind")
            found.append(LeftOut(effect.name, np.nan if effect in apart else _adds(model, effect, motion), reason))
    return tuple(found)


def _adds(model: FittedModel, effect: Effect, motion: Recording) -> float:
    """Return the RMS torque that an effect of a model adds over a motion."""
    alone = Drive(Model(NoFriction(), [effect]), model.inertia, model.motion)
    return rms(_friction(alone, model.parameters, motion))


def _friction(drive: Drive, values: Mapping[str, float], motion: Recording) -> Array:
    return drive.friction(motion, {**values, drive.inertia_key: values.get(drive.inertia_key, 0.0)})


def _motion(model: FittedModel, recording: Recording | None) -> tuple[Recording, str]:
    if recording is not None:
        from fricmodels.weakform.prepared import ready

        return ready(recording), "on the recording"
    return motion_over(model), "over the range of validity"


def motion_over(model: FittedModel) -> Recording:
    """Return a motion that goes through the ranges that a model is valid in, evenly, each channel at its own pace.

    Where the model remembers its way and does not look at the clock, the drive goes as far between two reversals as it
    did in the recording: a contact that bends over a millimetre is not bent all the time.
    """
    time = np.linspace(*model.ranges.get("time", (0.0, 40.0)), _SAMPLES)
    passed = 40.0 * np.arange(_SAMPLES) / _SAMPLES
    channels: dict[str, Array] = {"time": time}
    reversals, paces = 0.0, iter(np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0]))
    wanted = {*CHANNELS, *(n for n in model.document.units)} | {n for n in model.document.range if n.startswith(OTHER)}
    for name in sorted(wanted - {"time", "current", "torque_rate"}):
        low, high = model.ranges.get(name, (-1.0, 1.0))
        phase = passed * next(paces) / 2.0
        channels[name] = low + (high - low) * np.abs(2 * (phase % 1.0) - 1)
        if name == "velocity":
            reversals = 2 * float(phase[-1])
    low, high = model.ranges.get("position", (0.0, 0.0))
    way, speed = high - low, float(np.mean(np.abs(channels["velocity"])))
    if model.model.states and "time" not in model.needs and way > 0 and speed > 0:
        channels["time"] = np.linspace(0.0, reversals * way / speed, _SAMPLES)
    run = np.full(_SAMPLES, model.document.runs[0], dtype=np.int64)
    return Recording("range of validity", Motion(model.motion), channels, run, units=dict(model.document.units))


def rms(values: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
