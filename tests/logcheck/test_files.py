"""Several files read together: what is the matter with one of them is said of it, and what stops it alone stops."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.logcheck import Severity, checked, findings
from fricmodels.readers.together import together
from fricmodels.recording import Recording

INERTIA = 0.02


def day(number: int, sign: float = 1.0, speed: float = 1.0, spike: float = 0.0) -> Recording:
    """Return one file of a drive; of a turned sign of its torque, its velocity in another unit, or with a spike."""
    rng, time = np.random.default_rng(number), 2e-3 * np.arange(6000)
    frequencies, sizes = np.array([2.1, 5.3, 9.7]) * (1.0 + 0.1 * number), np.array([3.0, 2.0, 1.0])
    phase = np.outer(time, frequencies)
    velocity, position = np.cos(phase) @ sizes, np.sin(phase) @ (sizes / frequencies)
    torque = INERTIA * (-np.sin(phase) @ (sizes * frequencies)) + 0.05 * velocity + 0.3 * np.sign(velocity)
    torque = sign * torque + 0.002 * rng.standard_normal(len(time))
    torque[500] += spike
    channels = {
        "time": time,
        "torque": torque,
        "velocity": speed * (velocity + 0.002 * rng.standard_normal(len(time))),
        "position": position + 1e-4 * rng.standard_normal(len(time)),
    }
    columns = {channel: f"{channel}={channel}" for channel in channels}
    provenance = {"source": f"logs/day{number}.csv", "columns": columns}
    return Recording(f"day{number}", Motion.ROTARY, channels, np.zeros(len(time), np.int64), provenance=provenance)


@pytest.mark.parametrize(("wrong", "kind"), [({"sign": -1.0}, "torque-sign"), ({"speed": -1.0}, "velocity-sign")])
def test_a_file_that_would_stop_alone_stops_all(wrong: dict[str, float], kind: str) -> None:
    whole = together([day(1), day(2, **wrong), day(3)])
    stops = [one for one in findings(whole, INERTIA) if one.severity is Severity.STOP]
    assert [one.kind for one in stops] == [kind]
    assert stops[0].text.startswith("in day2.csv, the ")
    with pytest.raises(InputError, match=r"in day2\.csv, the .* leave it out"):
        checked(whole, INERTIA)


def test_what_is_only_worth_a_warning_is_said_of_its_file() -> None:
    found = [one for one in findings(together([day(1), day(2), day(3, spike=30.0)])) if one.severity is Severity.WARN]
    assert [one.kind for one in found] == ["spike"]
    assert found[0].text.startswith("in day3.csv, one sample")


def test_what_all_have_is_said_of_the_whole() -> None:
    turned = [day(number, sign=-1.0) for number in (1, 2, 3)]
    stops = [one for one in findings(together(turned), INERTIA) if one.severity is Severity.STOP]
    assert [(one.kind, one.text.startswith("the torque")) for one in stops] == [("torque-sign", True)]


def test_good_files_are_not_accused() -> None:
    assert [one.kind for one in findings(together([day(1), day(2), day(3)]), INERTIA)] == []


def test_files_of_one_name_are_told_apart_by_their_folders() -> None:
    first, second = (replace(day(n, **how), name="day") for n, how in ((1, {}), (2, {"sign": -1.0})))
    first, second = (
        replace(one, provenance={**one.provenance, "source": f"{folder}/day.csv"})
        for one, folder in ((first, "monday"), (second, "tuesday"))
    )
    stops = [one for one in findings(together([first, second]), INERTIA) if one.severity is Severity.STOP]
    assert [one.text.split(",")[0] for one in stops] == ["in tuesday/day.csv"]
