"""The grammar of units, their names on both kinds of drive, and the sizes that follow from them."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels import plugins
from fricmodels.dimension import (
    ACCELERATION,
    DIMENSIONLESS,
    DISPLACEMENT,
    FORCE,
    INERTIA,
    TEMPERATURE,
    TIME,
    VELOCITY,
    Dimension,
    Motion,
    Scales,
    parse_unit,
)
from fricmodels.errors import InputError
from fricmodels.term import Term

VISCOUS = FORCE * VELOCITY**-1

dimensions = st.builds(
    Dimension,
    force=st.integers(-1, 1).map(Fraction),
    displacement=st.fractions(-3, 3, max_denominator=4),
    time=st.fractions(-3, 3, max_denominator=4),
    temperature=st.integers(-1, 1).map(Fraction),
)
sizes = st.integers(-20, 20).map(lambda exponent: 2.0**exponent)
scales = st.builds(Scales, force=sizes, displacement=sizes, time=sizes, temperature=sizes)


@pytest.mark.parametrize(
    ("unit", "dimension"),
    [
        ("1", DIMENSIONLESS),
        ("", DIMENSIONLESS),
        ("N m", FORCE),
        ("N", FORCE),
        ("rad", DISPLACEMENT),
        ("m", DISPLACEMENT),
        ("rad/s", VELOCITY),
        ("m/s", VELOCITY),
        ("rad/s^2", ACCELERATION),
        ("m/s^2", ACCELERATION),
        ("kg m^2", INERTIA),
        ("kg", INERTIA),
        ("N m s/rad", VISCOUS),
        ("N s/m", VISCOUS),
        ("N m s^(1/2)/rad^(1/2)", FORCE * VELOCITY ** Fraction(-1, 2)),
        ("N m s^0.5/rad^0.5", FORCE * VELOCITY ** Fraction(-1, 2)),
        ("N m s^2/rad^2", FORCE * VELOCITY**-2),
        ("N m s/rad/K", VISCOUS * TEMPERATURE**-1),
        ("N/m", FORCE * DISPLACEMENT**-1),
        ("1/rad", DISPLACEMENT**-1),
        ("s^-1", TIME**-1),
        ("kg m/s^2", FORCE),
        ("kg m^2/s^2", INERTIA * TIME**-2),
        ("N m s^2/rad", INERTIA),
    ],
)
def test_units_are_read(unit: str, dimension: Dimension) -> None:
    assert parse_unit(unit) == dimension


@pytest.mark.parametrize(
    ("unit", "told"),
    [
        ("furlong", "unknown symbol 'furlong'"),
        ("N mm", "unknown symbol 'mm'"),
        ("W", "unknown symbol 'W'"),
        ("N m^", "cannot read the unit 'N m^' at '^'"),
        ("N*m", "at '*m'"),
        ("2 N m", "at '2 N m'"),
        ("N rad", "mixes rad with metres"),
        ("m rad", "mixes rad with metres"),
    ],
)
def test_other_units_are_refused_in_one_line(unit: str, told: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_unit(unit)
    assert told in str(refused.value)
    assert "\n" not in str(refused.value)


@given(dimensions)
def test_the_name_of_a_unit_is_read_back(dimension: Dimension) -> None:
    assert parse_unit(dimension.unit(Motion.ROTARY)) == dimension


@pytest.mark.parametrize(
    ("dimension", "rotary", "linear"),
    [
        (INERTIA, "kg m^2", "kg"),
        (VISCOUS, "N m s/rad", "N s/m"),
        (FORCE, "N m", "N"),
        (DISPLACEMENT**-1, "1/rad", "1/m"),
        (FORCE * VELOCITY ** Fraction(-2, 3), "N m s^(2/3)/rad^(2/3)", "N s^(2/3)/m^(2/3)"),
        (DIMENSIONLESS, "1", "1"),
    ],
)
def test_units_have_a_name_on_each_kind_of_drive(dimension: Dimension, rotary: str, linear: str) -> None:
    assert (dimension.unit(Motion.ROTARY), dimension.unit(Motion.LINEAR)) == (rotary, linear)


@given(dimensions, dimensions, scales)
def test_the_size_of_a_product_is_the_product_of_sizes(a: Dimension, b: Dimension, chosen: Scales) -> None:
    assert chosen.of(a * b) == pytest.approx(chosen.of(a) * chosen.of(b), rel=1e-12)


@given(dimensions, st.integers(-3, 3), scales)
def test_the_size_of_a_power_is_the_power_of_the_size(a: Dimension, exponent: int, chosen: Scales) -> None:
    assert chosen.of(a**exponent) == pytest.approx(chosen.of(a) ** exponent, rel=1e-12)


@given(dimensions)
def test_what_is_divided_by_itself_has_no_dimension(dimension: Dimension) -> None:
    assert dimension * dimension**-1 == DIMENSIONLESS


def test_the_papers_normalisation_makes_the_inertia_one() -> None:
    """Eq. 6: K_v' = K_v/(Jω), K_c' = K_c/(Jω²), B' = Bω."""
    J, omega = 4.87e-6, 39.54
    paper = Scales(force=J * omega**2, time=1 / omega)
    assert J / paper.of(INERTIA) == pytest.approx(1.0, rel=1e-12)
    assert 1e-4 / paper.of(VISCOUS) == pytest.approx(1e-4 / (J * omega), rel=1e-12)
    assert 1e-2 / paper.of(FORCE) == pytest.approx(1e-2 / (J * omega**2), rel=1e-12)
    assert 0.5 / paper.of(VELOCITY**-1) == pytest.approx(0.5 * omega, rel=1e-12)


def test_declared_units_mean_to_pint_what_they_mean_here() -> None:
    """Pint leaves the angle out of a dimension; force, time and temperature must agree."""
    registry: Any = pint.UnitRegistry()
    registered = plugins.load()
    terms: list[type[Term]] = [kind[name] for kind in (registered.laws, registered.effects) for name in kind]
    declared = {part.unit for term in terms for part in (*term.parameters, *term.states)}
    assert len(declared) > 10
    for unit in declared:
        d = parse_unit(unit)
        here = registry.Unit("N m") ** float(d.force) * registry.s ** float(d.time) * registry.K ** float(d.temperature)
        assert dict(here.dimensionality) == pytest.approx(dict(registry.parse_units(unit).dimensionality)), unit
