"""What cannot be computed is said before the work begins; what fails in the numbers is an answer too."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.errors import FricmodelsError, InputError

if TYPE_CHECKING:
    from rich.console import Console

    from fricmodels.diagnosis.ladder import Ladder
    from fricmodels.model import Model
    from fricmodels.progress import Cancelled
    from fricmodels.recording import Recording

FEWEST = 20
"""Samples that a model is fitted to at least."""
_GREATEST = 1e75
"""Fourth powers of sizes are computed; a float ends at 1e308."""
_HEAVIEST = 1e9
"""Inertial torque over the measured one: kg m² written in g mm² is as much."""


def check_computable(recording: Recording, inertia: float | None) -> None:
    """Refuse a recording, or an inertia for it, from which floating-point numbers can give no answer.

    Raises:
        InputError: naming the channel or the inertia, and the way out.
    """
    source = recording.provenance.get("source", recording.name)
    if len(recording) < FEWEST:
        raise InputError(f"{source}: {len(recording)} samples are too few to fit a model to; record {FEWEST} at least")
    steps = np.diff(recording.time)
    sizes = {name: np.abs(values) for name, values in recording.channels.items() if name != "time"}
    for name, size in {**sizes, "step of time": np.abs(steps)}.items():
        largest = float(size.max())
        if largest > _GREATEST or 0.0 < largest < 1 / _GREATEST:
            what = name.replace("_", " ")
            raise InputError(f"{source}: the {what} goes up to {largest:.3g}; correct its unit with --column")
    if inertia is None or "velocity" not in recording:
        return
    within = np.diff(recording.run) == 0
    fastest = float(np.abs(np.diff(recording.velocity) / steps)[within].max(initial=0.0))
    torque = float(np.abs(recording.torque).max())
    if torque and np.isfinite(inertia) and inertia * fastest / _HEAVIEST > torque:
        times = inertia * fastest / torque
        raise InputError(
            f"{source}: an inertia of {inertia:.3g} would need {times:.1g} times the torque that was measured; "
            f"give it in kg m² (kg for a linear axis), or leave it out to have it estimated"
        )


class Stopped(FricmodelsError):
    """The work was stopped from outside, after something was found."""

    exit_code = 130

    def __init__(self) -> None:
        super().__init__("stopped before the end: what stands above is partial; run it again for all of it")


def so_far(shown: Console, stopped: Cancelled) -> Ladder:
    """Return the ladder that work had come to when it was stopped.

    Where it had only fitted the model, that is printed.

    Raises:
        Stopped: where there is no ladder yet.
    """
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.diagnosis.ladder import Ladder
    from fricmodels.report.console import show_answer_of_comparison

    if isinstance(stopped.partial, Ladder):
        return stopped.partial
    if isinstance(stopped.partial, Comparison):
        show_answer_of_comparison(shown, stopped.partial)
        raise Stopped from None
    raise stopped


@contextmanager
def answered(recording: Recording, model: Model) -> Iterator[None]:
    """Turn numbers that come to no end into one line; any other error is one of the program, and stays."""
    try:
        yield
    except (ArithmeticError, np.linalg.LinAlgError, ValueError) as error:
        numeric = isinstance(error, ArithmeticError | np.linalg.LinAlgError)
        if not numeric and not any(word in str(error) for word in ("NaN", "infs", "finite")):
            raise
        source = recording.provenance.get("source", recording.name)
        raise FricmodelsError(
            f"{source}: no numbers for '{model.name}' can be had from this recording ({error}); "
            f"'fricmodels info' says what is the matter with it"
        ) from error
