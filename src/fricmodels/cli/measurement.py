"""What compare, diagnose and improve have in common: a recording, a model, an inertia."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricmodels.cli.motion import ControllerFile, Horizon, Score, ScoreOption, check_score, loop_of
from fricmodels.cli.outputs import check_outputs
from fricmodels.cli.quantities import inertia as inertia_of
from fricmodels.gaps import Gaps

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.dimension import Motion
    from fricmodels.loop import Loop
    from fricmodels.model import Model
    from fricmodels.recording import Recording
    from fricmodels.report.page import Page
    from fricmodels.saved import FittedModel

Data = Annotated[
    list[Path],
    typer.Argument(
        metavar="DATA…",
        help="Recording: .csv, .txt, .parquet, .mat, .h5, .json, .bag and more; see 'list readers'. "
        "Several files are one, each a run of it.",
    ),
]
ModelName = Annotated[
    str,
    typer.Option(
        "--model", metavar="LAW+EFFECT+…", help="Model to compare with the recording, or a file of `fit` to start from."
    ),
]
Fixed = Annotated[bool, typer.Option("--fixed", help="Hold the numbers of a model's file: fit nothing.")]
Inertia = Annotated[
    float | None,
    typer.Option(
        "--inertia",
        parser=inertia_of,
        metavar="J",
        help="Inertia [kg m²], or mass [kg] of a linear axis: of rotor, gear and link; estimated if left out.",
    ),
]
Column = Annotated[
    list[str] | None,
    typer.Option(
        "--column",
        metavar="CHANNEL=COLUMN[:UNIT]",
        help="Map a column, to other.NAME where it is another joint's; repeatable.",
    ),
]
TorqueConstant = Annotated[
    float | None, typer.Option("--torque-constant", help="Torque per current [N m/A], for logs of current.")
]
Format = Annotated[str | None, typer.Option("--reader", help="Read the file as this format.")]
Linear = Annotated[bool, typer.Option("--linear", help="A linear axis: forces and metres.")]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write the results there: JSON, of compare overlay.csv.")
]
Trust = Annotated[
    bool, typer.Option("--trust", help="Go on with a recording whose units, signs or columns look wrong.")
]
Report = Annotated[
    Path | None, typer.Option("--report", metavar="FILE.html", help="Write the report there: one page, with figures.")
]
GapsOption = Annotated[
    Gaps | None,
    typer.Option(
        "--gaps",
        help="Rows without numbers: drop them; split, a new run after each gap; join channels in rows of their own.",
    ),
]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Print all that was found, not only the answer.")]
LeaveOut = Annotated[
    list[str] | None, typer.Option("--leave-out", metavar="EFFECT", help="Do not consider; repeatable.")
]


@dataclass(frozen=True)
class Loaded:
    """A recording, a model, and its inertia; and the model's file, where it came from one."""

    recording: Recording
    model: Model
    inertia: float | None
    file: FittedModel | None = None

    @property
    def of_controller(self) -> dict[str, float]:
        """What the file's fit found of the controller that it carries, by key."""
        from fricmodels.saved.controlled import found_of

        return {} if self.file is None else found_of(self.file)


@dataclass(frozen=True)
class Reading:
    """How a recording is read, as the options of a command say."""

    column: list[str] | None
    torque_constant: float | None
    reader: str | None
    linear: bool
    gaps: Gaps | None

    def read(self, data: Sequence[Path], motion: Motion | None = None) -> Recording:
        """Read files as one recording; ``motion`` is that of a model's file, if it is to be taken."""
        from fricmodels.dimension import Motion
        from fricmodels.readers import read_together

        return read_together(
            data,
            columns=self.column or (),
            motion=Motion.LINEAR if self.linear else motion,
            reader=self.reader,
            torque_constant=self.torque_constant,
            gaps=self.gaps,
        )


