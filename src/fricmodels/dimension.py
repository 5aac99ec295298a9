"""Physical dimensions of parameters, and the scaling that they allow.

A rotary drive and a linear axis obey the same equations, so one set of base quantities serves both:
*force* (torque in N m, or force in N), *displacement* (rad, or m), *time* (s) and *temperature* (K).
A unit such as ``N m s/rad`` or ``N s/m`` is the dimension force × time / displacement in either case.
Changing the size of these base quantities must leave every torque equation true; this is both the check on
declared units and the normalisation of the paper (eq. 6).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

from fricmodels.errors import InputError


class Motion(StrEnum):
    """Whether a drive turns or slides; it decides the names of units and columns."""

    ROTARY = "rotary"
    LINEAR = "linear"


@dataclass(frozen=True)
class Dimension:
    """Exponents of the four base quantities."""

    force: Fraction = Fraction(0)
    displacement: Fraction = Fraction(0)
    time: Fraction = Fraction(0)
    temperature: Fraction = Fraction(0)

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(
            self.force + other.force,
            self.displacement + other.displacement,
            self.time + other.time,
            self.temperature + other.temperature,
        )

    def __pow__(self, exponent: int | Fraction) -> Dimension:
        e = Fraction(exponent)
        return Dimension(self.force * e, self.displacement * e, self.time * e, self.temperature * e)

    def unit(self, motion: Motion = Motion.ROTARY) -> str:
        """Name the coherent SI unit of this dimension, such as ``N m s/rad`` or ``N s/m``."""
        if self == INERTIA:
            return "kg m^2" if motion is Motion.ROTARY else "kg"
        rotary = motion is Motion.ROTARY
        parts = [
            ("N m" if rotary else "N", self.force),
            ("s", self.time),
            ("rad" if rotary else "m", self.displacement),
            ("K", self.temperature),
        ]
        above = " ".join(_power(symbol, e) for symbol, e in parts if e > 0)
        below = "/".join(_power(symbol, -e) for symbol, e in parts if e < 0)
        if not above and not below:
            return "1"
        return f"{above or '1'}/{below}" if below else above


def _power(symbol: str, exponent: Fraction) -> str:
    if exponent == 1:
        return symbol
    text = str(exponent) if exponent.denominator == 1 else f"({exponent})"
    return f"({symbol})^{text}" if " " in symbol else f"{symbol}^{text}"


FORCE = Dimension(force=Fraction(1))
DISPLACEMENT = Dimension(displacement=Fraction(1))
TIME = Dimension(time=Fraction(1))
TEMPERATURE = Dimension(temperature=Fraction(1))
DIMENSIONLESS = Dimension()
VELOCITY = DISPLACEMENT * TIME**-1
ACCELERATION = VELOCITY * TIME**-1
INERTIA = FORCE * ACCELERATION**-1
VISCOUS = FORCE * VELOCITY**-1

_TOKEN = re.compile(r"\s*(?:(?P<symbol>[A-Za-zµ°]+)(?:\^(?P<exp>\(?-?\d+(?:/\d+|\.\d+)?\)?))?|(?P<one>1)|(?P<slash>/))")


def parse_unit(unit: str) -> Dimension:
    """Read a unit such as ``N m s/rad``, ``s/rad``, ``N m s^(1/2)/rad^(1/2)``, ``N s/m``, ``kg m^2`` or ``1``.

    Everything after the first ``/`` up to the next one is below the line. Units must be coherent SI.

    Raises:
        InputError: for a symbol that is not N, m, kg, s, rad or K, or a unit of mixed motion.
    """
    exponents: dict[str, Fraction] = {}
    sign, position = 1, 0
    text = unit.strip()
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise InputError(f"cannot read the unit '{unit}' at '{text[position:]}'")
        position = match.end()
        if match["slash"]:
            sign = -1
        elif match["symbol"]:
            exponent = Fraction((match["exp"] or "1").strip("()"))
            exponents[match["symbol"]] = exponents.get(match["symbol"], Fraction(0)) + sign * exponent
    unknown = set(exponents) - {"N", "m", "kg", "s", "rad", "K"}
    if unknown:
        raise InputError(f"unit '{unit}' has the unknown symbol '{sorted(unknown)[0]}'; use N, m, kg, s, rad, K")
    newton, metre, mass = (exponents.get(symbol, Fraction(0)) for symbol in ("N", "m", "kg"))
    time = TIME ** exponents.get("s", Fraction(0)) * TEMPERATURE ** exponents.get("K", Fraction(0))
    if metre == newton + 2 * mass:
        angle = DISPLACEMENT ** exponents.get("rad", Fraction(0))
        return FORCE**newton * INERTIA**mass * angle * time
    if "rad" in exponents:
        raise InputError(f"unit '{unit}' mixes rad with metres that belong to no torque or inertia")
    return FORCE**newton * INERTIA**mass * DISPLACEMENT**metre * time


@dataclass(frozen=True)
class Scales:
    """Sizes, in SI, of the units in which a problem is solved.

    The paper's normalisation (eq. 6) is ``time = 1/ω``, ``displacement = 1`` and ``force = J ω²``, so that the
    normalised inertia is 1. Dividing an SI value by :meth:`of` its dimension gives the normalised value.
    """

    force: float = 1.0
    displacement: float = 1.0
    time: float = 1.0
    temperature: float = 1.0

    def of(self, dimension: Dimension) -> float:
        """Return the SI size of one normalised unit of ``dimension``."""
        return float(
            self.force ** float(dimension.force)
            * self.displacement ** float(dimension.displacement)
            * self.time ** float(dimension.time)
            * self.temperature ** float(dimension.temperature)
        )
