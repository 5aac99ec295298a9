"""Laws and effects that hang or kill the interpreter when they are used: left out by name, the work goes on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from fricmodels import plugins
from fricmodels.plugins import probe

Install = Callable[[str, str], Path]
PLUGIN = """
import ctypes, os, sys
from fricmodels import Effect, Law, Parameter, hookimpl
print("x" * 1000)
class Base(Effect):
    formula = "τ = c·ω²"
    c = Parameter("c", unit="N m s^2/rad^2", lower=0.0, meaning="drag")
    def torque(self, s, p):
        print("heard")
        self.act()
        return p.c * s.velocity * s.velocity
    def act(self):
        pass
class Loops(Base):
    name = "loops"
    def act(self):
        while True:
            pass
class Exits(Base):
    name = "exits"
    def act(self):
        os._exit(7)
class Leaves(Base):
    name = "leaves"
    def act(self):
        sys.exit(0)
class Crashes(Base):
    name = "crashes"
    def act(self):
        ctypes.string_at(0)
class Nothing(Base):
    name = "nothing"
    def torque(self, s, p):
        return p.c * s.velocity * s.velocity * float("nan")
class WrongUnit(Base):
    name = "wrong-unit"
    c = Parameter("c", unit="N m", lower=0.0, meaning="drag")
class Fine(Base):
    name = "fine"
@hookimpl
def fricmodels_effects():
    print("more")
    return [Loops, Exits, Leaves, Crashes, Nothing, WrongUnit, Fine]
"""
DANGERS = {
    "loops": "its torque does not end within 3 s",
    "exits": "its torque ends the interpreter with exit code 7",
    "leaves": "its torque ends the interpreter with exit code 0",
    "crashes": "its torque kills the interpreter (SIGSEGV)",
}


@pytest.fixture(autouse=True)
def own_cache(another_cache: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(probe, "_USE", 3.0)
    yield
    plugins.load.cache_clear()


def shell(site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "fricmodels", *arguments]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths}, timeout=120)


def recording(path: Path) -> Path:
    time = 0.005 * np.arange(4000)
    velocity = 5 * np.sin(2 * np.pi * time) + 2 * np.sin(5 * time)
    acceleration = 10 * np.pi * np.cos(2 * np.pi * time) + 10 * np.cos(5 * time)
    noise = 1e-3 * np.random.default_rng(0).standard_normal(len(time))
    torque = 0.01 * acceleration + 0.05 * velocity + 0.2 * np.sign(velocity) + noise
    table = np.column_stack([time, torque, velocity])
    np.savetxt(path, table, delimiter=",", header="time_s,torque_Nm,velocity_rad_s", comments="")
    return path


@pytest.mark.long
def test_every_command_goes_on_without_them(install: Install, tmp_path: Path) -> None:
    site = install("deadly-use", PLUGIN)
    registered = plugins.load()
    assert {name: registered.effects.danger(name) for name in DANGERS} == {
        name: f"{why}{' (FRICMODELS_PLUGIN_TIMEOUT sets the limit)' * (name == 'loops')}; it is tried again when its "
        "files change"
        for name, why in DANGERS.items()
    }
    assert not set(DANGERS) & {*registered.effects}
    assert "fine" in {*registered.effects}
    data = str(recording(tmp_path / "log.csv"))
    done = shell(
        site, "diagnose", data, "--model", "coulomb-viscous", "--inertia", "0.01", "--out", str(tmp_path / "d")
    )
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "d" / "diagnosis.json").read_text())["verdict"] == "adequate"
    for name, why in DANGERS.items():
        assert f"plugin 'deadly-use' of deadly-use is left out: effect '{name}': {why}" in done.stderr
    for name in ("nothing", "wrong-unit"):
        assert f"effect '{name}' of deadly-use is left out: '{name}': " in done.stderr
    assert "Traceback" not in done.stderr
    assert "heard" not in done.stdout
    for name, why in DANGERS.items():
        asked = shell(site, "compare", data, "--model", f"coulomb-viscous+{name}")
        assert asked.returncode == 2, asked.stderr
        assert asked.stdout == ""
        assert f"error: effect '{name}' of deadly-use cannot be used here: {why}" in asked.stderr
    listed = shell(site, "plugins")
    assert listed.returncode == 0, listed.stderr
    assert "deadly-use" in listed.stdout
    assert "xxx" not in listed.stdout
    assert "more" not in listed.stdout


def test_what_is_safe_is_tried_once(install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    install("safe", PLUGIN.replace("[Loops, Exits, Leaves, Crashes, Nothing, WrongUnit, Fine]", "[Fine]"))
    tried: list[str] = []
    start = probe._launched
    monkeypatch.setattr(probe, "_launched", lambda point, skip: (tried.append(point.name), start(point, skip))[1])
    for _ in range(2):
        plugins.load.cache_clear()
        assert "fine" in {*plugins.load().effects}
    assert tried.count("safe") == 1


@pytest.mark.long
def test_improve_refuses_the_wrong_unit_that_a_tournament_refuses(install: Install, tmp_path: Path) -> None:
    site = install(
        "wrong-use", PLUGIN.replace("[Loops, Exits, Leaves, Crashes, Nothing, WrongUnit, Fine]", "[WrongUnit]")
    )
    data = str(recording(tmp_path / "log.csv"))
    model = "coulomb-viscous+wrong-unit"
    text = f"datasets: [{{name: log, files: {data}, inertia: 0.01}}]\nmodels: [{model}]\nestimators: [batch]\n"
    (tmp_path / "t.yaml").write_text(text)
    ran = shell(site, "run", str(tmp_path / "t.yaml"), "--executor", "serial", "--out", str(tmp_path / "t"))
    assert "unexpected" not in ran.stderr
    (row,) = json.loads((tmp_path / "t" / "leaderboard.json").read_text())["rows"]
    assert row["status"] == "failed"
    assert row["message"].startswith("'wrong-unit': ")
    for command in ("improve", "diagnose", "compare"):
        asked = shell(site, command, data, "--model", model, "--inertia", "0.01")
        assert asked.returncode != 0, command
        assert asked.stdout == ""
        assert row["message"][:40] in " ".join(asked.stderr.split()), command
    improved = shell(site, "improve", data, "--model", "coulomb-viscous", "--inertia", "0.01")
    assert improved.returncode == 0, improved.stderr
    assert "effect 'wrong-unit' of wrong-use is left out: 'wrong-unit': " in improved.stderr
