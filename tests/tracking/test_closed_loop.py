"""The controlled drive: against a slow implementation, its limits, invariances, and rest."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.drive import Drive
from fricmodels.rig import Rig
from fricmodels.rig.closed_loop import Control
from fricmodels.tracking import Experiment, Settings

Joint = Callable[..., Rig]
LAW = {"K_v": 1.0, "K_c": 8.0}
PERFECT = {"delay": 0.0, "encoder_step": 0.0, "bandwidth": 8.0}
WIDTH = 1e-6


def slow_loop(
    control: Control,
    reference: NDArray[np.float64],
    feedforward: NDArray[np.float64],
    compensated: float,
    turn: float,
    substeps: int = 64,
) -> NDArray[np.float64]:
    """Follow a reference with a body of inertia 1 under Coulomb and viscous friction, in plain Python.

    Between two zeros of the velocity the equation is linear, J ω' = u − s F − K ω, and has a closed solution; a
    compensation F·tanh(v/turn) + K·v of the measured velocity is multiplied by ``compensated``.
    """
    inertia, viscous, coulomb = 1.0, LAW["K_v"], LAW["K_c"]
    h = control.interval / substeps
    late = round(control.delay / control.interval * substeps)
    fade = math.exp(-viscous / inertia * h)
    q, w, rate, speed = float(reference[0]), 0.0, 0.0, 0.0
    step = control.encoder_step
    waiting = [float(feedforward[0])] * late
    found, before, error_before = [], None, None
    for wanted, ahead in zip(reference, feedforward, strict=True):
        found.append(q)
        counted = math.floor(q / step + 0.5) * step if step else q
        error = wanted - counted
        if before is not None:
            speed += control.smoothing * ((counted - before) / control.interval - speed)
            rate += control.smoothing * ((error - error_before) / control.interval - rate)
        before, error_before = counted, error
        torque = ahead + control.proportional * error + control.derivative * rate
        torque += compensated * (coulomb * math.tanh(speed / turn) + viscous * speed)
        waiting += [torque] * substeps
        for _ in range(substeps):
            u = waiting.pop(0)
            if w == 0.0 and abs(u) <= coulomb:
                continue
            side = math.copysign(1.0, w if w != 0.0 else u)
            final = (u - side * coulomb) / viscous
            after = final + (w - final) * fade
            if after * side < 0.0:
                stop = inertia / viscous * math.log((w - final) / -final)
                q += final * stop + (w - final) * inertia / viscous * (1 - math.exp(-viscous / inertia * stop))
                w = 0.0
                continue
            q += final * h + (w - final) * inertia / viscous * (1 - fade)
            w = after
    return np.array(found)


@pytest.mark.parametrize("at", ["reference", "measured"])
def test_against_a_slow_implementation(joint: Joint, drive: Drive, at: str) -> None:
    """Delay of a sample and a half, an encoder, friction: the same motion to a thousandth of the error.

    The loop through the measured velocity has a perfect encoder: a count that comes a step earlier changes the torque.
    """
    step = 1e-4 if at == "reference" else 0.0
    how = {"delay": 1.5, "encoder_step": step, "bandwidth": 5.0, "motion": "trapezoid", "at": at}
    experiment = Experiment(joint(substeps=64), Settings.model_validate({**how, "at_rest": "smooth", "turn": 0.05}))
    count = 4000
    compensator = experiment.compensator(drive, LAW, WIDTH)
    run = experiment.run(compensator)
    ahead, turn = experiment.base[:count], 0.05 * experiment.reference.peak
    if at == "reference":
        rows = compensator.rows(0.001, experiment.base, experiment._signals["velocity"], experiment._signals)
        ahead = ahead + compensator.along(rows)[:count]
    expected = slow_loop(experiment.control, run.wanted[:count], ahead, float(at == "measured"), turn)
    error = run.wanted[:count] - expected
    assert np.ptp(expected) > 0.1
    np.testing.assert_allclose(run.driven.position[:count], expected, atol=2e-3 * np.max(np.abs(error)) + 1e-9)


def test_with_the_truth_nothing_but_delay_and_encoder_is_left(joint: Joint, drive: Drive) -> None:
    perfect = Experiment(joint(), Settings.model_validate(PERFECT))
    without = perfect.run(None).figures
    for run in (perfect.run_true(), perfect.run(perfect.compensator(drive, LAW, WIDTH))):
        assert run.figures.rms_error < 2e-3 * without.rms_error
        assert run.figures.largest_error < 2e-2 * without.largest_error
    for step in (1e-3, 1e-4):
        counted = Experiment(joint(), Settings.model_validate({**PERFECT, "delay": 1.0, "encoder_step": step}))
        assert counted.run(counted.compensator(drive, LAW, WIDTH)).figures.rms_error < 1.5 * step
        assert counted.run_true().figures.rms_error < 1.5 * step
    assert without.rms_error > 2e-3


def test_a_feed_forward_that_is_known_beforehand_takes_the_delay_out(joint: Joint, drive: Drive) -> None:
    errors, without = [], []
    for delay in (0.0, 2.0, 5.0):
        late = Experiment(joint(), Settings.model_validate({**PERFECT, "delay": delay, "bandwidth": 3.0}))
        errors.append(late.run(late.compensator(drive, LAW, WIDTH)).figures.rms_error)
        without.append(late.run(None).figures.rms_error)
    assert max(errors) < 2e-3 * min(without)
    assert np.ptp(errors) < 0.05 * max(errors)


@pytest.mark.parametrize("at", ["reference", "measured"])
def test_a_model_without_torque_is_no_compensation(joint: Joint, drive: Drive, at: str) -> None:
    """To the last bit."""
    experiment = Experiment(joint(samples=1000), Settings(bandwidth=8.0, at=at, motion="trapezoid"))  # type: ignore[arg-type]
    nothing = experiment.run(experiment.compensator(drive, {"K_v": 0.0, "K_c": 0.0}, WIDTH))
    none = experiment.run(None)
    np.testing.assert_array_equal(nothing.driven.position, none.driven.position)
    np.testing.assert_array_equal(nothing.driven.torque, none.driven.torque)
    assert nothing.figures == none.figures


def test_a_heavier_drive_of_as_much_more_friction_moves_the_same(joint: Joint, drive: Drive) -> None:
    """Mass in other units: torques are multiplied, motions are not."""
    light, heavy = joint(), joint(inertia=7.0, friction={"viscous": 7.0, "coulomb": 56.0})
    first, second = (Experiment(rig, Settings(bandwidth=8.0)) for rig in (light, heavy))
    one = first.run(first.compensator(drive, {"K_v": 1.2, "K_c": 7.0}, WIDTH))
    other = second.run(second.compensator(Drive(drive.model, 7.0), {"K_v": 8.4, "K_c": 49.0}, WIDTH))
    assert first.encoder_step == second.encoder_step
    np.testing.assert_allclose(other.driven.position, one.driven.position, atol=1e-3 * one.figures.largest_error)
    assert other.figures.rms_error == pytest.approx(one.figures.rms_error, rel=1e-4)
    assert other.figures.rms_torque == pytest.approx(7 * one.figures.rms_torque, rel=1e-4)


def test_lengths_in_other_units(joint: Joint, drive: Drive) -> None:
    """A linear axis a thousand times as long: every length is, and the shares stay."""
    errors = []
    for scale in (1.0, 1e3):
        excitation = {"kind": "tracking", "velocity": scale, "frequency": 0.5, "lines": 3, "bandwidth": 8.0}
        law = {"viscous": 1.0, "coulomb": 8.0 * scale}
        rig = joint(motion="linear", friction=law, excitation=excitation)
        experiment = Experiment(rig, Settings(bandwidth=8.0, encoder_step=1e-5 * scale))
        model = Drive(drive.model, 1.0, rig.motion)
        run = experiment.run(experiment.compensator(model, {"K_v": 1.2, "K_c": 7.0 * scale}, WIDTH * scale))
        errors.append(run.figures.rms_error / scale)
    assert errors[1] == pytest.approx(errors[0], rel=1e-3)


def test_forward_is_as_backward(joint: Joint, drive: Drive) -> None:
    experiment = Experiment(joint(), Settings.model_validate(PERFECT))
    compensator = experiment.compensator(drive, {"K_v": 1.2, "K_c": 7.0}, WIDTH)
    signals = experiment._signals
    forth = compensator.along(compensator.rows(0.001, experiment.base, signals["velocity"], signals))
    mirrored = {name: -values if name in ("position", "velocity", "acceleration") else values
                for name, values in signals.items()}  # fmt: skip
    back = compensator.along(compensator.rows(0.001, -experiment.base, -signals["velocity"], mirrored))
    np.testing.assert_array_equal(back, -forth)


@pytest.mark.parametrize("at_rest", ["none", "reference", "smooth"])
def test_too_much_compensation_in_the_loop_swings_on_at_rest(joint: Joint, drive: Drive, at_rest: str) -> None:
    """Of what is measured, more than twice the friction is too much: the drive is thrown back harder than it holds."""
    how = {"at": "measured", "at_rest": at_rest, "delay": 4.0, "bandwidth": 5.0, "motion": "trapezoid"}
    experiment = Experiment(joint(), Settings.model_validate(how))
    right = experiment.compensator(drive, LAW, WIDTH)
    for factor, swings in ((1.0, False), (1.9, False), (2.5, True)):
        found = experiment.run(right.times(factor)).figures
        assert found.limit_cycle is swings, factor
        assert (found.rest_counts > 100) is swings


def test_along_the_reference_nothing_swings(joint: Joint, drive: Drive) -> None:
    experiment = Experiment(joint(), Settings(delay=4.0, bandwidth=5.0, motion="trapezoid"))
    found = experiment.run(experiment.compensator(drive, LAW, WIDTH).times(4.0)).figures
    assert not found.limit_cycle
    assert found.rest_counts == 0.0
