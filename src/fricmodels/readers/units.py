"""Units of columns: to coherent SI, with the angle as a quantity of its own.

Any unit that Pint knows can be written, with a factor if need be: ``deg/s``, ``rpm``, ``ms``, ``kN``, ``0.5 um``.
Encoder counts state their resolution as counts a turn: ``count/2000`` is a two-thousandth of a turn, and
``count/2000/s`` a speed. Hertz is not a speed here, for nobody knows whether it counts turns or radians; what is
counted a minute is turns, and so is ``rev``. A mass times a length is a torque where one is asked for: the weight of
that mass at that arm.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.readers.unit_spelling import spelled
from fricmodels.readers.unit_text import is_plain
from fricmodels.recording import CHANNELS, word

_NOT_MECHANICAL = {"temperature": "degC", "current": "A"}
_COUNT = re.compile(r"\bcounts?\b")
_OWN_SIZE = re.compile(r"(?<![\^*])\d|\bpi\b|^\s*-")
"""A number that is no exponent, or a sign: what says how large a unit is."""


@dataclass(frozen=True)
class Conversion:
    """``SI value = factor × value + offset``."""

    factor: float
    offset: float

    def __call__(self, values: Array) -> Array:
        """Convert an array."""
        if self.factor == 1.0 and self.offset == 0.0:
            return values
        return self.factor * values + self.offset


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry()
    registry.define("newton_metre = newton * meter = Nm")
    return registry


@contextmanager
def _worked_out(unit: str) -> Iterator[None]:
    """Whatever Pint makes of a text from a file: where it fails, the text is no unit."""
    try:
        yield
    except Exception:
        raise InputError(f"unknown unit '{unit}'") from None


@lru_cache(maxsize=256)
def _quantity(unit: str) -> Any:
    """Return one of the unit. The angle stays in its root units, where Pint's dimensions leave it out."""
    text = spelled(unit)
    if not is_plain(text):
        raise InputError(f"unknown unit '{unit if len(unit) < 60 else unit[:60] + '…'}'")
    registry = _registry()
    with _worked_out(unit):
        try:
            return registry.Quantity(1.0, registry.parse_units(text))
        except Exception:
            return registry.Quantity(registry.parse_expression(_COUNT.sub("turn", text).replace("°", "deg")))


@lru_cache(maxsize=256)
def _in_channel(unit: str, channel: str) -> Any:
    """Return one of the unit as it is meant of a channel: a mass at an arm is a torque, counts a minute are turns.

    Single letters mean something there alone: C and F of a temperature, U (Umdrehung) of a position.
    """
    if channel == "temperature" and unit in ("C", "F"):
        return _quantity(f"deg{unit}")
    if channel == "position" and unit == "U":
        return _quantity("turn")
    quantity, registry = _quantity(unit), _registry()
    if channel not in ("torque", "load_torque", "velocity"):
        return quantity
    with _worked_out(unit):
        base = registry.get_root_units(quantity.units)[1]
        if channel == "velocity":
            turns = base == registry.get_root_units("1/s")[1] and "minute" in quantity.units._units
            return quantity * registry.Quantity(1.0, "turn") if turns else quantity
        weighs = base == registry.get_root_units("kg*m")[1]
        return quantity * registry.Quantity(1.0, "kgf/kg") if weighs else quantity


_OWN = frozenset(
    ("s", "rad", "rad/s", "rad/s^2", "m", "m/s", "m/s^2", "N m", "N", "degC", "A", "V", "kg", "kg m^2", "Pa", "W")
)
"""SI units as this package writes them: each measures what no other of them does. Pint takes 0.3 s to say so."""


def _own(unit: str) -> str:
    """Return an SI unit as this package writes it, or an empty text for any other unit."""
    written = {"Nm": "N m", "N*m": "N m", "kg*m^2": "kg m^2"}.get(unit, unit)
    return written if written in _OWN else ""


def _measures(unit: str, target: str, channel: str = "") -> bool:
    if _own(unit) and _own(target):
        return _own(unit) == _own(target)
    registry = _registry()
    quantity = _in_channel(unit, channel)
    with _worked_out(unit):
        here, there = (registry.get_root_units(units)[1] for units in (quantity.units, registry.parse_units(target)))
        return bool(here == there)


