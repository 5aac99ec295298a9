"""Numbers, units and names as a reader wants them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.model import Model
from fricmodels.parameter import Parameter
from fricmodels.report.figures.style import EXPONENT
from fricmodels.results.words import LEAST_CHANCE, LEAST_NOISE, NORMAL_95, borne, change_text, share_text, value_text

if TYPE_CHECKING:
    from fricmodels.results.diagnosis import DiagnosisDocument, InItsPlace

_STILL_MISSING = (
    "Standard errors are those of this model. What remains is not in it, and may have moved the values by more."
)
_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)\b")
_SUPERSCRIPT = str.maketrans("-0123456789/.", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ·")
_LEAST_PERCENT = 0.001
_SIGNALS = {
    "ω(?!_)": "ω: velocity",
    "q": "q: position",
    "dω/dt": "dω/dt: acceleration",
    "τ_m": "τ_m: motor torque",
    "τ_L": "τ_L: load torque",
    "ϑ": "ϑ: temperature",
    r"\bt\b(?!_)": "t: time",
}
"""How equations write the signals of a recording."""


def percent(value: float | None, digits: int = 3) -> str:
    """Return a percentage in so many figures; a dash for none. Less than a thousandth of one is not told apart."""
    if value is not None and 0 < value < _LEAST_PERCENT:
        return f"<\u00a0{_LEAST_PERCENT}\u00a0%"
    return "–" if value is None or not math.isfinite(value) else f"{number(value, digits)}\u00a0%"


def noise_alone(value: float | None) -> str:
    """Return what noise alone leaves in percent; less than a tenth of a percent is not told apart."""
    return f"<\u00a0{LEAST_NOISE}\u00a0%" if value is not None and value < LEAST_NOISE else percent(value)


def share(value: float | None) -> str:
    """Return a share of the error as the terminal does, its unit beside it."""
    return share_text(value).replace(" ", "\u00a0")


def change(gain: float | None) -> str:
    """Return the change of the error with an effect that takes away a share of it, as the terminal does."""
    return change_text(gain).replace("-", "−").replace(" %", "\u00a0%")


def number(value: float | None, digits: int = 3) -> str:
    """Return a number in so many figures, powers of ten as ×10ⁿ; a dash for none."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
    exponent = int(power)
    if -4 <= exponent < 5:
        return f"{value:.{max(0, digits - 1 - exponent)}f}".replace("-", "−")
    return f"{mantissa.replace('-', '−')}×10{str(exponent).translate(_SUPERSCRIPT)}"


def set_powers(text: str) -> str:
    """Return a text with its numbers like 1e-09 as 1×10⁻⁹."""
    return _POWER.sub(lambda found: f"{found[1]}×10{str(int(found[2])).translate(_SUPERSCRIPT)}", text)


def count(value: int) -> str:
    """Return a whole number with thin spaces between thousands."""
    return f"{value:,}".replace(",", "\u202f")


def interval(value: float | None, error: float | None) -> tuple[str, str]:
    """Return a value and half of its 95 % interval, both to the digit that the interval makes sense of."""
    if value is None or error is None or not math.isfinite(error) or error <= 0:
        return number(value, 4), ""
    half = NORMAL_95 * error
    return number(*borne(value, half)), "± " + number(half, 2)


def small(p_value: float | None) -> str:
    """Return a probability in words that do not pretend: below 10⁻⁶ the number means nothing."""
    if p_value is None:
        return "–"
    return "below one in a million" if p_value < LEAST_CHANCE else number(p_value, 1)


def unit(text: str) -> str:
    """Return a unit as it is printed: ``kg m²`` for ``kg m^2``; nothing for ``1``."""
    printed = re.sub(EXPONENT, lambda match: (match[1] or match[2]).translate(_SUPERSCRIPT), text)
    return "" if printed == "1" else printed


def listed(names: Iterable[str], joint: str = "and") -> str:
    """Return names as in a sentence: ``a, b and c``."""
    parts = list(names)
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} {joint} {parts[-1]}" if parts else ""


def listed_classes(classes: Iterable[Sequence[str]]) -> str:
    """Return names, those of one class joined by "or": ``a and b``, or ``a or b, and c`` where a class has several.

    A class of three or more is set off by semicolons: ``a or b; c, d or e; and f``.
    """
    found = [tuple(names) for names in classes]
    names = [listed(names, "or") for names in found]
    if len(names) < 2 or all(len(names) == 1 for names in found):
        return listed(names)
    apart = ";" if any(len(names) > 2 for names in found) else ","
    return f"{f'{apart} '.join(names[:-1])}{apart} and {names[-1]}"


