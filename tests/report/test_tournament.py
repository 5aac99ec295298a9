"""The report on a tournament: who came first, against which measurement, what failed, and how to do it again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fricmodels.report import of_run
from fricmodels.report.page import Block, Code, Fold, Gallery, Page, Picture, Table, Words
from fricmodels.report.render import render
from fricmodels.report.tournament import verdict
from fricmodels.tournament import run
from fricmodels.tournament.config import Config
from fricmodels.tournament.demonstration import MOTOR
from fricmodels.tournament.histories import read_histories
from fricmodels.tournament.leaderboard import Leaderboard

Made = Callable[..., Path]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    def tournament(**changes: Any) -> Path:
        folder = tmp_path_factory.mktemp("run")
        content = {
            "name": "motors",
            "datasets": [{"name": "first", "simulate": MOTOR}, {"name": "second", "simulate": MOTOR}],
            "models": ["coulomb-viscous", "asymmetric-coulomb-viscous", "coulomb-viscous+thermal"],
            "estimators": ["rls"],
            "simulate": False,
        }
        run(Config.model_validate({**content, **changes}), folder, executor="serial")
        return folder

    return tournament


@pytest.fixture(scope="module")
def folder(made: Made) -> Path:
    return made()


def blocks(page: Page) -> list[Block]:
    found: list[Block] = []
    for section in page.sections:
        waiting = [*section.blocks]
        while waiting:
            block = waiting.pop(0)
            found.append(block)
            if isinstance(block, Fold | Gallery):
                waiting[:0] = block.blocks
    return found


def captioned(page: Page, beginning: str) -> Table:
    return next(b for b in blocks(page) if isinstance(b, Table) and b.caption.startswith(beginning))


def test_the_best_model_is_named_with_its_error(folder: Path) -> None:
    page = of_run(folder)
    best = Leaderboard.read(folder).rows[0]
    assert page.verdict.sentence.startswith("asymmetric-coulomb-viscous comes first")
    assert f"{best['held_out_rms_torque_error_percent']:.3g}" in page.verdict.sentence
    assert page.title == "motors"
    assert page.verdict.sentence.endswith("It is first on all 2 of them.")
    assert "Two of 6 fits gave no result; the reasons stand below." in page.verdict.details
    assert page.tiles[-1].value == "4 of 6"


def test_beside_the_winner_stands_how_often_it_is_first_and_its_worst_place() -> None:
    """The median over recordings ranks; one that is always second is first, however bad it is on one of them."""
    errors = {"steady": (2.0, 2.0, 60.0), "left": (1.0, 30.0, 50.0), "right": (30.0, 1.0, 40.0)}
    rows = [
        {
            "model": model, "estimator": "rls", "dataset": name, "tags": {}, "status": "ok", "seconds": 1.0,
            "held_out_rms_torque_error_percent": error, "parameters": {}, "message": "",
        }
        for model, own in errors.items()
        for name, error in zip(("stage", "spindle", "wrist"), own, strict=True)
    ]  # fmt: skip
    sentence = verdict(Leaderboard.ranked(rows)).sentence
    assert sentence.startswith("steady comes first")
    assert sentence.endswith("It is first on 0 of 3 of them; its worst place is 3 of 3, on wrist.")
    stopped = [row for row in rows if (row["model"], row["dataset"]) != ("steady", "wrist")]
    sentence = verdict(Leaderboard.ranked(stopped)).sentence
    assert sentence.startswith("steady comes first")
    assert sentence.endswith("its worst place is 2 of 3, on stage; on 1 it has no result.")
    alone = verdict(Leaderboard.ranked(row for row in rows if row["dataset"] == "stage")).sentence
    assert "of them" not in alone


def test_failures_stand_with_their_reason_once(folder: Path) -> None:
    page = of_run(folder)
    rows = captioned(page, "Fits without a result").rows
    assert all(row[0] == "coulomb-viscous+thermal" for row in rows)
    assert sum(int(row[-1]) for row in rows) == 2
    assert all("temperature" in row[4] for row in rows)


def test_each_recording_has_its_best_model_drawn_and_its_parameters_beside_the_truth(folder: Path) -> None:
    page = of_run(folder)
    titles = [block.title for block in blocks(page) if isinstance(block, Picture)]
    assert titles.count("Torque over time") == 4, "the best and the next, on two recordings"
    assert titles.count("Error by regime") == 2
    rows = {row[0]: row for row in captioned(page, "Parameters").rows}
    value, half, truth = (float(text.removeprefix("± ")) for text in rows["K_c1"][1:4])
    assert truth == 0.01
    assert abs(value - truth) < 2 * half


def test_figures_carry_the_errors_of_the_leaderboard(folder: Path) -> None:
    page = of_run(folder)
    first = Leaderboard.read(folder).rows[0]
    overlay = next(b for b in blocks(page) if isinstance(b, Picture) and b.title == "Torque over time")
    assert f"{first['held_out_rms_torque_error_percent']:.3g}" in overlay.message


def test_the_configuration_and_the_commands_make_it_again(folder: Path, tmp_path: Path) -> None:
    import yaml

    codes = {block.title: block.text for block in blocks(of_run(folder)) if isinstance(block, Code)}
    config = Config.model_validate(yaml.safe_load(codes["Configuration"]))
    board = run(config, tmp_path, executor="serial")
    assert [row["key"] for row in board.rows] == [row["key"] for row in Leaderboard.read(folder).rows]
    assert "fricmodels report" in codes["To do it again"]


def test_equal_runs_give_equal_bytes(folder: Path) -> None:
    assert render(of_run(folder)) == render(of_run(folder))


def test_several_seeds_have_medians_and_quartiles(made: Made) -> None:
    page = of_run(made(datasets=[{"name": "noisy", "simulate": {**MOTOR, "seeds": 4}}]))
    rows = captioned(page, "Over seeds: test error").rows
    assert len(rows) == 3
    assert rows[0][1] == "asymmetric-coulomb-viscous"
    picture = next(b for b in blocks(page) if isinstance(b, Picture))
    assert picture.table is not None
    assert " to " in picture.table.rows[0][3]


def test_all_of_it_fitted_nothing_is_shaded(made: Made) -> None:
    page = of_run(made(score="paper"))
    overlay = next(b for b in blocks(page) if isinstance(b, Picture) and b.title == "Torque over time")
    assert "kept back" not in overlay.message
    assert "kept back from the fit" not in [trace.name for trace in overlay.figure.data]


def test_no_result_at_all_is_said_at_the_top(made: Made) -> None:
    page = of_run(made(models=["coulomb-viscous+thermal"]))
    assert page.verdict.sentence == "No fit gave a result."
    assert page.verdict.tone == "bad"
    render(page)


def test_a_run_of_an_old_version_has_its_table(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "leaderboard.json").write_bytes((folder / "leaderboard.json").read_bytes())
    page = of_run(tmp_path)
    assert page.verdict == of_run(folder).verdict
    assert any("does not say what it was made of" in b.text for b in blocks(page) if isinstance(b, Words))


def test_estimates_over_time_are_kept_typed_and_shown(made: Made) -> None:
    folder = made(estimators=["rls", "ekf", "batch"], models=["coulomb-viscous", "asymmetric-coulomb-viscous"])
    found = read_histories(folder)
    assert {estimator for _, estimator in found} == {"rls", "ekf"}
    one = found["first", "ekf"]
    assert one.kept > len(one.time)
    board = Leaderboard.read(folder)
    best = next(row for row in board.rows if row["dataset"] == "first" and row["estimator"] == "ekf")
    assert one.model == best["model"]
    assert all("history" not in row for row in board.rows)
    for key, course in one.courses.items():
        assert course.final == pytest.approx(best["parameters"][key])
        assert course.truth == pytest.approx(best["true_parameters"][key])
        assert len(course.estimates) == len(one.time)
    shown = [block for block in blocks(of_run(folder)) if isinstance(block, Picture) and "history" in block.name]
    assert {block.title for block in shown} == {"Estimates over time by rls", "Estimates over time by ekf"}
    assert all("estimates are drawn" in block.message for block in shown)


def test_each_dataset_and_each_level_of_noise_is_ranked_by_itself(made: Made) -> None:
    """The smallest error under much noise, averaged over a wide window, is not better than one under little."""
    simulated = {**MOTOR, "noise_percent": [1, 5], "seeds": 2}
    page = of_run(made(datasets=[{"name": "noisy", "simulate": simulated}, {"name": "quiet", "simulate": MOTOR}]))
    tables = [b for b in blocks(page) if isinstance(b, Table) and b.caption.startswith("Over seeds")]
    assert ["noisy" in tables[0].caption, "quiet" in tables[1].caption] == [True, True]
    titles = [column.title for column in tables[0].columns]
    noise, rank, median = (titles.index(title) for title in ("noise %", "rank", "median"))
    found = [(row[noise], row[rank], float(row[median] or "inf")) for row in tables[0].rows]
    assert [(level, place) for level, place, _ in found] == [(n, str(i)) for n in ("1", "5") for i in (1, 2, 3)]
    for level in ("1", "5"):
        errors = [error for other, _, error in found if other == level]
        assert errors == sorted(errors)
