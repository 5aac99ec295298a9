"""How many samples a comparison has, and its errors by window, as text for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fricmodels.diagnosis.comparison import Comparison
from fricmodels.recording import Recording
from fricmodels.results.comparison import Samples
from fricmodels.results.words import BY_WINDOW, noise_text
from fricmodels.split import WHOLE_RUNS
from fricmodels.terminal import Column, show_table

if TYPE_CHECKING:
    from rich.console import Console


def samples_of(train: Recording, test: Recording) -> Samples:
    """Return how many samples were fitted, and how many kept back."""
    return Samples(fitted=len(train), kept_back=len(test), kept_back_runs=test.provenance.get(WHOLE_RUNS, ()))


def sampled(comparison: Comparison) -> str:
    """Say how many samples there are, and how far apart."""
    samples = samples_of(comparison.train, comparison.test)
    parts = f"{samples.fitted} samples fitted, {samples.in_the_test_error}"
    if comparison.drive.model.known.fixed:
        parts = f"{samples.total} samples, none of them fitted, {samples.in_the_test_error}"
    return f"{parts}, sampled every {1000 * comparison.train.interval:.4g} ms."


def show_bands(console: Console, comparison: Comparison, unit: str) -> None:
    """Print the RMS torque error per sample and over wider windows, with what noise alone would leave."""
    bands = comparison.errors.bands
    fitted = "other samples" if comparison.drive.model.known.fixed else "fit error"
    columns = [
        Column("averaged over", ("a sample", *(f"{band.window_ms:.3g} ms" for band in bands[1:]))),
        Column(f"{fitted} [{unit}]", tuple(f"{band.SI:.3g}" for band in bands), True),
        Column(f"test error [{unit}]", tuple(f"{band.held_out_SI:.3g}" for band in bands), True),
        Column(fitted, tuple(f"{band.percent:.3g} %" for band in bands), True),
        Column("noise alone", tuple(noise_text(band.fit_noise_percent) for band in bands), True),
        Column("test error", tuple(f"{band.held_out_percent:.3g} %" for band in bands), True),
        Column("noise alone", tuple(noise_text(band.noise_floor_percent) for band in bands), True),
    ]
    show_table(console, columns, BY_WINDOW)
