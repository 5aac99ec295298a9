"""A friction model: a law plus effects, as one symbolic expression."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import compress
from typing import TYPE_CHECKING, Any

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.expressions import Expression, rest_treatment
from fricmodels.parameter import Parameter, State
from fricmodels.term import SIGNALS, Effect, Law, Parameters, Signals, Term

if TYPE_CHECKING:
    from fricmodels.recording import Recording


@dataclass(frozen=True)
class ModelExpression:
    """The friction torque of a model as CasADi ``SX`` expressions.

    Attributes:
        signals: every one of :attr:`Model.signals`, by name, used or not.
        parameters: column of all parameters, in the order of :attr:`Model.parameters`.
        states: column of all internal states, in the order of :attr:`Model.states`.
        width: the width of rest [velocity].
        torque: the friction torque τ_F.
        first: column of the states at the first sample of a run; they depend on the signals there.
        rates: column of d/dt of the states.
        discrete_step: by index into the states, those that have a formula for a time ``step`` later; they depend on the
            signals, the states and the signals at the end of the step, ``later``.
        needs: the signals that the equations touch.
        required: those of them without which there is no torque: an optional one is zero where it was not recorded.
    """

    signals: Mapping[str, Expression]
    parameters: Expression
    states: Expression
    width: Expression
    torque: Expression
    first: Expression
    rates: Expression
    later: Mapping[str, Expression]
    step: Expression
    discrete_step: Mapping[int, Expression]
    needs: frozenset[str]
    required: frozenset[str]


@dataclass(frozen=True)
class ModelParameter:
    """A parameter within a model: ``key`` is its symbol in the law, ``effect.symbol`` in an effect."""

    key: str
    declared: Parameter
    at_least: str | None


@dataclass(frozen=True)
class Known:
    """What is known of a model's parameters before it is fitted.

    Attributes:
        values: by key, the inertia among them. standard_errors: by key.
        fixed: whether they are held; a fit begins from them otherwise.
        runs: number of each run that they were fitted to, by the checksum of its torque, see
            :func:`fricmodels.fitted_runs.run_checksums`; ``None`` where runs of the same number are the same.
        promised: test error where they were fitted [% of the RMS motor torque], and the window that it is averaged
            over [ms]; ``None`` where that is not known.
        ranges: least and greatest value of each channel where they were fitted.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    standard_errors: Mapping[str, float] = field(default_factory=dict)
    fixed: bool = False
    runs: Mapping[str, int] | None = None
    promised: tuple[float, float] | None = None
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)


class NoFriction(Law):
    """No friction at all: the law on which an effect stands alone."""

    name = "no-friction"
    formula = "τ_F = 0"

    def torque(self, s: Signals, p: Parameters) -> float:
        """Return 0."""
        return 0.0


