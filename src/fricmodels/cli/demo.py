"""``fricmodels demo``: what this program does, on simulated data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

_INDENT = 3
"""Columns before a line that goes on."""


def command(
    out: Annotated[Path, typer.Option(help="Directory for the results.")] = Path("demo-run"),
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")] = None,
) -> None:
    """See all of it on simulated data.

    First a tournament: the motor of Elhami and Brookfield (1997) with 2 % noise, every law with every estimator, ranked
    by the torque error on cycles that were not fitted. Then a drive with hidden effects: where its model fails, which
    effects are missing, the ladder on which the error falls, and the leaderboard with and without them.
    """
    from fricmodels import plugins
    from fricmodels.cli.printing import warn

    warn(plugins.load().failures)
    _tournament(out, jobs)
    _hidden_effects(out / "hidden", jobs)


def _tournament(out: Path, jobs: int | None) -> None:
    from fricmodels.cli.leaderboard import show
    from fricmodels.cli.printing import print_line, progress_of_fits
    from fricmodels.tournament import run
    from fricmodels.tournament.demonstration import demonstration

    config = demonstration()
    text = "1. A motor with Coulomb and viscous friction that differ between its directions, 2 % noise on the velocity."
    print_line(text, _INDENT)
    text = "   Every law × every estimator, ranked by the torque error on the cycles that were not fitted:"
    print_line(text, _INDENT)
    with progress_of_fits() as report:
        board = run(config, out, processes=jobs, report=report)
    show(board, config.ranking)
    print(f"written to {out / 'leaderboard.json'}; more: fricmodels leaderboard {out} --format html --out board.html")


def _hidden_effects(out: Path, jobs: int | None) -> None:
    from fricmodels.cli.leaderboard import show
    from fricmodels.cli.printing import console, print_line, progress_of_fits, working
    from fricmodels.diagnosis import improve
    from fricmodels.diagnosis.document import document, write
    from fricmodels.model import Model
    from fricmodels.readers import read
    from fricmodels.report.console import show_answer_of_ladder
    from fricmodels.rig import write as write_recording
    from fricmodels.rig.demonstration import hidden
    from fricmodels.tournament import run
    from fricmodels.tournament.demonstration import with_and_without

    print()
    print_line(
        "2. A robot joint, modelled by Coulomb and viscous friction. Its truth is hidden from the program.", _INDENT
    )
    rig = hidden()
    data, truth = write_recording(rig.simulate(), out / "joint.csv")
    recording = read(data, name=rig.name)
    with working("looking for what is missing") as say:
        ladder = improve(recording, Model.parse("coulomb-viscous"), rig.inertia, progress=say)
    show_answer_of_ladder(console(), ladder)
    print_line(f"   The truth was {rig.true_model} ({truth.name}).", _INDENT)
    models = [rung.model for rung in ladder.rungs]
    print_line("3. The leaderboard with and without what was found, on data that took no part in fitting:", _INDENT)
    config = with_and_without(data, models, rig.inertia)
    with progress_of_fits() as report:
        board = run(config, out, processes=jobs, report=report)
    show(board, config.ranking)
    path = write(document(ladder.first, ladder), out)
    print(f"written to {path}; the same on your data: fricmodels improve DATA --model coulomb-viscous --inertia J")
    page = _report(out)
    if page is not None:
        print(f"4. All of it on one page, for any browser: {page}")


def _report(out: Path) -> Path | None:
    """Write the report, where the packages for it are installed."""
    from importlib.util import find_spec

    if find_spec("plotly") is None or find_spec("jinja2") is None:
        return None
    from fricmodels.report import of_run, write

    return write(of_run(out), out / "report.html")