def known(unit: str) -> bool:
    """Whether a text can be read as a unit."""
    if _own(unit):
        return True
    try:
        _quantity(unit)
    except InputError:
        return False
    return True


def is_current(unit: str) -> bool:
    """Whether a unit measures an electric current."""
    return _measures(unit, "A")


def is_voltage(unit: str) -> bool:
    """Whether a unit measures an electric voltage."""
    return _measures(unit, "V")


def _si_unit(channel: str, motion: Motion) -> str:
    return _NOT_MECHANICAL.get(channel) or CHANNELS[channel].unit(motion)


def fits(unit: str, channel: str) -> set[Motion]:
    """Return the kinds of motion in which the channel may have this unit."""
    return {motion for motion in Motion if _measures(unit, _si_unit(channel, motion), channel)}


def differ(stated: str, given: str, channel: str) -> bool:
    """Whether a unit by name has another size than the one that a header states, both of one channel.

    A unit with a number in it, as ``rpm/50`` behind a gear or ``-deg``, is meant to have another size.
    """
    if _OWN_SIZE.search(given):
        return False
    if is_current(stated) and is_current(given):
        return further(stated) != further(given)
    kinds = fits(stated, channel) & fits(given, channel)
    return any(conversion(stated, channel, motion) != conversion(given, channel, motion) for motion in kinds)


FURTHER_UNITS = ("rad", "rad/s", "rad/s^2", "m", "m/s", "m/s^2", "N m", "N", "degC", "A", "V", "Pa", "W", "s")
"""Units in which further channels are kept, if they measure the same; the quantities of drives, and usual ones."""


def further(unit: str) -> tuple[Conversion, str]:
    """Return how to convert a further channel to SI, and the SI unit: ``rad/s^2`` of ``deg/s^2``.

    Raises:
        InputError: for an unknown unit.
    """
    target = next((known for known in FURTHER_UNITS if _measures(unit, known)), None)
    if target is None:
        quantity = _quantity(unit)
        with _worked_out(unit):
            base = _registry().get_base_units(quantity.units)[1]
        target = f"{base:~}".replace(" ** ", "^").replace(" * ", " ").replace(" / ", "/") or "1"
    return _between(unit, target), target


def _between(unit: str, target: str, channel: str = "") -> Conversion:
    if _own(unit) and _own(unit) == _own(target):
        return Conversion(1.0, 0.0)
    quantity, create = _in_channel(unit, channel), _registry().Quantity
    wanted = "" if target == "1" else target
    with _worked_out(unit):
        low, high = (create(value * quantity.magnitude, quantity.units).to(wanted).magnitude for value in (0.0, 1.0))
        factor = float(high - low)
    if not (np.isfinite(factor) and factor != 0.0):
        raise InputError(f"the unit '{unit}' has the size {factor}")
    return Conversion(factor, float(low))


def conversion(unit: str, channel: str, motion: Motion) -> Conversion:
    """Return how to convert a channel from ``unit`` to SI.

    Raises:
        InputError: for an unknown unit, or one of another dimension than the channel's.
    """
    target = _si_unit(channel, motion)
    if not _measures(unit, target, channel):
        hint = "; state the counts a turn, such as count/2000" if _COUNT.search(spelled(unit)) else ""
        if is_voltage(unit):
            hint = "; a voltage is not a torque: give the current with --torque-constant, or the torque itself"
        if "%" in unit:
            of = {"torque": "0.1N*m", "current": "0.1A"}.get(channel, "0.01")
            hint = f"; say what 1 % is, a hundredth of what 100 % stands for, as in {channel}=COLUMN:{of}"
        a_second = channel == "velocity" and _measures(unit, "1/s")
        hint = hint or ("; use turn/s or rad/s" if "hz" in unit.lower() or a_second else "")
        raise InputError(
            f"the unit '{unit}' does not measure the {word(channel, motion)} of a {motion} drive, "
            f"which is in {target}{hint}"
        )
    return _between(unit, target, channel)
