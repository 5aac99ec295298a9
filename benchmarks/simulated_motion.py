"""Prints the tables of simulated motion: ``python benchmarks/simulated_motion.py emps|xl330 [--no-peers]``.

Needs the folder of real measurements beside the project. The numbers of docs/tables.md come from it.
"""

from __future__ import annotations

import argparse
import importlib
import time
from pathlib import Path

DATA = Path(__file__).parent.parent.parent / "shared" / "data"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("which", choices=("emps", "xl330"))
    parser.add_argument("--no-peers", action="store_true", help="leave CMA-ES or differential evolution out")
    given = parser.parse_args()
    begin = time.process_time()

    def say(line: str) -> None:
        print(f"  {line} ({time.process_time() - begin:.0f} s)", flush=True)

    module = importlib.import_module(f"motion_tables.{given.which}")
    for title, rows in module.tables(DATA, say, peers=not given.no_peers).items():
        print(f"\n{title}\n")
        for number, row in enumerate(rows):
            print(f"| {' | '.join(row)} |")
            if number == 0:
                print("|---" * len(row) + "|")


if __name__ == "__main__":
    main()
