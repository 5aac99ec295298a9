"""EMPS: a linear axis; fitted on emps_id.csv, checked on emps_pulses.csv."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fricmodels.dimension import Motion
from fricmodels.readers import read
from fricmodels.recording import Recording
from measured.pictures import picture
from measured.story import Story, blocks, by_hand_table, independent_table, leaderboard, table, tell

COLUMNS = ("time=t:s", "force=force_N:N", "position=pos_m:m")
BASE = "coulomb-viscous"
BY_HAND = (
    "presliding",
    "cogging",
    "presliding+cogging",
    "position-friction",
    "joint-compliance",
    "stribeck",
    "nonlinear-viscous",
)
PUBLISHED = {
    "coulomb-viscous+torque-offset": ("4.0834 %", "5.9824 %"),
    "asymmetric-coulomb-viscous": ("3.1117 %", "—"),
}
"""Relative error and cross-test of Janot, Gautier and Brunot (2019)."""


def recording(data: Path, which: str = "id") -> Recording:
    """Return the identification file or the one with force pulses."""
    return read(data / "emps" / f"emps_{which}.csv", columns=COLUMNS, motion=Motion.LINEAR)


def story(data: Path) -> Story:
    """Improve the symmetric law on the identification file; the pulses file takes no part."""
    return tell(recording(data), BASE, checks={"pulses file": recording(data, "pulses")})


def authors_table(config: Path) -> str:
    """Return the relative error as the authors define it, of the models of the configuration."""
    rows = leaderboard(config)
    listed = []
    for row in sorted(rows, key=lambda r: -float(r["rms_torque_error_percent"])):
        own, cross = PUBLISHED.get(row["model"], ("", ""))
        errors = [f"{row[key]:.2f} %" for key in ("rms_torque_error_percent", "held_out_rms_torque_error_percent")]
        listed.append([f"`{row['model']}`", errors[0], own, errors[1], cross])
    return table(["model", "relative error", "published", "cross-test on the pulses", "published"], listed)


def page(data: Path, configs: Path, pictures: Path, folder: Path, say: Callable[[str], None]) -> dict[str, str]:
    """Return the parts of the page."""
    say("improving")
    told = story(data)
    picture(told, pictures / "measured_emps.png")
    picture(told, pictures / "measured_emps_pulses.png", told.checks["pulses file"])
    published = {"M": "95.15", "K_v": "203.6", "K_c": "20.39", "asymmetry.c": "−0.24", "asymmetry.d": "−36.9"}
    say("adding effects by hand")
    hand = by_hand_table(told, f"{BASE}+asymmetry", BY_HAND)
    say("diagnosing each file by itself")
    files = {"identification file": recording(data), "pulses file": recording(data, "pulses")}
    alone = independent_table(files, BASE)
    say("comparing with the published errors")
    return {**blocks(told, published), "alone": alone, "hand": hand, "authors": authors_table(configs / "emps.yaml")}
