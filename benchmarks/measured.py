"""Tells the stories of the real measurements: writes docs/measured/*.md and its pictures.

    python benchmarks/measured.py [--only emps] [--prepare]

Needs the folder of real measurements beside the project. Every number and picture of the pages comes from this run; the
words between them stand in benchmarks/measured/*.md.
"""

from __future__ import annotations

import argparse
import datetime
import importlib
import re
import time
from collections.abc import Mapping
from pathlib import Path

from fricmodels.files import write_text

ROOT = Path(__file__).parent.parent
DATA = ROOT.parent / "shared" / "data"
PREPARED = ROOT / "build" / "measured"
STORIES = ("emps", "tx40", "xl330", "kuka", "other_joints")


def fill(template: str, parts: Mapping[str, str]) -> str:
    """Replace every {{name}}; a name without a part is an error. What an empty part leaves empty is taken out."""
    text = re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)], template)
    text = re.sub(r" +$", "", text, flags=re.MULTILINE)
    return re.sub(r"\n{3,}", "\n\n", text).rstrip() + "\n"


def prepare(name: str) -> None:
    """Write the files with standard columns that a story needs beyond the source's own, into build/measured."""
    story = importlib.import_module(f"measured.{name}")
    PREPARED.mkdir(parents=True, exist_ok=True)
    if hasattr(story, "prepare"):
        for path in story.prepare(DATA, PREPARED):
            print(f"{name}: prepared {path.relative_to(ROOT)}", flush=True)


def write(name: str) -> None:
    """Run one story and write its page."""
    start = time.perf_counter()
    story = importlib.import_module(f"measured.{name}")

    def say(line: str) -> None:
        print(f"{name}: {line} ({time.perf_counter() - start:.0f} s)", flush=True)

    prepare(name)
    parts = story.page(DATA, ROOT / "configs" / "measured", ROOT / "docs" / "pictures", PREPARED, say)
    command = f"`python benchmarks/measured.py --only {name}`"
    today = f"{datetime.date.today():%Y-%m-%d}"
    stamp = f"*Made by {command} on {today}; every number is from that run unless it is called published.*"
    template = (Path(__file__).parent / "measured" / f"{name}.md").read_text(encoding="utf-8")
    page = ROOT / "docs" / "measured" / f"{name}.md"
    write_text(page, fill(template, {**parts, "made": stamp}))
    say(f"wrote {page.relative_to(ROOT)}")


def main() -> None:
    """Run the stories that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=STORIES, action="append", help="one data set; repeatable")
    parser.add_argument("--prepare", action="store_true", help="only write the prepared files")
    arguments = parser.parse_args()
    chosen = arguments.only or STORIES
    if not DATA.is_dir():
        raise SystemExit(f"the folder of real measurements is not there: {DATA}")
    for name in chosen:
        prepare(name) if arguments.prepare else write(name)


if __name__ == "__main__":
    main()
