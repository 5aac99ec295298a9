"""``fricmodels demo``: what this program does, on simulated data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def command(
    out: Annotated[Path, typer.Option(help="Directory for the results.")] = Path("demo-run"),
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")] = None,
) -> None:
    """See all of it on simulated data.

    Simulates the motor of Elhami and Brookfield (1997) with 2 % noise, fits every law with every estimator and ranks
    them by the torque error on cycles that were not fitted.
    """
    from fricmodels import plugins
    from fricmodels.cli.leaderboard import show
    from fricmodels.cli.printing import progress_of_fits, warn
    from fricmodels.tournament import run
    from fricmodels.tournament.demonstration import demonstration

    warn(plugins.load().failures)
    config = demonstration()
    print("A motor with Coulomb and viscous friction that differ between its directions, 2 % noise on the velocity.")
    print("Every law × every estimator, ranked by the torque error on the cycles that were not fitted:")
    with progress_of_fits() as report:
        board = run(config, out, processes=jobs, report=report)
    show(board, config.ranking)
    print(f"written to {out / 'leaderboard.json'}; more: fricmodels leaderboard {out} --format html --out board.html")
