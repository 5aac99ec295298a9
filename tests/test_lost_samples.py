"""Samples that a log does not have, between others: they are counted, bridged, and a held torque is renewed in them."""

from __future__ import annotations

import numpy as np
import pytest

from fricmodels import compare
from fricmodels.dimension import Motion
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.signals.lost_samples import as_held, lost_samples
from fricmodels.signals.segments import stretches
from fricmodels.weakform.stretches import cells_of

INTERVAL = 0.01
VISCOUS, COULOMB = 0.6, 1.5


def clock(*after: int, count: int = 60, runs: bool = False) -> Recording:
    """Return a torque that rises steadily, without the samples that come 1, 2, … after each sixth one."""
    keep = np.ones(count, dtype=bool)
    for k, lost in enumerate(after):
        keep[7 + 6 * k : 7 + 6 * k + lost] = False
    index = np.flatnonzero(keep)
    run = (index >= count // 2).astype(np.int64) if runs else np.zeros(len(index), dtype=np.int64)
    return Recording("made", Motion.ROTARY, {"time": INTERVAL * index, "torque": 2.0 * index}, run)


def driven(held: bool, *, seed: int = 5, samples: int = 6000) -> Recording:
    """Return a drive on one slow sine of 100 samples a second, next to no noise."""
    rig = {
        "inertia": 0.05,
        "friction": {"viscous": VISCOUS, "coulomb": COULOMB},
        "excitation": {"kind": "sine", "amplitude": 4.0, "frequency": 0.8},
        "rate": 1 / INTERVAL,
        "samples": samples,
        "hold": held,
        "seed": seed,
    }
    return Rig.model_validate(rig).simulate()


def without(recording: Recording, lost: int, every: int = 40) -> Recording:
    """Return a recording without some samples in every so many."""
    return recording.select(np.arange(len(recording)) % every >= lost)


def test_lost_samples_are_counted_where_they_are() -> None:
    recording = clock(1, 3, 4)
    lost = lost_samples(recording)
    assert lost[lost > 0].tolist() == [1.0, 3.0, 4.0]
    np.testing.assert_allclose(np.diff(recording.time), INTERVAL * (lost + 1.0))


def test_a_gap_lacks_no_samples_that_can_be_told() -> None:
    assert not lost_samples(clock(5)).any()
    assert not lost_samples(clock(0, 0, 0, 0, 0, runs=True)).any()


def test_where_stamps_wander_no_samples_are_said_to_be_lost() -> None:
    steps = INTERVAL * np.random.default_rng(0).uniform(0.5, 2.2, 200)
    time = np.cumsum(steps)
    recording = Recording("made", Motion.ROTARY, {"time": time, "torque": time}, np.zeros(200, dtype=np.int64))
    assert not lost_samples(recording).any()


def test_a_held_torque_is_renewed_where_samples_are_lost() -> None:
    """Of a torque that rises steadily and is held from sample to sample the mean of any interval is known."""
    recording = clock(1, 3, 4)
    held = as_held(recording).torque
    first = np.rint(recording.time / INTERVAL).astype(int)
    for k in range(len(recording) - 1):
        assert held[k] == pytest.approx(2.0 * np.mean(np.arange(first[k], first[k + 1])))
    assert as_held(clock()) is not None
    np.testing.assert_array_equal(as_held(clock()).torque, clock().torque)


@pytest.mark.parametrize("lost", [2, 3, 4])
def test_the_equations_bridge_what_the_signals_bridge(lost: int) -> None:
    recording = clock(lost, lost)
    assert stretches(recording.time, recording.run) == [slice(0, len(recording))]
    assert cells_of(recording)[1].all()


def test_four_lost_samples_are_no_gap_however_stamps_are_rounded() -> None:
    for rounding in (-1e-9, 0.0, 1e-9):
        recording = clock(4, 4)
        time = recording.time + rounding * np.sign(np.sin(np.arange(len(recording))))
        assert stretches(time, recording.run) == [slice(0, len(recording))]
    assert len(stretches(clock(5).time)) == 2


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("lost", [2, 4])
def test_the_friction_is_as_without_lost_samples(held: bool, lost: int) -> None:
    """A held torque that was taken for held over all of each long interval made both 0.6 % wrong."""
    whole = driven(held)
    full, rest = (compare(one, "coulomb-viscous", 0.05).estimate.parameters for one in (whole, without(whole, lost)))
    for key in ("K_v", "K_c"):
        assert rest[key] == pytest.approx(full[key], rel=4e-3)


def test_a_log_in_pieces_says_that_it_is_and_not_that_it_moves_too_little() -> None:
    with pytest.raises(InputError) as refused:
        compare(without(driven(held=False), 6, every=15), "coulomb-viscous", 0.05)
    assert "gaps cut most of it into pieces of 9 samples or less" in str(refused.value)
    assert "record without gaps" in str(refused.value)
    assert "more strokes" not in str(refused.value)
