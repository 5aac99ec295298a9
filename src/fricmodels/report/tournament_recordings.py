"""The best models of a tournament against its recordings."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fricmodels.errors import FricmodelsError
from fricmodels.report.page import Block, Fold, Gallery, Heading, Section, Words
from fricmodels.report.wording import counted, listed, percent
from fricmodels.score.bands import Band, Errors
from fricmodels.tournament.leaderboard import FITTED, HELD_OUT, Leaderboard
from fricmodels.tournament.origin import Origin

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.tournament.sources import Loaded, Source

Row = Mapping[str, Any]

MOST_RECORDINGS = 8
"""Recordings that are drawn."""
OPEN = 1
"""Recordings that are shown unfolded."""
MOST_MODELS = 2
"""Models that are drawn beside the best, on each recording."""
MOST_SAMPLES = 1_000_000
"""Of a longer recording only the best model is drawn."""


def identity(dataset: str, tags: Mapping[str, Any]) -> str:
    """Return which recording a row or a source is of, as one text."""
    return json.dumps([dataset, dict(tags)], sort_keys=True)


def best_of_each(board: Leaderboard) -> dict[str, list[Row]]:
    """Return, for each dataset, the best fit of every model on the recording that the best of all was fitted to."""
    found: dict[str, list[Row]] = {}
    for row in board.rows:
        if row["status"] != "ok":
            continue
        own = found.setdefault(row["dataset"], [])
        if not own or (row["tags"] == own[0]["tags"] and all(row["model"] != other["model"] for other in own)):
            own.append(row)
    return found


def recordings(board: Leaderboard, best: Mapping[str, list[Row]], origin: Origin) -> Section:
    """Show the best model against each recording, and where it fails."""
    known = {identity(source.dataset, source.tags): source for source in origin.sources}
    blocks: list[Block] = []
    for number, (dataset, rows) in enumerate(best.items()):
        if number == MOST_RECORDINGS:
            rest = len(best) - MOST_RECORDINGS
            blocks.append(
                Words(f"{counted(rest, 'more dataset')} in the leaderboard: {listed([*best][MOST_RECORDINGS:])}.")
            )
            break
        source = known.get(identity(dataset, rows[0]["tags"]))
        heading, words, *shown = _dataset(dataset, rows, source, origin, alone=len(best) == 1)
        if number < OPEN:
            blocks += [heading, words, *shown]
        else:
            blocks.append(Fold(f"{dataset}: {_best_here(rows)}", [words, *shown]))
    without = [name for name in dict.fromkeys(row["dataset"] for row in board.rows) if name not in best]
    if without:
        blocks.append(Words(f"No model gave a result on {listed(without)}."))
    return Section("measured", "Best models against measurements", blocks)


def _dataset(dataset: str, rows: Sequence[Row], source: Source | None, origin: Origin, *, alone: bool) -> list[Block]:
    from fricmodels.report.pictures import by_regime, curve, marks, over_time

    first = rows[0]
    figure = HELD_OUT if first.get(HELD_OUT) is not None else FITTED
    tags = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in first["tags"].items())
    others = [f"{row['model']} {percent(row.get(figure))}" for row in rows[1:4]]
    words = f"Best here: {_best_here(rows)}"
    blocks: list[Block] = [
        Heading(dataset, remark=tags),
        Words(f"{words}; then {listed(others)}." if others else f"{words}."),
    ]
    try:
        loaded = _loaded(source, origin)
        comparison = compared(loaded, source, first)
    except FricmodelsError as error:
        return [*blocks, Words(f"There are no figures of this recording: {error}.")]
    kept_back = loaded.prepared_test is not None
    blocks += [over_time(comparison, kept_back=kept_back), curve(comparison), by_regime(comparison)]
    blocks.append(Fold(f"What {first['model']} leaves over, by signal", [Gallery(marks(comparison))]))
    inner: list[Block] = []
    others_drawn = 0 if len(comparison.train) > MOST_SAMPLES else MOST_MODELS if alone else 1
    for row in rows[1 : 1 + others_drawn]:
        other = compared(loaded, source, row)
        inner += [
            Heading(row["model"], remark=f"with {row['estimator']}"),
            over_time(other, kept_back=kept_back),
            curve(other),
        ]
    if inner:
        blocks.append(Fold("The next best model" if len(inner) == 3 else "The next best models", inner))
    return blocks


def _best_here(rows: Sequence[Row]) -> str:
    first = rows[0]
    error = first.get(HELD_OUT) if first.get(HELD_OUT) is not None else first.get(FITTED)
    return f"{first['model']} with {first['estimator']}, {percent(error)} torque error"


def _loaded(source: Source | None, origin: Origin) -> Loaded:
    from fricmodels.tournament.sources import load

    if source is None:
        raise FricmodelsError("the run does not say where it came from")
    loaded = load(source)
    if origin.digests.get(source, loaded.digest) != loaded.digest:
        raise FricmodelsError("its file has changed since the tournament")
    return loaded


def compared(loaded: Loaded, source: Source | None, row: Row) -> Comparison:
    """Return a row of the leaderboard as a comparison with its recording, as it was scored.

    Where all of a recording was fitted, that takes the place of what was kept back.
    """
    from fricmodels.diagnosis import compare_fit
    from fricmodels.drive import Drive
    from fricmodels.model import Model

    train = loaded.prepared_train
    test = loaded.prepared_test if loaded.prepared_test is not None else train
    drive = Drive(Model.parse(row["model"]), None if source is None else source.inertia, train.motion)
    errors = {key: value or 0.0 for key, value in row["standard_errors"].items()}
    found = compare_fit(train, test, drive, row["parameters"], errors)
    return replace(found, errors=_errors(row))


def _errors(row: Row) -> Errors:
    """Return the torque errors as they were scored; with the paper's or a decimated score there is only one."""
    bands = tuple(Band(**_or_nan(band)) for band in row.get("rms_torque_error_bands") or ())
    for band in bands:
        if band.window_ms == row["rms_torque_error_band_ms"]:
            return Errors(band, bands)
    figures = {
        "window_ms": None,
        "SI": row.get("rms_torque_error"),
        "percent": row[FITTED],
        "held_out_SI": row.get("held_out_rms_torque_error"),
        "held_out_percent": row.get(HELD_OUT),
        "noise_floor_percent": None,
        "fit_noise_percent": None,
    }
    only = Band(**_or_nan(figures))
    return Errors(only, (only,))


def _or_nan(values: Mapping[str, float | None]) -> dict[str, float]:
    return {key: math.nan if value is None else value for key, value in values.items()}