def on_parameters(data: DiagnosisDocument) -> list[str]:
    """Say what limits the values and standard errors of the final model: what was chosen, what cannot be told or is
    missing."""
    final = data.steps[-1]
    classes = [tuple(n for n in e.names if n not in {o.name for o in e.in_its_place}) for e in data.effects]
    chosen = values_hold_with(classes) if len(data.ladder) > 1 else ""
    pairs = [(effect.name, other) for effect in data.effects for other in effect.in_its_place]
    others = [values_in_its_place(other, name, final.parameters) for name, other in pairs]
    missing = _STILL_MISSING if data.remaining is not None else ""
    return [*filter(None, (chosen, *others, shows_no_inertia(final.parameters, final.standard_errors), missing))]


def values_hold_with(classes: Iterable[Sequence[str]]) -> str:
    """Say that parameters are those of the chosen ones among look-alikes; nothing where every name stands alone."""
    several = [tuple(names) for names in classes if len(names) > 1]
    if not several:
        return ""
    others = several[0][1:]
    another = f"{listed(others, 'or')} in its place" if len(several) == 1 else "a look-alike in the place of one"
    return f"The values hold with {listed(names[0] for names in several)}. With {another} the others may differ."


def values_in_its_place(other: InItsPlace, effect: str, chosen: Mapping[str, float | None]) -> str:
    """Say which values a model has with a look-alike in the place of an effect; the others are as they were.

    Args:
        other: the model with the look-alike.
        effect: whose place it takes.
        chosen: parameters of the model with that, by key.
    """
    errors = other.standard_errors
    values = {key: value for key, value in other.parameters.items() if value is not None}
    moved = [key for key, value in values.items() if errors.get(key) and _differs(value, chosen.get(key), errors[key])]
    if not moved:
        return f"With {other.name} in the place of {effect} they are the same."
    said = [f"{key} {value_text(values[key], errors[key])}" for key in moved]
    return f"With {other.name} in the place of {effect}: {listed(said)} (test error {percent(other.held_out_percent)})."


def _differs(value: float, chosen: float | None, error: float | None) -> bool:
    return chosen is None or abs(value - chosen) > (error or 0.0)


def shows_no_inertia(parameters: Mapping[str, float | None], errors: Mapping[str, float | None]) -> str:
    """Say what it means that an inertia may be nothing; empty where it is not, or is given.

    Args:
        parameters, errors: fitted values and standard errors, by key.
    """
    key = next((key for key in ("J", "M") if key in parameters), "")
    inertia, error = parameters.get(key), errors.get(key)
    if inertia is None or inertia > NORMAL_95 * (error or 0.0):
        return ""
    if not any(parameters.values()):
        name, turned = ("force", "force=NAME:-1*N") if key == "M" else ("torque", "torque=NAME:-1*N*m")
        return (
            f"Neither inertia nor friction shows. So it is where the {name} has the wrong sign: turn it, as in "
            f"--column {turned}, and compare. Or the {name} is not what moves the drive."
        )
    return (
        "No inertia shows: the speed changes too little or too slowly; or a controller switches the torque with the "
        "direction of motion, which looks like friction; or the torque goes with the velocity alone, as where a motor "
        "brakes what something else moves. Give the inertia (--inertia) to tell them apart."
    )


def counted(number_of: int, one: str) -> str:
    """Return a count with its noun, small numbers in words."""
    small_numbers = ("no", "one", "two", "three", "four", "five", "six")
    word = small_numbers[number_of] if number_of < len(small_numbers) else count(number_of)
    return f"{word} {one if number_of == 1 else one + 's'}"


def declared(model: str) -> dict[str, Parameter]:
    """Return the declared parameters of a model by key; none where a part of it is not installed."""
    parsed = known_model(model)
    return {} if parsed is None else {p.key: p.declared for p in parsed.parameters}


def known_model(name: str) -> Model | None:
    """Return a model by its name, or ``None`` where a law or an effect of it is not installed, or not safe to use."""
    registered = plugins.load()
    law, *effects = name.split("+")
    if law not in registered.laws or any(effect not in registered.effects for effect in effects):
        return None
    if registered.laws.danger(law) or any(registered.effects.danger(effect) for effect in effects):
        return None
    return Model.parse(name)


def unit_of(key: str, known: Mapping[str, Parameter], motion: Motion) -> str:
    """Return the printed unit of a parameter of a model, the inertia among them."""
    if key in known:
        return unit(known[key].unit_for(motion))
    return {"J": "kg m²", "M": "kg"}.get(key, "")


def meaning_of(key: str, known: Mapping[str, Parameter]) -> str:
    """Return what a parameter is, in words."""
    if key in known:
        return known[key].meaning
    return {"J": "inertia", "M": "moving mass"}.get(key, "")


def physics(term: Any) -> str:
    """Return the first line of a term's own description, without its full stop."""
    return (term.__doc__ or "").strip().partition("\n")[0].rstrip(".")


def symbols_in(term: Any) -> str:
    """Return the symbols of the signals in a term's equation, with their names: ``ω: velocity, q: position``."""
    return ", ".join(text for sign, text in _SIGNALS.items() if re.search(sign, term.formula))
