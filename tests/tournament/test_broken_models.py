"""A plugin whose law is broken: its rows say what happened, and the other models go on."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from fricmodels import plugins
from fricmodels.tournament import load_config, run

LAWS = """
import os
import casadi
from fricmodels import Law, Parameter, hookimpl
from fricmodels.expressions import sign


class Base(Law):
    K_c = Parameter("K_c", unit="N m", lower=0.0, meaning="Coulomb friction torque")


class Raises(Base):
    name = "raises"

    def torque(self, s, p):
        return p.K_w * sign(s.velocity)


class WrongShape(Base):
    name = "wrong-shape"

    def torque(self, s, p):
        return casadi.vertcat(p.K_c, p.K_c) * sign(s.velocity)


class NotFinite(Base):
    name = "not-finite"

    def torque(self, s, p):
        return p.K_c * sign(s.velocity) * casadi.sqrt(-1 - s.velocity**2)


class Endless(Base):
    name = "endless"

    def torque(self, s, p):
        while True:
            pass


class Kills(Base):
    name = "kills"

    def torque(self, s, p):
        os._exit(7)


class Exits(Base):
    name = "exits"

    def torque(self, s, p):
        raise SystemExit(3)


class WrongUnit(Law):
    name = "wrong-unit"
    K = Parameter("K", unit="N m s/rad", lower=0.0, meaning="Coulomb friction torque")

    def torque(self, s, p):
        return p.K * sign(s.velocity)


class NoUnit(Law):
    name = "no-unit"
    K = Parameter("K", unit="furlong", meaning="a unit that is none")

    def torque(self, s, p):
        return p.K * sign(s.velocity)


class Taken(Base):
    name = "coulomb-viscous"

    def torque(self, s, p):
        return p.K_c * sign(s.velocity)


class NoLaw:
    name = "no-law"


@hookimpl
def fricmodels_laws():
    return [Raises, WrongShape, NotFinite, Endless, Kills, Exits, WrongUnit, NoUnit, Taken, NoLaw]
"""
BROKEN = ["raises", "wrong-shape", "not-finite", "endless", "kills", "exits", "wrong-unit"]
CONFIG = """\
datasets:
  - {{name: motor, files: motor.csv, inertia: 4.87e-6}}
models: [{models}]
estimators: batch
simulate: false
timeout: 6
"""


@pytest.fixture(scope="module")
def distribution(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the distribution: the same for all tests, so that what hangs is tried once."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "broken_laws-1.0.dist-info").mkdir(parents=True)
    (folder / "broken_laws.py").write_text(LAWS)
    (folder / "broken_laws-1.0.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: broken-laws\nVersion: 1.0\n"
    )
    (folder / "broken_laws-1.0.dist-info" / "entry_points.txt").write_text("[fricmodels]\nbroken = broken_laws\n")
    return folder


@pytest.fixture
def site(distribution: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Install the distribution with the broken laws for as long as a test lasts."""
    monkeypatch.syspath_prepend(str(distribution))
    plugins.load.cache_clear()
    yield distribution
    sys.modules.pop("broken_laws", None)
    plugins.load.cache_clear()


def write_log(path: Path) -> None:
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.simulation import simulate

    moments = 1e-3 * np.arange(2000)
    drive = Drive(Model.parse("coulomb-viscous"), 4.87e-6)
    made = simulate(drive, {"K_v": 1e-4, "K_c": 0.01}, moments, 0.03 * np.sin(20 * moments), substeps=4)
    rows = np.column_stack([made.time, made.torque, made.velocity])
    np.savetxt(path, rows, delimiter=",", header="time_s,torque_Nm,velocity_rad_s", comments="")


@pytest.mark.long
def test_rows_say_what_happened_and_the_others_go_on(site: Path, tmp_path: Path) -> None:
    write_log(tmp_path / "motor.csv")
    config = tmp_path / "config.yaml"
    config.write_text(CONFIG.format(models=", ".join([*BROKEN, "no-unit", "coulomb-viscous", "square-root"])))
    board = run(load_config(config), tmp_path / "out", directory=tmp_path, processes=1)
    found = {row["model"]: (row["status"], row["message"]) for row in board.rows}
    assert set(found) == {*BROKEN, "no-unit", "coulomb-viscous", "square-root"}
    assert [row["model"] for row in board.rows[:2]] == ["coulomb-viscous", "square-root"]
    assert found["coulomb-viscous"][0] == found["square-root"][0] == "ok"
    assert found["raises"][0] == "failed"
    assert "there is no parameter 'K_w'" in found["raises"][1]
    assert found["wrong-shape"] == (
        "failed",
        "'wrong-shape': torque() has the wrong shape 2×1; return one scalar, the torque at one sample",
    )
    assert found["not-finite"][0] == "failed"
    assert "the torque is not finite at rest" in found["not-finite"][1]
    assert found["wrong-unit"][0] == found["no-unit"][0] == "failed"
    assert "K has the wrong unit 'N m s/rad': the torque equation needs 'N m'" in found["wrong-unit"][1]
    assert "law 'no-unit' cannot be used" in found["no-unit"][1]
    assert "unknown symbol 'furlong'" in found["no-unit"][1]
    assert found["endless"] == ("timeout", "took longer than 6 s")
    assert found["kills"] == ("crashed", "its process died with exit code 7")
    assert found["exits"][0] == "failed"
    assert "SystemExit: 3" in found["exits"][1]
    assert all(message for status, message in found.values() if status != "ok")


@pytest.mark.long
def test_list_goes_on_and_names_what_cannot_be_used(site: Path) -> None:
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-m", "fricmodels", "list", "laws"],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": paths},
    )
    assert done.returncode == 0, done.stderr
    for name in [*BROKEN, "coulomb-viscous", "square-root"]:
        assert name in done.stdout
    warnings = done.stderr.splitlines()
    assert len(warnings) == 3
    assert "'no-unit' declares K: unit 'furlong' has the unknown symbol" in done.stderr
    assert "'coulomb-viscous' is already provided by fricmodels" in done.stderr
    assert "'no-law' is not derived from fricmodels.term.Law" in done.stderr


@pytest.mark.parametrize(
    ("name", "timeout", "result", "message"),
    [
        pytest.param("endless", 3, "timeout", "is there an endless loop?", marks=pytest.mark.long),
        ("kills", 60, "crashed", "the interpreter died with exit code 7"),
        pytest.param("wrong-shape", 60, "failed", "wrong shape 2×1", marks=pytest.mark.long),
        pytest.param("not-finite", 60, "failed", "not finite at rest", marks=pytest.mark.long),
    ],
)
def test_the_exam_survives_them(site: Path, name: str, timeout: float, result: str, message: str) -> None:
    from fricmodels.testing import examine

    outcomes = list(examine("law", name, timeout=timeout))
    assert any(o.result == result and message in o.message for o in outcomes), outcomes
