"""Deliberate mistakes in a law or an effect: each is caught by the exam, with a message that names the mistake."""

from __future__ import annotations

import itertools
import re
import time
from collections.abc import Callable
from typing import Any

import casadi
import numpy as np
import pytest

from fricmodels import Effect, Law, Parameter, State
from fricmodels.expressions import absolute, exp, sign, sqrt
from fricmodels.testing import EffectExam, LawExam, Outcome, checks, sit

NUMBERS = itertools.count()
"""Models are known by their names: each mutant has its own."""

DECLARED = {
    "K_v": Parameter("K_v", unit="N m s/rad", lower=0.0, meaning="viscous friction coefficient"),
    "K_c": Parameter("K_c", unit="N m", lower=0.0, meaning="stick torque", at_least="C"),
    "C": Parameter("C", unit="N m", lower=0.0, meaning="slip torque"),
    "B": Parameter("B", unit="s/rad", lower=0.0, meaning="stick-to-slip rate", scan=(3.0, 10.0, 30.0)),
}


def right(self: Law, s: Any, p: Any) -> Any:
    return p.K_v * s.velocity + (p.C + (p.K_c - p.C) * exp(-p.B * absolute(s.velocity))) * sign(s.velocity)


def law(torque: Callable[[Any, Any, Any], Any] = right, **changed: Any) -> type[Law]:
    """Return the exponential law with something changed."""
    words = {
        "name": f"mutant-{next(NUMBERS)}",
        "formula": "τ_F = …",
        "same_as": frozenset({"exponential-stick-slip"}),
        "symmetry": "odd",
        "__doc__": "A mutant.",
        "torque": torque,
    }
    return type("Mutant", (Law,), {**words, **DECLARED, **changed})


def examined(exam: type[Any], subject: type[Any]) -> dict[str, Outcome]:
    """Return the outcomes of all checks but registration and recovery, by name."""
    sitting = type("Exam", (exam,), {"term": subject})
    names = [name for name in checks(sitting) if name not in ("test_registered", "test_recovered", "test_compiled")]
    return {name.removeprefix("test_"): sit(sitting, name) for name in names}


def scanless() -> Parameter:
    return Parameter("B", unit="s/rad", lower=0.0, meaning="stick-to-slip rate")


