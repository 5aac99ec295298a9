"""``fricmodels check``: the exam of a law, an effect, an estimator, a reader or a controller."""

from __future__ import annotations

from typing import Annotated

import typer


def command(
    name: Annotated[str, typer.Argument(metavar="NAME|DISTRIBUTION", help="What is to be examined.")],
    thorough: Annotated[
        bool, typer.Option("--thorough", help="Recovery by every estimator, coverage over 100 seeds.")
    ] = False,
    timeout: Annotated[float, typer.Option(min=1.0, help="Seconds for one check.")] = 120.0,
) -> None:
    """Let a law, an effect, an estimator, a reader or a controller sit its exam.

    Each check that fails says what to change; the exit code is 1 if one does.
    """
    from fricmodels import plugins
    from fricmodels.cli.printing import console, print_table, warn
    from fricmodels.errors import FricmodelsError
    from fricmodels.export.columns import Column
    from fricmodels.testing.sitting import EXAMS, Outcome, checks, examine, named, once

    subjects = named(name)
    warn(plugins.load().failures)
    bad = 0
    for kind, own in subjects:
        outcomes: list[Outcome] = []
        with console(errors=True).status(f"{kind} {own}") as status:
            for outcome in examine(kind, own, timeout=timeout, thorough=thorough):
                outcomes.append(outcome)
                status.update(f"{kind} {own}: {len(outcomes)} of {len(checks(EXAMS[kind]))}")
        outcomes = once(outcomes)
        bad += sum(not outcome.good for outcome in outcomes)
        print_table(
            [
                Column("check", tuple(o.check.removeprefix("test_").replace("_", " ") for o in outcomes)),
                Column("result", tuple(o.result for o in outcomes)),
                Column("s", tuple(f"{o.seconds:.1f}" for o in outcomes), number=True),
                Column("what to change", tuple(o.message for o in outcomes)),
            ],
            title=f"{kind} {own}",
        )
    if bad:
        raise FricmodelsError(f"{bad} check{'s' * (bad > 1)} of '{name}' failed; the table says what to change")
