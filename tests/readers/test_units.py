import math
import time

import pytest

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.readers import units
from fricmodels.readers.units import conversion, fits, known

R, L = Motion.ROTARY, Motion.LINEAR


@pytest.mark.parametrize(
    ("unit", "channel", "motion", "value", "expected"),
    [
        ("deg/s", "velocity", R, 180.0, math.pi),
        ("°/s", "velocity", R, 180.0, math.pi),
        ("rpm", "velocity", R, 60.0, 2 * math.pi),
        ("turn/s", "velocity", R, 1.0, 2 * math.pi),
        ("count/2000", "position", R, 500.0, math.pi / 2),
        ("counts/4096/s", "velocity", R, 4096.0, 2 * math.pi),
        ("360/4096 deg", "position", R, 1024.0, math.pi / 2),
        ("ms", "time", R, 5.0, 5e-3),
        ("µs", "time", R, 5.0, 5e-6),
        ("us", "time", L, 5.0, 5e-6),
        ("mm", "position", L, 12.0, 0.012),
        ("0.05 um", "position", L, 20.0, 1e-6),
        ("kN", "torque", L, 0.5, 500.0),
        ("mNm", "torque", R, 3.0, 3e-3),
        ("N m", "torque", R, 3.0, 3.0),
        ("0.05 N m", "torque", R, 2.0, 0.1),
        ("mA", "current", R, 250.0, 0.25),
        ("degC", "temperature", R, 31.5, 31.5),
        ("K", "temperature", R, 300.0, 26.85),
        ("degF", "temperature", R, 212.0, 100.0),
        ("deg/s^2", "acceleration", R, 90.0, math.pi / 2),
        *(
            (unit, "velocity", R, 60.0, 2 * math.pi)
            for unit in ("U/min", "Umdr./min", "1/min", "min⁻¹", "min^-1", "min-1")
        ),
        *((unit, "velocity", R, 60.0, 2 * math.pi) for unit in ("RPM", "r/min", "rev/min", "tr/min")),
        *((unit, "position", R, 0.5, math.pi) for unit in ("rev", "Rev", "REV", "revs", "rev.", "Umdr", "Umdr.", "U")),
        *((unit, "velocity", R, 1.0, 2 * math.pi) for unit in ("rev/s", "revs/s", "Rev/sec", "rev.s-1", "rev s^-1")),
        *((unit, "velocity", R, 60.0, 2 * math.pi) for unit in ("Rev/min", "REV/MIN", "revs/min", "Umdr/min")),
        *((unit, "acceleration", R, 1.0, 2 * math.pi) for unit in ("rev/s^2", "rev/s²", "U/s²")),
        ("rev/4096", "position", R, 2048.0, math.pi),
        ("mrev", "position", R, 500.0, math.pi),
        *((f"N{dot}m", "torque", R, 2.0, 2.0) for dot in "·⋅・･∙•‧"),
        *((unit, "torque", R, 1.0, 0.0980665) for unit in ("kg.cm", "kgf.cm", "kp·cm", "kg-cm", "kgfcm")),
        *((unit, "torque", R, 1.0, 0.1129848290276167) for unit in ("lb-in", "lbf-in", "lbf·in", "in-lb", "inlb")),
        *((unit, "torque", R, 1.0, 0.00706155181422604) for unit in ("ozf·in", "oz-in", "ozf in")),
        *((unit, "torque", R, 1.0, 0.01) for unit in ("Ncm", "N.cm", "N-cm", "cNm")),
        ("m/min", "velocity", L, 60.0, 1.0),
        ("mmps", "velocity", L, 1.0, 1e-3),
        ("rad.s-1", "velocity", R, 1.0, 1.0),
        ("Grad", "position", R, 180.0, math.pi),
        ("sec.", "time", R, 5.0, 5.0),
        *((unit, "velocity", R, 180.0, math.pi) for unit in ("dps", "DPS", "deg s^-1", "deg s-1")),
        ("rad s-1", "velocity", R, 1.0, 1.0),
        ("cnt/4096", "position", R, 2048.0, math.pi),
        *(
            (unit, "torque", R, 2.0, 2.0)
            for unit in ("Newtonmeter", "newton meter", "Newton-meters", "Newton*metre", "newton_meter", "NM")
        ),
        ("millinewton-meters", "torque", R, 2.0, 2e-3),
        *((unit, "torque", L, 2.0, 2.0) for unit in ("Newton", "Newtons", "newton")),
        *((unit, "current", R, 2.0, 2.0) for unit in ("amps", "Amps", "Ampere", "amperes")),
        ("C", "temperature", R, 20.0, 20.0),
    ],
)
def test_units_become_si(unit, channel, motion, value, expected):
    factor = conversion(unit, channel, motion)
    assert factor.factor * value + factor.offset == pytest.approx(expected, rel=1e-12, abs=1e-10)


