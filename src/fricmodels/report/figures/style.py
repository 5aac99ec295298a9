"""How every figure looks: one template, colours for a light and a dark page, text that is safe to show.

Colours are those of Okabe and Ito (2008), which people with any common colour blindness tell apart, lightened where the
page is dark. What differs in colour differs in dash or marker too, so that a print in grey can be read.
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias

from fricmodels.dimension import Dimension, Motion
from fricmodels.errors import InputError
from fricmodels.recording import CHANNELS

if TYPE_CHECKING:
    import plotly.graph_objects as go

    Figure: TypeAlias = go.Figure
else:
    Figure: TypeAlias = Any

LIGHT: Mapping[str, str] = {
    "text": "#1c1c1c",
    "muted": "#555a60",
    "axis": "#8b9198",
    "grid": "#e4e6e9",
    "surface": "#ffffff",
    "shade": "rgba(120,126,134,0.14)",
    "measured": "#2b2b2b",
    "faint": "rgba(90,96,104,0.45)",
    "blue": "#0072b2",
    "blue_band": "rgba(0,114,178,0.20)",
    "sky": "#56b4e9",
    "orange": "#e69f00",
    "green": "#009e73",
    "vermillion": "#d55e00",
    "vermillion_band": "rgba(213,94,0,0.24)",
    "purple": "#cc79a7",
    "few": "#dfe7ec",
    "some": "#8fb3c9",
    "many": "#1f4e6b",
    "below_far": "#004c7a",
    "below": "#5fa8d6",
    "none": "#f4f4f2",
    "above": "#f0a05f",
    "above_far": "#a34400",
}
"""Colour of each part on a light page."""

DARK: Mapping[str, str] = {
    "text": "#f1f2f3",
    "muted": "#b4bac1",
    "axis": "#7f8790",
    "grid": "#343b43",
    "surface": "#15191e",
    "shade": "rgba(170,178,188,0.16)",
    "measured": "#d9dcdf",
    "faint": "rgba(190,196,204,0.45)",
    "blue": "#4da6e0",
    "blue_band": "rgba(77,166,224,0.28)",
    "sky": "#8ed3fa",
    "orange": "#f2b630",
    "green": "#2cc297",
    "vermillion": "#f58442",
    "vermillion_band": "rgba(245,132,66,0.30)",
    "purple": "#e39cc4",
    "few": "#26313a",
    "some": "#46708c",
    "many": "#b9ddf3",
    "below_far": "#86c9f5",
    "below": "#2b7bad",
    "none": "#20252b",
    "above": "#b8621f",
    "above_far": "#ffb57d",
}
"""Colour of each part on a dark page."""

SERIES = (
    ("blue", "solid", "circle"),
    ("vermillion", "dash", "square"),
    ("green", "dot", "diamond"),
    ("purple", "dashdot", "triangle-up"),
    ("orange", "longdash", "x"),
    ("sky", "longdashdot", "cross"),
    ("measured", "solid", "star"),
)
"""Colour, dash and marker of things shown side by side, in this order."""

FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif'
POINTS = 2000
"""Most points of a trace."""
_LONGEST_SUBTITLE = 52
SUPERSCRIPT: Mapping[int, int] = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SUPERSCRIPT = {"^2": "²", "^3": "³"}
EXPONENT = r"\^(?:\((-?[\d./]+)\)|(-?\d+(?:\.\d+)?))"
"""An exponent in a unit: a whole number, or a fraction in brackets; what follows it is not of it."""


def graph_objects() -> Any:
    """Return ``plotly.graph_objects``.

    Raises:
        InputError: when Plotly is not installed.
    """
    try:
        import plotly.graph_objects as go
    except ImportError:
        raise InputError(
            "figures need plotly, which is not installed; install it with: pip install 'fricmodels[report]'"
        ) from None
    return go


def subplots() -> Any:
    """Return Plotly's function that makes figures of several panels; see :func:`graph_objects`."""
    graph_objects()
    from plotly.subplots import make_subplots

    return make_subplots


def series(index: int) -> tuple[str, str, str]:
    """Return colour, dash and marker of the index-th of several things."""
    colour, dash, marker = SERIES[index % len(SERIES)]
    return LIGHT[colour], dash, marker


def stroke(x: Any, y: Any, name: str, colour: str, width: float, dash: str | None = None, **more: Any) -> Any:
    """Return a line to add to a figure.

    Args:
        x, y: shape (n,). name: in the legend. colour: name of one in :data:`LIGHT`. width, dash: of the line.
        more: as of Plotly's ``Scatter``.
    """
    line = {"color": LIGHT[colour], "width": width} | ({} if dash is None else {"dash": dash})
    return graph_objects().Scatter(x=x, y=y, name=name, mode="lines", line=line, **more)


def add_lines(figure: Figure, x: Any, lines: Iterable[tuple[int, str, Any, str, str, float]], unit: str) -> None:
    """Add lines to a figure of several rows.

    Args:
        figure: of :func:`subplots`.
        x: shape (n,).
        lines: row, name, values of shape (n,), name of the colour, dash and width of each.
        unit: of the values.
    """
    for row, name, values, colour, dash, width in lines:
        shown = f"{name} %{{y:.4g}} {unit}<extra></extra>"
        figure.add_trace(stroke(x, values, name, colour, width, dash, hovertemplate=shown), row=row, col=1)


