"""Sums of rows: equal to all rows at once, whatever is cut where, and true."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricmodels import sums
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.sums import rows as rows_module
from fricmodels.sums.rows import block_rows
from fricmodels.weakform.estimate import Estimate
from fricmodels.weakform.prepared import ready
from fricmodels.weakform.problem import WeakFormProblem

TRUTH = {"J": 0.05, "K_v": 0.1, "K_c": 0.4}
LAW = "coulomb-viscous"


def arm(samples: int = 20_000, seed: int = 0, noise: float = 0.02, **columns: object) -> pd.DataFrame:
    """A motion with reversals, sampled every 2 ms, whose torque is the truth's."""
    rng = np.random.default_rng(seed)
    time = 0.002 * np.arange(samples)
    parts = [(f, a, p) for f, a, p in zip((1.9, 4.8, 9.0), (4.0, 3.0, 2.0), rng.uniform(0, 6, 3), strict=True)]
    velocity = sum(a * np.sin(f * time + p) for f, a, p in parts)
    slope = sum(a * f * np.cos(f * time + p) for f, a, p in parts)
    position = sum(-a / f * np.cos(f * time + p) for f, a, p in parts)
    torque = TRUTH["J"] * slope + TRUTH["K_v"] * velocity + TRUTH["K_c"] * np.sign(velocity)
    measured = velocity + noise * rng.standard_normal(samples)
    table = pd.DataFrame({"time_s": time, "torque_Nm": torque, "velocity_rad_s": measured, "position_rad": position})
    return table.assign(**columns)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("sums")


@pytest.fixture(scope="module")
def written(folder: Path) -> Callable[[str, pd.DataFrame], Path]:
    def write(name: str, table: pd.DataFrame) -> Path:
        path = folder / name
        table.drop(columns="position_rad").to_parquet(path, row_group_size=7001)
        return path

    return write


@pytest.fixture(scope="module")
def first(written: Callable[[str, pd.DataFrame], Path]) -> Path:
    return written("first.parquet", arm())


@pytest.fixture(scope="module")
def plan(first: Path) -> sums.Plan:
    return sums.plan_for(sums.pilot(first), LAW)


def near(one: Estimate, other: Estimate) -> None:
    left, right = one.parameters, other.parameters
    for key, value in left.items():
        assert value == pytest.approx(right[key], rel=1e-10), key


