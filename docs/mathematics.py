"""Sets formulas as MathML when the site is built, so that its pages need no script and no network."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert

from fricmodels.report.formula import mathml

_TEX = re.compile(r'<(div|span) class="arithmatex">\\([\[(])(.*?)\\[\])]</\1>', re.DOTALL)
_CELL = re.compile(r"<td>(τ(?:_\w+)? = [^<]+)</td>")


def on_page_content(content: str, page: Any, config: Any, files: Any) -> str:
    """Return the page with its formulas, and the equations in tables, as MathML."""
    content = _TEX.sub(lambda found: _set(found[3], block=found[2] == "["), content)
    return _CELL.sub(lambda found: f"<td>{''.join(mathml(html.unescape(found[1])))}</td>", content)


def _set(tex: str, *, block: bool) -> str:
    return convert(html.unescape(tex).strip(), display="block" if block else "inline")
