"""Long work says how far it is as data, and can be stopped; what was found until then is there, said to be partial."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from fricmodels import diagnosis
from fricmodels.cli import main
from fricmodels.diagnosis.comparison import Comparison
from fricmodels.diagnosis.diagnose import diagnose
from fricmodels.diagnosis.document import document
from fricmodels.diagnosis.improve import improve
from fricmodels.diagnosis.ladder import Ladder
from fricmodels.progress import Cancelled, Progress, Token, each, steps, watched
from fricmodels.recording import Recording
from fricmodels.report.answer import answer
from fricmodels.results.diagnosis import DiagnosisDocument
from fricmodels.rig import write

Made = Callable[..., Recording]
TRUE = {"cogging.a": 0.8, "cogging.b": 0.3, "cogging.k": 7.3}


@pytest.fixture(scope="module")
def recording(made: Made) -> Recording:
    return made("coulomb-viscous+cogging", TRUE, samples=4000)


def test_rate_and_time_left_are_those_of_the_parts() -> None:
    one = Progress("testing", done=5, total=20, seconds=2.5)
    assert one.rate == pytest.approx(2.0)
    assert one.left == pytest.approx(7.5)
    assert str(one) == "testing: 5 of 20, 2/s, 8 s left of this step"
    assert str(Progress("fitting")) == "fitting"
    assert Progress("fitting").left is None


def test_unwatched_work_goes_its_way_and_a_watcher_may_stop_it() -> None:
    assert list(each("counting", range(3))) == [0, 1, 2]

    def refuse(found: Progress) -> None:
        raise ValueError(found.stage)

    with pytest.raises(ValueError, match="counting"), watched(refuse):
        list(each("counting", range(3)))
    assert list(each("counting", range(3))) == [0, 1, 2]


def test_parts_that_are_done_are_counted_and_there_are_never_more_than_said() -> None:
    seen = list[Progress]()
    with watched(seen.append), steps("summing", 5) as done:
        done()
        done(3)
        done(9)
    assert [(one.stage, one.done, one.total) for one in seen] == [("summing", n, 5) for n in (0, 1, 4, 5)]
    assert (
        str(Progress("summing", 2_000_000, 4_000_000, 2.0))
        == "summing: 2000000 of 4000000, 1000000/s, 2 s left of this step"
    )
    with steps("unwatched", 2) as done:
        done()


def test_a_comparison_says_how_far_it_is(recording: Recording) -> None:
    seen = list[Progress]()
    with watched(seen.append):
        diagnosis.compare(recording, "coulomb-viscous")
    parts = [one.done for one in seen if one.stage == "fitting coulomb-viscous"]
    assert parts == [0, 1, 2]


def stopped_at(stage: str, token: Token) -> Callable[[Progress], None]:
    def watch(found: Progress) -> None:
        if found.stage.startswith(stage):
            token.cancel()

    return watch


def test_a_diagnosis_that_is_stopped_has_the_fitted_model(recording: Recording) -> None:
    token, seen = Token(), list[Progress]()

    def watch(found: Progress) -> None:
        seen.append(found)
        if found.done == 3:
            token.cancel()

    with pytest.raises(Cancelled) as stop:
        diagnose(recording, "coulomb-viscous", 2.0, progress=watch, token=token)
    assert isinstance(stop.value.partial, Comparison)
    assert seen[0].stage == "fitting coulomb-viscous"
    assert seen[-1].stage == "testing effects on coulomb-viscous"
    assert 3 <= seen[-1].done <= 4 < seen[-1].total
    tested = [found.done for found in seen if found.stage == seen[-1].stage]
    assert tested == [*range(len(tested))]
    assert [found.done for found in seen[1 : -len(tested)]] == [0, 1, 2], "and before, the parts of the fit"


def test_a_ladder_that_is_stopped_has_its_rungs_and_says_so(recording: Recording) -> None:
    token = Token()
    watch = stopped_at("testing effects on coulomb-viscous+cogging", token)
    with pytest.raises(Cancelled) as stop:
        improve(recording, "coulomb-viscous", 2.0, progress=watch, token=token)
    ladder = stop.value.partial
    assert isinstance(ladder, Ladder)
    assert ladder.partial
    assert [rung.added for rung in ladder.rungs] == ["", "cogging"]
    data = document(ladder.first, ladder)
    assert data.partial
    assert data.remaining is None
    found = answer(data)
    assert found.sentence == "Stopped before the end, so far: The model coulomb-viscous lacks one effect: cogging."
    assert found.remains.startswith("not looked at yet")
    assert "improve" in found.command


def test_ctrl_c_shows_and_writes_what_was_found(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*given: object, progress: Callable[[Progress], None], **more: object) -> Ladder:
        def watch(found: Progress) -> None:
            progress(found)
            if found.stage == "testing effects on coulomb-viscous+cogging":
                raise KeyboardInterrupt

        return improve(*given, progress=watch, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(diagnosis, "improve", interrupted)
    data, _ = write(recording, tmp_path / "joint.csv")
    code = run(["improve", str(data), "--model", "coulomb-viscous", "--inertia", "2", "--out", str(tmp_path / "out")])
    shown = capsys.readouterr()
    assert code == 130
    assert "Stopped before the end" in shown.out
    assert "partial" in shown.err
    assert DiagnosisDocument.read(tmp_path / "out" / "diagnosis.json", "").partial


def run(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as end:
        main(arguments)
    return int(end.value.code or 0)