def test_blocks_change_nothing(first: Path, plan: sums.Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sums.of_file(first, plan)
    monkeypatch.setattr(rows_module, "_BLOCK", 1500)
    cut = sums.of_file(first, plan)
    assert cut.rows == whole.rows
    near(sums.solved(cut), sums.solved(whole))
    np.testing.assert_allclose(cut.stretches, whole.stretches, rtol=1e-9, atol=1e-9 * float(np.abs(whole.whole).max()))


def test_files_and_runs_of_one_file_say_the_same(written: Callable[[str, pd.DataFrame], Path], plan: sums.Plan) -> None:
    tables = [arm(9000 + 500 * seed, seed) for seed in range(3)]
    each = [sums.of_file(written(f"part{i}.parquet", table), plan) for i, table in enumerate(tables)]
    joined = pd.concat([table.assign(run=number) for number, table in enumerate(tables)], ignore_index=True)
    together = sums.of_file(written("joined.parquet", joined), plan)
    merged = sums.added(each)
    assert (merged.rows, merged.samples) == (together.rows, together.samples)
    near(sums.solved(merged), sums.solved(together))
    near(sums.solved(merged, 0.05), sums.solved(together, 0.05))
    left, right = (sums.solved(one).standard_errors for one in (merged, together))
    ratios = [left[key] / right[key] for key in TRUTH]
    assert min(ratios) > 0.6, "the jackknife has other parts of the same size"
    assert max(ratios) < 1.7, ratios
    again = sums.added(each[::-1])
    assert again.to_json() == merged.to_json(), "the order of the files decides nothing"
    near(sums.solved(each[0].plus(each[1].plus(each[2]))), sums.solved(each[0].plus(each[1]).plus(each[2])))


def test_the_rows_are_those_of_a_fit_of_the_whole_recording(first: Path, plan: sums.Plan) -> None:
    recording = ready(sums.pilot(first))
    drive = Drive(Model.parse(LAW))
    problem = WeakFormProblem.of(drive, recording, plan.friction, plan.width)
    channels = {name: recording[name] for name in ("time", "torque", "velocity")}
    rows, begins = block_rows(plan, channels, 0, len(recording))
    own = np.vstack([problem.driving, problem.momentum, problem.columns(drive)[0], problem.sign_change,
                     problem.torque_rate])  # fmt: skip
    both, here, there = np.intersect1d(begins, problem.test_functions.begins, return_indices=True)
    assert len(both) > 0.95 * problem.rows, "only rests are told apart in another way"
    size = np.abs(own).max(axis=1, keepdims=True)
    np.testing.assert_allclose(rows[:, here] / size, own[:, there] / size, atol=1e-8)


@pytest.mark.parametrize(("lost", "is_gap"), [(3, False), (4, False), (8, True)])
def test_a_stretch_ends_where_a_fit_sees_a_gap(
    written: Callable[[str, pd.DataFrame], Path], plan: sums.Plan, lost: int, is_gap: bool
) -> None:
    """Of every sixty samples some are lost: a few are bridged by the rows of sums as by those of a fit."""
    table = arm(20_000, 7)
    kept = table[np.arange(len(table)) % 60 >= lost]
    found = sums.of_file(written(f"lost{lost}.parquet", kept), plan)
    whole = sums.of_file(written("seven.parquet", table), plan)
    assert (found.rows < 0.8 * whole.rows) is is_gap
    values = sums.solved(found).parameters
    for key, value in TRUTH.items():
        assert values[key] == pytest.approx(value, rel=0.02)


def test_the_solution_is_the_least_squares_of_all_rows(first: Path, plan: sums.Plan) -> None:
    channels = {name: sums.pilot(first)[name] for name in ("time", "torque", "velocity")}
    rows, _ = block_rows(plan, channels, 0, len(channels["time"]))
    free = plan.model_copy(update={"row_noise": 0.0})
    found = sums.solved(sums.of_file(first, free))
    theta = np.linalg.lstsq(rows[1:].T, rows[0], rcond=None)[0]
    for key, value in zip(("J", "K_v", "K_c"), theta, strict=False):
        assert found.parameters[key] == pytest.approx(value, rel=1e-10)


def test_the_truth_lies_within_the_standard_errors(
    written: Callable[[str, pd.DataFrame], Path], plan: sums.Plan
) -> None:
    inside = dict.fromkeys(TRUTH, 0)
    trials = 24
    for seed in range(trials):
        found = sums.solved(sums.of_file(written("trial.parquet", arm(6000, 100 + seed)), plan))
        for key, value in TRUTH.items():
            inside[key] += abs(found.parameters[key] - value) <= 2 * found.standard_errors[key] + 5e-4 * value
    assert all(count >= 0.8 * trials for count in inside.values()), inside


def test_positions_alone_are_enough(folder: Path) -> None:
    path = folder / "positions.parquet"
    table = arm(20_000, 7).drop(columns="velocity_rad_s")
    noise = 1e-5 * np.random.default_rng(0).standard_normal(len(table))
    table.assign(position_rad=table["position_rad"] + noise).to_parquet(path)
    plan = sums.plan_for(sums.pilot(path), LAW)
    assert plan.derived_over > 0
    found = sums.solved(sums.of_file(path, plan))
    for key, value in TRUTH.items():
        assert found.parameters[key] == pytest.approx(value, rel=2e-3)
    wrapped = folder / "wrapped.parquet"
    turned = table.assign(position_rad=np.mod(table["position_rad"] + noise, 2 * np.pi))
    turned.to_parquet(wrapped)
    plan = sums.plan_for(sums.pilot(wrapped), LAW)
    assert plan.wrap == pytest.approx(2 * np.pi)
    assert sums.solved(sums.of_file(wrapped, plan)).parameters["K_c"] == pytest.approx(TRUTH["K_c"], rel=2e-3)


def test_effects_that_are_linear_are_summed_as_well(folder: Path) -> None:
    path = folder / "gravity.parquet"
    table = arm(20_000, 4)
    table["torque_Nm"] += 0.3 * np.sin(table["position_rad"]) + 0.2 * np.cos(table["position_rad"]) + 0.05
    table.to_parquet(path)
    plan = sums.plan_for(sums.pilot(path), "coulomb-viscous+gravity+torque-offset", 0.05)
    found = sums.solved(sums.of_file(path, plan), 0.05)
    assert found.parameters["J"] == 0.05
    assert "J" not in found.standard_errors
    for key, value in {"K_v": 0.1, "K_c": 0.4, "gravity.a": 0.2, "gravity.b": 0.3}.items():
        assert found.parameters[key] == pytest.approx(value, abs=2e-3), key


def test_a_file_of_sums_keeps_every_bit(first: Path, plan: sums.Plan, folder: Path) -> None:
    one = sums.of_file(first, plan)
    path = one.save(folder / "one.sums.json")
    again = sums.load(path)
    assert again.to_json() == one.to_json()
    np.testing.assert_array_equal(again.stretches, one.stretches)
    np.testing.assert_array_equal(again.apart, one.apart)
    assert path.stat().st_size < 20_000


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text[: len(text) // 2], "holds no sums"),
        (lambda text: json.dumps({**json.loads(text), "rows": -1}), "rows"),
        (lambda text: json.dumps({**json.loads(text), "columns": ["push"]}), "has the columns push"),
        (lambda text: json.dumps({**json.loads(text), "stretches": {"99": [1.0]}}), "part 99"),
        (lambda text: text.replace("coulomb-viscous", "coulomb-vicious"), "coulomb-v"),
        (lambda text: "[" * 100_000, "holds no sums"),
    ],
)
def test_spoilt_files_of_sums_are_one_line(
    first: Path, plan: sums.Plan, folder: Path, change: Callable[[str], str], said: str
) -> None:
    path = folder / "spoilt.sums.json"
    path.write_text(change(sums.of_file(first, plan).to_json()))
    with pytest.raises(InputError, match=said) as error:
        sums.load(path)
    assert "\n" not in str(error.value)