def escaped(text: object) -> str:
    """Return a text that Plotly shows as it stands: no markup, no formula, no template in it, on one line."""
    plain = html.escape(" ".join(str(text).split()), quote=False)
    return plain.replace("$", "&#36;").replace("%{", "%&#123;")


def shortened(text: object) -> str:
    """Return the beginning of a long text, escaped."""
    plain = " ".join(str(text).split())
    return escaped(plain if len(plain) <= _LONGEST_SUBTITLE else plain[: _LONGEST_SUBTITLE - 1] + "…")


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: ``rad/s²`` for ``rad/s^2``."""
    for power, superscript in _SUPERSCRIPT.items():
        unit = unit.replace(power, superscript)
    return re.sub(EXPONENT, lambda found: f"<sup>{found[1] or found[2]}</sup>", unit)


def unit_of(quantity: str | Dimension, motion: Motion) -> str:
    """Return the printed unit of a channel or a dimension on a rotary drive or a linear axis."""
    if quantity == "temperature":
        return "°C"
    dimension = CHANNELS[quantity] if isinstance(quantity, str) else quantity
    return unit_text(dimension.unit(motion))


def words(channel: str, motion: Motion) -> str:
    """Return the name of a channel in words; a torque is a force on a linear axis."""
    text = channel.replace("_", " ")
    return text if motion is Motion.ROTARY else text.replace("torque", "force")


def label(text: str, unit: str) -> str:
    """Return the title of an axis: words and unit."""
    return f"{text} [{unit}]"


def logarithmic(values: Iterable[float]) -> dict[str, Any]:
    """Return a logarithmic axis around positive values, labelled at 1, 2 and 5 times powers of ten.

    Over less than a decade there are more labels, over several fewer, so that the axis is seen not to be even.
    """
    positive = [value for value in values if value > 0] or [1.0]
    low, high = math.log10(min(positive)), math.log10(max(positive))
    margin = 0.06 * (high - low) or 0.3
    low, high = low - margin, high + margin
    digits = (1, 1.5, 2, 3, 4, 5, 6, 8) if high - low < 1 else (1, 2, 5) if high - low < 3.5 else (1,)
    powers = range(math.floor(low), math.ceil(high) + 1)
    ticks = [digit * 10.0**power for power in powers for digit in digits]
    shown = [tick for tick in ticks if low <= math.log10(tick) <= high]
    return {"type": "log", "range": [low, high], "tickvals": shown, "ticktext": [f"{tick:g}" for tick in shown]}


@lru_cache(maxsize=1)
def template() -> Any:
    """Return the template of all figures: transparent, legend below, colours of :data:`LIGHT`; it is not to change."""
    go = graph_objects()
    axis = {
        "automargin": True,
        "color": LIGHT["text"],
        "exponentformat": "power",
        "gridcolor": LIGHT["grid"],
        "linecolor": LIGHT["axis"],
        "showline": True,
        "tickcolor": LIGHT["axis"],
        "tickfont": {"size": 12, "color": LIGHT["text"]},
        "ticklen": 4,
        "ticks": "outside",
        "title": {"standoff": 8, "font": {"size": 13}},
        "zerolinecolor": LIGHT["axis"],
        "zerolinewidth": 1,
    }
    layout = {
        "colorway": [LIGHT[colour] for colour, _, _ in SERIES],
        "font": {"family": FONT, "size": 13, "color": LIGHT["text"]},
        "hoverlabel": {
            "bgcolor": LIGHT["surface"],
            "bordercolor": LIGHT["axis"],
            "font": {"family": FONT, "size": 12, "color": LIGHT["text"]},
        },
        "legend": {
            "bgcolor": "rgba(0,0,0,0)",
            "font": {"size": 12, "color": LIGHT["text"]},
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "xref": "container",
            "y": 0,
            "yanchor": "bottom",
            "yref": "container",
        },
        "margin": {"l": 12, "r": 14, "t": 58, "b": 12, "pad": 0},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": LIGHT["muted"], "activecolor": LIGHT["text"]},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "title": {
            "font": {"size": 15, "color": LIGHT["text"]},
            "x": 0,
            "xanchor": "left",
            "xref": "container",
            "pad": {"l": 12, "t": 16},
            "y": 1,
            "yanchor": "top",
            "yref": "container",
        },
        "xaxis": axis,
        "yaxis": axis,
    }
    return go.layout.Template(layout=layout)


def styled(figure: Figure, title: str, subtitle: str = "", height: int = 420) -> Figure:
    """Give a figure its template, its title in plain words, and its height; the width is that of the page.

    Args:
        figure: to be changed.
        title: in words.
        subtitle: of the user's; it is escaped, and cut where it is long.
        height: in pixels.
    """
    text = f"<b>{title}</b>"
    if subtitle:
        text += f"<br><span style='font-size:12px'>{shortened(subtitle)}</span>"
    figure.update_layout(template=template(), title_text=text, height=height, autosize=True)
    return figure


def recolouring(theme: Mapping[str, str]) -> dict[str, str]:
    """Return which colour is to be replaced by which, whatever theme a figure has now."""
    return {old[part]: new for part, new in theme.items() for old in (LIGHT, DARK)}