@pytest.mark.parametrize(
    ("unit", "channel", "motion", "hint"),
    [
        ("mm", "position", R, "rad"),
        ("deg", "velocity", R, "rad/s"),
        ("N", "torque", R, "N m"),
        ("N m", "torque", L, "in N"),
        ("s", "temperature", R, "degC"),
        ("count", "position", R, "count/2000"),
        ("count/2000", "position", L, "count/2000"),
        ("Hz", "velocity", R, "turn/s"),
        ("1", "position", R, "rad"),
        ("1/s", "velocity", R, "turn/s"),
        ("count/min", "velocity", R, "count/2000"),
        ("kg", "torque", L, "in N"),
        ("N", "torque", R, "torque of a rotary drive"),
        ("N m", "torque", L, "force of a linear drive"),
        ("0 m", "position", L, "size"),
    ],
)
def test_another_dimension_is_refused(unit, channel, motion, hint):
    with pytest.raises(InputError, match=hint):
        conversion(unit, channel, motion)


@pytest.mark.parametrize("unit", ["furlongg", "rad/", "(", "__import__('os')", "x"])
def test_what_is_no_unit(unit):
    assert not known(unit)
    with pytest.raises(InputError, match="unknown unit"):
        conversion(unit, "velocity", R)


def test_the_kind_of_motion_that_a_unit_belongs_to():
    assert fits("mm/s", "velocity") == {L}
    assert fits("rpm", "velocity") == {R}
    assert fits("s", "time") == {R, L}
    assert fits("mm", "velocity") == set()


@pytest.mark.parametrize(
    "unit",
    [
        "10**10**8*s",
        "9**9**9*s",
        "2**(2**40)*s",
        "s^2^3",
        "s²**9",
        "s²²²",
        "s**99",
        "s**s",
        "N**turn",
        "s* *9",
        "2**s",
        "(s",
        "s)",
        "(((((((((((s",
        "s" * 5000,
        "(" * 5000 + "s",
        "1" * 400 + "*s",
        "s;import os",
        "__import__('os')",
        "s**(1/0)",
    ],
)
def test_a_unit_that_is_more_than_a_unit_is_refused_at_once(unit: str) -> None:
    begin = time.monotonic()
    assert not known(unit)
    with pytest.raises(InputError, match="unknown unit") as refused:
        conversion(unit, "time", Motion.ROTARY)
    assert time.monotonic() - begin < 5
    assert len(str(refused.value)) < 100


@pytest.mark.parametrize(
    ("unit", "factor"), [("1e-3 s", 1e-3), ("10**-3*s", 1e-3), ("(ms)", 1e-3), ("s**2/s", 1.0), ("ms²/ms", 1e-3)]
)
def test_units_with_numbers_and_exponents_are_worked_out(unit: str, factor: float) -> None:
    assert conversion(unit, "time", Motion.ROTARY).factor == pytest.approx(factor)


def test_a_unit_beyond_floats_is_no_unit() -> None:
    with pytest.raises(InputError, match="unknown unit"):
        conversion("count**12(1e3turn)1e3", "velocity", Motion.ROTARY)


def test_what_the_package_knows_of_its_own_units_is_what_pint_says() -> None:
    registry = units._registry()
    roots = {unit: registry.get_root_units(units._quantity(unit).units)[1] for unit in units._OWN}
    for one, root in roots.items():
        assert {other for other in roots if roots[other] == root} == {one}
        quantity = units._quantity(one)
        assert registry.Quantity(quantity.magnitude, quantity.units).to(one).magnitude == 1.0
        assert units._between(one, one) == units.Conversion(1.0, 0.0)
