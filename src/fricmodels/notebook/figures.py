"""Figures within HTML, drawn by Plotly's JavaScript.

It comes from Plotly's content delivery network, once a page. Where there is no network, run
``plotly.offline.init_notebook_mode()`` first, which puts it into the notebook; the tables say the same in any case.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Sequence
from html import escape
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import plotly.graph_objects as go

_count = itertools.count()


def drawn(wanted: Sequence[tuple[str, object]]) -> list[go.Figure]:
    """Return figures by name, each with what it draws; none where Plotly is not installed."""
    if find_spec("plotly") is None:
        return []
    from fricmodels.report import figures

    return [getattr(figures, name)(result) for name, result in wanted]


_SCRIPT = """<div id="{place}" class="fricmodels-figure" role="img" aria-label="{label}"
 style="min-height: {height}px; background: #fff">
</div>
<script>
(function () {{
  const figure = {figure};
  const place = document.getElementById("{place}");
  const draw = () => window.Plotly.newPlot(place, figure.data, figure.layout, {{responsive: true, displaylogo: false}});
  if (window.Plotly) {{ draw(); return; }}
  let script = document.getElementById("fricmodels-plotly");
  if (!script) {{
    script = document.createElement("script");
    script.id = "fricmodels-plotly";
    script.src = "{source}";
    document.head.append(script);
  }}
  script.addEventListener("load", draw);
  script.addEventListener("error", () => {{
    place.style.minHeight = "0";
    place.textContent = "The figure needs Plotly's JavaScript, which could not be loaded; the tables hold its numbers.";
  }});
}})();
</script>"""


def figure_html(figure: go.Figure) -> str:
    """Return a figure that draws itself once Plotly's JavaScript is there; nothing in it can end the script."""
    from plotly.offline import get_plotlyjs_version

    content = str(figure.to_json())
    for sign in "<>&\u2028\u2029":
        content = content.replace(sign, f"\\u{ord(sign):04x}")
    place = f"fricmodels-{hashlib.sha256(content.encode()).hexdigest()[:12]}-{next(_count)}"
    title = str(figure.layout.title.text or "figure").partition("<br>")[0]
    return _SCRIPT.format(
        place=place,
        label=escape(title),
        height=int(figure.layout.height or 420),
        figure=content,
        source=f"https://cdn.plot.ly/plotly-{get_plotlyjs_version()}.min.js",
    )
