"""A simulated drive: known truth, hidden effects, real sensors."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.documents import NotNegative, Positive
from fricmodels.errors import InputError
from fricmodels.recording import Recording
from fricmodels.rig.effects import AnyEffect
from fricmodels.rig.excitation import AnyExcitation, ClosedLoop
from fricmodels.rig.hidden import Waves
from fricmodels.rig.memory import SensorDelay
from fricmodels.rig.sensors import History, Sensors, instants, noisy, quantised

Pair = tuple[NotNegative, NotNegative]
_MOST_HARMONICS = 16
_MOST_STEPS = 1000
_MOST_SAMPLES = 20_000_000
_RUNAWAY = 1000.0
"""A controlled drive that is faster than so many times the fastest that is commanded has run away."""
EXCLUSIVE = (("backlash", "joint-compliance"), ("presliding", "rising-stiction"), ("frictional-lag", "presliding"))
"""Effects that cannot be simulated together."""


class Friction(BaseModel):
    """The friction law that is no secret: Coulomb and viscous, or the paper's exponential stick–slip (eq. 4).

    Each coefficient is one number, or [forward, backward]. ``stick`` is the dry torque at rest, falling to
    ``coulomb`` as exp(−``fall``·|ω|).
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    viscous: NotNegative | Pair
    coulomb: NotNegative | Pair
    stick: NotNegative | Pair | None = None
    fall: NotNegative | Pair | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.stick is None) != (self.fall is None):
            raise ValueError("give 'stick' and 'fall' together")
        if any(s < c for s, c in zip(_pair(self.stick), _pair(self.coulomb), strict=True)) and self.stick is not None:
            raise ValueError("'stick' must not be below 'coulomb'")
        return self

    @property
    def asymmetric(self) -> bool:
        """Whether a coefficient differs between the directions."""
        return any(isinstance(v, tuple) for v in (self.viscous, self.coulomb, self.stick, self.fall))

    @property
    def law(self) -> str:
        """Name of the law."""
        return ("asymmetric-" if self.asymmetric else "") + (
            "coulomb-viscous" if self.stick is None else "exponential-stick-slip"
        )

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters of the law by the symbols that models use."""
        rows = [("K_v", self.viscous), ("K_c", self.coulomb)]
        if self.stick is not None:
            rows = [("K_v", self.viscous), ("K_c", self.stick), ("C", self.coulomb), ("B", self.fall or 0.0)]
        if not self.asymmetric:
            return {symbol: _pair(value)[0] for symbol, value in rows}
        name = {"K_v": "K_v{}", "K_c": "K_c{}", "C": "C_{}", "B": "B_{}"}
        return {name[symbol].format(i + 1): _pair(value)[i] for symbol, value in rows for i in (0, 1)}

    def level(self, speed: Array, side: int) -> Array:
        """Return the magnitude of the friction torque at each speed; side 0 is forward, 1 backward."""
        coulomb, viscous = _pair(self.coulomb)[side], _pair(self.viscous)[side]
        rise = 0.0 if self.stick is None else _pair(self.stick)[side] - coulomb
        return np.asarray(coulomb + viscous * speed + rise * np.exp(-_pair(self.fall)[side] * speed))

    def residual(self, velocity: Array, net: Array, rest_speed: float) -> Array:
        """Return net torque less friction torque; at rest, how far the net torque is beyond what friction holds."""
        forward, backward = self.level(np.abs(velocity), 0), self.level(np.abs(velocity), 1)
        resting = net - np.clip(net, -backward, forward)
        return np.where(velocity > rest_speed, net - forward, np.where(velocity < -rest_speed, net + backward, resting))


class Load(BaseModel):
    """A load torque that is known and recorded: a payload's weight, and a load put on from outside.

    τ_L = bias + amplitude·sin(2π frequency t + φ), φ random in each run, + payload·sin(q + payload_angle).
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    bias: float = 0.0
    amplitude: NotNegative = 0.0
    frequency: NotNegative = 0.0
    payload: float = 0.0
    payload_angle: float = 0.0


