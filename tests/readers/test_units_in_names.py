"""Units at the end of a column's name, after an underscore."""

from __future__ import annotations

import pytest

from fricmodels.readers.header_units import stated_unit, without_unit


@pytest.mark.parametrize(
    ("column", "channel", "unit"),
    [
        ("pos_mrad", "position", "mrad"),
        ("pos_arcmin", "position", "arcmin"),
        ("vel_mrads", "velocity", "mrad/s"),
        ("vel_mrad_s", "velocity", "mrad/s"),
        ("vel_mrad/s", "velocity", "mrad/s"),
        ("vel_um_s", "velocity", "um/s"),
        ("v_mps", "velocity", "m/s"),
        ("acc_mm_s2", "acceleration", "mm/s^2"),
        ("torque_inlb", "torque", "lbf*in"),
        ("torque_in-lb", "torque", "lbf*in"),
        ("torque_lbin", "torque", "lbf*in"),
        ("torque_oz_in", "torque", "ozf*in"),
        ("tau_kg_cm", "torque", "kgf*cm"),
        ("x_s", "position", None),
        ("q_m", "position", None),
        ("pos_deg_s", "position", None),
        ("vel_deg", "velocity", None),
    ],
)
def test_what_stands_after_an_underscore_is_the_unit_if_it_measures_the_channel(
    column: str, channel: str, unit: str | None
) -> None:
    assert stated_unit(column, channel) == unit


def test_a_name_without_its_unit() -> None:
    assert without_unit("torque_in-lb") == "torque"
    assert without_unit("vel_mrad_s") == "vel"
