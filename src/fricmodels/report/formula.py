"""Equations as MathML, which browsers set without any program, from the plain text that laws and effects carry.

The text is read as a sequence, never evaluated; what is not understood is shown as it stands, so that the formula of
any plugin gives something readable.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape

_FUNCTIONS = frozenset(("abs", "acos", "asin", "atan", "cos", "cosh", "exp", "ln", "log", "max", "min", "sgn", "sign"))
_FUNCTIONS |= {"sin", "sinh", "sqrt", "tan", "tanh"}
_SUBSCRIPTS = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
_CLOSING = {"(": ")", "[": "]", "|": "|"}
_LETTER, _INDEX = r"[^\W\d_⁰¹²³⁴-⁹₀-₉]", r"[^\W⁰¹²³⁴-⁹]"
_NAME = rf"{_LETTER}+(?:_{_INDEX}+|[₀-₉]+|\d+)?"
_TOKEN = re.compile(
    rf"(?P<rate>d(?P<above>{_NAME})/d(?P<below>[a-z](?![\w])))|(?P<name>{_NAME})|(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<power>[⁰¹²³⁴-⁹]+)|(?P<space>\s+)|(?P<sign>.)"
)

_GREEK = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "epsilon": "ε",
    "zeta": "ζ",
    "eta": "η",
    "theta": "θ",
    "kappa": "κ",
    "lambda": "λ",
    "mu": "μ",
    "nu": "ν",
    "xi": "ξ",
    "rho": "ρ",
    "sigma": "σ",
    "tau": "τ",
    "phi": "φ",
    "chi": "χ",
    "psi": "ψ",
    "omega": "ω",
}
_LONGEST = 400
"""A longer formula is shown as it stands."""

Token = tuple[str, str]


def mathml(formula: str) -> list[str]:
    """Return one MathML element for each equation of a formula; equations are parted by semicolons.

    Example:
        >>> mathml("τ_0")
        ['<math displaystyle="true" aria-label="τ_0"><msub><mi>τ</mi><mn>0</mn></msub></math>']
    """
    if len(formula) > _LONGEST:
        return [f"<math><mtext>{escape(formula)}</mtext></math>"]
    equations = [part.strip() for part in re.split(r";\s+", formula) if part.strip()]
    return [
        f'<math displaystyle="true" aria-label="{escape(text)}">{"".join(_Reader(text).sequence())}</math>'
        for text in equations
    ]


def symbol(name: str) -> str:
    """Return a parameter's symbol as inline MathML; of a key such as ``cogging.a`` the part after the dot."""
    base, line, index = name.rpartition(".")[2].partition("_")
    text = _GREEK.get(base, base) + line + _GREEK.get(index, index)
    return f'<math aria-label="{escape(text)}">{"".join(_Reader(text).sequence())}</math>'


def _tokens(text: str) -> Iterator[Token]:
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or "sign"
        if match["rate"]:
            yield "rate", f"{match['above']}/{match['below']}"
        elif kind != "space":
            yield kind, match[0]


