"""The internal states of terms with memory, integrated along a measured motion."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array, Index
from fricmodels.beginning import Balance, Beginning, UnitTorque, unknown_beginnings
from fricmodels.kernels import ArrayFunction, Scan
from fricmodels.model import Model
from fricmodels.past import Past
from fricmodels.term import Term

_GAMMA = 1 - 1 / math.sqrt(2)
_FADES_WITHIN = 512
"""Samples in which a beginning is looked for first."""
_FADED, _LASTS = 1e-3, 1e-2
"""Share of its torque below which a beginning is gone, and above which it lasts: what lasts all through a run is no
beginning. Between the two less and less of it counts."""


class Memory:
    r"""The internal states of a model along one motion, for whatever parameters.

    Every run starts from the declared initial states, or from those that its first sample tells
    (:meth:`fricmodels.term.Term.first_states`) or its torque (:mod:`fricmodels.beginning`). With rates f, their
    derivative F by the states and the step h, a step is the second-order Rosenbrock formula

    .. math::
        (I - \gamma h F) k_1 &= f(z_n, t_n) + \gamma\,[f(z_n, t_{n+1}) - f(z_n, t_n)] \\
        (I - \gamma h F) k_2 &= f(z_n + h k_1, t_{n+1}) - 2 k_1 - \gamma\,[f(z_n, t_{n+1}) - f(z_n, t_n)] \\
        z_{n+1} &= z_n + \tfrac h2 (3 k_1 + k_2), \qquad \gamma = 1 - 1/\sqrt2

    which is L-stable: a contact that bends within less than a sample settles at once instead of ringing. States
    with a :meth:`fricmodels.term.Term.discrete_step` follow its formula, and those that a term computes from the
    recording (:meth:`fricmodels.term.Term.states_from_recording`) are what it computed.

    Args:
        model: the model with memory.
        signals: value or array of shape (N,) of each signal that the model needs.
        time: sample times [s]; run: run number of each sample.
        width: width of rest.
        balance: what the torque is seen in, where first states are to be found from it.

    Source: J. G. Verwer et al., "A second-order Rosenbrock method", SIAM J. Sci. Comput. 20 (1999).
    """

    def __init__(
        self,
        model: Model,
        signals: Mapping[str, ArrayLike],
        time: Array,
        run: Index,
        width: float,
        balance: Balance | None = None,
    ) -> None:
        self._scan, self._width = _scan(model), width
        self._count, self._first = len(model.states), _first(model)
        needed = _needed(model)
        self._signals = np.array([np.broadcast_to(signals[name], time.shape) for name in needed]).reshape(-1, len(time))
        rows = np.column_stack([np.diff(time), self._signals[:, :-1].T, self._signals[:, 1:].T])
        self._rows = np.ascontiguousarray(rows)  # as it is scanned
        self._edges = [0, *(np.flatnonzero(np.diff(run)) + 1).tolist(), len(time)]
        self._past = Past(signals, time, self._edges)
        self._from_recording = list(_from_recording(model))
        self._begun: list[tuple[slice, slice, UnitTorque, list[Beginning]]] = []
        self._limits = np.array([[s.lower for s in model.states], [s.upper for s in model.states]])
        if balance is not None:
            self._scan_beginning = _scan(model, True)
            parts = [slice(*ends) for ends in itertools.pairwise(self._edges)]
            given = dict(zip(needed, self._signals, strict=True))
            for term, own, places in unknown_beginnings(model):
                found = [Beginning(balance, part) for part in parts]
                self._begun.append((own, places, UnitTorque(term, given, width), found))

    def __call__(self, parameters: ArrayLike) -> tuple[Array, ...]:
        """Return each state at every sample, one array of shape (N,) for each.

        Args:
            parameters: all of the model's parameters, in order.
        """
        states = np.empty((self._count, self._edges[-1]))
        values = np.asarray(parameters, dtype=float)
        if sum(len(term.states) for term, _, _ in self._from_recording) < self._count:
            for number, ends in enumerate(itertools.pairwise(self._edges)):
                self._integrate(number, slice(*ends), values, states[:, slice(*ends)])
        for term, first_parameter, first_state in self._from_recording:
            symbols = [p.symbol for p in term.parameters]
            own = values[first_parameter : first_parameter + len(symbols)].tolist()
            found = term.states_from_recording(self._past, dict(zip(symbols, own, strict=True)))
            for i, state in enumerate(term.states, start=first_state):
                states[i] = found[state.symbol]
        return tuple(states)

    def _integrate(self, number: int, run: slice, values: Array, states: Array) -> None:
        """Write the states along a run, shape (S, n)."""
        rows, constants = self._rows[run.start : run.stop - 1], [*values, self._width]
        states[:, 0] = self._first(self._signals[:, run.start], values)
        units = [torque(values[own], run) for own, _, torque, _ in self._begun]
        left = self._left(rows, constants, states, units) if self._begun else []
        done = left[0].shape[-1] if left else 1
        if done < states.shape[1]:
            _, following, _ = self._scan(states[:, done - 1], rows[done - 1 :], constants)
            states[:, done:] = following.T
        for (_, places, _, runs), unit, of_term in zip(self._begun, units, left, strict=True):
            _add_beginning(runs[number], unit, states[places], of_term, self._limits[:, places])

    def _left(
        self, rows: Array, constants: list[float], states: Array, units: list[tuple[Array, Array]]
    ) -> list[Array]:
        """Return what a unit more of each first value leaves of each state of a term, shape (q, q, samples).

        It goes as far as some of it is left. The states up to there, which are integrated with it, are written.
        """
        counts = [_count(places) for _, places, _, _ in self._begun]
        scanned = np.empty((states.shape[1], self._scan_beginning.n_states))
        scanned[0] = np.concatenate([states[:, 0], *(np.eye(q).ravel() for q in counts)])
        ends = np.cumsum([self._count, *(q * q for q in counts)])
        done, length, whole = 1, min(_FADES_WITHIN, len(scanned)), len(scanned)
        while True:
            part = scanned[done:length]
            self._scan_beginning(scanned[done - 1], rows[done - 1 : length - 1], constants, outputs=part)
            parts = (scanned[:length, slice(*pair)].T for pair in itertools.pairwise(ends))
            left = [part.reshape(q, q, length) for q, part in zip(counts, parts, strict=True)]
            lasting = (_lasting(_seen(slope, part)) for (_, slope), part in zip(units, left, strict=True))
            if length == whole or max(lasting) < _FADED:
                states[:, :length] = scanned[:length, : self._count].T
                return left
            done, length = length, min(4 * length, whole)


def _add_beginning(beginning: Beginning, unit: tuple[Array, Array], states: Array, left: Array, limits: Array) -> None:
    """Add to the states of a term in a run, shape (q, n), what its beginning leaves that the motion does not tell.

    Args:
        beginning: finds it.
        unit: torque per unit of the amplitude without states, and its slope along them.
        states: from the declared beginning; they are changed in place.
        left: what a unit more of each first value leaves of each state, as long as it lasts, shape (q, q, samples).
        limits: least and greatest of each state, shape (2, q).
    """
    without, slope = unit
    torque = _seen(slope, left)
    lasting = _lasting(torque)
    if lasting < _LASTS:
        first = beginning(without, _seen(slope, states), torque, limited=bool(np.all(np.isfinite(limits))))
        first *= min(math.log(_LASTS / lasting) / math.log(_LASTS / _FADED), 1.0) if lasting > 0.0 else 1.0
        first = np.clip(states[:, 0] + first, *limits) - states[:, 0]
        states[:, : left.shape[-1]] += np.tensordot(first, left, 1)


def _seen(slope: Array, states: Array) -> Array:
    """Return the torque of states, shape (..., q, n), by its slope along them, shape (q, m) with m at least n or 1."""
    each = slope[:, : states.shape[-1]] * states
    return np.asarray(each[..., 0, :] if len(slope) == 1 else np.sum(each, axis=-2))


def _count(places: slice) -> int:
    return int(places.stop - places.start)


def _lasting(torque: Array) -> float:
    """Return the share of all that is left, shape (q, n), that there still is in its last eighth."""
    size = np.abs(torque)
    return float(np.max(size[:, -max(size.shape[1] // 8, 1) :])) / (float(np.max(size)) or 1.0)


def _from_recording(model: Model) -> Iterator[tuple[Term, int, int]]:
    """Yield the terms that find their states in a recording, with the index of their first parameter and state."""
    parameter = state = 0
    for term in model.terms:
        if type(term).states_from_recording is not Term.states_from_recording:
            yield term, parameter, state
        parameter, state = parameter + len(term.parameters), state + len(term.states)


def _needed(model: Model) -> list[str]:
    return [name for name in model.signals if name in model.needs]


@lru_cache(maxsize=64)
def _first(model: Model) -> Callable[[Array, Array], Array]:
    """Return what gives the states of a model at the first sample of a run, from the signals there and parameters."""
    function = first_states(model)
    if function is None:
        declared = np.array([state.initial for state in model.states], dtype=float)
        return lambda signals, parameters: declared
    begun = ArrayFunction(function)
    return lambda signals, parameters: begun(*signals, *parameters)[0][:, 0]


@lru_cache(maxsize=64)
def _scan(model: Model, with_beginnings: bool = False) -> Scan:
    return Scan(step_with_beginnings(model) if with_beginnings else memory_step(model))


class MemoryStep:
    """The internal states of a model, one sample after the other: what :class:`Memory` does with a whole motion.

    States that a term computes from a recording follow their rates here; see :attr:`approximate`.
    """

    def __init__(self, model: Model, width: float) -> None:
        self.needs = tuple(_needed(model))
        self._first = _first(model)
        self.approximate = tuple(term.name for term, _, _ in _from_recording(model))
        self._scan, self._width = _scan(model), width

    def first(self, signals: Mapping[str, float], parameters: Sequence[float] | Array) -> tuple[float, ...]:
        """Return the states at the first sample of a motion: those declared, or those that its signals tell."""
        given = np.array([signals[name] for name in self.needs])
        return tuple(self._first(given, np.asarray(parameters, dtype=float)).tolist())

    def __call__(
        self,
        states: ArrayLike,
        begin: Mapping[str, float],
        end: Mapping[str, float],
        interval: float,
        parameters: Sequence[float] | Array,
    ) -> tuple[float, ...]:
        """Return the states a sampling interval later.

        Args:
            states: before. begin, end: every needed signal at the beginning and at the end of the interval.
            interval: its length [s]. parameters: of the model, in order.
        """
        row = [interval, *(begin[name] for name in self.needs), *(end[name] for name in self.needs)]
        following, _, _ = self._scan(states, [row], [*parameters, self._width])
        return tuple(following.tolist())


def moved(
    model: Model,
    states: Sequence[Array],
    signals: Mapping[str, ArrayLike],
    interval: float,
    parameters: Sequence[float] | Array,
    width: float,
) -> tuple[Array, ...]:
    """Return the states after a time with constant signals, each sample by itself, an array of shape (N,) for each.

    In two steps: what bends within a fraction of the way would swing over in one.

    Args:
        model: the model with memory.
        states: an array of shape (N,) for each of its states. signals: value or array of each signal that it needs.
        interval: the time [s]. parameters: of the model, in order. width: width of rest.
    """
    given = [np.broadcast_to(signals[name], np.shape(states[0])) for name in _needed(model)]
    for _ in range(2):
        states = tuple(_step(model)(*states, interval / 2, *given, *given, *parameters, width)[0])
    return tuple(states)


@lru_cache(maxsize=64)
def _step(model: Model) -> ArrayFunction:
    return ArrayFunction(memory_step(model))


def first_states(model: Model) -> Any | None:
    """Build the states at the first sample of a motion as a CasADi function; ``None`` where they are as declared.

    Inputs: the signals there that the model needs, in the order of :attr:`fricmodels.model.Model.signals`, and the
    parameters.
    """
    import casadi

    e = model.expression()
    signals = casadi.vertcat(*(e.signals[name] for name in _needed(model)))
    if not casadi.depends_on(e.first, casadi.vertcat(signals, e.parameters)):
        return None
    return casadi.Function("first", [signals, e.parameters], [e.first], {"cse": True})


def memory_step(model: Model) -> Any:
    """Build a step of the internal states as a CasADi function for :class:`fricmodels.kernels.Scan`.

    State: the internal states. Input: ``[h; signals at the beginning; signals at the end]``, those that the model
    needs, in the order of :attr:`fricmodels.model.Model.signals`. Constant: ``[parameters; width]``.
    """
    import casadi

    e = model.expression()
    signals = casadi.vertcat(*(e.signals[name] for name in _needed(model)))
    begin, end = (casadi.SX.sym(name, signals.numel()) for name in ("begin", "end"))
    h = casadi.SX.sym("h")

    def at(expression: Any, states: Any, ends: Any) -> Any:
        return casadi.substitute(expression, casadi.vertcat(e.states, signals), casadi.vertcat(states, ends))

    following = casadi.SX(e.states)
    for own in _integrated_together(model, e.discrete_step):
        # Each term by itself: in one solution a short time of one made numbers of none of them.
        states, rates = e.states[own], e.rates[own]
        before, after = at(rates, e.states, begin), at(rates, e.states, end)
        slope = casadi.jacobian(rates, states)
        mean_slope = (at(slope, e.states, begin) + at(slope, e.states, end)) / 2
        matrix = casadi.SX.eye(len(own)) - _GAMMA * h * mean_slope
        change = _GAMMA * (after - before)
        k1 = casadi.solve(matrix, before + change)
        moved = casadi.SX(e.states)
        moved[own] = states + h * k1
        k2 = casadi.solve(matrix, at(rates, moved, end) - 2 * k1 - change)
        following[own] = states + h / 2 * (3 * k1 + k2)
    given = casadi.vertcat(signals, *(e.later[name] for name in _needed(model)), e.step)
    for i, expression in e.discrete_step.items():
        following[i] = casadi.substitute(expression, given, casadi.vertcat(begin, end, h))
    slope = casadi.jacobian(following, e.states)
    if not casadi.depends_on(slope, e.states):  # all but a product and a sum can then be done ahead of the states
        following = casadi.mtimes(slope, e.states) + casadi.substitute(following, e.states, 0)
    constants = casadi.vertcat(e.parameters, e.width)
    return casadi.Function(
        "memory", [e.states, casadi.vertcat(h, begin, end), constants], [following, following], {"cse": True}
    )


def _integrated_together(model: Model, discrete: Collection[int]) -> Iterator[list[int]]:
    """Yield the places of the states of each term whose rates are integrated."""
    places = itertools.count()
    for term in model.terms:
        own = [place for place in itertools.islice(places, len(term.states)) if place not in discrete]
        if own:
            yield own


def step_with_beginnings(model: Model) -> Any:
    r"""Build a step of the internal states and of what a unit more of each unknown first value leaves of them.

    As :func:`memory_step`, but for the states: those of the model, then for every term whose beginning is unknown, and
    each of its q states i, the q numbers :math:`R_i = \partial z / \partial z_i(0)`. With
    :math:`z_{n+1} = S z_n + \dots` they follow :math:`R_{n+1} = S R_n`.

    Raises:
        TypeError: when the step of such a term is not linear in its states.
    """
    import casadi

    step = memory_step(model)
    given = [casadi.SX.sym(step.name_in(i), step.numel_in(i)) for i in range(3)]
    following = step(*given)[0]
    states, after = [given[0]], [following]
    for term, _, places in unknown_beginnings(model):
        own = given[0][places]
        slope = casadi.jacobian(following[places], own)
        if casadi.depends_on(slope, own):
            raise TypeError(f"the states of '{term.name}' have unknown first values, but are not linear in them")
        left = casadi.SX.sym("left", own.numel(), own.numel())
        states.append(casadi.vec(left))
        after.append(casadi.vec(casadi.mtimes(slope, left)))
    whole, following = casadi.vertcat(*states), casadi.vertcat(*after)
    return casadi.Function("memory", [whole, *given[1:]], [following, following], {"cse": True})
