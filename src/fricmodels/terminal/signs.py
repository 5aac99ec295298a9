"""Signs that a terminal may not have."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

_ASCII = str.maketrans({"−": "-", "→": "->", "–": "-", "×": "x", "·": "*", "±": "+-"})
_POWER, _RAISED = re.compile("10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)"), str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def spoken(console: Console, text: str) -> str:
    """Return a text with plain spaces; with signs of ASCII where the terminal has no others."""
    plainer = text.replace("\N{NO-BREAK SPACE}", " ").replace("\N{NARROW NO-BREAK SPACE}", " ")
    if not console.options.ascii_only:
        return plainer
    return _POWER.sub(lambda found: f"10^{found[1].translate(_RAISED)}", plainer).translate(_ASCII)
