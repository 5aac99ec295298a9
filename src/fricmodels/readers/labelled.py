"""Lines in which every number has its name before it, as a board prints them: ``Time: 5001 Position: 595``."""

from __future__ import annotations

import re

_NAME = r"[^\W\d](?:[^:=,;\t\n]*[^:=,;\s])?"
_VALUE = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|nan|[-+]?inf"
_PAIR = re.compile(rf"\s*({_NAME})\s*[:=]\s*({_VALUE})\s*(?:[,;\t]\s*|\s|$)", re.IGNORECASE)


def labels_of(line: str) -> list[str] | None:
    """Return the names of the numbers of a line; ``None`` where it is no line of names with a number each."""
    names, end = [], 0
    while end < len(line):
        pair = _PAIR.match(line, end)
        if pair is None:
            return None
        names.append(pair[1])
        end = pair.end()
    return names if len(names) > 1 and len(set(names)) == len(names) else None


def without_labels(text: str, labels: list[str]) -> str:
    """Return the text with a comma in the place of every name but the first of a line, which is left out."""
    first, *others = (rf"{re.escape(label)}[ \t]*+[:=]" for label in labels)
    text = re.sub(rf"^[ \t]*+{first}", "", text, flags=re.MULTILINE)
    # From the first blank of several, and no way back: many of them are looked at once.
    return re.sub(rf"(?<![ \t,;])[ \t,;]++(?:{'|'.join(others)})", ",", text)
