"""Puts Plotly's JavaScript beside the notebook pages when the site is built, so that they need no other server."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from plotly.offline import get_plotlyjs

_ELSEWHERE = re.compile(r"https://cdn\.plot\.ly/plotly-[\d.]+\.min\.js")
_SCRIPT = "plotly.min.js"


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Let the figures of a notebook page load the script from the site."""
    up = "../" * page.url.count("/")
    return _ELSEWHERE.sub(f"{up}assets/{_SCRIPT}", output) if page.file.src_uri.endswith(".ipynb") else output


def on_post_build(config: Any) -> None:
    """Write the script into the site."""
    target = Path(config["site_dir"]) / "assets" / _SCRIPT
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(get_plotlyjs(), encoding="utf-8")
