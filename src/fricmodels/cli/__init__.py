"""The command line. Each command is a module of this package with a function ``command``, imported when it is used."""

from __future__ import annotations

import importlib
import io
import os
import sys
import traceback
import warnings
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from fricmodels import __version__

COMMANDS = {
    "run": "Run a tournament and rank models and estimators.",
    "leaderboard": "Show or export the leaderboard of a run.",
    "list": "List laws, effects, estimators, readers or the data sets of a run.",
    "plugins": "List installed distributions, what they give, and their state.",
    "info": "Say what a recording is, and what is the matter with it.",
    "compare": "Compare a model with a recording: where does it fail?",
    "diagnose": "Name the effect that a model is missing.",
    "improve": "Add what is missing, refit, repeat: watch the error fall.",
    "fit": "Fit a model and keep it in a file, to call, simulate and export.",
    "sums": "Sum up what long or many recordings say of a linear law, to be added and fitted.",
    "export": "Write a fitted model for a program: C, MuJoCo, URDF, Isaac Lab, Drake, ROS 2.",
    "report": "Write it all as one HTML page: verdict, figures, parameters, provenance.",
    "simulate": "Make a recording with hidden effects from a rig file.",
    "compensate": "Say what a friction model is worth to a controller: tracking error with and without.",
    "new": "Write a plugin: a law, an effect, an estimator or a reader, ready to install.",
    "check": "Let a law, an effect, an estimator or a reader sit its exam.",
    "demo": "See all of it on simulated data.",
    "schema": "Print the JSON Schema of a configuration, for editors.",
}
"""Command → what it does, in one line. A new command is a module ``cli/NAME.py`` and a line here."""


class _Lazy(TyperGroup):
    """Imports the module of a command only when the command is used."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the commands in the order in which they are declared."""
        return [*COMMANDS]  # the module of the command `list` hides the builtin here

    def get_command(self, ctx: Any, name: str) -> Any:
        """Return the command of that name."""
        if name not in COMMANDS:
            return None
        module = importlib.import_module(f"fricmodels.cli.{name}")
        app = typer.Typer(add_completion=False, rich_markup_mode=None)
        app.command(name, help=_help(name, module.command))(module.command)
        return typer.main.get_command(app)


def _help(name: str, function: Any) -> str:
    """Put the one line that lists show before what else the command says of itself."""
    rest = (function.__doc__ or "").strip().partition("\n\n")[2]
    return f"{COMMANDS[name]}\n\n{rest}".strip()


app = typer.Typer(cls=_Lazy, add_completion=False, rich_markup_mode=None)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"fricmodels {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    """Find out what friction really does in a drive."""


ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""What is solved here is small: on a busy machine threads of linear algebra that wait for each other cost ten times."""


INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> None:
    """Run the command line. Exit codes: 0 done, 1 the work failed, 2 bad input, 130 interrupted."""
    given = sys.argv[1:] if arguments is None else arguments
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")  # read once, when numpy is imported
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a pipe that cannot encode ω gets a question mark, not a crash
    from fricmodels.cli.boundary import forgiving

    sys.stdout = forgiving(sys.stdout)
    sys.exit(_run(given))


def _run(arguments: list[str]) -> int:
    from fricmodels.cli.boundary import explain, keep_warnings_from_users, say

    debug = "--debug" in arguments
    shown = warnings.showwarning
    keep_warnings_from_users(debug)
    try:
        result = app(arguments or ["--help"], prog_name="fricmodels", standalone_mode=False)
        sys.stdout.flush()  # a full disk behind a pipe is told here, not when the interpreter ends
    except (Exception, KeyboardInterrupt, SystemExit) as error:
        if debug and not isinstance(error, KeyboardInterrupt):
            traceback.print_exc()
        return explain(error)
    finally:
        warnings.showwarning = shown
    if result == INTERRUPTED:  # Typer ends so on Ctrl-C
        say("interrupted")
    return result if isinstance(result, int) else 0
