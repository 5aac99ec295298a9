"""The simulator of whole recordings against other implementations, closed solutions and its invariances."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError
from fricmodels.expressions import Expression, sin
from fricmodels.loop import Loop
from fricmodels.model import Model
from fricmodels.motion import Controller, Simulator, motion_errors, state_at
from fricmodels.parameter import Parameter
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.term import Parameters, Signals
from fricmodels.weakform.prepared import ready

J, K_V, K_C, K_T, R = 0.01, 0.05, 0.03, 0.2, 2.0
VALUES = {"J": J, "K_v": K_V, "K_c": K_C}


def drive(name: str = "coulomb-viscous") -> Drive:
    return Drive(Model.parse(name))


def torque_at(time: np.ndarray) -> np.ndarray:
    return 0.15 * np.sin(3.0 * time) + 0.08 * np.sin(7.1 * time + 1.0)


def recorded(values: dict[str, float] | None = None, count: int = 3000, **given: Any) -> Recording:
    """A recording that the ordinary simulation made, with its position."""
    time = np.arange(count) * 1e-3
    made = simulate(drive(), values or VALUES, time, torque_at(time), with_position=True, **given)
    return replace(made, provenance={})


def looped(controller: Controller, count: int = 3000) -> tuple[Recording, Any]:
    """A closed loop by an integrator that knows nothing of this package, without dry friction."""
    time = np.arange(count) * 1e-3

    def rates(t: float, x: np.ndarray) -> list[float]:
        error, integral = np.sin(4.0 * t) - x[0], 0.0
        if controller.speed_gain is None:
            output = controller.gain * error - controller.derivative * x[1]
        else:
            proportional = controller.speed_gain * (controller.gain * error - x[1])
            output = proportional + (x[2] if controller.integral_time else 0.0)
            integral = proportional / controller.integral_time if controller.integral_time else 0.0
        torque = output if controller.motor is None else K_T / R * (output - K_T * x[1])
        return [x[1], (torque - K_V * x[1]) / J, integral]

    found = solve_ivp(rates, (0.0, time[-1]), [0.0, 0.0, 0.0], t_eval=time, rtol=1e-10, atol=1e-12)
    channels = {"time": time, "torque": np.zeros(count), "position": found.y[0], "velocity": found.y[1]}
    channels["other.reference"] = np.sin(4.0 * time)
    return Recording("looped", Motion.ROTARY, channels, np.zeros(count, dtype=np.int64)), found


MOTOR = {"torque_constant": K_T, "resistance": R}


@pytest.mark.parametrize(
    "settings",
    [
        {"kind": "position-gain", "gain": 2.0},
        {"kind": "pd", "gain": 3.0, "derivative": 0.2},
        {"kind": "pd", "gain": 30.0, "derivative": 2.0, "motor": MOTOR},
        {"kind": "speed-loop", "gain": 10.0, "speed_gain": 0.3},
        {"kind": "speed-loop", "gain": 10.0, "speed_gain": 3.0, "integral_time": 0.1, "motor": MOTOR},
    ],
    ids=lambda settings: f"{settings['kind']}{'-motor' * ('motor' in settings)}",
)
def test_controllers_are_what_an_independent_integrator_says(settings: dict[str, Any]) -> None:
    controller = Controller.model_validate({"reference": "reference", **settings})
    recording, _ = looped(controller)
    simulator = Simulator(drive(), recording, loop=controller.loop(), initial_samples=1)
    position, velocity = simulator({"J": J, "K_v": K_V, "K_c": 0.0})
    assert np.max(np.abs(position - recording["position"])) < 2e-5
    assert np.max(np.abs(velocity - recording.velocity)) < 1e-3


def test_coulomb_friction_under_a_constant_torque_has_its_closed_solution() -> None:
    """Up to a speed, down to a stop, and at rest for as long as the torque is less than the friction."""
    time = np.arange(2001) * 1e-3
    torque = np.where(time < 0.5, 0.2, 0.0)
    channels = {"time": time, "torque": torque, "position": np.zeros(2001), "velocity": np.zeros(2001)}
    recording = Recording("steps", Motion.ROTARY, channels, np.zeros(2001, dtype=np.int64))
    simulator = Simulator(drive(), recording, between_samples="held", initial_samples=1)
    position, velocity = simulator({"J": J, "K_v": 0.0, "K_c": K_C})
    peak = (0.2 - K_C) / J * 0.5
    stop = 0.5 + peak * J / K_C
    assert velocity[500] == pytest.approx(peak, rel=1e-9)
    assert np.all(velocity[time > stop + 1e-3] == 0.0) or stop > 2.0
    distance = peak * 0.5 / 2 + peak * min(1.5, peak * J / K_C) - K_C / J * min(1.5, peak * J / K_C) ** 2 / 2
    assert position[-1] == pytest.approx(distance, rel=1e-9)


def test_stick_slip_is_that_of_the_ordinary_simulation() -> None:
    recording = recorded()
    position, velocity = Simulator(drive(), recording, initial_samples=1)(VALUES)
    assert np.max(np.abs(velocity - recording.velocity)) < 1e-12
    assert np.max(np.abs(position - recording["position"])) < 1e-12
    assert np.any(recording.velocity == 0.0), "the motion has rests"


def test_a_controller_with_recorded_output_is_the_open_loop() -> None:
    """What a loop says is what it would be had it been recorded."""

    class Recorded(Loop):
        channels = ("other.torque",)

        def motor_torque(self, s: Signals, p: Parameters) -> Expression:
            return s["other.torque"]

    recording = recorded()
    with_channel = recording.with_channels(**{"other.torque": recording.torque})
    open_loop = Simulator(drive(), recording)(VALUES)
    closed = Simulator(drive(), with_channel, loop=Recorded())(VALUES)
    assert np.max(np.abs(open_loop[0] - closed[0])) < 1e-12


def test_a_load_of_the_position_reaches_law_and_motion() -> None:
    """Gravity as the load of a loop is gravity as an effect, and a load that the law uses is that load."""

    class Pendulum(Loop):
        load = True
        channels = ("other.torque",)
        weight = Parameter("weight", unit="N m", initial=0.1)

        def motor_torque(self, s: Signals, p: Parameters) -> Expression:
            return s["other.torque"]

        def load_torque(self, s: Signals, p: Parameters) -> Expression:
            return p.weight * sin(s.position)

    recording = recorded()
    recording = recording.with_channels(**{"other.torque": recording.torque})
    loop = Pendulum(weight=0.1)
    simulator = Simulator(drive(), recording, loop=loop)
    assert simulator.keys == ("J", "K_v", "K_c"), "a fixed parameter is not found"
    closed = simulator(VALUES)[0]
    gravity = {**VALUES, "gravity.a": 0.0, "gravity.b": 0.1}
    effect = Simulator(drive("coulomb-viscous+gravity"), recording)(gravity)[0]
    assert np.max(np.abs(closed - effect)) < 1e-9
    loaded = Simulator(drive("coulomb-viscous+load-friction"), recording, loop=loop)
    assert np.max(np.abs(loaded({**VALUES, "load-friction.mu": 0.0})[0] - closed)) < 1e-12
    assert np.max(np.abs(loaded({**VALUES, "load-friction.mu": 0.3})[0] - closed)) > 1e-3


def test_windows_forget_and_runs_begin_anew() -> None:
    """A model that is wrong drifts in one go, and less in windows; each window starts from the measured state."""
    recording = recorded()
    wrong = {**VALUES, "K_c": 0.8 * K_C}
    free = motion_errors(Simulator(drive(), recording), wrong).position
    windows = [motion_errors(Simulator(drive(), recording, horizon=n), wrong).position for n in (1000, 200, 50)]
    assert free > windows[0] > windows[1] > windows[2]
    simulator = Simulator(drive(), recording, horizon=50)
    assert motion_errors(simulator, VALUES).position < 1e-4
    assert np.count_nonzero(simulator.scored) == len(recording) - 1
    parts = replace(recording, run=np.repeat([0, 1, 2], 1000))
    assert np.count_nonzero(Simulator(drive(), parts).scored) == len(recording) - 3


def test_finer_steps_come_nearer_to_the_motion() -> None:
    """A pendulum that swings in 0.4 s, logged at 25 Hz: one step a sample is coarse; the error falls with the steps."""
    swinging = drive("coulomb-viscous+gravity")
    values = {**VALUES, "gravity.a": 0.0, "gravity.b": 2.5}
    time = np.arange(0, 8.0, 0.04)
    log = simulate(swinging, values, time, 8.0 * torque_at(time), with_position=True)
    ways = [Simulator(swinging, replace(log, provenance={}), substeps=n)(values)[0] for n in (1, 4, 16, 256)]
    off = [float(np.nanmax(np.abs(way - ways[-1]))) for way in ways[:-1]]
    assert off[0] > 3.0 * off[1] > 9.0 * off[2] > 0.0
    with pytest.raises(InputError, match="substeps must be at least 1"):
        Simulator(drive(), log, substeps=0)


def test_memory_is_carried_into_a_window() -> None:
    """A contact that is bent when a window begins is bent as it is along the measured motion."""
    name = "coulomb-viscous+presliding"
    values = {**VALUES, "presliding.F_1": 0.02, "presliding.F_2": 0.02, "presliding.D": 0.0, "presliding.x_s": 0.02}
    time = np.arange(3000) * 1e-3
    recording = simulate(Drive(Model.parse(name)), values, time, torque_at(time), with_position=True)
    errors = motion_errors(Simulator(Drive(Model.parse(name)), recording, horizon=100), values)
    assert errors.position < 2e-4 * float(np.std(recording["position"]))


def test_units_direction_and_start_of_the_clock_do_not_matter() -> None:
    recording = recorded()
    own = Simulator(drive(), recording)(VALUES)[0]
    later = recording.with_channels(derived=False, time=recording.time + 1234.5)
    assert np.max(np.abs(Simulator(drive(), later)(VALUES)[0] - own)) < 1e-6
    flipped = recording.with_channels(
        derived=False, torque=-recording.torque, velocity=-recording.velocity, position=-recording["position"]
    )
    assert np.max(np.abs(Simulator(drive(), flipped)(VALUES)[0] + own)) < 1e-12
    heavier = recording.with_channels(derived=False, torque=1000 * recording.torque)
    scaled = {key: 1000 * value for key, value in VALUES.items()}
    assert np.max(np.abs(Simulator(drive(), heavier)(scaled)[0] - own)) < 1e-9


def test_the_first_state_is_that_of_the_samples_about_it() -> None:
    time = np.arange(200) * 1e-3
    position = 0.3 + 2.0 * time + 1.5 * time**2
    random = np.random.default_rng(1)
    channels = {"time": time, "torque": time, "position": position + 1e-6 * random.standard_normal(200)}
    channels["velocity"] = 2.0 + 3.0 * time
    run = Recording("r", Motion.ROTARY, channels, np.zeros(200, dtype=np.int64), derived=frozenset({"velocity"}))
    for index in (0, 100, 199):
        state = state_at(run, index)
        expected = (position[index], 2.0 + 3.0 * time[index])
        assert (state.position, state.velocity) == pytest.approx(expected, abs=1e-3)
        away = np.array([state.position, state.velocity]) - expected
        assert np.all(np.abs(away) < 4 * np.sqrt(np.diag(state.covariance)))


def test_what_cannot_be_simulated_is_said() -> None:
    recording = recorded()
    with pytest.raises(InputError, match="horizon"):
        Simulator(drive(), recording, horizon=0)
    with pytest.raises(InputError, match=r"other\.reference"):
        Simulator(drive(), recording, loop=Controller(kind="pd", reference="reference", gain=1.0).loop())
    with pytest.raises(InputError, match="'K_c'"):
        Simulator(drive(), recording)({"J": J, "K_v": K_V})
    with pytest.raises(InputError, match="inertia"):
        Simulator(drive(), recording)({**VALUES, "J": -1.0})
    still = ready(recording)
    assert motion_errors(Simulator(drive(), still), VALUES).horizon is None
    falling = {**VALUES, "K_v": -1e4}
    assert not np.isfinite(motion_errors(Simulator(drive(), recording), falling).position)


def test_a_delay_shifts_the_motion_as_the_ordinary_simulation_has_it() -> None:
    """Also where the delay changes from one call to the next."""
    recording, model = recorded(), drive("coulomb-viscous+sensor-delay")
    simulator = Simulator(model, recording)
    for delay in (0.004, -0.003, 0.0, 0.004):
        values = {**VALUES, "sensor-delay.T": delay}
        begin = simulator.starts[0][1].velocity
        expected = simulate(model, values, recording.time, recording.torque, initial_velocity=begin)
        np.testing.assert_allclose(simulator(values)[1], expected.velocity, rtol=0, atol=1e-12)
