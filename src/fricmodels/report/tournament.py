"""The report on a tournament: who came first, how well, where it fails, and what did not work."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fricmodels.dimension import Motion
from fricmodels.export.columns import Column, tables, window_words
from fricmodels.report.estimates import histories
from fricmodels.report.page import (
    Block,
    Code,
    Fold,
    Heading,
    Page,
    Picture,
    Section,
    Table,
    Tile,
    Verdict,
    Words,
    table,
)
from fricmodels.report.parameters import parameters
from fricmodels.report.provenance import versions
from fricmodels.report.sections import equations
from fricmodels.report.tournament_recordings import best_of_each, identity, recordings
from fricmodels.report.wording import counted, percent
from fricmodels.tournament.histories import read_histories
from fricmodels.tournament.leaderboard import HELD_OUT, Leaderboard
from fricmodels.tournament.origin import Origin

if TYPE_CHECKING:
    from fricmodels.report.figures.tournament import Entry
    from fricmodels.results.history import ParameterHistory
    from fricmodels.tournament.sources import Source

Row = Mapping[str, Any]

MOST_ROWS = 200
"""Rows of the leaderboard that are printed; all of them are in its file."""
FIRST_ROWS, _FEWEST = 20, 3
"""Rows that are shown before all of them, and at least of each dataset."""
MOST_TABLES = 40
"""Datasets that have a table each."""
_WHO = ("model", "estimator", "dataset")
_MADE_OF = "The tournament: data, versions, how to reproduce"


def page(board: Leaderboard, origin: Origin | None, directory: Path) -> Page:
    """Return the report on a tournament.

    Args:
        board: its leaderboard.
        origin: what it was made of; without it there are no figures of recordings.
        directory: where it is kept, for the commands.
    """
    name = str(origin.config.get("name", directory.name)) if origin is not None else directory.name
    return Page(
        title=name,
        kicker="Friction report on a tournament",
        verdict=verdict(board),
        tiles=tiles(board),
        sections=sections(board, origin, directory),
        made_by=f"fricmodels {origin.versions['fricmodels']}" if origin is not None else "fricmodels",
    )


def sections(board: Leaderboard, origin: Origin | None, directory: Path) -> list[Section]:
    """Return the sections in reading order."""
    found = [leaderboard(board)]
    best = best_of_each(board)
    if origin is not None:
        found.append(recordings(board, best, origin))
    found.append(best_parameters(best, read_histories(directory)))
    if any(row.get("not_identified") for row in board.rows):
        found.append(not_identified(board))
    if board.failures:
        found.append(failed(board))
    return [*found, made_of(origin, directory)]


def entrants(board: Leaderboard) -> list[Entry]:
    """Return every model with every estimator, the smallest median error first."""
    from fricmodels.report.figures.tournament import entries

    return sorted(entries(board.rows, board.figure).values(), key=lambda each: each.middle)


def verdict(board: Leaderboard) -> Verdict:
    """Return who came first, in one sentence, and by how much."""
    ok = len(board.rows) - len(board.failures)
    if not ok:
        return Verdict("No fit gave a result.", "bad", ["The reasons stand below."])
    ranked = [each for each in entrants(board) if math.isfinite(each.middle)]
    over = "on the recording" if len(_recordings(board)) == 1 else "in the median over all recordings"
    kind = "data that took no part in fitting" if board.figure == HELD_OUT else "what was fitted"
    if not ranked:
        return Verdict(
            "No model gave a result on half of the recordings.", "bad", [f"{ok} of {len(board.rows)} fits did."]
        )
    first = ranked[0]
    sentence = f"{first.model} comes first: {percent(first.middle)} torque error {over}, with {first.estimator}."
    sentence += _places(board, first)
    window = f", averaged{window_words(board)}" if window_words(board) else ""
    details = [f"The error is in % of the RMS motor torque, on {kind}{window}."]
    others = [each for each in ranked if each.model != first.model]
    if others:
        details.append(
            f"The next model, {others[0].model} with {others[0].estimator}, leaves {percent(others[0].middle)}."
        )
    if board.failures:
        lost = counted(len(board.failures), "fit").partition(" ")[0].capitalize()
        stands = "reason stands" if len(board.failures) == 1 else "reasons stand"
        details.append(f"{lost} of {len(board.rows)} fits gave no result; the {stands} below.")
    return Verdict(sentence, "warn" if board.failures else "good", details)


def _places(board: Leaderboard, first: Entry) -> str:
    """Say on how many recordings the winner by the median is first, and its worst place; nothing with only one."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in board.summary():
        groups.setdefault((row["dataset"], json.dumps(row["tags"], sort_keys=True)), []).append(row)
    if len(groups) < 2:
        return ""
    places, missing = [], 0
    for (dataset, _), rows in groups.items():
        errors = {(row["model"], row["estimator"]): row["median"] for row in rows}
        own = errors.get((first.model, first.estimator))
        if own is None:
            missing += 1
            continue
        better = sum(error is not None and error < own for error in errors.values())
        places.append((better + 1, len(errors), dataset))
    lacks = f"; on {missing} it has no result" if missing else ""
    if not places:
        return ""
    worst, of, where = max(places, key=lambda place: place[0])
    firsts = sum(place == 1 for place, _, _ in places)
    if firsts == len(places):
        return f" It is first on {'all ' if len(places) > 1 else ''}{firsts} of them{lacks}."
    return f" It is first on {firsts} of {len(groups)} of them; its worst place is {worst} of {of}, on {where}{lacks}."


