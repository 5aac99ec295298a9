"""A plugin that fails is named, and the rest goes on."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from fricmodels import plugins
from fricmodels.cli import main

Install = Callable[[str, str], Path]

BROKEN = {
    "fails-to-import": ("import there_is_no_such_module\n", "there_is_no_such_module"),
    "wrong-syntax": ("def (:\n", "SyntaxError"),
    "raises-in-hook": (
        "from fricmodels import hookimpl\n@hookimpl\ndef fricmodels_laws():\n    raise RuntimeError('boom')\n",
        "boom",
    ),
    "takes-a-name": (
        "from fricmodels import Law, hookimpl\n"
        "class Mine(Law):\n    name = 'coulomb-viscous'\n    def torque(self, s, p):\n        return 0\n"
        "@hookimpl\ndef fricmodels_laws():\n    return [Mine]\n",
        "already provided by fricmodels",
    ),
    "writes-no-torque": (
        "from fricmodels import Law, hookimpl\nclass Mine(Law):\n    name = 'mine'\n"
        "@hookimpl\ndef fricmodels_laws():\n    return [Mine]\n",
        "does not write torque",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_is_named_and_the_rest_goes_on(name: str, install: Install) -> None:
    source, reason = BROKEN[name]
    built_in = set(plugins.load().laws)
    install(name, source)
    registered = plugins.load()
    assert set(registered.laws) == built_in
    (failure,) = registered.failures
    assert failure.distribution == name
    assert reason in str(failure)
    assert name in str(failure)


def test_list_names_it_on_standard_error(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    install("fails-to-import", BROKEN["fails-to-import"][0])
    with pytest.raises(SystemExit) as stopped:
        main(["list", "laws"])
    captured = capsys.readouterr()
    assert stopped.value.code == 0
    assert "fails-to-import" in captured.err
    assert len(captured.err.splitlines()) == 1
    assert "coulomb-viscous" in captured.out


@pytest.mark.long
def test_a_tournament_goes_on(install: Install, tmp_path: Path) -> None:
    site = install("fails-to-import", BROKEN["fails-to-import"][0])
    config = tmp_path / "config.yaml"
    config.write_text(
        "datasets:\n  - simulate: {model: coulomb-viscous, parameters: {K_v: 1e-4, K_c: 0.01}, inertia: 4.87e-6,"
        " amplitude: 0.02, frequency: 39.54}\nmodels: coulomb-viscous\nestimators: rls\nsimulate: false\n"
    )
    command = [sys.executable, "-m", "fricmodels", "run", str(config), "--out", str(tmp_path / "out")]
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": paths})
    assert done.returncode == 0, done.stderr
    assert "fails-to-import" in done.stderr
    assert "there_is_no_such_module" in done.stderr
    assert "coulomb-viscous" in done.stdout
    assert (tmp_path / "out" / "leaderboard.json").is_file()
