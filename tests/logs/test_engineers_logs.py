"""The simulator of engineers' logs: its torque balance, its step, what it writes, and when an answer is right."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

Modules = Callable[[str], ModuleType]


def short(from_benchmarks: Modules, name: str, **options: Any) -> Any:
    """Return a case of three seconds."""
    case = next(case for case in from_benchmarks("logs.cases").CASES if case.name == name)
    return replace(case, seconds=3, **options)


def test_the_torque_balance_closes(from_benchmarks: Modules) -> None:
    """One step a period, so that all terms are known: what the drive does is what the equation says."""
    plant = from_benchmarks("logs.plant")
    p = plant.Plant(
        inertia=0.5, coulomb=1.0, viscous=0.3, torque_time=1e-3, asymmetry_dry=0.1, asymmetry_viscous=0.02,
        stribeck_rise=0.4, stribeck_speed=0.3, stribeck_exponent=1.5, square_root=0.05, square=0.02, load_friction=0.1,
        friction_wave=0.1, friction_wave_number=17.0, friction_wave_phase=1.0, friction_bump=0.2, bump_torque=0.1,
        bump_place=0.05, bump_width=0.02, offset=0.1, gravity_cosine=0.2, gravity_sine=0.3, stiffness=0.4, neutral=0.1,
        wave=0.2, wave_number=30.0, wave_phase=0.3, second_wave=0.1, second_wave_number=60.0, ripple=0.05,
        ripple_wave_number=11.0, ripple_phase=2.0, rope_torque=0.2, rope_place=0.3,
    )  # fmt: skip
    rate = 20_000.0
    time = np.arange(20_000) / rate
    reference = np.stack([0.4 - 0.375 * np.cos(8 * time), 3 * np.sin(8 * time), 24 * np.cos(8 * time)])
    f, v = 1 + 0.2 * time, 1 - 0.1 * time
    inputs = np.stack([0 * time, f, v, 0.1 * np.cos(3 * time), 0.7 * np.sin(5 * time)])
    loop = plant.Loop(True, rate, 30.0, 20.0, 100.0, 0.5, 0.3, 100.0, 1e-9, 1.0)
    c = plant.simulate(p, loop, reference, inputs, 1)
    q, w, speed, torque = c.position, c.velocity, np.abs(c.velocity), c.mean_torque
    bump = np.exp(-0.5 * ((q - 0.05) / 0.02) ** 2)
    level = 1.0 + 0.4 * np.exp(-((speed / 0.3) ** 1.5)) + 0.05 * np.sqrt(speed) + 0.02 * w**2
    level = f * (level + 0.1 * np.abs(c.load) + 0.1 * np.cos(17 * q + 1.0) + 0.2 * bump)
    outside = 0.1 + 0.2 * np.cos(q) + 0.3 * np.sin(q) + 0.4 * (q - 0.1) + 0.2 * np.cos(30 * q + 0.3)
    outside += 0.1 * np.cos(60 * q) + 0.1 * bump + 0.2 * (q > 0.3) + inputs[3] + c.load
    acting = torque * (1 - 0.05 * np.cos(11 * q + 2.0))
    left = 0.5 * np.diff(w) * rate
    left -= (acting - outside - v * 0.3 * w - 0.02 * speed - np.sign(w) * level - 0.1)[:-1]
    sliding = (w[1:] * w[:-1] > 0) & (speed[:-1] > 0)
    assert sliding.mean() > 0.9
    assert np.max(np.abs(left[sliding])) < 1e-9
    hidden = torque - 0.5 * np.gradient(w) * rate - 0.3 * w - np.sign(w) - c.load
    np.testing.assert_allclose(np.mean(c.hidden), np.mean(hidden), atol=0.02)


@pytest.mark.parametrize("name", ["screw-moves", "servo-presliding", "hydraulic-ageing"])
def test_the_recording_does_not_hang_on_the_step(from_benchmarks: Modules, name: str) -> None:
    """With a fine encoder: the steps of a coarse one make a loop chatter, and no two chatters are alike."""
    drawn = from_benchmarks("logs.record").drawn
    case = short(from_benchmarks, name)
    case = replace(case, sensors=replace(case.sensors, resolution=1e-5 * case.make.resolution))
    one, other = (drawn(case, integrated=rate).channels for rate in (40_000.0, 80_000.0))
    for channel in ("position", "velocity", "torque"):
        wrong = np.sqrt(np.mean((one[channel] - other[channel]) ** 2))
        assert wrong < 2e-3 * np.sqrt(np.mean(one[channel] ** 2))


def test_a_log_is_read_as_it_was_drawn(from_benchmarks: Modules, tmp_path: Path) -> None:
    """Each make: the options that an engineer gives bring the SI units back, within the digits and steps of the log."""
    from fricmodels import read

    record, makes = from_benchmarks("logs.record"), set()
    for case in from_benchmarks("logs.cases").CASES:
        if case.make.name in makes or case.kind != "clean":
            continue
        makes.add(case.make.name)
        brief = replace(case, seconds=3)
        log, path = record.drawn(brief), tmp_path / f"{case.name}.csv"
        record.write(brief, log, path)
        told = [word.split("=", 1) for word in record.options(brief) if "=" in word]
        constant = case.make.torque_constant
        motion = {"motion": "linear"} if case.make.linear else {}
        found = read(path, columns=dict(told), torque_constant=constant, **motion)
        for channel, column in zip(("time", "position", "velocity", "torque"), case.make.columns, strict=True):
            step = column.scale * max(column.step, 10.0**-column.decimals)
            step *= constant if constant and channel == "torque" else 1.0
            np.testing.assert_allclose(found[channel], log.channels[channel], atol=0.51 * step, err_msg=case.name)
    assert len(makes) == 8


def test_another_seed_draws_another_recording(from_benchmarks: Modules) -> None:
    drawn = from_benchmarks("logs.record").drawn
    case = short(from_benchmarks, "motor-cogging")
    torques = [drawn(case, seed).channels["torque"] for seed in (0, 0, 1)]
    np.testing.assert_array_equal(torques[0], torques[1])
    assert np.std(torques[2] - torques[0]) > 3 * case.make.torque_noise


def test_cases_are_told_apart_and_hide_known_effects(from_benchmarks: Modules) -> None:
    from fricmodels import plugins

    cases, effects = from_benchmarks("logs.cases").CASES, set(plugins.load().effects)
    assert Counter(case.kind for case in cases) == {"clean": 20, "one": 43, "several": 15, "unlisted": 12}
    assert len({case.number for case in cases}) == len({case.name for case in cases}) == 90
    for case in cases:
        assert {*case.beside, *(name for group in case.there for name in group)} <= effects, case.name
        from_benchmarks("logs.record").plant_of(case)


def test_when_an_answer_is_right(from_benchmarks: Modules) -> None:
    judge = from_benchmarks("logs.judge").judge
    cases = {case.name: case for case in from_benchmarks("logs.cases").CASES}

    def right(name: str, *names: list[str], unknown: bool = False) -> bool:
        return bool(judge(cases[name], {"status": "ok", "names": names, "unknown": unknown}).is_right)

    assert right("arm-fourier")
    assert not right("arm-fourier", ["stiffness"])
    assert not right("arm-fourier", unknown=True)
    assert right("arm-slow-torque", ["sensor-delay"])
    assert right("arm-asymmetry", ["torque-offset"])
    assert not right("arm-asymmetry")
    assert not right("arm-asymmetry", ["asymmetry"], ["stribeck"])
    assert right("robot-gravity-stribeck", ["gravity"], ["stribeck", "frictional-lag"])
    assert not right("robot-gravity-stribeck", ["gravity"])
    assert right("servo-rope-stribeck", unknown=True)
    assert right("servo-rope-stribeck", ["stribeck"])
    assert not right("servo-rope-stribeck", ["gravity"])
    assert not judge(cases["arm-fourier"], {"status": "failed", "message": "no answer"}).is_right