class _Reader:
    """Reads one equation from left to right; groups in parentheses, absolute values, powers and fractions nest."""

    def __init__(self, text: str) -> None:
        self._tokens = [*_tokens(text)]
        self._place = 0

    def sequence(self, closing: str = "", *, flat: bool = False) -> list[str]:
        """Return the elements up to a closing sign, or to the end. A flat one keeps its strokes of division."""
        found: list[str] = []
        while (token := self._next()) is not None:
            kind, text = token
            if kind == "sign" and text == closing:
                return found
            if kind == "sign" and text == "^" and found:
                found[-1] = f"<msup>{found[-1]}{self._exponent()}</msup>"
            elif kind == "power" and found:
                found[-1] = f"<msup>{found[-1]}<mn>{text.translate(_SUPERSCRIPTS)}</mn></msup>"
            elif kind == "sign" and text == "/" and found and not flat and (below := self._divisor()):
                found[-1] = f"<mfrac>{_bare(found[-1])}{_bare(below)}</mfrac>"
            else:
                begins = not found or found[-1] == "<mo>=</mo>"
                found.append(self._first(kind, text) if begins else self._element(kind, text))
        return found

    def _first(self, kind: str, text: str) -> str:
        """Return the element that begins a sequence; a minus there is a sign."""
        return '<mo form="prefix">−</mo>' if text in ("−", "-") else self._element(kind, text)

    def _next(self) -> Token | None:
        self._place += 1
        return self._tokens[self._place - 1] if self._place <= len(self._tokens) else None

    def _ahead(self) -> Token:
        return self._tokens[self._place] if self._place < len(self._tokens) else ("end", "")

    def _element(self, kind: str, text: str) -> str:
        if kind == "rate":
            above, below = text.split("/")
            return f"<mfrac><mrow><mi>d</mi>{_name(above)}</mrow><mrow><mi>d</mi>{_name(below)}</mrow></mfrac>"
        if kind == "name":
            return _name(text)
        if kind in ("number", "power"):
            return f"<mn>{text}</mn>"
        if text in _CLOSING:
            inside = "".join(self.sequence(_CLOSING[text], flat=True))
            left, right = (f'<mo fence="true" form="{form}">' for form in ("prefix", "postfix"))
            return f"<mrow>{left}{text}</mo>{inside}{right}{_CLOSING[text]}</mo></mrow>"
        if text == "·":
            return "<mo>·</mo>" if self._ahead()[1] in ("(", "[") else '<mspace width="0.16em"/>'
        return f"<mo>{escape(text)}</mo>"

    def _exponent(self) -> str:
        if self._ahead() == ("sign", "("):
            self._next()
            return f"<mrow>{''.join(self.sequence(')', flat=True))}</mrow>"
        return self._single()

    def _divisor(self) -> str:
        """Return what stands below a stroke, with its own power; nothing where no operand follows."""
        kind, text = self._ahead()
        if kind not in ("name", "number") and text not in _CLOSING:
            return ""
        below = self._single()
        if self._ahead() == ("sign", "^"):
            self._next()
            below = f"<msup>{below}{self._exponent()}</msup>"
        return below

    def _single(self) -> str:
        token = self._next()
        return self._element(*token) if token is not None else "<mrow></mrow>"


def _bare(element: str) -> str:
    """Return the inside of a group in parentheses, which a fraction bar makes superfluous."""
    opening = '<mrow><mo fence="true" form="prefix">(</mo>'
    closing = '<mo fence="true" form="postfix">)</mo></mrow>'
    if element.startswith(opening) and element.endswith(closing):
        return f"<mrow>{element[len(opening) : -len(closing)]}</mrow>"
    return element


def _name(text: str) -> str:
    base, index = _parts(text)
    if base in _FUNCTIONS:
        shown = f"<mi>{base}</mi>"
        spaced = f"<msub>{shown}<mn>{index}</mn></msub>" if index else shown
        return f'<mrow>{spaced}<mspace width="0.16em"/></mrow>'
    if index:
        kind = "mn" if index.isdigit() else "mi"
        return f"<msub><mi>{escape(base)}</mi><{kind}>{escape(index)}</{kind}></msub>"
    if len(base) <= 2 and base.isascii() and base.islower():
        return "".join(f"<mi>{letter}</mi>" for letter in base)
    if len(base) == 2 and base[0] == "Δ":
        return f"<mrow><mi>Δ</mi><mi>{escape(base[1])}</mi></mrow>"
    if len(base) == 1:
        return f"<mi>{escape(base)}</mi>"
    return f"<mtext>&#160;{escape(base)}&#160;</mtext>"


def _parts(text: str) -> tuple[str, str]:
    """Split a name into base and index: ``K_v1`` → K, v1; ``sgn₁`` → sgn, 1; ``γ2`` → γ, 2."""
    match = re.fullmatch(rf"({_LETTER}+)(?:_(.+)|([₀-₉]+)|(\d+))?", text)
    if match is None:
        return text, ""
    index = match[2] or match[3] or match[4] or ""
    return match[1], index.translate(_SUBSCRIPTS)