def tiles(board: Leaderboard) -> list[Tile]:
    """Return the few figures that carry the verdict."""
    ok = len(board.rows) - len(board.failures)
    models = {row["model"] for row in board.rows}
    estimators = {row["estimator"] for row in board.rows}
    finite = [each.middle for each in entrants(board) if math.isfinite(each.middle)]
    median = "median " if len(_recordings(board)) > 1 else ""
    return [
        Tile(percent(finite[0]) if finite else "–", f"smallest {median}{_part(board)}", "of all models and estimators"),
        Tile(
            str(len(models)), "models" if len(models) > 1 else "model", f"with {counted(len(estimators), 'estimator')}"
        ),
        Tile(
            str(len(_recordings(board))),
            "recordings",
            f"in {counted(len({r['dataset'] for r in board.rows}), 'dataset')}",
        ),
        Tile(f"{ok} of {len(board.rows)}", "fits with a result"),
    ]


def _recordings(board: Leaderboard) -> list[str]:
    return list(dict.fromkeys(identity(row["dataset"], row["tags"]) for row in board.rows))


def leaderboard(board: Leaderboard) -> Section:
    """Show the leaderboard: picture, table, and medians with quartiles where there are several seeds."""
    from fricmodels.report import figures

    blocks: list[Block] = []
    ranked = [each for each in entrants(board) if math.isfinite(each.middle)]
    if ranked:
        with_result = {each.model for each in ranked}
        rows: list[tuple[str, ...]] = [
            (each.model, each.estimator, percent(each.middle), f"{percent(each.low)} to {percent(each.high)}")
            for each in ranked[:MOST_ROWS]
        ]
        titles = {"model": False, "estimator": False, "median": True, "quartiles": True}
        over = "Marks are medians, bars quartiles, over recordings and seeds"
        caption = f"{over}; a fit without a result counts as infinitely bad"
        if len(_recordings(board)) == 1:
            titles = {"model": False, "estimator": False, "error": True}
            rows = [row[:3] for row in rows]
            over, caption = "Each mark is one fit", f"{_part(board).capitalize()} of each fit"
        words = f"{over}. The smaller, the better; {ranked[0].model} with {ranked[0].estimator} leads."
        shown = table(caption, titles, rows)
        figure = figures.leaderboard([row for row in board.rows if row["model"] in with_result])
        words += " The axis is logarithmic." if figure.layout.xaxis.type == "log" else ""
        blocks.append(Picture("Torque error by model and estimator", words, figure, shown, "errors-by-model"))
    datasets = len({row["dataset"] for row in board.rows})
    medians = [each for each in tables(board, max(_FEWEST, FIRST_ROWS // datasets)) if each.medians]
    if medians:
        blocks += [Table(f"{each.title}; median and quartiles, in %", each.columns) for each in medians[:MOST_TABLES]]
        blocks.append(Fold("Every fit", every_fit(board)))
    elif len(board.rows) <= FIRST_ROWS:
        blocks += every_fit(board)
    else:
        blocks += _fits(board, max(_FEWEST, FIRST_ROWS // datasets))
        blocks.append(Fold(f"All {len(board.rows)} fits", every_fit(board)))
    return Section("leaderboard", "Leaderboard", blocks)


def _part(board: Leaderboard) -> str:
    return "test error" if board.figure == HELD_OUT else "fit error"


def every_fit(board: Leaderboard) -> list[Block]:
    """Return the table of all fits, or of the first of them where there are many."""
    found: list[Block] = [*_fits(Leaderboard(board.rows[:MOST_ROWS]))]
    if len(board.rows) > MOST_ROWS:
        found.append(Words(f"The first {MOST_ROWS} of {len(board.rows)}; all of them are in leaderboard.json."))
    return found


def _fits(board: Leaderboard, top: int | None = None) -> list[Table]:
    """Return the fits of each dataset, ranked, without what is the same in all rows; reasons stand by themselves."""
    found = []
    for each in [each for each in tables(board, top) if not each.medians][:MOST_TABLES]:
        listed = {column.title: column for column in each.columns if column.title != "reason"}
        marks = listed.pop("not sure of", None)
        if marks is not None:
            listed["status"] = _judged(listed["status"], marks)
        columns = [*listed.values()]
        same = {each.title: each.cells[0] for each in columns if len({*each.cells}) == 1 and len(each.cells) > 1}
        kept = [column for column in columns if column.title not in same or column.title not in ("dataset", "status")]
        note = f" on {same['dataset']}" if "dataset" in same else ""
        found.append(Table(f"{each.title}{note}; torque errors{each.window}, in % of the RMS motor torque", kept))
    return found


def _judged(status: Column, marks: Column) -> Column:
    """Return the column of the status with how many parameters mean nothing by themselves; a section names them."""
    cells = []
    for cell, own in zip(status.cells, marks.cells, strict=True):
        loose, held = own.count("?"), own.count("|")
        parts = [cell, f"{loose} not determined" if loose else "", f"{held} at a bound" if held else ""]
        cells.append(", ".join(filter(None, parts)))
    return Column(status.title, tuple(cells))


def best_parameters(
    best: Mapping[str, list[Row]], found: Mapping[tuple[str, str], ParameterHistory] | None = None
) -> Section:
    """List the parameters of the best model on each recording, and show how sequential estimators came to theirs."""
    blocks: list[Block] = []
    described: set[str] = set()
    for dataset, rows in best.items():
        row = rows[0]
        blocks.append(Heading(dataset, remark=f"{row['model']} with {row['estimator']}"))
        motion = Motion.LINEAR if "M" in row["parameters"] else Motion.ROTARY
        if row["model"] not in described:
            blocks += equations(row["model"], motion)
            described.add(row["model"])
        truth = row.get("true_parameters")
        shown = parameters(row["model"], row["parameters"], row["standard_errors"], motion, "Parameters", truth)
        blocks.append(shown)
        blocks += histories(dataset, row["estimator"], found or {})
    if not blocks:
        blocks.append(Words("No fit gave a result."))
    return Section("parameters", "Parameters of the best models", blocks)


def not_identified(board: Leaderboard) -> Section:
    """List which parameters the recordings do not determine, with the reason."""
    reasons: dict[tuple[str, str, str], list[str]] = {}
    for row in board.rows:
        for key, reason in (row.get("not_identified") or {}).items():
            reasons.setdefault((row["model"], row["dataset"], reason), []).append(key)
    rows = [
        (model, dataset, ", ".join(dict.fromkeys(keys)), reason) for (model, dataset, reason), keys in reasons.items()
    ]
    titles = {"model": False, "dataset": False, "parameters": False, "why": False}
    blocks: list[Block] = [
        Words("A fit may converge and still not determine each parameter. These values mean nothing by themselves."),
        table("Parameters that the recordings do not determine", titles, rows[:MOST_ROWS]),
    ]
    return Section("not-identified", "What was not identifiable", blocks)


def failed(board: Leaderboard) -> Section:
    """List the fits without a result, with their reasons."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in board.failures:
        groups.setdefault((" ".join(str(row["message"]).split()), row["status"]), []).append(row)
    titles = {"model": False, "estimator": False, "dataset": False, "status": False, "why": False, "fits": True}
    rows = [
        (*(", ".join(dict.fromkeys(row[key] for row in own)) for key in _WHO), status, message, str(len(own)))
        for (message, status), own in groups.items()
    ]
    blocks: list[Block] = [table("Fits without a result", titles, rows[:MOST_ROWS])]
    return Section("failures", "What failed, and why", blocks)


def made_of(origin: Origin | None, directory: Path) -> Section:
    """Say what the tournament was made of, and how to do it again."""
    where = shlex.quote(str(directory))
    lines = [f"fricmodels leaderboard {where}", f"fricmodels report {where}"]
    if origin is None:
        note = "The run does not say what it was made of; a run of this version does."
        return Section("made-of", _MADE_OF, [Words(note), Code("To show it again", "\n".join(lines))])
    import yaml

    text = yaml.safe_dump(dict(origin.config), sort_keys=False, allow_unicode=True, width=100)
    rows = [(_described(source), origin.digests.get(source, "")) for source in origin.sources[:MOST_ROWS]]
    titles = {"recording": False, "checksum of its samples": False}
    blocks: list[Block] = [
        table("Recordings", titles, [(name, digest or "made from the configuration") for name, digest in rows]),
        Words(f"Made with {versions(origin.versions)}."),
    ]
    if origin.left_out:
        blocks.append(Words(f"Left out: {'; '.join(origin.left_out)}."))
    blocks.append(Code("Configuration", text))
    if origin.config_file:
        lines.insert(0, f"fricmodels run {shlex.quote(origin.config_file)} --out {where}")
    blocks.append(Code("To do it again", "\n".join(lines)))
    return Section("made-of", _MADE_OF, blocks)


def _described(source: Source) -> str:
    tags = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in source.tags.items())
    return f"{source.dataset} ({tags})" if tags else source.dataset