def linear_of(file: FittedModel | None) -> Motion | None:
    """Return the motion of a linear axis where a model's file is of one."""
    from fricmodels.dimension import Motion

    return Motion.LINEAR if file is not None and file.motion is Motion.LINEAR else None


def load(
    data: Sequence[Path],
    model: str,
    reading: Reading,
    *,
    leave_out: list[str] | None = None,
    inertia: float | None,
    trust: bool,
    fixed: bool = False,
) -> Loaded:
    """Read the recording and the model that the options name; warn of what is the matter with the recording.

    A model that is a file's knows its numbers, and gives its inertia where none is given and the file's was.

    Raises:
        InputError: for anything that cannot be read or is not known, and where units, signs or columns look so wrong
            that every answer would be nonsense.
    """
    from fricmodels import plugins
    from fricmodels.cli.answers import check_computable
    from fricmodels.cli.printing import warn, working
    from fricmodels.errors import InputError
    from fricmodels.logcheck import checked
    from fricmodels.model import Model
    from fricmodels.progress import watched
    from fricmodels.tournament.jobs import check_plugins

    file = of_file(model)
    if fixed and file is None:
        raise InputError(f"--fixed holds the numbers of a model's file, '{model}' is a name; give a file of `fit`")
    chosen = Model.parse(model) if file is None else known(file, fixed)
    if file is not None:
        own = file.parameters[file.drive.inertia_key]
        if fixed and inertia is not None and inertia != own:
            warn([f"--inertia {inertia:g} is taken in the place of the {own:g} of {model}; --fixed alone holds that"])
        inertia = file.drive.inertia if inertia is None else inertia
    registered = plugins.load()
    for term in chosen.terms:
        registry = registered.laws if term is chosen.law else registered.effects
        danger = registry.danger(term.name)
        if danger is not None:
            owner = registry.entry(term.name).distribution
            raise InputError(f"{registry.kind} '{term.name}' of {owner} cannot be used here: {danger}")
    check_plugins(chosen.name)
    for effect in leave_out or ():
        plugins.load().effects.entry(effect)
    with working(f"reading {data[0].name}") as say, watched(say):
        recording = reading.read(data, linear_of(file))
    say_gaps(recording)
    check_computable(recording, inertia)
    if file is not None and file.motion is not recording.motion:
        raise InputError(f"{model}: is of a {file.motion.value} drive, the recording of a {recording.motion.value} one")
    return Loaded(checked(recording, inertia, trust=trust, warn=warn), chosen, inertia, file)


def of_file(model: str) -> FittedModel | None:
    """Return the model of a file, or ``None`` where a model's name was given.

    Raises:
        InputError: where the file is none of a model.
    """
    if not model.endswith(".json"):
        return None
    from fricmodels.saved import load

    return load(model)


def known(file: FittedModel, fixed: bool = False) -> Model:
    """Return the model of a file that knows its numbers, and the runs that they are of."""
    from fricmodels.model import Known

    error = file.document.error
    promised = None if error is None or error.test_percent is None else (error.test_percent, error.window_ms)
    return file.model.knowing(
        Known(file.parameters, file.standard_errors, fixed, file.fitted_runs, promised, file.ranges)
    )


def say_gaps(recording: Recording) -> None:
    """Warn of how many rows were left out, where any were."""
    from fricmodels.cli.printing import warn

    if "gaps" in recording.provenance:
        warn([f"{recording.provenance['source']}: {recording.provenance['gaps']}"])


def effects_left_out(named: Sequence[str]) -> tuple[str, ...]:
    """Return the effects that are left out: the named ones, and those of plugins that would spoil a diagnosis.

    What is named needs no look; each of the others has a warning.
    """
    from fricmodels import plugins
    from fricmodels.cli.printing import warn
    from fricmodels.tournament.jobs import check_plugins

    effects, found = plugins.load().effects, list(named)
    warn([*plugins.load().failures, *plugins.load().unsafe])
    for name in effects:
        distribution = effects.entry(name).distribution
        if distribution == "fricmodels" or name in named:
            continue
        try:
            check_plugins(f"coulomb-viscous+{name}")
        except (Exception, SystemExit) as error:
            warn([f"effect '{name}' of {distribution} is left out: {error}"])
            found.append(name)
    return tuple(found)


