"""Plugins that hang or kill the interpreter when they are imported: skipped, named, tried again when they change."""

from __future__ import annotations

import importlib.metadata
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.plugins import probe
from fricmodels.tournament import load_config

Install = Callable[[str, str], Path]

GOOD = """
from fricmodels import Law, Parameter, hookimpl
class Rubber(Law):
    name = "rubber"
    formula = "τ_F = c·ω"
    c = Parameter("c", unit="N m s/rad", lower=0.0, meaning="viscous coefficient")
    def torque(self, s, p):
        return p.c * s.velocity
@hookimpl
def fricmodels_laws():
    return [Rubber]
"""
HANGS = "import time\nwhile True:\n    time.sleep(0.01)\n"
DEADLY = {
    "exits": ("import os\nos._exit(1)\n", "ends the interpreter with exit code 1"),
    "exits-quietly": ("import os\nos._exit(0)\n", "ends the interpreter with exit code 0"),
    "segfaults": ("import ctypes\nctypes.string_at(0)\n", "kills the interpreter (SIGSEGV)"),
    "hangs": (HANGS, "does not end within 6 s (FRICMODELS_PLUGIN_TIMEOUT sets the limit)"),
    "interrupts": ("raise KeyboardInterrupt\n", "the interpreter"),
    "never-lets-go": ("import threading\nthreading.Thread(target=threading.Event().wait).start()\n", "does not end"),
    "dies-in-hook": (GOOD.replace("    return [Rubber]", "    import os; os._exit(5)"), "exit code 5"),
    "dies-when-made": (
        GOOD.replace("    c =", "    def __init__(self):\n        import os; os._exit(6)\n    c ="),
        "code 6",
    ),
}
CONFIG = """\
datasets:
  - simulate: {model: coulomb-viscous, parameters: {K_v: 1e-4, K_c: 0.01}, inertia: 4.87e-6, amplitude: 0.02,
               frequency: 39.54}
models: [coulomb-viscous, rubber, coulomb-viscous+rubber-seal]
estimators: [rls, rubber-filter]
simulate: false
"""


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Keep verdicts apart from those of the user, the time limit short, and other installed plugins out of the way."""
    every = importlib.metadata.entry_points

    def some(**selected: str) -> list[importlib.metadata.EntryPoint]:
        found = [point for point in every(**selected) if point.dist is not None]
        return [
            p for p in found if p.dist.name == "fricmodels" or tmp_path in Path(str(p.dist.locate_file(""))).parents
        ]

    monkeypatch.setattr(importlib.metadata, "entry_points", some)
    monkeypatch.setenv("FRICMODELS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv(probe.LIMIT, "6")
    yield tmp_path / "cache"
    plugins.load.cache_clear()


def shell(site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a process of its own, with the distributions of a directory on its path."""
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "fricmodels", *arguments]
    return subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths}, stdin=subprocess.DEVNULL
    )


