"""Machine code on disk: spoilt files, several processes, and what it needs of the process."""

from __future__ import annotations

import ctypes
import gc
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fricmodels.kernels import machine_code
from fricmodels.kernels.machine_code import ENTRY, MachineCode, loaded

UNARY = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)


def source(number: float) -> str:
    return f"""declare double @erf(double)
        define double @{ENTRY}(double %x) {{
        %a = call double @erf(double %x)
        %b = fadd double %a, {number}
        ret double %b }}
        """


def result(code: MachineCode) -> float:
    return float(UNARY(code.address)(0.0))


@pytest.fixture(autouse=True)
def nothing_in_memory() -> None:
    machine_code._loaded.cache_clear()


def test_what_was_compiled_is_read_the_next_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert result(loaded(source(1.25), tmp_path)) == 1.25
    machine_code._loaded.cache_clear()
    monkeypatch.setattr(machine_code, "_compiled", None)
    assert result(loaded(source(1.25), tmp_path)) == 1.25
    with pytest.raises(TypeError):
        loaded(source(1.75), tmp_path)


@pytest.mark.parametrize("spoil", ["cut", "empty", "changed", "folder"])
def test_a_spoilt_file_is_compiled_anew(spoil: str, tmp_path: Path) -> None:
    assert result(loaded(source(1.5), tmp_path)) == 1.5
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    file.unlink()
    if spoil == "folder":
        file.mkdir()
    else:
        changed = bytearray(content)
        changed[len(changed) // 2] ^= 1
        file.write_bytes({"cut": content[: len(content) // 2], "empty": b"", "changed": bytes(changed)}[spoil])
    machine_code._loaded.cache_clear()
    assert result(loaded(source(1.5), tmp_path)) == 1.5
    if spoil != "folder":
        assert file.read_bytes() == content


def test_another_processor_has_code_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    here = machine_code._compiler()
    loaded(source(2.5), tmp_path)
    machine_code._loaded.cache_clear()
    monkeypatch.setattr(machine_code, "_compiler", lambda: here._replace(described=here.described + " and more"))
    loaded(source(2.5), tmp_path)
    assert len(list(tmp_path.iterdir())) == 2


def test_code_lives_as_long_as_it_is_held(tmp_path: Path) -> None:
    held = [loaded(source(float(i)), tmp_path) for i in range(5)]
    machine_code._loaded.cache_clear()
    gc.collect()
    assert [result(code) for code in held] == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_functions_that_the_process_does_not_show_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from llvmlite import binding

    machine_code._from_elsewhere.cache_clear()
    monkeypatch.setattr(binding, "address_of_symbol", lambda _: None)
    try:
        found = machine_code._from_elsewhere()
        assert {"erf", "pow", "tanh"} <= found.keys()
        assert UNARY(found["erf"])(0.0) == 0.0
        assert result(loaded(source(3.5), tmp_path)) == 3.5
    finally:
        machine_code._from_elsewhere.cache_clear()


PROCESS = """
import sys
import casadi, numpy as np
from fricmodels.kernels import Scan
x, u, c = (casadi.SX.sym(name) for name in "xuc")
step = casadi.sin(x) ** c + casadi.cos(x) + casadi.erf(u) + casadi.tanh(x) + casadi.atan2(x, u) + casadi.expm1(-u)
last, _, done = Scan(casadi.Function("f", [x, u, c], [step / 9, x]))([0.1], np.ones(50), [2.0])
assert "numba" not in sys.modules
print(done, float(last[0]).hex())
"""


def test_processes_that_compile_the_same_at_once_agree(tmp_path: Path) -> None:
    """They have neither Numba nor one another's code; the third finds what they left."""
    environment = {**os.environ, "FRICMODELS_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", PROCESS]
    both = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    said = [process.communicate(timeout=120)[0] for process in both]
    said.append(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)
    assert [process.returncode for process in both] == [0, 0]
    assert len(set(said)) == 1
    assert said[0].startswith("50 0x")
    assert len(list(tmp_path.iterdir())) == 1
