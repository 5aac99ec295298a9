"""The report on a folder of results: a tournament, a diagnosis, or both."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fricmodels.diagnosis.document import FILE as DIAGNOSIS
from fricmodels.errors import FricmodelsError, InputError
from fricmodels.progress import each
from fricmodels.report import story, tournament
from fricmodels.report.page import Fold, Page, Picture, Section, Words
from fricmodels.report.wording import known_model
from fricmodels.results.diagnosis import DiagnosisDocument
from fricmodels.results.history import FILE as HISTORIES
from fricmodels.signals.coasting import coasting
from fricmodels.stored import as_written
from fricmodels.tournament.leaderboard import AGAIN, Leaderboard
from fricmodels.tournament.leaderboard import FILE as LEADERBOARD
from fricmodels.tournament.origin import FILE as ORIGIN
from fricmodels.tournament.origin import read_origin
from fricmodels.tournament.store import FILE as STORE

if TYPE_CHECKING:
    from fricmodels.diagnosis.ladder import Rung

_AGAIN = "fricmodels improve DATA --model M --out DIR"


def page(directory: Path) -> Page:
    """Return the report on a folder with ``leaderboard.json``, ``diagnosis.json`` or both, or on one of these files.

    Raises:
        InputError: when neither is there, or one cannot be read.
    """
    with as_written(directory, f"{AGAIN}, or {_AGAIN}"):
        return _page(directory)


def files(directory: Path) -> list[Path]:
    """Return the files that :func:`page` reads: results, and the recordings that they are of.

    Raises:
        InputError: when one of the results cannot be read.
    """
    folder = directory if directory.is_dir() else directory.parent
    found = [folder / name for name in (LEADERBOARD, DIAGNOSIS, ORIGIN, HISTORIES)]
    with as_written(directory, f"{AGAIN}, or {_AGAIN}"):
        if (folder / DIAGNOSIS).exists():
            paths = DiagnosisDocument.read(folder / DIAGNOSIS, _AGAIN).recording.paths
            found += [path if path.exists() else folder / path for path in map(Path, paths)]
        origin = read_origin(folder)
        for source in () if origin is None else origin.sources:
            values = source.values
            found += [Path(file) for key in ("files", "test_files") for file in values.get(key) or ()]
            found += [Path(values["file"])] if "file" in values else []
    return found


def _page(directory: Path) -> Page:
    folder = directory if directory.is_dir() else directory.parent
    wanted = {directory.name} if not directory.is_dir() else {LEADERBOARD, DIAGNOSIS}
    diagnosis = _of_diagnosis(folder) if DIAGNOSIS in wanted and (folder / DIAGNOSIS).exists() else None
    if LEADERBOARD not in wanted or not (folder / LEADERBOARD).exists():
        if diagnosis is None and (folder / STORE).exists():
            raise InputError(
                f"{directory}: the run was stopped before its leaderboard was written; the same 'fricmodels run' goes "
                f"on from there, and 'fricmodels leaderboard {directory}' shows what is done"
            )
        if diagnosis is None:
            raise InputError(
                f"{directory}: there is neither {LEADERBOARD} nor {DIAGNOSIS}; make one with: fricmodels run "
                "CONFIG.yaml --out DIR, or fricmodels improve DATA --model M --out DIR"
            )
        return diagnosis
    board, origin = Leaderboard.read(folder), read_origin(folder)
    if not board.rows and diagnosis is not None:
        return diagnosis
    if not board.rows:
        raise InputError(
            f"{folder / LEADERBOARD}: holds no fit, for no dataset of the run was there; correct the paths in its "
            f"configuration, and make it anew with: {AGAIN}"
        )
    if diagnosis is None:
        return tournament.page(board, origin, folder)
    first, *others = tournament.sections(board, origin, folder)
    ranks = [Fold(block.title, [block]) if isinstance(block, Picture) else block for block in first.blocks]
    beside = Section("tournament", "The tournament", [*ranks, *(Fold(s.title, s.blocks) for s in others)])
    return replace(
        diagnosis,
        kicker="Friction report on a recording and a tournament",
        verdict=replace(
            diagnosis.verdict,
            details=[*diagnosis.verdict.details, f"In the tournament, {tournament.verdict(board).sentence}"],
        ),
        sections=[*diagnosis.sections, beside],
    )


def _of_diagnosis(folder: Path) -> Page:
    data = DiagnosisDocument.read(folder / DIAGNOSIS, _AGAIN)
    command = "improve" if len(data.ladder) > 1 else "diagnose"
    try:
        rungs = _rungs(data, folder)
    except FricmodelsError as error:
        found = story.page(data, [], command)
        first, *rest = found.sections
        note = Words(f"There are no figures: {error}.")
        return replace(found, sections=[replace(first, blocks=[note, *first.blocks]), *rest])
    return story.page(data, rungs, command)


def _rungs(data: DiagnosisDocument, folder: Path) -> list[Rung]:
    """Return the models of a ladder against the recording, as they were fitted."""
    from fricmodels.diagnosis import compare_fit, kept_back, ready
    from fricmodels.diagnosis.ladder import Rung
    from fricmodels.drive import Drive
    from fricmodels.readers import read_together

    known = data.recording
    if data.offsets_of_runs:
        raise FricmodelsError("offsets were taken from the runs; the option --report of the same command draws them")
    if not known.paths:
        raise FricmodelsError("the recording was not read from a file")
    paths = [Path(file) for file in known.paths]
    recording = read_together(
        [path if path.exists() else folder / path for path in paths],
        columns=known.columns,
        motion=data.motion,
        name=data.dataset,
        reader=known.reader,
        torque_constant=known.torque_constant,
    )
    if recording.provenance["sha256"] != known.sha256:
        raise FricmodelsError(f"{known.source} has changed since the diagnosis")
    inertia = None if data.inertia.estimated else data.inertia.value
    train, test = kept_back(ready(coasting(recording, inertia)))
    rungs = []
    for step in each("evaluating the models", data.steps):
        model = known_model(step.model)
        if model is None:
            raise FricmodelsError(f"a part of the model '{step.model}' is not installed here")
        drive = Drive(model, inertia, data.motion)
        values = {key: value for key, value in step.parameters.items() if value is not None}
        errors = {key: value or 0.0 for key, value in step.standard_errors.items()}
        rungs.append(Rung(compare_fit(train, test, drive, values, errors), step.added, step.removed))
    return rungs