def test_what_cannot_be_added_is_refused(first: Path, plan: sums.Plan) -> None:
    one = sums.of_file(first, plan)
    with pytest.raises(InputError, match=r"first\.parquet would count twice"):
        sums.added([one, one])
    other = sums.of_file(first, plan.model_copy(update={"width": 2 * plan.width}))
    with pytest.raises(InputError, match="'width' is"):
        sums.added([one, other])
    with pytest.raises(InputError, match="no sums"):
        sums.added([])


def test_laws_of_which_no_sums_can_be_made(first: Path) -> None:
    for name, why in (("exponential-stick-slip", "not linear in"), ("coulomb-viscous+cogging", "not linear in")):
        with pytest.raises(InputError, match=why):
            sums.plan_for(sums.pilot(first), name)


def test_rows_that_cannot_be_used_are_named(written: Callable[[str, pd.DataFrame], Path], plan: sums.Plan) -> None:
    table = arm(6000, 3)
    table.loc[4000, "torque_Nm"] = np.nan
    path = written("hole.parquet", table)
    with pytest.raises(InputError, match=r"row 4001, torque: .* --gaps"):
        sums.of_file(path, plan)
    assert sums.of_file(path, plan, gaps="drop").samples == 5999
    restarted = pd.concat([arm(3000, 4), arm(3000, 5)], ignore_index=True)
    path = written("restarted.parquet", restarted)
    with pytest.raises(InputError, match=r"row 3001: the time 0 s goes back"):
        sums.of_file(path, plan)
    split = sums.of_file(path, plan, gaps="split")
    runs = pd.concat([arm(3000, 4).assign(run=1), arm(3000, 5).assign(run=2)], ignore_index=True)
    near(sums.solved(split), sums.solved(sums.of_file(written("runs.parquet", runs), plan)))
    torn = runs.assign(run=np.repeat([1, 2, 1, 2], 1500))
    with pytest.raises(InputError, match="run 1 do not stand together"):
        sums.of_file(written("torn.parquet", torn), plan, gaps="split")
    with pytest.raises(InputError, match=r"is sampled every 0\.004 s"):
        sums.of_file(written("slower.parquet", arm(6000, 3).assign(time_s=0.004 * np.arange(6000))), plan)


def test_a_file_at_rest_adds_nothing(written: Callable[[str, pd.DataFrame], Path], plan: sums.Plan) -> None:
    still = arm(5000, 1).assign(velocity_rad_s=0.0, torque_Nm=0.1)
    found = sums.of_file(written("still.parquet", still), plan)
    assert found.rows == 0
    with pytest.raises(InputError, match="0 stretches of clear motion"):
        sums.solved(found)


def test_many_files_that_differ_are_less_certain_than_one_is(
    written: Callable[[str, pd.DataFrame], Path], plan: sums.Plan
) -> None:
    """Friction that changes from day to day is seen between files only."""
    each = []
    for day in range(16):
        table = arm(4000, 200 + day)
        more = 0.05 * np.random.default_rng(day).standard_normal()
        table["torque_Nm"] += more * np.sign(table["velocity_rad_s"])
        each.append(sums.of_file(written("day.parquet", table), plan))
    alone, all_of_them = sums.solved(each[0]), sums.solved(sums.added(each))
    spread = np.std([sums.solved(one).parameters["K_c"] for one in each], ddof=1) / 4
    assert all_of_them.standard_errors["K_c"] == pytest.approx(spread, rel=0.6)
    assert all_of_them.standard_errors["K_c"] > alone.standard_errors["K_c"]


def test_a_recording_of_another_format_is_summed_as_well(folder: Path, first: Path, plan: sums.Plan) -> None:
    path = folder / "first.csv"
    pd.read_parquet(first).to_csv(path, index=False)
    near(sums.solved(sums.of_file(path, plan)), sums.solved(sums.of_file(first, plan)))


def test_a_pilot_of_a_long_file_is_spread_over_it(folder: Path) -> None:
    path = folder / "long.parquet"
    arm(200_000, 9).drop(columns="position_rad").to_parquet(path, row_group_size=30_000)
    found = sums.pilot(path)
    assert isinstance(found, Recording)
    assert len(found) == 163_840
    assert found.time[-1] == pytest.approx(0.002 * 199_999)
    assert len(np.unique(found.run)) == 20
