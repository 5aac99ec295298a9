"""``fricmodels run``: a tournament from its YAML file."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from fricmodels.cli.measurement import Trust
from fricmodels.errors import FricmodelsError


def command(
    config: Annotated[Path, typer.Argument(help="The tournament, in YAML.", show_default=False)],
    out: Annotated[Path | None, typer.Option(help="Directory for the results; runs/NAME by default.")] = None,
    executor: Annotated[str, typer.Option(help="local, dask or serial")] = "local",
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Running Dask cluster, as tcp://HOST:8786, for dask."),
    ] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")] = None,
    report_file: Annotated[
        Path | None,
        typer.Option("--report", metavar="FILE.html", help="Write the report there: one page, with figures."),
    ] = None,
    trust: Trust = False,
    retry: Annotated[bool, typer.Option("--retry", help="Do again what did not end well.")] = False,
) -> None:
    """Run a tournament and rank models and estimators.

    Results are kept as they come: after an interruption, or when the configuration grows, the same command does only
    what is missing.
    """
    from fricmodels import plugins
    from fricmodels.cli.leaderboard import show
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.cli.printing import progress_of_fits, warn
    from fricmodels.tournament import plan, run
    from fricmodels.tournament.config import read_config

    warn(plugins.load().failures)
    loaded, document = read_config(config)
    planned = plan(loaded, config.parent, trust=trust, document=document)
    warn([*planned.left_out, *planned.doubts])
    target = out if out is not None else Path("runs") / loaded.name
    written = [target / name for name in ("leaderboard.json", "run.json", "histories.json")]
    check_outputs([*written, report_file], [config, *map(Path, planned.jobs.sources.files)])
    if report_file is not None:
        from fricmodels.report import check

        check(report_file)
    with progress_of_fits() as report:
        board = run(
            loaded,
            target,
            executor=executor,
            processes=jobs,
            retry=retry,
            report=report,
            planned=planned,
            config_file=config,
            scheduler=scheduler,
        )
    show(board, loaded.ranking)
    print(f"written to {target / 'leaderboard.json'}")
    if report_file is not None and board.rows:
        from fricmodels.report import of_run, write

        print(f"wrote {write(of_run(target / 'leaderboard.json'), report_file)}")
    if not board.rows:
        raise FricmodelsError(f"{config}: no fit was done, for no dataset is there; correct the paths under 'files'")
    if len(board.failures) == len(board.rows):
        reasons = f"fricmodels leaderboard {shlex.quote(str(target))} --format csv"
        raise FricmodelsError(f"{config}: none of {len(board.rows)} fits gave a result; '{reasons}' has every reason")
