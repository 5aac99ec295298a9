"""What an author gets wrong beside the equation, and what the exam says of it: the line, and what to write instead."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from fricmodels import Effect, Law, Parameter, State
from fricmodels.drive import Drive
from fricmodels.expressions import absolute, exp, power, sign
from fricmodels.model import Model
from fricmodels.plugins import load
from fricmodels.testing import EffectExam, LawExam, checks, sit
from fricmodels.testing.formula_text import NotRead, equations
from fricmodels.testing.recovery import rich_case
from fricmodels.testing.sitting import once
from fricmodels.testing.subject import subject


class Plain(Law):
    """Coulomb and viscous friction with a drag, right as it stands."""

    name = "plain-with-drag"
    formula = "τ_F = K_v·ω + D·|ω|·ω + K_c·sgn ω"
    K_v = Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")
    D = Parameter("D", unit="N m s^2/rad^2", lower=0.0, meaning="drag")
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="Coulomb friction torque")

    def torque(self, s: Any, p: Any) -> Any:
        return p.K_v * s.velocity + p.D * absolute(s.velocity) * s.velocity + p.K_c * sign(s.velocity)


class NumpySign(Plain):
    def torque(self, s: Any, p: Any) -> Any:
        return p.K_v * s.velocity + p.D * absolute(s.velocity) * s.velocity + p.K_c * np.sign(s.velocity)


class NumpyWhere(Plain):
    def torque(self, s: Any, p: Any) -> Any:
        return p.K_v * s.velocity + p.K_c * np.where(s.velocity >= 0, 1, -1)


class If(Plain):
    """The law with an if."""

    def torque(self, s: Any, p: Any) -> Any:
        return p.K_c if s.velocity > 0 else -p.K_c


class Max(Plain):
    def torque(self, s: Any, p: Any) -> Any:
        return p.K_v * max(s.velocity, 0)


class Misspelt(Plain):
    def torque(self, s: Any, p: Any) -> Any:
        return p.K_v * s.velocty


class Division(Plain):
    def torque(self, s: Any, p: Any) -> Any:
        return p.K_v * s.velocity + p.K_c * s.velocity / absolute(s.velocity)


class OtherFormula(Plain):
    formula = "τ_F = K_v·ω + D·ω² + K_c·sgn ω"


class Copy(Law):
    """The Coulomb-viscous law with other letters, in another order."""

    name = "copied"
    formula = "τ_F = C·sgn ω + B·ω"
    C = Parameter("C", unit="N m", lower=0.0, meaning="Coulomb friction torque")
    B = Parameter("B", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient")

    def torque(self, s: Any, p: Any) -> Any:
        return p.C * sign(s.velocity) + p.B * s.velocity


class Bristle(Effect):
    """A bristle, right as it stands."""

    name = "one-bristle"
    formula = "τ = F·z;  dz/dt = (ω − |ω|·z)/x_s"
    signature = "a loop"
    needs_motion = "reversals"
    F = Parameter("F", unit="N m", meaning="torque")
    x_s = Parameter("x_s", unit="rad", initial=0.1, lower=1e-9, meaning="distance", scan=(0.01, 0.1))
    z = State("z", meaning="deflection")
    turns, faster = -1, 1

    def torque(self, s: Any, p: Any) -> Any:
        return p.F * s.z

    def rates(self, s: Any, p: Any) -> Any:
        return {"z": self.faster * (s.velocity + self.turns * absolute(s.velocity) * s.z) / p.x_s}


class TwiceAsFast(Bristle):
    faster = 2


class Unsaid(Bristle):
    formula = "τ = F·z"


class Grows(Bristle):
    formula = "τ = F·z;  dz/dt = (ω + |ω|·z)/x_s"
    turns = 1


class Bump(Effect):
    """A bump at one position: τ = A·exp(−((q − q_0)/w)²)."""

    name = "bump"
    formula = "τ = A·exp(−((q − q_0)/w)²)"
    signature = "at one position"
    needs_motion = "motion over that position"
    A = Parameter("A", unit="N m", meaning="height")
    q_0 = Parameter("q_0", unit="rad", meaning="where it is", place=True, scan=(0.1, 0.3, 0.5, 0.7, 0.9))
    w = Parameter("w", unit="rad", initial=1.0, lower=1e-9, meaning="width", scan=(0.03, 0.1, 0.3))

    def torque(self, s: Any, p: Any) -> Any:
        return p.A * exp(-(((s.position - p.q_0) / p.w) ** 2))


class Unplaced(Bump):
    q_0 = Parameter("q_0", unit="rad", meaning="where it is", scan=(0.1, 0.3, 0.5))


class TorquePower(Effect):
    """Friction that grows with a power of the torque: τ = c·(|τ_m|/T_0)^n·sgn ω."""

    name = "torque-power"
    formula = "τ = c·(|τ_m|/T_0)^n·sgn ω"
    signature = "along the motion, growing with the torque"
    needs_motion = "torques of many sizes"
    c = Parameter("c", unit="N m", lower=0.0, meaning="friction torque at 1 N m")
    n = Parameter("n", initial=1.5, lower=0.5, upper=3.0, meaning="exponent", scan=(1.2, 1.6, 2.0))
    T_0 = Parameter("T_0", unit="N m", initial=1.0, lower=1.0, upper=1.0, meaning="torque that the power refers to")

    def torque(self, s: Any, p: Any) -> Any:
        return p.c * power(s.motor_torque, p.n, p.T_0) * sign(s.velocity)


MISTAKES: dict[str, tuple[type[Any], str, str]] = {
    "np.sign": (
        NumpySign,
        "own_functions",
        r"np.sign\(\).* in line \d+ of test_author_mistakes.py.*sign\(s.velocity\)",
    ),
    "np.where": (
        NumpyWhere,
        "own_functions",
        r"np.where\(\) is used in line \d+ of test_author_mistakes.py.*write where\(",
    ),
    "if": (If, "torque_is_an_expression", r"line \d+ of test_author_mistakes.py: return .*where\(condition, yes, no\)"),
    "max": (Max, "torque_is_an_expression", r"\(line \d+ of test_author_mistakes.py: .*maximum\(x, y\) for max\(\)"),
    "misspelt": (Misspelt, "torque_is_an_expression", r"\(line \d+ of test_author.*did you mean s.velocity\?"),
    "0/0 at rest": (Division, "units", "not finite at rest.*division by zero"),
    "another formula": (
        OtherFormula,
        "formula",
        r"the formula says τ = .*, torque\(\) gives .* write the same in both",
    ),
    "a copy": (Copy, "no_copy", "it is 'coulomb-viscous' of fricmodels under another name"),
    "a rate twice as fast": (TwiceAsFast, "formula", r"the formula says dz/dt = .*, rates\(\) gives"),
    "a rate that is not said": (Unsaid, "formula", r"does not say how the state z changes; add '; dz/dt = …'"),
    "a rate that grows": (Grows, "identifiable", r"grows without bound: look at the signs in rates\(\)"),
    "a place taken for a length": (Unplaced, "parameters_matter", "q_0 is a place in the travel.*place=True"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_is_caught(mistake: str) -> None:
    cls, check, message = MISTAKES[mistake]
    exam = LawExam if issubclass(cls, Law) else EffectExam
    outcome = sit(type("Exam", (exam,), {"term": cls}), f"test_{check}")
    assert outcome.result == "failed", outcome
    assert re.search(message, outcome.message), outcome.message


@pytest.mark.parametrize("cls", [Plain, Bristle, Bump, TorquePower])
def test_what_is_right_passes(cls: type[Any]) -> None:
    exam = type("Exam", (LawExam if issubclass(cls, Law) else EffectExam,), {"term": cls})
    left = ("test_registered", "test_compiled")
    outcomes = {name: sit(exam, name) for name in checks(exam) if name not in left}
    assert {name: o.message for name, o in outcomes.items() if not o.good} == {}
    assert outcomes["test_recovered"].result == outcomes["test_formula"].result == "passed"


def test_one_mistake_is_one_failure() -> None:
    exam = type("Exam", (LawExam,), {"term": If})
    outcomes = once([sit(exam, name) for name in checks(exam) if name != "test_registered"])
    assert [o.check for o in outcomes if not o.good] == ["test_torque_is_an_expression"]
    assert sum("not tried: see 'torque is an expression'" in o.message for o in outcomes) > 10


def test_a_copy_that_is_meant_says_so() -> None:
    meant = type("Meant", (Copy,), {"same_as": frozenset({"coulomb-viscous"}), "__doc__": "On purpose."})
    assert sit(type("Exam", (LawExam,), {"term": meant}), "test_no_copy").result == "passed"


def test_what_a_class_says_of_its_exam_counts_everywhere() -> None:
    from fricmodels.testing.sitting import exam_of

    said = type("Said", (Bump,), {"exam": {"truth": {"A": 0.05, "q_0": -2.0, "w": 0.5}, "tolerance": 0.1}})
    for exam in (type("Exam", (EffectExam,), {"term": said}), exam_of("effect", said)):
        assert exam.truth == said.exam["truth"]
        assert exam.tolerance == 0.1
    assert type("Exam", (EffectExam,), {"term": said, "tolerance": 0.2}).tolerance == 0.2


def test_a_constant_is_not_estimated() -> None:
    case = rich_case(subject(TorquePower))
    fit = load().estimators["batch"]().fit(case.drive, case.recording)
    assert "torque-power.T_0" not in fit.standard_errors
    assert not fit.not_identified, "a constant is no direction in which anything could change"
    assert fit.parameters["torque-power.n"] == pytest.approx(case.truth["torque-power.n"], rel=2e-3)
    assert fit.parameters["torque-power.T_0"] == 1.0


@pytest.mark.parametrize("shift", [0.0, 100.0, -3000.0])
def test_a_place_is_found_wherever_the_position_has_its_zero(shift: float) -> None:
    case = rich_case(subject(Bump))
    moved = case.recording.with_channels(derived=False, position=case.recording["position"] + shift)
    drive = Drive(Model(load().laws["coulomb-viscous"](), [Bump()]), case.drive.inertia)
    fit = load().estimators["batch"]().fit(drive, moved)
    assert fit.parameters["bump.q_0"] - shift == pytest.approx(case.truth["bump.q_0"], abs=1e-3)
    assert fit.parameters["bump.A"] == pytest.approx(case.truth["bump.A"], rel=1e-3)


@pytest.mark.parametrize(
    ("formula", "value"),
    [
        ("τ = F·exp(−(|ω|/ω_s)^δ)·sgn ω", 2 * np.exp(-((3 / 1.5) ** 0.7))),
        ("τ = F cos kq + F·sin 2kq", 2 * np.cos(0.2) + 2 * np.sin(0.4)),
        ("τ = −F·ω² + S, S = |ω/ω_s|^(1/2)", -18 + 2**0.5),
        ("τ = F·e^(−|ω|)/(1 + |q − k|)", 2 * np.exp(-3) / 1.1),
    ],
)
def test_formulas_are_read(formula: str, value: float) -> None:
    given = {"velocity": 3.0, "position": 0.4, "F": 2.0, "omega_s": 1.5, "delta": 0.7, "k": 0.5}
    first, _ = equations(formula, ["F", "omega_s", "delta", "k"], [])
    assert first["τ"](given) == pytest.approx(value)


@pytest.mark.parametrize(
    "formula", ["τ = Σ F_i·φ_i", "τ = c for ω > 0", "a·ω", "τ = F·(ω", "τ = F·|ω", "τ = …", "d = "]
)
def test_formulas_in_words_are_not_read(formula: str) -> None:
    with pytest.raises(NotRead):
        equations(formula, ["F"], [])