@dataclass(frozen=True)
class Measurement:
    """What ``compare``, ``diagnose`` and ``improve`` are given on the command line, read.

    Its options are those that a report repeats, so that its command gives the same answer.
    """

    recording: Recording
    model: Model
    inertia: float | None
    leave_out: tuple[str, ...]
    out: Path | None
    report: Path | None
    options: list[str]
    verbose: bool
    score: Score
    horizon: int | None
    loop: Loop | None
    of_controller: dict[str, float]

    def write_report(self, shown: Console, page: Callable[[Any], Page]) -> None:
        """Write the report, where one is wanted: the page that is made with :mod:`fricmodels.report.story`."""
        if self.report is not None:
            from fricmodels.report import story, write

            shown.print(f"wrote {write(page(story), self.report)}", markup=False, soft_wrap=True)


def options_again(left_out: Sequence[str], trust: bool, gaps: Gaps | None) -> list[str]:
    """Return the options with which another command gives the same answer."""
    names = [part for name in left_out for part in ("--leave-out", name)]
    return [*names, *["--trust"] * trust, *([] if gaps is None else ["--gaps", gaps.value])]


OF_MOTION = ("score", "horizon", "controller")
"""The options by which a command judges by simulated motion."""


def measured(*without: str, writes: Sequence[str]) -> Callable[[Callable[[Measurement], None]], Callable[..., None]]:
    """Return what makes a command of some work on a measurement; it has all options ``without`` these.

    Args:
        without: names of options that it does not have.
        writes: names of the files that it may write into the folder of --out.
    """

    def made(work: Callable[[Measurement], None]) -> Callable[..., None]:
        def command(
            data: Data,
            model: ModelName,
            inertia: Inertia = None,
            column: Column = None,
            torque_constant: TorqueConstant = None,
            reader: Format = None,
            linear: Linear = False,
            leave_out: LeaveOut = None,
            trust: Trust = False,
            gaps: GapsOption = None,
            fixed: Fixed = False,
            out: Out = None,
            report: Report = None,
            verbose: Verbose = False,
            score: ScoreOption = Score.TORQUE,
            horizon: Horizon = None,
            controller: ControllerFile = None,
        ) -> None:
            from fricmodels.cli.answers import answered

            check_outputs([report, *(out / name for name in writes if out is not None)], [*data, model, controller])
            reading = Reading(column, torque_constant, reader, linear, gaps)
            given = load(data, model, reading, leave_out=leave_out, inertia=inertia, trust=trust, fixed=fixed)
            check(report)
            check_score(score, given.recording, horizon, controller)
            loop = loop_of(controller, given.recording, given.file if score is Score.POSITION else None)
            left_out = () if "leave_out" in without else effects_left_out(leave_out or ())
            measurement = Measurement(
                given.recording,
                given.model,
                given.inertia,
                left_out,
                out,
                report,
                options_again(left_out, trust, gaps),
                verbose,
                score,
                horizon,
                loop,
                given.of_controller if score is Score.POSITION else {},
            )
            with answered(given.recording, given.model):
                work(measurement)

        command.__doc__ = work.__doc__
        signature = inspect.signature(command, eval_str=True)
        kept = [p for name, p in signature.parameters.items() if name not in without]
        command.__signature__ = signature.replace(parameters=kept)  # type: ignore[attr-defined]
        return command

    return made


def check(report: Path | None) -> None:
    """Make sure, before the work begins, that a report can be written where it is wanted."""
    if report is not None:
        from fricmodels.report import check

        check(report)