MISTAKES: dict[str, tuple[Callable[[], type[Law]], str, str]] = {
    "wrong sign": (
        lambda: law(lambda self, s, p: -p.K_v * s.velocity + right(self, s, p) - p.K_v * s.velocity),
        "dissipative",
        "the part with K_v has the wrong sign",
    ),
    "wrong unit": (
        lambda: law(K_v=Parameter("K_v", unit="N m", lower=0.0, meaning="viscous friction coefficient")),
        "units",
        "K_v has the wrong unit 'N m': the torque equation needs 'N m s/rad'",
    ),
    "wrong unit of a nonlinear parameter": (
        lambda: law(B=Parameter("B", unit="rad/s", lower=0.0, meaning="rate", scan=(3.0, 10.0))),
        "units",
        "B has the wrong unit 'rad/s': the torque equation needs 's/rad'",
    ),
    "a number that hides a unit": (
        lambda: law(lambda self, s, p: right(self, s, p) * (1 + absolute(s.velocity))),
        "units",
        "a sum or a function mixes quantities of different units; give each number",
    ),
    "missing |ω|": (
        lambda: law(
            lambda self, s, p: p.K_v * s.velocity + (p.C + (p.K_c - p.C) * exp(-p.B * s.velocity)) * sign(s.velocity)
        ),
        "symmetry",
        r"the directions differ in size.*use absolute\(s.velocity\)",
    ),
    "forgotten sgn": (
        lambda: law(
            lambda self, s, p: p.K_v * s.velocity + p.C + (p.K_c - p.C) * exp(-p.B * absolute(s.velocity)),
        ),
        "dissipative",
        r"the part with (K_c|C) does not turn with the direction.*multiply it by sign\(s.velocity\)",
    ),
    "sgn forgotten everywhere": (
        lambda: law(
            lambda self, s, p: p.K_v * absolute(s.velocity) + p.C + (p.K_c - p.C) * exp(-p.B * absolute(s.velocity)),
            dissipative=False,
        ),
        "symmetry",
        "the sign of the direction is forgotten",
    ),
    "a bound the wrong way": (
        lambda: law(K_v=Parameter("K_v", unit="N m s/rad", upper=0.0, meaning="viscous friction coefficient")),
        "dissipative",
        r"negative K_v, which its bounds \[-inf, 0\] allow.*lower=0.0",
    ),
    "a missing bound": (
        lambda: law(K_v=Parameter("K_v", unit="N m s/rad", meaning="viscous friction coefficient")),
        "dissipative",
        r"negative K_v, which its bounds \[-inf, inf\] allow",
    ),
    "a friction that is negative at some places": (
        lambda: law(
            lambda self, s, p: right(self, s, p) + p.k * s.position * sign(s.velocity),
            k=Parameter("k", unit="N m/rad", meaning="friction that grows with position"),
        ),
        "dissipative",
        r"the part with k pushes along the motion where position is negative, with a positive k too: τ = .* at "
        r"position = -.*absolute\(s.position\)",
    ),
    "a derivative that is NaN at rest": (
        lambda: law(
            lambda self, s, p: right(self, s, p) + p.R * sqrt(absolute(s.velocity)) * sign(s.velocity),
            R=Parameter("R", unit="N m s^(1/2)/rad^(1/2)", lower=0.0, meaning="coefficient of the root of speed"),
        ),
        "finite_at_rest_and_at_bounds",
        r"derivative of the torque by velocity is (not a number|infinite) at rest.*power\(s.velocity, n\)",
    ),
    "a division by zero at rest": (
        lambda: law(lambda self, s, p: p.K_v * s.velocity + p.K_c * s.velocity / absolute(s.velocity)),
        "finite_at_rest_and_at_bounds",
        "torque is not finite at rest.*division by zero",
    ),
    "not finite at a bound": (
        lambda: law(lambda self, s, p: p.K_v * s.velocity + p.C**2 / p.K_c * sign(s.velocity)),
        "finite_at_rest_and_at_bounds",
        "not finite with K_c at its lower bound 0",
    ),
    "time-dependent without saying so": (
        lambda: law(lambda self, s, p: right(self, s, p) * exp(-p.B * absolute(s.velocity) * s.time / s.time)),
        "depends_on_its_signals_alone",
        "depends on the time itself and does not say so; declare depends_on_time = True",
    ),
    "the clock of the computer": (
        lambda: law(lambda self, s, p: right(self, s, p) * (1 + 1e-3 * (time.perf_counter() % 1))),
        "depends_on_its_signals_alone",
        "another expression at every call",
    ),
    "wrong shape": (
        lambda: law(lambda self, s, p: casadi.vertcat(right(self, s, p), 0)),
        "torque_is_an_expression",
        "wrong shape 2×1; return one scalar",
    ),
    "an array instead of an expression": (
        lambda: law(lambda self, s, p: np.zeros(3)),
        "torque_is_an_expression",
        "returns ndarray, no expression",
    ),
    "forgotten return": (
        lambda: law(lambda self, s, p: None),
        "torque_is_an_expression",
        "returns nothing; end it with return",
    ),
    "a nonlinear parameter with no scan": (
        lambda: law(B=scanless()),
        "parameters_matter",
        "B enters nonlinearly and has no scan",
    ),
    "an exception in torque": (
        lambda: law(lambda self, s, p: p.K_v * s.velocity + {}["K_c"]),
        "torque_is_an_expression",
        r"torque\(\) raises KeyError: 'K_c' \(line \d+ of test_mutations.py: ",
    ),
    "a misspelt parameter": (
        lambda: law(lambda self, s, p: p.K_w * s.velocity),
        "torque_is_an_expression",
        "there is no parameter 'K_w'; declared: K_v, K_c, C, B",
    ),
    "if on a symbol": (
        lambda: law(lambda self, s, p: p.K_c if s.velocity > 0 else -p.K_c),
        "torque_is_an_expression",
        r"torque\(\) raises .*fricmodels.expressions",
    ),
    "a parameter that is never used": (
        lambda: law(Z=Parameter("Z", unit="N m", lower=0.0, meaning="nothing")),
        "parameters_matter",
        "Z is declared but enters neither",
    ),
    "two parameters that do the same": (
        lambda: law(
            lambda self, s, p: right(self, s, p) + p.D * s.velocity,
            D=Parameter("D", unit="N m s/rad", lower=0.0, meaning="viscous friction once more"),
        ),
        "identifiable",
        "D and K_v cannot be told apart",
    ),
    "bounds in a circle": (
        lambda: law(C=Parameter("C", unit="N m", lower=0.0, meaning="slip torque", at_least="K_c")),
        "finite_at_rest_and_at_bounds",
        "at_least goes round in a circle",
    ),
    "a name with capitals": (lambda: law(name="MyLaw"), "declaration", "lower case with hyphens"),
    "an unknown unit": (
        lambda: law(K_v=Parameter("K_v", unit="lbf ft", lower=0.0, meaning="viscous friction")),
        "declaration",
        "unit of K_v: .*unknown symbol",
    ),
    "rounding": (
        lambda: law(lambda self, s, p: right(self, s, p) + p.K_v * casadi.floor(s.velocity * 1e7) / 1e7),
        "derivatives",
        "rounding or a jump hides the slope",
    ),
}


