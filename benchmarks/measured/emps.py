"""EMPS: a linear axis; fitted on emps_id.csv, checked on emps_pulses.csv."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from fricmodels.dimension import Motion
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.score import filtered_torque_error
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


def plateau_table(told: Story) -> str:
    """Return what is left at each constant speed: friction above the model, and the largest wave over position."""
    rows = []
    comparison = told.ladder.rungs[min(1, len(told.ladder.rungs) - 1)].comparison
    for name, part in {"identification": told.recording, **told.checks}.items():
        error = filtered_torque_error(comparison.drive, comparison.estimate.parameters, part)
        steady = np.abs(part["acceleration"]) < 0.3
        for speed in (0.042, 0.083, 0.125):
            mask = steady & (np.abs(np.abs(part.velocity) - speed) < 0.01)
            above = float(np.mean((error * np.sign(part.velocity))[mask]))
            left = error - above * np.sign(part.velocity)
            waves = np.arange(400.0, 4000.0, 2.0)
            size = [abs(np.mean(left[mask] * np.exp(-1j * k * part["position"][mask]))) for k in waves]
            best = int(np.argmax(size))
            wave = (f"{waves[best]:.0f} /m", f"{2 * size[best]:.2f} N", f"{waves[best] * speed / (2 * np.pi):.0f} Hz")
            rows.append([name, f"{speed:.3f} m/s", f"{above:+.2f} N", *wave])
    return table(["file", "speed", "friction above the model", "largest wave", "amplitude", "frequency"], rows)


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
    return {
        **blocks(told, published),
        "alone": alone,
        "hand": hand,
        "plateaus": plateau_table(told),
        "authors": authors_table(configs / "emps.yaml"),
    }
