"""Reads the formula of a term as it is printed, ``τ = F·exp(−|ω|/ω_s)·sgn ω; dz/dt = …``, so that it can be evaluated.

Only plain formulas are read: sums, products, quotients, powers, absolute values and the usual functions. What needs a
word (``for``, ``where``), a sum sign or an unknown symbol is not read, and :class:`NotRead` says which.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping

Value = Callable[[Mapping[str, float]], float]

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
    "chi": "χ", "psi": "ψ", "omega": "ω", "Delta": "Δ", "Omega": "Ω", "Gamma": "Γ",
}  # fmt: skip
_SIGNALS = {
    "dω/dt": "acceleration",
    "dτ_m/dt": "motor_torque_rate",
    "τ_m": "motor_torque",
    "τ_L": "load_torque",
    "ω": "velocity",
    "q": "position",
    "ϑ": "temperature",
    "t": "time",
}
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sgn₁": lambda x: 1.0 if x >= 0 else 0.0,
    "sgn₂": lambda x: -1.0 if x < 0 else 0.0,
    "sgn": lambda x: 1.0 if x >= 0 else -1.0,
    "exp": math.exp,
    "ln": math.log,
    "log": math.log,
    "sqrt": math.sqrt,
    "√": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tanh": math.tanh,
    "tan": math.tan,
    "arctan": math.atan,
    "atan": math.atan,
    "abs": abs,
}
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻ⁿ", "0123456789-n")
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


class NotRead(Exception):
    """The formula has something that is not read; the message says what."""


def equations(formula: str, parameters: Collection[str], states: Collection[str]) -> list[dict[str, Value]]:
    """Return the right-hand side of each equation by its left, ``τ`` for the torque and ``dz/dt`` for a rate.

    A function without brackets may take the next symbols or the whole product after it: there is one reading for each.

    Raises:
        NotRead: where something in it is not understood.
    """
    return [_read(formula, parameters, states, greedy) for greedy in (False, True)]


def _read(formula: str, parameters: Collection[str], states: Collection[str], greedy: bool) -> dict[str, Value]:
    lines = [line.strip() for line in _split(formula)]
    sides = [tuple(part.strip() for part in line.partition("=")[::2]) for line in lines if line]
    if not all(left and right for left, right in sides):
        raise NotRead("it is no list of equations LEFT = RIGHT")
    names = _names(parameters, states)
    defined = [left for left, _ in sides if not re.fullmatch(r"τ(_F)?|d.+/dt", left)]
    for left in defined:
        names[left] = left
    found: dict[str, Value] = {}
    for left, right in sides:
        value = _Reader(right, names, greedy).whole()
        if left in defined:
            found[left] = value
        elif left in ("τ", "τ_F"):
            found["τ"] = value
        else:
            symbol = names.get(left[1:].removesuffix("/dt"))
            if symbol is None:
                raise NotRead(f"'{left}' is the rate of no state")
            found[f"d{symbol}/dt"] = value
    return {left: _with(value, {name: found[name] for name in defined}) for left, value in found.items()}


def _with(value: Value, defined: Mapping[str, Value]) -> Value:
    """Return a value that knows what else the formula defines, each by those before and after it."""

    def evaluated(given: Mapping[str, float]) -> float:
        known = dict(given)
        for _ in defined:
            for name, of in defined.items():
                try:
                    known[name] = of(known)
                except KeyError:
                    continue
        return value(known)

    return evaluated


def _split(formula: str) -> list[str]:
    parts, depth, start = [], 0, 0
    for place, letter in enumerate(formula):
        depth += (letter in "([") - (letter in ")]")
        if letter in ";,\n" and depth == 0:
            parts.append(formula[start:place])
            start = place + 1
    return [*parts, formula[start:]]


def _names(parameters: Collection[str], states: Collection[str]) -> dict[str, str]:
    """Return the symbol that each written name means: Greek letters for their names, with or without ``_``."""
    names = dict(_SIGNALS)
    for symbol in (*parameters, *states):
        first, underscore, rest = symbol.partition("_")
        written = {first, _GREEK.get(first, first)} | ({"ϑ"} if first == "theta" else set())
        if first[:1] == "d" and len(first) > 1:
            written.add(f"Δ{first[1:]}")
        for start in written:
            names[f"{start}{underscore}{rest}"] = symbol
            if rest.isdigit():
                names[f"{start}{rest}"] = symbol
    return names


class _Reader:
    """Recursive descent over one right-hand side."""

    def __init__(self, text: str, names: Mapping[str, str], greedy: bool) -> None:
        self.text = _plain(text)
        self.names = names
        self.greedy = greedy
        self.place = 0
        self.bars = 0
        self.words = sorted([*names, *_FUNCTIONS, "π", "e"], key=len, reverse=True)

    def whole(self) -> Value:
        value = self.sum()
        if self._next():
            raise NotRead(f"'{self.text[self.place :][:20]}' is not understood")
        return value

    def _next(self) -> str:
        while self.place < len(self.text) and self.text[self.place].isspace():
            self.place += 1
        return self.text[self.place : self.place + 1]

    def _taken(self, letters: str) -> str:
        found = self._next()
        if found and found in letters:
            self.place += 1
            return found
        return ""

    def sum(self) -> Value:
        value = self.product()
        while sign := self._taken("+-"):
            value = _joined(value, self.product(), sign)
        return value

    def product(self) -> Value:
        negative = bool(self._taken("-"))
        value = self.power()
        while True:
            if sign := self._taken("*/"):
                value = _joined(value, self.power(), sign)
            elif self._begins():
                value = _joined(value, self.power(), "*")
            else:
                return _joined(_number(0.0), value, "-") if negative else value

    def _begins(self) -> bool:
        following = self._next()
        return bool(following) and (following in "([" or following.isalnum() or following in "√∂" or (
            following == "|" and not self.bars))  # fmt: skip

    def power(self) -> Value:
        base = self.primary()
        if self._taken("^"):
            exponent = self.power() if not self._taken("-") else _joined(_number(0.0), self.power(), "-")
            return lambda given: base(given) ** exponent(given)
        return base

    def primary(self) -> Value:
        if self._taken("(["):
            bars, self.bars = self.bars, 0
            value = self.sum()
            self.bars = bars
            if not self._taken(")]"):
                raise NotRead("a bracket is not closed")
            return value
        if self._taken("|"):
            self.bars += 1
            value = self.sum()
            self.bars -= 1
            if not self._taken("|"):
                raise NotRead("a bar is not closed")
            return lambda given: abs(value(given))
        self._next()
        number = _NUMBER.match(self.text, self.place)
        if number:
            self.place = number.end()
            return _number(float(number[0]))
        return self._word()

    def _word(self) -> Value:
        for word in self.words:
            if not self.text.startswith(word, self.place) or self._goes_on(word):
                continue
            self.place += len(word)
            if word in self.names:
                symbol = self.names[word]
                return lambda given: given[symbol]
            if word in ("π", "e"):
                return _number(math.pi if word == "π" else math.e)
            return self._function(_FUNCTIONS[word])
        raise NotRead(f"'{self.text[self.place :][:20]}' is not understood")

    def _goes_on(self, word: str) -> bool:
        following = self.text[self.place + len(word) : self.place + len(word) + 1]
        return following == "_" or (word not in _FUNCTIONS and following.isdigit())

    def _function(self, function: Callable[[float], float]) -> Value:
        bracketed = self._next() in ("(", "[")
        inner = self.power()
        while not bracketed and (self._begins() or (self.greedy and self._next() == "*")):
            self._taken("*")
            inner = _joined(inner, self.power(), "*")
        return lambda given: function(inner(given))


def _plain(text: str) -> str:
    text = re.sub(r"[⁰¹²³⁴⁵⁶⁷⁸⁹⁻ⁿ]+", lambda found: f"^({found[0].translate(_RAISED)})", text)
    for written, meant in (("·", "*"), ("×", "*"), ("−", "-"), ("–", "-"), ("**", "^")):
        text = text.replace(written, meant)
    return text


def _number(value: float) -> Value:
    return lambda given: value


def _joined(left: Value, right: Value, sign: str) -> Value:
    if sign == "+":
        return lambda given: left(given) + right(given)
    if sign == "-":
        return lambda given: left(given) - right(given)
    if sign == "*":
        return lambda given: left(given) * right(given)
    return lambda given: left(given) / right(given)