def test_the_law_itself_passes() -> None:
    outcomes = examined(LawExam, law())
    assert {name: o.message for name, o in outcomes.items() if not o.good} == {}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_is_caught_by_name(mistake: str) -> None:
    make, check, message = MISTAKES[mistake]
    outcome = sit(type("Exam", (LawExam,), {"term": make()}), f"test_{check}")
    assert outcome.result == "failed", outcome
    assert re.search(message, outcome.message), outcome.message
    assert "\n" not in outcome.message


class Bump(Effect):
    """An effect with a memory, right as it stands."""

    name = "mutant-effect"
    formula = "τ = F·z;  dz/dt = (ω − |ω|·z)/x_s"
    signature = "a loop"
    needs_motion = "reversals"
    F = Parameter("F", unit="N m", meaning="torque")
    x_s = Parameter("x_s", unit="rad", initial=0.1, lower=1e-9, meaning="distance", scan=(0.01, 0.1))
    z = State("z", meaning="deflection")

    def torque(self, s: Any, p: Any) -> Any:
        return p.F * s.z

    def rates(self, s: Any, p: Any) -> Any:
        return {"z": (s.velocity - absolute(s.velocity) * s.z) / p.x_s}


def effect(**changed: Any) -> type[Effect]:
    """Return the effect with something changed."""
    return type("Mutant", (Bump,), {"name": f"mutant-effect-{next(NUMBERS)}", "__doc__": "A mutant.", **changed})


EFFECTS: dict[str, tuple[dict[str, Any], str, str]] = {
    "not absent at zero": (
        {"torque": lambda self, s, p: p.F * s.z + s.motor_torque},
        "neutral",
        "with all linear parameters zero the effect still adds",
    ),
    "cannot be absent": (
        {"F": Parameter("F", unit="N m", initial=2.0, lower=1.0, meaning="torque")},
        "neutral",
        "F cannot be zero within",
    ),
    "a step of another law than the rates": (
        {"discrete_step": lambda self, s, later, h, p: {"z": s.z + h * s.velocity / p.x_s}},
        "discrete_step",
        "over a short discrete_step()",
    ),
    "an unknown beginning of what is not linear": (
        {"beginning_unknown": True, "torque": lambda self, s, p: p.F * s.z * absolute(s.z)},
        "beginning",
        "linear in the states",
    ),
    "a state without its rate": ({"rates": lambda self, s, p: {}}, "torque_is_an_expression", "no rate for the state"),
    "wrong unit of a rate": (
        {"rates": lambda self, s, p: {"z": (s.velocity - absolute(s.velocity) * s.z) * p.x_s}},
        "units",
        "x_s has the wrong unit 'rad': the torque equation needs '1/rad'",
    ),
    "no words": ({"signature": ""}, "declaration", "signature is empty"),
    "not linear in the acceleration": (
        {"torque": lambda self, s, p: p.F * s.z * absolute(s.acceleration)},
        "torque_is_an_expression",
        "not linear in s.acceleration",
    ),
}


def test_the_effect_itself_passes() -> None:
    outcomes = examined(EffectExam, Bump)
    assert {name: o.message for name, o in outcomes.items() if not o.good} == {}


@pytest.mark.parametrize("mistake", EFFECTS)
def test_is_caught_in_an_effect(mistake: str) -> None:
    changed, check, message = EFFECTS[mistake]
    outcome = sit(type("Exam", (EffectExam,), {"term": effect(**changed)}), f"test_{check}")
    assert outcome.result == "failed", outcome
    assert re.search(message, outcome.message), outcome.message
