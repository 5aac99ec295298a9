"""Compiles LLVM's intermediate representation for this processor, and keeps the machine code on disk.

A file is named after all that it depends on: what was compiled, the compiler, the processor and what that can do. It
begins with the checksum of the rest: a file that is not whole is compiled anew.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import hashlib
import itertools
import sys
import threading
from contextlib import suppress
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from fricmodels.errors import InputError
from fricmodels.files import write_bytes

ENTRY = "run"
"""Name of the function that is called."""
_CHECKSUM = hashlib.sha256().digest_size
_FROM_C = (
    *("acos", "asin", "atan", "atan2", "cbrt", "ceil", "copysign", "cos", "cosh", "erf", "exp", "exp10", "exp2"),
    *("expm1", "fabs", "floor", "fmax", "fmin", "fmod", "ldexp", "log", "log10", "log1p", "log2", "memcpy", "memmove"),
    *("memset", "pow", "rint", "round", "sin", "sincos", "sinh", "sqrt", "tan", "tanh", "trunc"),
)
"""What compiled code may call: functions that were asked for, and those that the compiler puts in their place."""
_BEFORE = ("jump_threading", "instruction_combine", "jump_threading")
"""Passes before LLVM's own O3: a condition that is asked more than once is followed, before short branches become
choices of computed values. Without them filters take up to a half longer."""
_lock = threading.Lock()
_numbers = itertools.count()


class MachineCode:
    """Compiled code in memory, until nobody holds it any more; :attr:`address` is that of its function."""

    def __init__(self, library: Any) -> None:
        self._library = library
        self.address: int = library[ENTRY]


class _Compiler(NamedTuple):
    """What makes machine code, what puts it into memory, and all that the code depends on but its source."""

    machine: Any
    linker: Any
    described: str


def loaded(source: str, folder: Path) -> MachineCode:
    """Return the machine code of a module, compiled where it is not in a folder yet, and kept there where it can be.

    Args:
        source: LLVM's intermediate representation; its function is called :data:`ENTRY`.
        folder: where machine code is kept.
    """
    with _lock:
        return _loaded(source, folder)


@lru_cache(maxsize=256)
def _loaded(source: str, folder: Path) -> MachineCode:
    digest = hashlib.sha256(f"{_compiler().described}\n{source}".encode()).hexdigest()
    path = folder / f"fricmodels_{digest[:32]}.code"
    code = _read(path)
    if code is None:
        code = _compiled(source)
        with suppress(OSError, InputError):  # then it is compiled anew the next time
            write_bytes(path, hashlib.sha256(code).digest() + code)
    return _linked(code)


def _read(path: Path) -> bytes | None:
    try:
        content = path.read_bytes()
    except OSError:
        return None
    code = content[_CHECKSUM:]
    return code if content[:_CHECKSUM] == hashlib.sha256(code).digest() else None


@cache
def _compiler() -> _Compiler:
    """Return the compiler for this processor, made once for a process."""
    import llvmlite
    from llvmlite import binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    triple, processor, features = llvm.get_process_triple(), llvm.get_host_cpu_name(), ""
    with suppress(RuntimeError):  # where LLVM cannot tell, it takes what all processors of that name can
        features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_triple(triple)
    machine = target.create_target_machine(processor, features, opt=3, reloc="pic", codemodel="default", jit=True)
    linker = llvm.create_lljit_compiler(machine, use_jit_link=sys.platform != "win32")
    versions = (llvmlite.__version__, llvm.llvm_version_info, _BEFORE)
    return _Compiler(machine, linker, f"{versions} {triple} {processor} {features}")


def _compiled(source: str) -> bytes:
    from llvmlite import binding as llvm

    machine = _compiler().machine
    module = llvm.parse_assembly(source)
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    before = llvm.create_new_module_pass_manager()
    for name in _BEFORE:
        getattr(before, f"add_{name}_pass")()
    before.run(module, builder)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def _linked(code: bytes) -> MachineCode:
    from llvmlite import binding as llvm

    builder = llvm.JITLibraryBuilder().add_object_img(code).add_current_process().export_symbol(ENTRY)
    for name, address in _from_elsewhere().items():
        builder.import_symbol(name, address)
    return MachineCode(builder.link(_compiler().linker, f"fricmodels{next(_numbers)}"))


@cache
def _from_elsewhere() -> dict[str, int]:
    """Return the addresses of the functions of C that are not among the symbols of this process."""
    from llvmlite import binding as llvm

    missing = [name for name in _FROM_C if not llvm.address_of_symbol(name)]
    if not missing:
        return {}
    library = ctypes.CDLL(ctypes.util.find_library("m") or ctypes.util.find_library("c"))
    found = {name: getattr(library, name) for name in missing if hasattr(library, name)}
    return {name: ctypes.cast(function, ctypes.c_void_p).value or 0 for name, function in found.items()}