class Rig(BaseModel):
    """A simulated drive and one experiment with it, as a YAML file states it.

    ``inertia`` is the stated one [kg m² or kg]; an ``inertia-error`` makes the true one differ. Each of ``runs`` runs
    has ``samples`` samples at ``rate`` [Hz]. ``hold`` keeps the torque constant between samples. A motor that slows
    below ``rest_speed`` stops: without it, a well damped controller lets it creep up to its goal for ever.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    name: str = "rig"
    motion: Motion = Motion.ROTARY
    inertia: Positive
    friction: Friction
    effects: tuple[AnyEffect, ...] = ()
    load: Load | None = None
    excitation: AnyExcitation
    sensors: Sensors = Sensors()
    rate: Positive
    samples: Annotated[int, Field(ge=10, le=10_000_000)] = 20_000
    runs: Annotated[int, Field(ge=1, le=1000)] = 1
    hold: bool = True
    torque_limit: Positive | None = None
    rest_speed: NotNegative = 0.0
    substeps: Annotated[int, Field(ge=1, le=1000)] = 20
    seed: Annotated[int, Field(ge=0)] = 0

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.samples * self.runs > _MOST_SAMPLES:
            raise ValueError(f"'samples' times 'runs' are {self.samples * self.runs}, more than {_MOST_SAMPLES}")
        names = [effect.name for effect in self.effects]
        if len(set(names)) != len(names):
            raise ValueError("an effect is listed twice; give cogging and the like several 'harmonics' instead")
        if sum(len(getattr(effect, "harmonics", ())) for effect in self.effects) > _MOST_HARMONICS:
            raise ValueError(f"there are more than {_MOST_HARMONICS} 'harmonics' in all")
        for one, other in EXCLUSIVE:
            if one in names and other in names:
                raise ValueError(f"'{one}' and '{other}' cannot be simulated together")
        return self

    def __copy__(self) -> Self:
        copied = super().__copy__()
        copied.__dict__.pop("histories", None)  # what is kept belongs to one rig alone
        return copied

    def __getstate__(self) -> dict[Any, Any]:
        return super(Rig, self.__copy__()).__getstate__()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rig) and self.model_dump() == other.model_dump()

    def __hash__(self) -> int:
        return hash(self.model_dump_json())

    # ---- variations -----------------------------------------------------------------------------------------------

    def with_strength(self, factor: float) -> Rig:
        """Return the same rig with every hidden effect stronger by ``factor``."""
        return self.model_copy(update={"effects": tuple(effect.scaled(factor) for effect in self.effects)})

    def noiseless(self) -> Rig:
        """Return the same rig with perfect sensors of every channel (a hidden sensor delay stays)."""
        return self.model_copy(update={"sensors": Sensors(temperature=True)})

    # ---- truth ----------------------------------------------------------------------------------------------------

    @property
    def true_model(self) -> str:
        """Name of the law and of every hidden effect: ``coulomb-viscous+cogging``."""
        return "+".join([self.friction.law, *(effect.name for effect in self.effects)])

    @property
    def truth(self) -> dict[str, Any]:
        """True model, parameters and hidden effects, as they go into the provenance."""
        inertia_key = "J" if self.motion is Motion.ROTARY else "M"
        return {
            "true_model": self.true_model,
            "inertia": self.inertia,
            "true_parameters": {inertia_key: self.inertia, **self.friction.parameters},
            "hidden_effects": [{"name": effect.name, "parameters": effect.parameters()} for effect in self.effects],
            "rig": self.model_dump(mode="json"),
        }

    # ---- simulation -----------------------------------------------------------------------------------------------

    def simulate(self) -> Recording:
        """Simulate all runs and record them.

        Returns:
            A recording with time, torque and, where the sensors have them, velocity, position, load torque and
            temperature; the truth is its provenance.

        Raises:
            InputError: when the drive swings by itself too fast for the rate, or runs away.
        """
        self._check_bounded()
        moved, driven = self._delays
        warms = any(effect.name == "thermal" for effect in self.effects)
        parts: list[dict[str, Array]] = []
        for number, history in enumerate(self.histories):
            rng = np.random.default_rng([self.seed, number, 1])
            time = instants(self.samples, 1 / self.rate, self.sensors, rng)
            part = {"time": time + number * self.samples / self.rate}
            part["torque"] = history.driving(time - driven)
            part["velocity"] = history.moving(history.velocity, time - moved)
            part["position"] = history.moving(history.position, time - moved)
            part["load_torque"] = history.sampled(history.load, time)
            part["temperature"] = history.sampled(history.temperature, time)
            parts.append(part)
        run = np.repeat(np.arange(self.runs), [len(part["time"]) for part in parts])
        whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        rng = np.random.default_rng([self.seed, self.runs, 2])
        whole["torque"] = noisy(whole["torque"], self.sensors.torque_noise_percent, rng)
        whole["velocity"] = noisy(whole["velocity"], self.sensors.velocity_noise_percent, rng)
        whole["temperature"] = whole["temperature"] + self.sensors.temperature_noise * rng.standard_normal(len(run))
        whole["position"] = quantised(whole["position"], self.sensors.encoder_step)
        kept = {"time", "torque"}
        kept |= {"velocity"} if self.sensors.velocity == "measured" else set()
        kept |= {"position"} if self.sensors.position or self.sensors.velocity == "none" else set()
        kept |= {"load_torque"} if self.load is not None else set()
        kept |= {"temperature"} if warms or self.sensors.temperature else set()
        if self.sensors.temperature is False:
            kept -= {"temperature"}
        channels = {name: values for name, values in whole.items() if name in kept}
        return Recording(self.name, self.motion, channels, run.astype(np.int64), provenance=self.truth)

    def _check_bounded(self) -> None:
        """Raise an error for a drive that runs away."""
        fastest = float(np.max([np.max(np.abs(history.velocity)) for history in self.histories]))
        if isinstance(self.excitation, ClosedLoop):
            time = np.arange(self.samples, dtype=np.float64) / self.rate
            commanded = self.excitation.command(time, np.random.default_rng([self.seed, 0])).velocity
            if not fastest <= _RUNAWAY * float(np.max(np.abs(commanded))):
                raise InputError(
                    f"rig '{self.name}' runs away: its controller is unstable with these effects; lower its 'bandwidth'"
                )
        elif not np.isfinite(fastest):
            raise InputError(f"rig '{self.name}' runs away: nothing bounds its speed; lower the torque or the effects")

    @cached_property
    def histories(self) -> tuple[History, ...]:
        """The true motion of every run, at every sub-step."""
        return tuple(self._run(number) for number in range(self.runs))

    def effect_torque(self) -> Array:
        """Return what the hidden effects leave in the residual torque of the true law, shape (runs·samples,).

        It is τ_m − τ_L − J dω/dt − τ_F(ω) of the recorded signals, without noise and without hidden effects in τ_F
        (at rest, the distance to what dry friction can hold), averaged over the interval after each sample.
        """
        moved, driven = self._delays
        parts = []
        for history in self.histories:
            n = len(history.velocity)
            step = history.interval * self.samples / n
            time = np.arange(n, dtype=np.float64) * step
            velocity, later = (history.moving(history.velocity, time - moved + ahead) for ahead in (0.0, step))
            applied = history.driving(time + 0.5 * step - driven) - history.sampled(history.load, time + 0.5 * step)
            net = applied - self.inertia * (later - velocity) / step
            between = np.where((velocity == 0) & (later == 0), 0.0, 0.5 * (velocity + later))
            parts.append(self.friction.residual(between, net, self.rest_speed).reshape(self.samples, -1).mean(axis=1))
        return np.concatenate(parts)

    @property
    def _delays(self) -> tuple[float, float]:
        delays = [effect for effect in self.effects if isinstance(effect, SensorDelay)]
        moved = sum(effect.delay for effect in delays if effect.channel == "motion")
        return moved, sum(effect.delay for effect in delays if effect.channel == "torque")

    def _physics(self) -> Any:
        from fricmodels.rig.physics import PHYSICS

        p = np.zeros(1, dtype=PHYSICS)[0]
        friction = self.friction
        stick = friction.coulomb if friction.stick is None else friction.stick
        for i, side in enumerate(("forward", "backward")):
            p[f"viscous_{side}"] = _pair(friction.viscous)[i]
            p[f"coulomb_{side}"] = _pair(friction.coulomb)[i]
            p[f"rise_{side}"] = _pair(stick)[i] - _pair(friction.coulomb)[i]
            p[f"fall_{side}"] = _pair(friction.fall)[i]
        p["motor_inertia"], p["motor_share"] = self.inertia, 1.0
        p["stribeck_speed"] = p["stribeck_exponent"] = p["ageing_distance"] = p["ageing_time"] = 1.0
        p["rest_speed"], p["step_time"] = self.rest_speed, np.inf
        p["torque_limit"] = np.inf if self.torque_limit is None else self.torque_limit
        if self.load is not None:
            p["payload"], p["payload_angle"] = self.load.payload, self.load.payload_angle
        if isinstance(self.excitation, ClosedLoop):
            natural = 2 * np.pi * self.excitation.bandwidth
            p["proportional"] = self.inertia * natural**2
            p["derivative"] = 2 * self.excitation.damping_ratio * self.inertia * natural
        waves: Waves = []
        for effect in self.effects:
            effect.enter(p, waves)
        p["wave_count"] = len(waves)
        p["waves"][: len(waves)] = np.reshape(waves, (-1, 4))
        return p

    def _steps(self, p: Any) -> int:
        """Return the number of sub-steps: as stated, and at least 40 to a period of any oscillation of its own."""
        natural = 0.0
        if p["load_inertia"] > 0:
            reduced = p["motor_inertia"] * p["load_inertia"] / (p["motor_inertia"] + p["load_inertia"])
            natural = float(np.sqrt(p["coupling_stiffness"] / reduced))
        if p["presliding"] > 0:
            dry = max(p["coulomb_forward"] + p["rise_forward"], p["coulomb_backward"] + p["rise_backward"])
            steepest = 2.1 * p["motor_share"] * (dry + p["stribeck_rise"]) / p["elastic_width"]
            natural = max(natural, float(np.sqrt(steepest / p["motor_inertia"])))
        needed = int(np.ceil(natural / self.rate / 0.15))
        if needed > _MOST_STEPS:
            raise InputError(
                f"rig '{self.name}' swings by itself at {natural / 2 / np.pi:.3g} Hz, too fast for a rate of "
                f"{self.rate:g} Hz; widen the elastic contact, soften the joint or raise the rate"
            )
        return max(self.substeps, needed)

    def _run(self, number: int) -> History:
        from fricmodels.rig.motion import simulate

        rng = np.random.default_rng([self.seed, number])
        interval = 1 / self.rate
        time = np.arange(self.samples, dtype=np.float64) * interval
        p = self._physics()
        command = self.excitation.command(time, rng)
        load = np.zeros(self.samples)
        if self.load is not None:
            phase = rng.uniform(0, 2 * np.pi)
            load += self.load.bias + self.load.amplitude * np.sin(2 * np.pi * self.load.frequency * time + phase)
        torque = command.torque.copy()
        noise = np.zeros(self.samples)
        if self.excitation.closed_loop:
            weight = float(p["payload"]) * np.sin(command.position + float(p["payload_angle"]))
            torque += self.inertia * command.acceleration + load + weight
            if self.sensors.noisy_feedback:
                noise = noisy(command.velocity, self.sensors.velocity_noise_percent, rng) - command.velocity
        substeps = self._steps(p)
        position, velocity = np.zeros(self.samples * substeps), np.zeros(self.samples * substeps)
        known, temperature = np.zeros(self.samples), np.zeros(self.samples)
        reference = np.column_stack([command.position, command.velocity])
        start = np.array([command.position[0], command.velocity[0]])
        simulate(
            p,
            torque,
            reference,
            noise,
            load,
            start,
            self.hold,
            interval,
            substeps,
            number * self.samples * interval,
            position,
            velocity,
            known,
            temperature,
        )
        return History(
            interval, position, velocity, torque, known, temperature, self.hold or self.excitation.closed_loop
        )


def _pair(value: float | tuple[float, float] | None) -> tuple[float, float]:
    if value is None:
        return 0.0, 0.0
    return value if isinstance(value, tuple) else (value, value)
