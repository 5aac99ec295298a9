"""A page as one HTML file that needs nothing else: style, program, plotting library and figures are inside.

All text goes through Jinja's autoescape. Figures and the plotting library are gzip in base64, an alphabet that can end
no element; a content security policy admits the two programs of the page by their checksums and forbids all traffic.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmodels.report.formula import mathml, symbol
from fricmodels.report.page import Block, Fold, Gallery, Page, Picture

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_HEIGHT = 420
_UNIT = re.compile(r"(?<=\d) (?=%|(?:ms|s|N|rad|m|Hz)\b)")
_LONG_WORD = 44
"""A longer name is broken to fit its column."""


def render(page: Page) -> str:
    """Return a page as HTML; equal pages give equal text."""
    from markupsafe import Markup

    pictures = [*_pictures(block for section in page.sections for block in section.blocks)]
    names = figure_names(pictures)
    program, style = asset("report.js"), asset("report.css")
    html: str = (
        _environment()
        .from_string(asset("report.html"))
        .render(
            page=page,
            names=names,
            loop_key=id,
            style=Markup(style),
            program=Markup(program),
            policy=_policy([program, *([plotly_script()] if pictures else [])]),
            plotly=_packed_plotly() if pictures else "",
            looks=_packed(_style()) if pictures else "",
            figures=[(names[id(picture)], _packed(_content(picture.figure))) for picture in pictures],
        )
    )
    return html.strip() + "\n"


def _environment() -> Any:
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["mathml"] = lambda text: [Markup(line) for line in mathml(text)]
    environment.filters["held"] = held
    environment.filters["symbol"] = lambda text: Markup(symbol(text))
    environment.filters["height"] = lambda picture: int(picture.figure.layout.height or _HEIGHT)
    environment.filters["one_word"] = lambda text: len(text) <= _LONG_WORD and not any(map(str.isspace, text))
    return environment


def held(text: str) -> str:
    """Return a text in which a number stays on one line with its unit."""
    together = text.replace("N m", "N\N{NO-BREAK SPACE}m")
    return _UNIT.sub("\N{NO-BREAK SPACE}", together)


def fragment(blocks: Iterable[Block]) -> tuple[str, dict[str, str]]:
    """Return blocks as a piece of HTML without a page around it, and the figures in it as JSON by name.

    Args:
        blocks: of a page; an application shows them and draws the figures itself.
    """
    listed = list(blocks)
    pictures = [*_pictures(listed)]
    names = figure_names(pictures)
    macros: Any = (
        _environment()
        .from_string(asset("report.html").partition("<!DOCTYPE")[0])
        .make_module({"names": names, "loop_key": id})
    )
    text = "\n".join(str(macros.block_of(block, 3)).strip() for block in listed)
    return text, {names[id(picture)]: _content(picture.figure) for picture in pictures}


def figure_names(pictures: Sequence[Picture]) -> dict[int, str]:
    """Return the name of each picture's figure in a page: its own, with a number from the second on."""
    names: dict[int, str] = {}
    taken: dict[str, int] = {}
    for picture in pictures:
        own = re.sub(r"[^a-z0-9]+", "-", picture.name.lower()).strip("-") or "figure"
        taken[own] = taken.get(own, 0) + 1
        names[id(picture)] = own if taken[own] == 1 and picture.name else f"{own}-{taken[own]}"
    return names


@lru_cache(maxsize=8)
def asset(name: str) -> str:
    """Return the text of a file of the page."""
    return (Path(__file__).with_name("assets") / name).read_text(encoding="utf-8")


@lru_cache(maxsize=1)
def plotly_script() -> str:
    """Return the plotting library as plotly packs it."""
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs())


@lru_cache(maxsize=1)
def _packed_plotly() -> str:
    return _packed(plotly_script())


def _packed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode(), compresslevel=9, mtime=0)).decode("ascii")


def _policy(programs: Iterable[str]) -> str:
    digests = (base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii") for text in programs)
    scripts = " ".join(f"'sha256-{digest}'" for digest in digests)
    return (
        f"default-src 'none'; script-src {scripts}; style-src 'unsafe-inline'; img-src data: blob:; "
        "form-action 'none'; base-uri 'none'"
    )


def _pictures(blocks: Iterable[Block]) -> Iterator[Picture]:
    for block in blocks:
        if isinstance(block, Picture):
            yield block
        elif isinstance(block, Fold | Gallery):
            yield from _pictures(block.blocks)


def _content(figure: Figure) -> str:
    content = figure.to_dict()
    content["layout"].pop("template", None)
    return _json(content)


def _style() -> str:
    from fricmodels.report.figures import style

    template = deepcopy(style.template())
    # Each axis makes room on its own side only: a label at the end of a narrow figure would move both in turn.
    template.layout.xaxis.automargin = "height"
    template.layout.yaxis.automargin = "width"
    schemes = {"light": style.recolouring(style.LIGHT), "dark": style.recolouring(style.DARK)}
    return _json({"template": template, **schemes})


def _json(content: Any) -> str:
    from plotly.utils import PlotlyJSONEncoder

    return json.dumps(content, cls=PlotlyJSONEncoder, separators=(",", ":"))
