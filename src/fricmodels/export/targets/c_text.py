"""Names and comments as C takes them."""

from __future__ import annotations

import re
import textwrap
import unicodedata
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


_ASCII = {"ω": "w", "·": "*", "×": "x", "−": "-", "–": "-", "≥": ">=", "≤": "<=", "≠": "!=", "≈": "~", "…": "...",
          "∞": "inf", "√": "sqrt", "°": "deg", "∂": "d", "∑": "sum", "Σ": "sum", "∫": "int", "‖": "|", "→": "->",
          "′": "'", "µ": "mu", "ß": "ss", "∈": " in ", "±": "+-"}  # fmt: skip
"""Signs as C's comments have them; letters of the Greek alphabet are spelled by their names."""
_MARKS = {"\u0307": "d{}/dt", "\u0308": "d2{}/dt2"}
"""Dots above a letter → the derivative by time that they are; any other mark is left out."""
_DIGITS = dict(zip("₀₁₂₃₄₅₆₇₈₉", "0123456789", strict=True)) | dict(
    zip("⁰¹²³⁴⁵⁶⁷⁸⁹", (f"^{digit}" for digit in range(10)), strict=True)
)
_UMLAUTS = frozenset(f"{letter}\u0308" for letter in "aouAOU")
_SUBSCRIPTS = dict(zip("ₐₑᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ", "aeijklmnoprstuvx", strict=True))


def ascii_text(text: str) -> str:
    """Return a text in printable ASCII that can stand in a comment of C."""
    plain = "".join(map(_ascii, re.findall(r".[\u0300-\u036f]?", unicodedata.normalize("NFD", text), re.DOTALL)))
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace("\\", "/")


def _ascii(sign: str) -> str:
    """Return a sign, with a mark above it or without, as ASCII."""
    letter, mark = sign[0], sign[1:]
    if sign in _UMLAUTS:
        return f"{letter}e"
    if mark:
        return _MARKS.get(mark, "{}").format(_ascii(letter))
    for known in (_ASCII, _DIGITS, _SUBSCRIPTS):
        if letter in known:
            return known[letter]
    if letter.isascii():
        return letter if letter.isprintable() else "?"
    words = unicodedata.name(letter, "").removesuffix(" SYMBOL").split()  # GREEK SMALL LETTER SIGMA, GREEK THETA SYMBOL
    if len(words) < 2 or words[0] != "GREEK":
        return "?"
    name = words[-1].replace("LAMDA", "LAMBDA")
    return name.capitalize() if words[1] == "CAPITAL" else name.lower()


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


def mentions(lines: Iterable[str], name: str) -> bool:
    """Whether lines of C mention a variable of a name."""
    return re.search(rf"(?<![\w.>]){name}(?!\w)", "\n".join(lines)) is not None