class Model:
    """A law and the effects added to it: ``asymmetric-coulomb-viscous+cogging+stribeck``.

    Models are equal when their terms are, see :class:`fricmodels.term.Term`; their names alone do not make them so.
    """

    def __init__(self, law: Law, effects: Sequence[Effect] = ()) -> None:
        names = [effect.name for effect in effects]
        if len(set(names)) != len(names):
            raise InputError(f"model '{'+'.join([law.name, *names])}' has an effect twice")
        self.law = law
        self.effects = tuple(effects)
        self.known = Known()

    @classmethod
    def parse(cls, name: str) -> Model:
        """Build the model that ``LAW+EFFECT+EFFECT`` names; an effect of a channel is ``EFFECT(CHANNEL)``.

        Raises:
            InputError: for an unknown law or effect, naming the nearest known one.
        """
        registered = plugins.load()
        law, *effects = (part.strip() for part in name.split("+"))
        _check_kinds(registered, law, effects)
        return cls(registered.laws[law](), [_named(registered.effects, effect) for effect in effects])

    @classmethod
    def of(cls, model: Model | str) -> Model:
        """Return a model as it is, or the one that a name says; see :meth:`parse`.

        Raises:
            InputError: for an unknown law or effect, or what is no model, such as a fitted one.
        """
        if isinstance(model, str):
            return cls.parse(model)
        if not isinstance(model, Model):
            own = isinstance(getattr(model, "model", None), Model)
            raise InputError(
                f"a model is wanted, got {type(model).__name__}; give {'its .model, or ' if own else ''}a name such as "
                "'coulomb-viscous+gravity'"
            )
        return model

    @classmethod
    def only(cls, term: Law | Effect) -> Model:
        """Return the model that has nothing but a term."""
        return cls(term) if isinstance(term, Law) else cls(NoFriction(), [term])

    def on(self, recording: Recording) -> Model:
        """Return the model as it is for a recording: see :meth:`fricmodels.term.Effect.on`."""
        effects = [effect.on(recording, [t for t in self.terms if t is not effect]) for effect in self.effects]
        return self if effects == list(self.effects) else Model(self.law, effects)

    def knowing(self, known: Known) -> Model:
        """Return the model with what is known of its parameters; it stays equal to the one without."""
        model = Model(self.law, self.effects)
        model.known = known
        return model

    def plus(self, effect: Effect) -> Model:
        """Return this model with one effect more."""
        return Model(self.law, (*self.effects, effect))

    def without_memory(self) -> Model:
        """Return the model of the terms that have no internal states."""
        law = NoFriction() if self.law.states else self.law
        return Model(law, [effect for effect in self.effects if not effect.states])

    def minus(self, effect_name: str) -> Model:
        """Return this model without the named effect."""
        return Model(self.law, [effect for effect in self.effects if effect.name != effect_name])

    @property
    def name(self) -> str:
        """The name that :meth:`parse` reads."""
        return "+".join(term.name for term in self.terms)

    @property
    def terms(self) -> tuple[Law | Effect, ...]:
        """The law, then the effects."""
        return (self.law, *self.effects)

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """The signals of :data:`fricmodels.term.SIGNALS`, then the further channels of the terms."""
        return _signals(self.terms)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """All parameters, the law's first."""
        return tuple(
            ModelParameter(prefix + p.symbol, p, prefix + p.at_least if p.at_least else None)
            for term, prefix in _prefixed(self.terms)
            for p in term.parameters
        )

    @cached_property
    def delay(self) -> str | None:
        """Key of the parameter that is a delay of the record, if there is one."""
        return next((p.key for p in self.parameters if p.declared.delay), None)

    @cached_property
    def states(self) -> tuple[State, ...]:
        """All internal states, the law's first."""
        return tuple(state for term in self.terms for state in term.states)

    @cached_property
    def beginning_unknown(self) -> bool:
        """Whether first states of a term are to be found from the torque, see :mod:`fricmodels.beginning`."""
        return any(term.beginning_unknown for term in self.terms)

    @cached_property
    def needs(self) -> frozenset[str]:
        """The signals that the model's equations touch."""
        return self.expression().needs

    @cached_property
    def required(self) -> frozenset[str]:
        """Those of them without which there is no torque."""
        return self.expression().required

    def expression(self, *, smooth: bool = False) -> ModelExpression:
        """Return the friction torque; ``smooth`` replaces sgn by tanh of the expression's width."""
        return _build(self.terms, smooth)

    @cached_property
    def linear(self) -> tuple[bool, ...]:
        """For each parameter, whether the torque is linear in it jointly with the others so marked.

        Found from the expression: the derivative of the torque by one such parameter does not depend on any of them,
        comparisons included. A parameter that enters the rate of an internal state, or a comparison only, is nonlinear.
        """
        import casadi

        e = self.expression()
        symbols = casadi.vertsplit(e.parameters) if self.parameters else []
        memory = casadi.vertcat(e.rates, *e.discrete_step.values())
        slopes = [casadi.jacobian(e.torque, symbol) for symbol in symbols]
        linear = [
            slope.nnz() > 0 and not casadi.depends_on(slope, symbol) and not casadi.depends_on(memory, symbol)
            for slope, symbol in zip(slopes, symbols, strict=True)
        ]
        while True:
            members = [i for i, is_linear in enumerate(linear) if is_linear]
            conflicts = {
                i: sum(
                    casadi.depends_on(slopes[j], symbols[i]) + casadi.depends_on(slopes[i], symbols[j]) for j in members
                )
                for i in members
            }
            worst = max(conflicts, key=lambda i: conflicts[i], default=None)
            if worst is None or conflicts[worst] == 0:
                return tuple(linear)
            linear[worst] = False

    @cached_property
    def linear_parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters in which the torque is linear, see :attr:`linear`."""
        return tuple(compress(self.parameters, self.linear))

    @cached_property
    def nonlinear_parameters(self) -> tuple[ModelParameter, ...]:
        """The other parameters."""
        return tuple(p for p, linear in zip(self.parameters, self.linear, strict=True) if not linear)

    def linear_of(self, values: Mapping[str, float], *, delay: bool = True) -> list[float]:
        """Return the values of the linear parameters, of those by key; zero for a delay that is not wanted."""
        return [values[p.key] if delay or not p.declared.delay else 0.0 for p in self.linear_parameters]

    def nonlinear_of(self, values: Mapping[str, float]) -> list[float]:
        """Return the values of the nonlinear parameters, of those by key."""
        return [values[p.key] for p in self.nonlinear_parameters]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and other.terms == self.terms

    def __hash__(self) -> int:
        return hash(self.terms)

    def __repr__(self) -> str:
        return f"<Model '{self.name}'>"


def _check_kinds(registered: plugins.Plugins, law: str, effects: Sequence[str]) -> None:
    """Refuse an effect in the place of the law, and a law in that of an effect."""
    if law not in registered.laws and law.partition("(")[0] in registered.effects:
        example = "+".join(["coulomb-viscous", law, *effects])
        raise InputError(f"'{law}' is an effect, and a model begins with a law: write LAW+{law}, such as {example}")
    for effect in effects:
        if effect in registered.laws and effect not in registered.effects:
            what = f"'{law}' stands twice" if effect == law else f"'{law}' and '{effect}' are two"
            raise InputError(f"a model has one law, and {what}; leave one of them out")


def _named(effects: plugins.Registry[Effect], written: str) -> Effect:
    name, bracket, rest = written.partition("(")
    if bracket and not rest.endswith(")"):
        raise InputError(f"'{written}' lacks its closing bracket")
    return effects[name.strip()].named(rest[:-1].strip())


def _signals(terms: tuple[Term, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys([*SIGNALS, *(channel for term in terms for channel in term.channels)]))


def _prefixed(terms: tuple[Term, ...]) -> list[tuple[Term, str]]:
    law, *effects = terms
    return [(law, ""), *((effect, f"{effect.name}.") for effect in effects)]


@lru_cache(maxsize=128)
def _build(terms: tuple[Term, ...], smooth: bool) -> ModelExpression:
    """Build the torque of a model; equal models share it, and with it all that is compiled from it."""
    import casadi

    signals = {name: casadi.SX.sym(name) for name in _signals(terms)}
    later = {name: casadi.SX.sym(f"later_{name}") for name in signals}
    width, step = casadi.SX.sym("width"), casadi.SX.sym("step")
    discrete_step: dict[int, Any] = {}
    parameters: list[Any] = []
    states: list[Any] = []
    first: list[Any] = []
    rates: list[Any] = []
    torque = casadi.SX(0)
    touched: set[str] = set()
    required: set[str] = set()
    with rest_treatment(width, smooth=smooth), plugins.unheard():
        for term, prefix in _prefixed(terms):
            own = {p.symbol: casadi.SX.sym(prefix + p.symbol) for p in term.parameters}
            memory = {z.symbol: casadi.SX.sym(prefix + z.symbol) for z in term.states}
            s, p = Signals(signals, memory), Parameters(own)
            torque = torque + term.torque(s, p)
            if memory:
                changes = term.rates(s, p)
                missing = set(memory) - set(changes)
                if missing:
                    raise InputError(f"'{term.name}' gives no rate for its state '{sorted(missing)[0]}'")
                rates.extend(changes[symbol] for symbol in memory)
                begun = term.first_states(s, p)
                if not begun.keys() <= memory.keys():
                    unknown = min(begun.keys() - memory.keys())
                    raise InputError(f"'{term.name}' gives a first value of '{unknown}', which is none of its states")
                first.extend(begun.get(z.symbol, z.initial) for z in term.states)
                end = Signals(later, {})
                following = term.discrete_step(s, end, step, p)
                if following and set(following) != set(memory):
                    raise InputError(
                        f"'{term.name}' has a discrete step for some of its states only; give all, or none"
                    )
                discrete_step |= {len(states) + list(memory).index(symbol): x for symbol, x in following.items()}
                s.touched |= end.touched
            parameters.extend(own.values())
            states.extend(memory.values())
            touched |= s.touched
            required |= s.touched - term.optional
    return ModelExpression(
        signals,
        casadi.vertcat(*parameters),
        casadi.vertcat(*states),
        width,
        torque,
        casadi.vertcat(*first),
        casadi.vertcat(*rates),
        later,
        step,
        discrete_step,
        frozenset(touched),
        frozenset(required),
    )