def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the names of the entry points that are tried from now on."""
    started: list[str] = []
    start = probe._started

    def noted(point: object) -> object:
        started.append(point.name)  # type: ignore[attr-defined]
        return start(point)  # type: ignore[arg-type]

    monkeypatch.setattr(probe, "_started", noted)
    return started


def loaded_again() -> plugins.Plugins:
    plugins.load.cache_clear()
    return plugins.load()


@pytest.mark.long
def test_list_and_a_tournament_go_on_beside_all_of_them(install: Install, tmp_path: Path) -> None:
    """From the shell: each is named with its reason, at once the second time; the names that it may have are rows."""
    for name, (source, _) in DEADLY.items():
        site = install(name, source)
    first = shell(site, "list", "laws")
    begin = time.monotonic()
    again = shell(site, "list", "laws")
    assert time.monotonic() - begin < 6, "nothing is tried again"
    assert first.returncode == again.returncode == 0, first.stderr
    assert again.stderr == first.stderr
    assert "coulomb-viscous" in again.stdout
    assert "rubber" not in again.stdout
    warnings = again.stderr.splitlines()
    assert len(warnings) == len(DEADLY)
    for name, (_, reason) in DEADLY.items():
        (line,) = (line for line in warnings if f"plugin '{name}' of {name} is left out" in line)
        assert reason in line
    (tmp_path / "config.yaml").write_text(CONFIG)
    done = shell(site, "run", str(tmp_path / "config.yaml"), "--out", str(tmp_path / "out"), "--jobs", "1")
    assert done.returncode == 0, done.stderr
    rows = json.loads((tmp_path / "out" / "leaderboard.json").read_text())["rows"]
    assert len(rows) == 6
    assert (rows[0]["model"], rows[0]["estimator"], rows[0]["status"]) == ("coulomb-viscous", "rls", "ok")
    for row in rows[1:]:
        assert row["status"] == "failed"
        assert "unknown" in row["message"]
        assert "plugin 'segfaults' of segfaults is left out: importing it kills the interpreter" in row["message"]


@pytest.mark.parametrize("name", ["exits", pytest.param("hangs", marks=pytest.mark.long)])
def test_a_repaired_plugin_is_seen_again(name: str, install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    site = install(name, DEADLY[name][0])
    assert "rubber" not in loaded_again().laws
    tried = counted(monkeypatch)
    assert "rubber" not in loaded_again().laws
    assert tried == []
    (site / f"{name}.py").write_text(GOOD)
    registered = loaded_again()
    assert tried == [name]
    assert registered.laws.entry("rubber").distribution == name
    assert registered.failures == ()
    loaded_again()
    assert tried == [name]


def test_a_plugin_that_breaks_later_is_found_out(install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    site = install("fine", GOOD)
    assert "rubber" in loaded_again().laws
    tried = counted(monkeypatch)
    (site / "fine.py").write_text("import os\nos._exit(1)\n")
    registered = loaded_again()
    assert tried == ["fine"]
    assert "rubber" not in registered.laws
    assert "exit code 1" in registered.failures[0].reason


@pytest.mark.parametrize(
    "broken",
    [
        "import os\nos._exit(1)\n",
        "import there_is_no_such_module\n",
        pytest.param(GOOD + "1 / 0\n", marks=pytest.mark.long),
    ],
)
def test_what_it_offered_before_is_still_a_row_among_all(broken: str, install: Install, tmp_path: Path) -> None:
    site = install("fine", GOOD)
    loaded_again()
    (site / "fine.py").write_text(broken)
    sys.modules.pop("fine", None)
    registered = loaded_again()
    assert registered.laws.lost == ("rubber",)
    (tmp_path / "config.yaml").write_text(
        CONFIG.replace("[coulomb-viscous, rubber, coulomb-viscous+rubber-seal]", "all")
    )
    config = load_config(tmp_path / "config.yaml")
    assert config.model_names == (*registered.laws, "rubber")
    with pytest.raises(plugins.LeftOut, match="law 'rubber' cannot be used: plugin 'fine' of fine is left out"):
        Model.parse("rubber")
    (site / "fine.py").write_text(GOOD)
    sys.modules.pop("fine", None)
    again = loaded_again().laws
    assert "rubber" in again
    assert again.lost == ()


def test_what_is_installed_beside_it_matters(install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    site = install("exits", "import beside\n" + DEADLY["exits"][0])
    (site / "beside.py").write_text("")
    loaded_again()
    tried = counted(monkeypatch)
    (site / "beside-2.dist-info").mkdir()
    loaded_again()
    assert tried == ["exits"]


def test_the_limit_bounds_the_time_and_another_limit_is_another_try(
    install: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    install("slow", "import time\ntime.sleep(1.5)\n" + GOOD)
    monkeypatch.setenv(probe.LIMIT, "1")
    begin = time.monotonic()
    (failure,) = (f for f in loaded_again().failures if f.plugin == "slow")
    assert time.monotonic() - begin < 15
    assert "does not end within 1 s" in failure.reason
    monkeypatch.setenv(probe.LIMIT, "60")
    assert "rubber" in loaded_again().laws


@pytest.mark.parametrize("limit", ["soon", "0", "-1", "inf", "nan"])
def test_a_limit_that_is_none_is_refused(limit: str, install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    install("fine", GOOD)
    monkeypatch.setenv(probe.LIMIT, limit)
    with pytest.raises(InputError, match=f"FRICMODELS_PLUGIN_TIMEOUT is '{limit}'"):
        loaded_again()


def test_a_spoilt_verdict_is_made_anew(install: Install, own_cache: Path) -> None:
    install("exits", DEADLY["exits"][0])
    expected = loaded_again().failures
    (verdict,) = own_cache.glob("plugin-*.json")
    kept = verdict.read_text()
    for content in (
        "",
        "{",
        "[]",
        "7",
        '{"fingerprint": 1}',
        "\x00\xff",
        "[" * 100_000,
        kept.replace('"reason"', '"why"'),
    ):
        verdict.write_text(content, encoding="latin-1")
        assert loaded_again().failures == expected
        assert json.loads(verdict.read_text()).items() >= json.loads(kept).items()


def test_without_a_cache_plugins_are_tried_each_time(
    install: Install, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "blocked").write_text("a file where the directory should be")
    monkeypatch.setenv("FRICMODELS_CACHE", str(tmp_path / "blocked" / "below"))
    install("exits", DEADLY["exits"][0])
    tried = counted(monkeypatch)
    for _ in range(2):
        assert "exit code 1" in loaded_again().failures[0].reason
    assert tried == ["exits"] * 2


def test_kept_bytecode_is_no_other_plugin(install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    site = install("exits", DEADLY["exits"][0])
    loaded_again()
    tried = counted(monkeypatch)
    (site / "__pycache__").mkdir(exist_ok=True)
    (site / "__pycache__" / "one.pyc").write_bytes(b"kept")
    loaded_again()
    assert tried == []
    (site / "another.pth").write_text("")
    loaded_again()
    assert tried == ["exits"]


@pytest.mark.long
def test_what_a_plugin_started_ends_with_it(install: Install, tmp_path: Path) -> None:
    """A child of a child that hangs does not stay behind."""
    sign = tmp_path / "sign"
    grandchild = f"import time\nwhile True:\n    open({str(sign)!r}, 'a').write('x')\n    time.sleep(0.05)\n"
    install("breeds", f"import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', {grandchild!r}])\n{HANGS}")
    loaded_again()
    assert sign.exists()
    time.sleep(0.3)
    size = sign.stat().st_size
    time.sleep(0.5)
    assert sign.stat().st_size == size


def test_a_plugin_that_asks_for_the_registry_while_it_is_imported_is_no_loop(install: Install) -> None:
    install("curious", "from fricmodels.model import Model\nModel.parse('coulomb-viscous')\n" + GOOD)
    assert "coulomb-viscous" in loaded_again().laws


def test_built_in_plugins_are_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = counted(monkeypatch)
    loaded_again()
    assert not {"laws", "effects", "estimators", "readers"} & set(tried)


def test_plugins_are_tried_whichever_class_their_entry_points_are_of(
    install: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once ``importlib_metadata`` is imported, as by Dask, all entry points are of its own class."""

    class Other:
        def __init__(self, point: importlib.metadata.EntryPoint) -> None:
            self.name, self.value, self.group, self.dist = point.name, point.value, point.group, point.dist
            self.module, self.attr, self.load = point.module, point.attr, point.load

    install("exits", DEADLY["exits"][0])
    points = [Other(point) for point in importlib.metadata.entry_points(group="fricmodels")]
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: points)
    (failure,) = (f for f in loaded_again().failures if f.plugin == "exits")
    assert "ends the interpreter with exit code 1" in failure.reason
