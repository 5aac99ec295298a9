"""``fricmodels sums``: what long or many recordings say of a linear law, file by file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricmodels.cli.measurement import (
    Column,
    Format,
    GapsOption,
    Inertia,
    Linear,
    ModelName,
    TorqueConstant,
    Trust,
)

if TYPE_CHECKING:
    from fricmodels.gaps import Gaps
    from fricmodels.sums import Plan, Sums

Like = Annotated[
    Path | None,
    typer.Option("--like", metavar="FILE.sums.json", help="Take the rows that these sums are of, not new ones."),
]


Recordings = Annotated[
    list[Path],
    typer.Argument(metavar="DATA…", help="Recordings, each summed by itself, or files of sums to add."),
]


def command(
    data: Recordings,
    model: ModelName,
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            metavar="DIR|FILE.sums.json",
            help="A file of sums for each recording, or one of all.",
            show_default=False,
        ),
    ],
    like: Like = None,
    inertia: Inertia = None,
    column: Column = None,
    torque_constant: TorqueConstant = None,
    reader: Format = None,
    linear: Linear = False,
    trust: Trust = False,
    gaps: GapsOption = None,
) -> None:
    """Sum up what recordings say of a law that is linear in its parameters.

    Sums are small, are made where the data lies, in little memory however long a recording is, and are added: `fit`
    takes files of them in the place of recordings and gives the parameters that all rows together have. What the rows
    are is laid down by the first recording, or by --like. Give files of sums to add them to one.
    """
    from fricmodels.cli.outputs import check_outputs
    from fricmodels.cli.printing import working
    from fricmodels.errors import InputError
    from fricmodels.progress import watched
    from fricmodels.sums import added, load
    from fricmodels.sums.summed import SUFFIX

    one = out.name.endswith(SUFFIX)
    if not one and is_sums(data):
        raise InputError(f"{data[0]}: is sums already; name one file for what is added, as --out all{SUFFIX}")
    targets = {path: out if one else out / f"{path.stem}{SUFFIX}" for path in data}
    check_outputs(targets.values(), [*data, like])
    if is_sums(data):
        total = added(load(path) for path in data)
        check_model(total, model)
        print(f"{said_of(total)}; wrote {total.save(out)}")
        return
    how = {"columns": column or (), "reader": reader, "torque_constant": torque_constant}
    if not one and len(set(targets.values())) < len(data):
        names = [path.stem for path in data]
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"two recordings called {twice} would have one file of sums; give each its own folder")
    plan = load(like).plan if like is not None else plan_of(data[0], model, inertia, linear, trust, gaps, how)
    found = []
    with working(f"summing {len(data)} file{'s' * (len(data) != 1)}") as say, watched(say):
        for path, sums in summed(data, plan, gaps, how):
            check_model(sums, model)
            if one:
                found.append(sums)
                continue
            sums.save(targets[path])
            print(f"{path}: {sums.samples} samples, {sums.rows} rows; wrote {targets[path]}")
    if one:
        total = added(found)
        print(f"{said_of(total)}; wrote {total.save(out)}")


def said_of(total: Sums) -> str:
    """Say how many samples of how many files are summed up."""
    count = len(total.files)
    return f"{total.samples} samples in {count} file{'s' * (count != 1)}"


def is_sums(data: Sequence[Path]) -> bool:
    """Return whether files are of sums; all of them, or none.

    Raises:
        InputError: where some are.
    """
    from fricmodels.errors import InputError
    from fricmodels.sums.summed import SUFFIX

    some = [path.name.endswith(SUFFIX) for path in data]
    if any(some) and not all(some):
        raise InputError(
            f"{data[some.index(True)]} is sums, {data[some.index(False)]} a recording; make sums of it with "
            f"'fricmodels sums' and --like"
        )
    return all(some)


def plan_of(
    path: Path,
    model: str,
    inertia: float | None,
    linear: bool,
    trust: bool,
    gaps: Gaps | None,
    how: Mapping[str, Any],
) -> Plan:
    """Return what the rows are by a recording, once its log was checked.

    Raises:
        InputError: for a recording or a model of which no sums can be made.
    """
    from fricmodels.cli.answers import answered, check_computable
    from fricmodels.cli.printing import warn, working
    from fricmodels.dimension import Motion
    from fricmodels.logcheck import checked
    from fricmodels.sums import pilot, plan_for
    from fricmodels.sums.plan import linear_model

    known = linear_model(model)
    recording = pilot(path, gaps=gaps, **({"motion": Motion.LINEAR} if linear else {}), **how)
    check_computable(recording, inertia)
    recording = checked(recording, inertia, trust=trust, warn=warn)
    with answered(recording, known), working(f"looking at {path.name}"):
        return plan_for(recording, model, inertia)


def summed(data: Sequence[Path], plan: Plan, gaps: Gaps | None, how: Mapping[str, Any]) -> Iterator[tuple[Path, Sums]]:
    """Yield each file with its sums."""
    from fricmodels.sums import of_file

    for path in data:
        yield path, of_file(path, plan, gaps=gaps, **how)


def check_model(sums: Sums, model: str) -> None:
    """Make sure that sums are of a model.

    Raises:
        InputError: where they are of another.
    """
    from fricmodels.errors import InputError
    from fricmodels.model import Model

    if Model.parse(model).name != Model.parse(sums.plan.model).name:
        raise InputError(f"these sums are of '{sums.plan.model}', not of '{model}'; make others from the recordings")
