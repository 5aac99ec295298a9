"""Prints the error of M1 to M6 on recordings of the bench beside what the authors published.

``python -m fricmodels_bam.reproduce ../shared/data/bam_xl330/xl330_pendulum_16logs.csv``
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from fricmodels_bam import LAWS
from fricmodels_bam.bench import Bench, Log, read_logs
from fricmodels_bam.identify import identify
from fricmodels_bam.published import XL330

KEPT_BACK = {("sin_sin", 100), ("lift_and_drop", 200), ("up_and_down", 400), ("sin_time_square", 800)}
"""Logs that take no part in the last column: one of every trajectory, one of every gain."""


def errors(logs: Sequence[Log]) -> dict[str, dict[str, float]]:
    """Return mean absolute errors of the simulated position [rad], by column and law.

    The columns: as published, on the authors' recordings; with the published parameters on these logs; identified on
    these logs; identified on twelve of them and simulated on the other four.
    """
    kept_back = [(log.trajectory, log.gain) in KEPT_BACK for log in logs]
    fitted = [log for log, kept in zip(logs, kept_back, strict=True) if not kept]
    others = [log for log, kept in zip(logs, kept_back, strict=True) if kept]
    whole, part = identify(logs), identify(fitted)
    table: dict[str, dict[str, float]] = {name: {} for name in ("published", "transferred", "identified", "kept back")}
    for law in LAWS:
        bench, published = Bench(law), XL330[law.name]
        table["published"][law.name] = published.error
        table["transferred"][law.name] = bench.error(logs, published.values)
        table["identified"][law.name] = bench.error(logs, whole[law.name])
        table["kept back"][law.name] = bench.error(others, part[law.name])
    return table


def main(path: Path) -> None:
    """Print the table as Markdown: milliradians, and the change from M1."""
    table = errors(read_logs(path))
    print(f"| law | {' | '.join(table)} |")
    print("|---" * (1 + len(table)) + "|")
    for law in LAWS:
        cells = []
        for column in table.values():
            value, first = column[law.name], column[LAWS[0].name]
            cells.append(f"{1e3 * value:.1f} ({100 * (value / first - 1):+.1f} %)")
        print(f"| {law.name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
