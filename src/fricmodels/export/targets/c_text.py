"""Names and comments as C takes them."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from fricmodels.kernels.c_source import c_lines, literal

KEYWORDS = frozenset(
    re.findall(
        r"\w+",
        "auto break case char const continue default do double else enum extern float for goto if inline int long "
        "register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while",
    )
)
_WIDTH = 110


def c_names(names: Iterable[str]) -> list[str]:
    """Return names as C takes them, all different: ``gravity.a`` is ``gravity_a``."""
    found: list[str] = []
    for name in names:
        text = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or "x"
        text = f"_{text}" if text[0].isdigit() else text
        while text in found or text in KEYWORDS:
            text += "_"
        found.append(text)
    return found


def comment(lines: Iterable[str]) -> str:
    """Return lines as a comment of C, in ASCII, folded; nothing in them ends it."""
    folded: list[str] = []
    for line in lines:
        text = ascii_text(line)
        folded += textwrap.wrap(text, _WIDTH, subsequent_indent="    ") if text else [""]
    return "/*\n" + "\n".join(f" * {line}".rstrip() for line in folded) + "\n */"


_ASCII = {"ω": "w", "τ": "tau", "·": "*", "−": "-", "₁": "1", "₂": "2", "≥": ">=", "²": "^2", "…": "...", "δ": "delta",
          "μ": "mu", "σ": "sigma", "α": "alpha", "∞": "inf", "√": "sqrt", "°": "deg", "ż": "dz/dt", "|": "|",
          "≤": "<=", "∂": "d", "φ": "phi", "θ": "theta"}  # fmt: skip


def ascii_text(text: str) -> str:
    """Return a text in printable ASCII that can stand in a comment of C."""
    plain = "".join(_ASCII.get(c, c if c.isascii() and c.isprintable() else "?") for c in text)
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace("\\", "/")


def table(name: str, values: Iterable[float]) -> str:
    """Return the declaration of a table of numbers."""
    listed = [literal(float(value)) for value in values]
    return f"static const double {name}[{len(listed)}] = {{{', '.join(listed)}}};"


def step(name: str, function: Any, taken: Sequence[str], places: Sequence[Callable[[int], str]]) -> str:
    """Return the function that writes the memory after a sample to ``next``.

    Args:
        name: what its name begins with. function: of CasADi, whose first result is that memory.
        taken: the pointers that it takes. places: where each argument of the function stands, by its place.
    """
    import casadi

    given = function.sx_in()
    following = casadi.Function("step", given, [function(*given)[0]], {"cse": True})
    pointers = ", ".join(f"const double *{each}" for each in taken)
    return "\n".join(
        [
            f"static inline void {name}_online_step({pointers}, double *next) {{",
            *(f"    {line}" for line in c_lines(following, places, [lambda i: f"next[{i}]"])),
            "}",
        ]
    )
