"""The header against Python: two implementations of every law and effect, by the system's own compiler."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.export.targets.c_header import c_header
from fricmodels.export.targets.c_text import ascii_text, c_names, comment
from fricmodels.saved import FittedModel

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror"]
CHANNEL = {
    "other": "j2_position",
    "other-friction": "j2_velocity",
    "other-gravity": "j2_position",
    "chain-gravity": "j2_position",
}
CHANNEL |= {"other-inertia": "j2_velocity", "proximal-coupling": "j2_velocity"}
DRIVER = """
#include "{n}.h"
void {n}_torques(long count, const double *in, const double *z, double *out) {{
    long i;
    (void)z;
    for (i = 0; i < count; i++) out[i] = {n}_torque(&{n}_fitted, (const {n}_signals *)(const void *)(in + i * {m}){z});
}}
void {n}_compensations(long count, const double *in, const double *z, int at_rest, const double *reference,
                       double width, double *out) {{
    long i;
    (void)z;
    for (i = 0; i < count; i++)
        out[i] = {n}_compensation(&{n}_fitted, (const {n}_signals *)(const void *)(in + i * {m}){z},
                                  ({n}_at_rest)at_rest, reference[i], width);
}}
"""
FOLLOWER = """
void {n}_followed(long count, const double *in, double interval, double *out) {{
    long i;
    {n}_state state = {n}_begin();
    for (i = 0; i < count; i++)
        out[i] = {n}_follow(&{n}_fitted, &state, interval, (const {n}_signals *)(const void *)(in + i * {m}));
}}
"""


def names() -> list[str]:
    found = plugins.load()
    built_in = [n for n in found.laws if found.laws.entry(n).distribution == "fricmodels"]
    for name in found.effects:
        if found.effects.entry(name).distribution == "fricmodels":
            inside = f"({CHANNEL[name]})" if name in CHANNEL else ""
            built_in.append(f"asymmetric-exponential-stick-slip+{name}{inside}")
    return [*built_in, "exponential-stick-slip+presliding+cogging+load-friction+thermal"]


def signals(model: FittedModel) -> list[str]:
    return [s for s in model.model.signals if s in model.needs or s == "velocity"]


class Compiled:
    """Models as one shared library."""

    def __init__(self, models: Sequence[FittedModel], directory: Path) -> None:
        text = ""
        for i, model in enumerate(models):
            name = f"m{i}"
            (directory / f"{name}.h").write_text(c_header(model, name), encoding="ascii")
            z = ", z + i * " + str(len(model.model.states)) if model.model.states else ""
            text += DRIVER.format(n=name, m=len(signals(model)), z=z)
            if model.model.states:
                text += FOLLOWER.format(n=name, m=len(signals(model)))
        (directory / "all.c").write_text(text, encoding="ascii")
        library = directory / "all.so"
        done = subprocess.run(
            [str(COMPILER), *STRICT, "-shared", "-fPIC", "-o", str(library), str(directory / "all.c"), "-lm"],
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr[:4000]
        self.library = ctypes.CDLL(str(library))

    def call(self, name: str, count: int, *arguments: Any) -> np.ndarray[Any, Any]:
        out = np.empty(count)
        given = [a.ctypes.data_as(ctypes.c_void_p) if isinstance(a, np.ndarray) else a for a in (*arguments, out)]
        getattr(self.library, name)(ctypes.c_long(count), *given)
        return out


def drawn(model: FittedModel, count: int, rng: np.random.Generator) -> tuple[np.ndarray[Any, Any], ...]:
    """Return random signals, one a column, over several magnitudes, at rest too; and random states."""
    size = 10.0 ** rng.uniform(-3, 1.5, (count, 1))
    given = size * rng.standard_normal((count, len(signals(model))))
    for i, name in enumerate(signals(model)):
        if name in ("time", "temperature"):
            given[:, i] = np.abs(given[:, i])
        if name == "run":
            given[:, i] = rng.integers(0, 3, count)
    given[: count // 100, signals(model).index("velocity")] = 0.0
    return np.ascontiguousarray(given), rng.uniform(-1, 1, (count, max(1, len(model.model.states))))


def compared(models: Sequence[FittedModel], directory: Path, count: int) -> dict[str, float]:
    """Return by model the greatest difference of torque or compensation, relative to the torque or its RMS."""
    compiled, rng, worst = Compiled(models, directory), np.random.default_rng(7), {}
    for i, model in enumerate(models):
        given, z = drawn(model, count, rng)
        named = dict(zip(signals(model), given.T, strict=True))
        states = list(z.T) if model.model.states else None
        expected = [model.torque(states=states, channels=named)]
        found = [compiled.call(f"m{i}_torques", count, given, z)]
        reference = rng.choice([-1.0, 0.0, 1.0], count)
        for code, rest in enumerate(("none", "reference", "smooth")):
            expected.append(
                model.compensation(at_rest=rest, reference=reference, width=0.2, states=states, channels=named)
            )
            found.append(compiled.call(f"m{i}_compensations", count, given, z, code, reference, ctypes.c_double(0.2)))
        worst[model.name] = max(
            float(np.max(np.abs(a - b) / np.maximum(np.abs(b), np.sqrt(np.mean(b**2)))))
            for a, b in zip(found, expected, strict=True)
        )
    return worst


@needs_compiler
def test_every_law_and_effect_is_the_same_in_c(kept: Any, tmp_path: Path) -> None:
    """100 000 random inputs over all, each as torque and as three compensations."""
    models = [kept(name) for name in names()]
    assert len(models) > 30
    worst = compared(models, tmp_path, 100_000 // len(models) + 1)
    assert max(worst.values()) <= 1e-12, {k: v for k, v in worst.items() if v > 1e-12}


@needs_compiler
@pytest.mark.long
def test_a_million_inputs_of_every_law_and_effect(kept: Any, tmp_path: Path) -> None:
    worst = compared([kept(name) for name in names()], tmp_path, 1_000_000)
    assert max(worst.values()) <= 1e-12, {k: v for k, v in worst.items() if v > 1e-12}


@needs_compiler
def test_what_remembers_follows_a_motion_as_python_does(kept: Any, tmp_path: Path) -> None:
    models = [m for m in map(kept, names()) if m.model.states and not m.memory.approximate]
    assert len(models) >= 4
    compiled, time = Compiled(models, tmp_path), np.arange(3000) * 1e-3
    for i, model in enumerate(models):
        wave = {"velocity": 2 * np.sin(7 * time) + np.sin(23 * time), "position": -2 / 7 * np.cos(7 * time)}
        named = {s: wave.get(s, 0.3 * np.cos(5 * time)) for s in signals(model)}
        expected = model.torque(time=time, channels=named)
        given = np.ascontiguousarray(np.stack([named[s] for s in signals(model)], axis=1))
        found = compiled.call(f"m{i}_followed", len(time), given, ctypes.c_double(1e-3))
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected)), err_msg=model.name)


@needs_compiler
def test_a_header_may_be_included_twice_and_by_cpp(kept: Any, tmp_path: Path) -> None:
    (tmp_path / "joint.h").write_text(c_header(kept("coulomb-viscous+presliding"), "joint"), encoding="ascii")
    body = '#include "joint.h"\n#include "joint.h"\nint main(void) { joint_state s = joint_begin(); return s.begun; }\n'
    (tmp_path / "main.c").write_text(body, encoding="ascii")
    subprocess.run([str(COMPILER), *STRICT, "-o", str(tmp_path / "a"), str(tmp_path / "main.c"), "-lm"], check=True)
    cpp = shutil.which("c++") or shutil.which("g++")
    if cpp is not None:
        (tmp_path / "main.cpp").write_text(body, encoding="ascii")
        flags = ["-std=c++11", "-Wall", "-Wextra", "-Werror"]
        subprocess.run([cpp, *flags, "-o", str(tmp_path / "b"), str(tmp_path / "main.cpp"), "-lm"], check=True)


def test_nothing_allocates_and_nothing_is_undetermined_in_silence(kept: Any) -> None:
    text = c_header(kept("coulomb-viscous+cogging", not_identified={"cogging.a": "contains zero */ int x;"}), "j")
    assert not any(word in text for word in ("malloc", "calloc", "stdlib", "for (", "while ("))
    assert text.count("NOT DETERMINED") == 2
    assert "*/ int x" not in text


def test_names_are_names_in_c() -> None:
    assert c_names(["gravity.a", "other(j2).a", "1x", "double", "a.b", "a_b"]) == [
        "gravity_a", "other_j2_a", "_1x", "double_", "a_b", "a_b_"
    ]  # fmt: skip
    assert ascii_text("τ = K·ω ?? */").isascii()
    assert comment(["a */ b"]).count("*/") == 1


@pytest.mark.parametrize("name", ["joint 1", "1joint", "double", "", "j;x"])
def test_a_name_that_is_none_is_refused(kept: Any, name: str) -> None:
    with pytest.raises(InputError, match="no name in C"):
        c_header(kept("coulomb-viscous"), name)


def test_no_letter_of_a_formula_is_lost_in_a_comment():
    registered = plugins.load()
    for registry in (registered.laws, registered.effects):
        for name in registry.names:
            term = registry.entry(name).cls
            texts = [term.formula, *(text for p in term.parameters for text in (p.symbol, p.unit_for(Motion.ROTARY)))]
            assert not any("?" in ascii_text(text) for text in texts), name


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("σ_1·ζ̇ + γ₂·ẋ", "sigma_1*dzeta/dt + gamma2*dx/dt"),
        ("ΔJ·ω̇, ϑ, Σ F_i·φ_i", "DeltaJ*dw/dt, theta, sum F_i*phi_i"),
        ("x² ≥ 0 °C", "x^2 >= 0 degC"),
        ("Größe für é; λ, ẍ", "Groesse fuer e; lambda, d2x/dt2"),
    ],
)
def test_signs_as_a_comment_has_them(text, plain):
    assert ascii_text(text) == plain
