"""Internal states along a motion: closed solutions, SciPy's integrator, stiff limits, units and runs."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.effects import Presliding
from fricmodels.errors import InputError
from fricmodels.expressions import maximum, minimum, sign, where
from fricmodels.laws import CoulombViscous
from fricmodels.memory import Memory, MemoryStep
from fricmodels.model import Model
from fricmodels.parameter import Parameter, State
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.term import SIGNALS, Effect

Array = NDArray[np.float64]


def states(effect: str, parameters: dict[str, float], time: Array, **signals: Array) -> tuple[Array, ...]:
    """Integrate an effect's states; what is not given is 1, for it does not shape them."""
    model = Model.parse(f"coulomb-viscous+{effect}")
    given = {name: signals.get(name, np.zeros(len(time))) for name in SIGNALS}
    run = np.zeros(len(time), dtype=np.int64)
    values = [parameters.get(p.declared.symbol, 1.0) for p in model.parameters]
    return Memory(model, given, time, run, 1e-9)(values)


def test_presliding_after_a_reversal_is_the_closed_form() -> None:
    """z = 1 − 2 exp(−Δq/x_s), from full deflection the other way."""
    x_s = 0.01
    time = np.linspace(0, 2, 20_001)
    velocity = np.where(time < 1, -0.1, 0.1)
    (z,) = states("presliding", {"x_s": x_s}, time, velocity=velocity)
    assert z[time < 1][-1] == pytest.approx(-1.0, abs=1e-4)
    turned = int(np.argmax(time >= 1))
    q = 0.1 * (time[turned:] - time[turned])
    exact = 1 - (1 - z[turned]) * np.exp(-q / x_s)
    assert np.max(np.abs(z[turned:] - exact)) < 1e-6
    assert z[turned] == pytest.approx(-1.0, abs=2e-3)


def test_the_presliding_loop_has_its_width_in_position_not_in_time() -> None:
    x_s = 0.02
    loops = []
    for speed in (0.1, 1.0, 10.0):
        time = np.linspace(0, 1.0 / speed, 5001)
        (z,) = states("presliding", {"x_s": x_s}, time, velocity=np.full(5001, speed))
        loops.append(np.interp([0.01, 0.02, 0.05], speed * time, z))
    np.testing.assert_allclose(loops[1:], [loops[0]] * 2, rtol=1e-9)
    np.testing.assert_allclose(loops[0], 1 - np.exp(-np.array([0.5, 1.0, 2.5])), rtol=1e-5)


@pytest.mark.parametrize(
    ("effect", "parameters"), [("presliding", {"x_s": 0.03}), ("rising-stiction", {"T": 0.3, "x_s": 0.05})]
)
def test_a_sine_agrees_with_scipys_integrator(effect: str, parameters: dict[str, float]) -> None:
    time = np.linspace(0, 2, 40_001)

    def velocity(t: Array | float) -> Array:
        return np.asarray(np.sin(2 * np.pi * np.asarray(t)))

    def slope(t: float, z: Array) -> Array:
        omega = float(velocity(t))
        if effect == "presliding":
            return np.array((omega - abs(omega) * z) / parameters["x_s"])
        return np.array((1 - z) / parameters["T"] - abs(omega) * z / parameters["x_s"])

    (z,) = states(effect, parameters, time, velocity=velocity(time))
    reference = solve_ivp(slope, (0, 2), [0.0], t_eval=time, rtol=1e-10, atol=1e-12, max_step=1e-3)
    assert np.max(np.abs(z - reference.y[0])) < 2e-6


def test_halving_the_step_quarters_the_error() -> None:
    errors = []
    for samples in (201, 401, 801):
        time = np.linspace(0, 0.4, samples)
        (z,) = states("presliding", {"x_s": 0.05}, time, velocity=np.cos(2 * time))
        exact = 1 - np.exp(-np.sin(2 * time) / 2 / 0.05)
        errors.append(np.max(np.abs(z - exact)))
    ratios = np.array(errors[:-1]) / errors[1:]
    assert np.all((ratios > 3.5) & (ratios < 4.6))


def followed(time: Array, omega: float, T: float, r: float) -> Array:
    """Return what follows 2 + sin ωt with a delay of (1 − r) T and then a lag of the first order of r T."""
    transfer = np.exp(-1j * omega * (1 - r) * T) / (1 + 1j * omega * r * T)
    return 2 + np.imag(transfer * np.exp(1j * omega * time))


@pytest.mark.parametrize("r", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("omega", [2.0, 10.0, 20.0])
def test_lagging_friction_is_that_of_the_speed_that_is_followed(omega: float, r: float) -> None:
    """F_s exp(−u/ω_s) + K (u − |ω|), against the direction of motion."""
    T, time = 0.05, np.linspace(0, 4, 40_001)
    speed = 2 + np.sin(omega * time)
    channels = {"time": time, "torque": np.zeros(40_001), "velocity": -speed}
    recording = Recording("made", Motion.ROTARY, channels, np.zeros(40_001, dtype=np.int64))
    drive = Drive(Model.parse("coulomb-viscous+frictional-lag"), 1.0)
    lag = {f"frictional-lag.{key}": x for key, x in {"F_s": 2.0, "K": 3.0, "omega_s": 1.5, "T": T, "r": r}.items()}
    torque = drive.friction(recording, {"K_v": 0.0, "K_c": 0.0, **lag})
    late, u = time > 1, followed(time, omega, T, r)
    expected = -(2 * np.exp(-u / 1.5) + 3 * (u - speed))
    assert np.max(np.abs(torque - expected)[late]) < 1e-5
    if r == 0:  # what was before the record is as it was at its beginning
        early = time < T
        np.testing.assert_allclose(torque[early], -(2 * np.exp(-2 / 1.5) + 3 * (2 - speed))[early], atol=1e-9)


@pytest.mark.parametrize("r", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("omega", [2.0, *(pytest.param(omega, marks=pytest.mark.long) for omega in (10.0, 20.0))])
def test_the_rates_of_lagging_friction_are_those_of_its_lag(omega: float, r: float) -> None:
    """What a filter follows is what a recording shows, up to the phase error of the delay D, (ωD)⁵/720, and what is
    left of a part that is nothing, T/1000."""
    T = 0.05
    model = Model.parse("coulomb-viscous+frictional-lag")
    rates = model.expression()
    import casadi

    slope = casadi.Function("rates", [rates.states, rates.signals["velocity"], rates.parameters], [rates.rates])
    values = [0.0, 0.0, 0.0, 1.0, 1.0, T, r]

    def change(t: float, z: Array) -> Array:
        return np.asarray(slope(z, 2 + np.sin(omega * t), values)).ravel()

    time = np.linspace(0, 2, 2001)
    found = solve_ivp(change, (0, 2), [0.0, 0.0, 2.0], t_eval=time, rtol=1e-8, atol=1e-10, method="Radau")
    late = time > 1
    within = (omega * (1 - r) * T) ** 5 / 720 + 1e-3 * omega * T + 1e-6
    assert np.max(np.abs(found.y[2] - followed(time, omega, T, r))[late]) < within


def test_every_run_has_a_past_of_its_own() -> None:
    time = np.concatenate([np.arange(100), np.arange(100)]) * 0.01
    run = np.repeat([0, 1], 100)
    velocity = np.concatenate([np.full(100, 1.0), np.full(100, 5.0)])
    channels = {"time": time, "torque": np.zeros(200), "velocity": velocity}
    recording = Recording("two", Motion.ROTARY, channels, run)
    drive = Drive(Model.parse("coulomb-viscous+frictional-lag"), 1.0)
    lag = {"F_s": 1.0, "K": 3.0, "omega_s": 1.0, "T": 0.3, "r": 0.5}
    found = drive.friction(recording, {"K_v": 0.0, "K_c": 0.0} | {f"frictional-lag.{key}": x for key, x in lag.items()})
    np.testing.assert_allclose(found, np.exp(-velocity), rtol=1e-12)


def test_what_is_recalled_stands_beside_what_is_integrated() -> None:
    """The states of two effects, one of each kind, are those that each has alone, in either order."""
    time = np.linspace(0, 2, 4001)
    velocity = np.sin(7 * time)
    alone = {
        "presliding": states("presliding", {"x_s": 0.01}, time, velocity=velocity),
        "frictional-lag": states("frictional-lag", {"T": 0.1, "r": 0.4}, time, velocity=velocity),
    }
    for pair in (("presliding", "frictional-lag"), ("frictional-lag", "presliding")):
        both = states("+".join(pair), {"x_s": 0.01, "T": 0.1, "r": 0.4}, time, velocity=velocity)
        np.testing.assert_allclose(both, [*alone[pair[0]], *alone[pair[1]]], rtol=1e-12)


def test_a_compliant_joint_resonates_where_and_as_much_as_the_textbook_says() -> None:
    """Twist per acceleration: 1/√((ω_n² − ω²)² + (2ζω_nω)²)."""
    omega_n, zeta = 50.0, 0.2
    time = np.linspace(0, 3, 60_001)
    for omega in (10.0, omega_n, 200.0):
        moved = {"velocity": -np.cos(omega * time) / omega, "acceleration": np.sin(omega * time)}
        x, v = states("joint-compliance", {"omega_n": omega_n, "zeta": zeta}, time, **moved)
        late = time > 2.0
        gain = 1 / np.hypot(omega_n**2 - omega**2, 2 * zeta * omega_n * omega)
        waves = np.column_stack([np.sin(omega * time[late]), np.cos(omega * time[late])])
        for state, expected in ((x, gain), (v, gain * omega)):
            assert np.linalg.norm(np.linalg.lstsq(waves, state[late], rcond=None)[0]) == pytest.approx(
                expected, rel=1e-3
            )


def test_a_part_on_a_spring_is_not_struck_where_a_record_begins() -> None:
    """A run that begins while the drive speeds up evenly leaves the twist at a/ω_n²; begun from 0 it would swing."""
    time = np.linspace(0, 3, 3001)
    moved = {"velocity": 7.0 * time, "acceleration": np.full(3001, 7.0)}
    x, v = states("joint-compliance", {"omega_n": 50.0, "zeta": 0.02}, time, **moved)
    np.testing.assert_allclose(x, 7.0 / 50.0**2, rtol=1e-9)
    np.testing.assert_allclose(v, 0.0, atol=1e-9)


def test_a_first_value_of_no_state_is_refused() -> None:
    class Lost(Effect):
        name = "lost"
        z = State("z")

        def torque(self, s: Any, p: Any) -> Any:
            return s.z

        def rates(self, s: Any, p: Any) -> Mapping[str, Any]:
            return {"z": s.velocity}

        def first_states(self, s: Any, p: Any) -> Mapping[str, Any]:
            return {"y": s.velocity}

    with pytest.raises(InputError, match="'lost' gives a first value of 'y'"):
        Model(CoulombViscous(), [Lost()]).expression()


@pytest.mark.parametrize("x_s", [1e-3, 1e-5, 1e-8, 1e-12])
def test_a_contact_that_settles_within_a_sample_does_not_ring(x_s: float) -> None:
    """L-stable: after a reversal z is at its new end after a few samples, and stays there."""
    time = np.arange(200) * 1e-2
    velocity = np.where((time // 0.5) % 2 == 0, 1.0, -1.0)
    (z,) = states("presliding", {"x_s": x_s}, time, velocity=velocity)
    after = np.arange(200) % 50
    settled = (after >= 25) & (after < 50)
    np.testing.assert_allclose(z[settled], np.sign(velocity[settled]), atol=1e-4)
    assert np.max(np.abs(z)) < 1.5


def test_at_rest_a_deflection_stays_and_a_bond_ages() -> None:
    time = np.linspace(0, 4, 4001)
    velocity = np.where(time < 1, 0.01, 0.0)
    (z,) = states("presliding", {"x_s": 0.02}, time, velocity=velocity)
    resting = time > 1.001
    np.testing.assert_allclose(z[resting], z[-1], rtol=1e-12)
    assert z[-1] == pytest.approx(1 - np.exp(-0.5), abs=1e-3)
    (age,) = states("rising-stiction", {"T": 0.5, "x_s": 1e-3}, time, velocity=np.zeros(4001))
    np.testing.assert_allclose(age, 1 - np.exp(-time / 0.5), atol=1e-6)


def test_runs_begin_afresh() -> None:
    model = Model.parse("coulomb-viscous+presliding")
    values = [0.3 if p.declared.symbol == "x_s" else 1.0 for p in model.parameters]
    time = np.tile(np.linspace(0, 1, 101), 2)
    run = np.repeat([0, 1], 101)
    signals = {name: np.ones(202) for name in SIGNALS}
    (z,) = Memory(model, signals, time, run, 1e-9)(values)
    np.testing.assert_array_equal(z[:101], z[101:])
    assert z[101] == 0.0


def test_several_memories_do_not_disturb_each_other() -> None:
    time = np.linspace(0, 1, 1001)
    signals = {name: np.zeros(1001) for name in SIGNALS}
    signals["velocity"] = np.sin(9 * time)
    run = np.zeros(1001, dtype=np.int64)
    model = Model.parse("coulomb-viscous+presliding+rising-stiction")
    chosen = {"presliding.x_s": 0.03, "rising-stiction.T": 0.3, "rising-stiction.x_s": 0.05}
    both = Memory(model, signals, time, run, 1e-9)([chosen.get(p.key, 1.0) for p in model.parameters])
    alone = states("presliding", {"x_s": 0.03}, time, velocity=signals["velocity"])
    alone += states("rising-stiction", {"T": 0.3, "x_s": 0.05}, time, velocity=signals["velocity"])
    np.testing.assert_allclose(both, alone, rtol=1e-12, atol=1e-14)


class SpringAndSlider(Effect):
    """A spring in series with dry friction: it sticks, or slips at full torque."""

    name = "spring-and-slider"
    F = Parameter("F", unit="N m", lower=0.0)
    x_s = Parameter("x_s", unit="rad", initial=0.01, lower=1e-9, scan=(0.01,))
    z = State("z")

    def torque(self, s: Any, p: Any) -> Any:
        return p.F * s.z

    def rates(self, s: Any, p: Any) -> Mapping[str, Any]:
        return {"z": where(sign(s.velocity) * s.z >= 1, 0, s.velocity / p.x_s)}

    def discrete_step(self, s: Any, later: Any, h: Any, p: Any) -> Mapping[str, Any]:
        return {"z": maximum(-1, minimum(1, s.z + h * (s.velocity + later.velocity) / 2 / p.x_s))}


def test_a_switching_contact_is_advanced_by_its_own_formula() -> None:
    """However long the step, it breaks away without overshoot; a memory beside it is integrated as ever."""
    time = np.arange(81) * 0.05
    velocity = np.where((time // 1.0) % 2 == 0, 1.0, -0.5)
    signals = {**{name: np.zeros(81) for name in SIGNALS}, "velocity": velocity}
    run = np.zeros(81, dtype=np.int64)
    model = Model(CoulombViscous(), [Presliding(), SpringAndSlider()])
    values = [{"presliding.x_s": 0.03, "spring-and-slider.x_s": 0.2}.get(p.key, 1.0) for p in model.parameters]
    bent, z = Memory(model, signals, time, run, 1e-9)(values)
    expected = [0.0]
    for before, after in itertools.pairwise(velocity):
        expected.append(float(np.clip(expected[-1] + 0.05 * (before + after) / 2 / 0.2, -1, 1)))
    np.testing.assert_allclose(z, expected, atol=1e-12)
    assert (z.min(), z.max()) == (-1.0, 1.0)
    (alone,) = states("presliding", {"x_s": 0.03}, time, velocity=velocity)
    np.testing.assert_allclose(bent, alone, rtol=1e-12)


@pytest.mark.parametrize("push", [0.5, 2.0])
def test_a_switching_contact_in_motion(push: float) -> None:
    """Below its torque it is a spring, ω = √(k/J); above it, a constant torque."""
    drive = Drive(Model(CoulombViscous(), [SpringAndSlider()]), 0.01)
    values = {"K_v": 0.0, "K_c": 0.0, "spring-and-slider.F": 1.0, "spring-and-slider.x_s": 0.1}
    time = np.linspace(0, 1, 2001)
    push = 0.9 * push / 2 if push < 1 else push
    found = simulate(drive, values, time, np.full(2001, push), substeps=4, with_position=True)
    natural = np.sqrt(1.0 / 0.1 / 0.01)
    if push < 1:
        assert np.max(np.abs(found["position"] - push * 0.1 * (1 - np.cos(natural * time)))) < 1e-5
    else:
        assert np.polyfit(time[time > 0.5], found.velocity[time > 0.5], 1)[0] == pytest.approx((push - 1) / 0.01)


@pytest.mark.parametrize("beside", ["presliding", "rising-stiction"])
@pytest.mark.parametrize("late", [1e-6, 2e-4, 1e-2])
def test_a_lag_of_any_length_leaves_other_states_as_they_are(beside: str, late: float) -> None:
    """Solved together with the others its states made these no numbers, in a recording and from sample to sample."""
    time = 1e-3 * np.arange(3000)
    velocity = np.sin(3.0 * time) + 0.3 * np.sin(17.0 * time)
    own = {"x_s": 0.02, "T": 0.2} if beside == "rising-stiction" else {"x_s": 1e-6}
    alone = states(beside, own, time, velocity=velocity)
    both = Model.parse(f"coulomb-viscous+{beside}+frictional-lag")
    given = {name: velocity if name == "velocity" else np.zeros(len(time)) for name in SIGNALS}
    lag = {"frictional-lag.T": late, "frictional-lag.r": 0.3}
    values = [lag.get(p.key, own.get(p.declared.symbol, 1.0)) for p in both.parameters]
    found = Memory(both, given, time, np.zeros(len(time), dtype=np.int64), 1e-9)(values)
    for one, other in zip(alone, found, strict=False):
        np.testing.assert_allclose(other, one, rtol=1e-9, atol=1e-12)
    assert np.all(np.isfinite(found))
    step, ends = MemoryStep(both, 1e-9), [{name: float(given[name][i]) for name in SIGNALS} for i in range(1500)]
    reached = step.first(ends[0], values)
    for begin, end in itertools.pairwise(ends):
        reached = step(reached, begin, end, 1e-3, values)
    np.testing.assert_allclose(reached[: len(alone)], [one[1499] for one in alone], rtol=1e-9, atol=1e-12)
