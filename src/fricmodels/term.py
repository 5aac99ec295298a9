"""What laws and effects are: a torque written once as a symbolic expression.

A *law* is the friction law that a model starts from; an *effect* is a physical effect added to it. Both are
:class:`Term`: they declare parameters (and states, where they remember) as class attributes and write one method.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from fricmodels.dimension import (
    ACCELERATION,
    DISPLACEMENT,
    FORCE,
    TEMPERATURE,
    TIME,
    VELOCITY,
    Dimension,
)
from fricmodels.errors import InputError
from fricmodels.expressions import Expression
from fricmodels.parameter import Parameter, State

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fricmodels.past import Past
    from fricmodels.recording import Recording

SIGNALS: Mapping[str, Dimension] = {
    "velocity": VELOCITY,
    "position": DISPLACEMENT,
    "acceleration": ACCELERATION,
    "motor_torque": FORCE,
    "motor_torque_rate": FORCE * TIME**-1,
    "load_torque": FORCE,
    "temperature": TEMPERATURE,
    "time": TIME,
}
"""The signals that a term may use, and their dimensions."""


class Signals:
    """The measured signals, and the term's own states, as a term sees them: ``s.velocity``, ``s.position``, …

    A further channel that the term declares is ``s["other.j2_acceleration"]``. What is touched is remembered; it is
    what the term needs from a recording.
    """

    def __init__(self, values: Mapping[str, Expression], states: Mapping[str, Expression]) -> None:
        self._values = values
        self._states = states
        self.touched: set[str] = set()

    if TYPE_CHECKING:
        velocity: Any
        position: Any
        acceleration: Any
        motor_torque: Any
        motor_torque_rate: Any
        load_torque: Any
        temperature: Any
        time: Any

    def __getattr__(self, name: str) -> Expression:
        if name in self._states:
            return self._states[name]
        if name in self._values:
            self.touched.add(name)
            return self._values[name]
        known = ", ".join([*self._values, *self._states])
        raise AttributeError(f"there is no signal or state '{name}'; known: {known}")

    def __getitem__(self, channel: str) -> Expression:
        return getattr(self, channel)


class Parameters:
    """A term's parameters as expressions, by symbol: ``p.K_v``."""

    def __init__(self, values: Mapping[str, Expression]) -> None:
        self._values = values

    def __getattr__(self, name: str) -> Expression:
        try:
            return self._values[name]
        except KeyError:
            known = ", ".join(self._values)
            raise AttributeError(f"there is no parameter '{name}'; declared: {known}") from None


class Term(ABC):
    """A contribution to the friction torque ``τ_F`` of ``J dω/dt = τ_m − τ_L − τ_F``.

    Attributes:
        name: lower case with hyphens, as printed and as used in model names.
        formula: the equation in plain text, for lists and reports.
        parameters, states: collected from the class body, in order of declaration.
        channels: further channels of a recording that it uses beside the signals, such as ``other.j2_acceleration``,
            or ``run``, the number of the run; see :attr:`fricmodels.recording.Recording.channels`.
        dissipative: claims that τ·ω ≥ 0 for all parameters within their bounds: the term never pushes.
        symmetry: claims what the torque does when the velocity is reversed and all other signals stay: ``odd``, it
            is reversed too; ``even``, it stays; ``None``, neither.
        depends_on_time: whether it touches the time itself, so that a record that starts later has other parameters.
        angular: whether the position enters as an angle in rad (``sin q``), which no rescaling may change.
        beginning_unknown: whether its states at the beginning of a run are to be found from the torque; the term then
            has one linear parameter, and torque and rates that are linear in its states. See :mod:`.beginning`.
        optional: signals that are zero where a recording does not have them; only a load torque can be.
        same_as: terms that have the same equation under another name, on purpose.
        exam: what the exam of this class needs beside the class, such as ``{"truth": {"q_0": 3.0}}``; see
            :class:`fricmodels.testing.TermExam`.

    What a term claims is checked by :mod:`fricmodels.testing`. Two terms are equal when they are of the same class and
    hold the same values: a class defined again under its name, as in a notebook, is another one.
    """

    name: str
    formula: str = ""
    dissipative: ClassVar[bool] = False
    symmetry: ClassVar[Literal["odd", "even"] | None] = None
    depends_on_time: ClassVar[bool] = False
    angular: ClassVar[bool] = False
    beginning_unknown: ClassVar[bool] = False
    optional: ClassVar[frozenset[str]] = frozenset()
    same_as: ClassVar[frozenset[str]] = frozenset()
    exam: ClassVar[Mapping[str, Any]] = {}
    parameters: tuple[Parameter, ...] = ()
    channels: tuple[str, ...] = ()
    states: ClassVar[tuple[State, ...]] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        own = [value for value in vars(cls).values() if isinstance(value, Parameter)]
        inherited = [parameter for parameter in cls.parameters if parameter.symbol not in {p.symbol for p in own}]
        cls.parameters = (*inherited, *own)
        own_states = [value for value in vars(cls).values() if isinstance(value, State)]
        cls.states = (*cls.states, *own_states)
        symbols = [*(p.symbol for p in cls.parameters), *(z.symbol for z in cls.states)]
        if len(set(symbols)) != len(symbols):
            raise TypeError(f"{cls.__name__}: a symbol is declared twice among {', '.join(symbols)}")
        for parameter in cls.parameters:
            if parameter.at_least is not None and parameter.at_least not in symbols:
                raise TypeError(f"{cls.__name__}: {parameter.symbol} is at least '{parameter.at_least}', not declared")

    @abstractmethod
    def torque(self, s: Signals, p: Parameters) -> Expression:
        """Return the torque [N m] (or force [N]) that this term adds to the friction torque."""

    def rates(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return d/dt of each declared state, by symbol. Only terms with memory write this."""
        return {}

    def discrete_step(self, s: Signals, later: Signals, h: Expression, p: Parameters) -> Mapping[str, Expression]:
        """Return every declared state a time ``h`` later, by symbol, where a formula is exact; else nothing.

        Only terms whose states switch write this (a contact that either sticks or slips): a step of finite length
        overshoots the switch. Recordings are then followed, and drives simulated, by this in place of the rates.

        Args:
            s: signals and states at the beginning of the step; later: signals at its end, the velocity changing
                linearly between; h: its length [s]; p: the parameters.
        """
        return {}

    def first_states(self, s: Signals, p: Parameters) -> Mapping[str, Expression]:
        """Return states at the first sample of a run, by symbol; of those left out, the declared initial values.

        Override it where a drive that was in motion before its run began, as in a recording cut out of a longer one,
        has states that its first sample tells: a part on a spring lags behind the acceleration from the first sample
        on. Begun from rest it would swing as if it had been struck.

        Args:
            s: the signals at the first sample; p: the parameters.
        """
        return {}

    def states_from_recording(self, past: Past, parameters: Mapping[str, float]) -> Mapping[str, NDArray[np.float64]]:
        """Return every declared state at every sample of a recorded motion, by symbol; by default nothing.

        Override it where the state can be computed directly from recorded signals, such as the speed of a while ago.
        Filters and simulations, which do not have the recording, integrate the rates.

        Args:
            past: the motion, see :class:`fricmodels.past.Past`; parameters: values by symbol.
        """
        return {}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and vars(other) == vars(self)

    def __hash__(self) -> int:
        return hash(type(self))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} '{self.name}'>"


class Law(Term):
    """A friction law: the base that a model starts from. It never pushes, unless it says so."""

    dissipative = True

    combines: ClassVar[frozenset[str]] = frozenset()
    """Names of effects beside a Coulomb–viscous law that this law has in one: where a diagnosis names several of them,
    it says so."""


class Effect(Term):
    """A physical effect that a base law leaves out."""

    signature: str = ""
    """What the missing effect leaves in the residual torque, in words."""

    needs_motion: ClassVar[str] = ""
    """What a recording must contain to show it: slow motion, reversals, a wide speed range, …"""

    friction: ClassVar[bool] = False
    """Whether it is a part of the friction: it may push by itself, but what it leaves of the law's friction does not.
    Half the difference of two Coulomb torques is never more than their mean."""

    absent: ClassVar[str] = "the recording has nothing that it could be of"
    """Why a recording may have no candidate for it; see :meth:`candidates`."""

    separated_from: ClassVar[Mapping[str, str]] = {}
    """Effects that may look alike, by name, and the experiment that would tell them from this one, in words."""

    distinct_from: ClassVar[frozenset[str]] = frozenset()
    """Effects of which this one may contain the whole torque, though it is another physical cause."""

    only_beside: ClassVar[str] = ""
    """Name of an effect without which a diagnosis does not consider this one; empty where it stands by itself."""

    fitted_runs: frozenset[int] | None = None
    """Numbers of the runs that its parameters are of, each of one run; ``None`` where they are of all alike."""

    @classmethod
    def named(cls, argument: str = "") -> Effect:
        """Return the effect that a model's name means; the argument is what stands in brackets, if anything does.

        Raises:
            InputError: for an argument that the effect does not take.
        """
        if argument:
            raise InputError(f"'{cls.name}' takes nothing in brackets, found '{argument}'")
        return cls()

    @classmethod
    def candidates(cls, recording: Recording) -> Sequence[Effect]:
        """Return what the effect may be in a recording: itself, or one for each channel that it may be of."""
        return [cls()]

    def another(self) -> Effect | None:
        """Return the effect once more, under another name, if a drive may have several of its kind; by default none.

        Where a model has the effect, a diagnosis considers this one. See also :meth:`first_of_kind`.
        """
        return None

    def first_of_kind(self) -> Effect:
        """Return that of which it is another; by default itself."""
        return self

    def on(self, recording: Recording, beside: Sequence[Term] = ()) -> Effect:
        """Return the effect as it is for a recording, whose channels have units and whose runs have numbers.

        Args:
            recording: what a model is fitted to.
            beside: the other terms of the model.
        """
        return self

    @property
    def physics(self) -> str:
        """The physics in a few words, as they go on in a sentence."""
        first = (type(self).__doc__ or "").strip().partition("\n")[0].rstrip(".")
        return first[:1].lower() + first[1:]

    def own_friction(self, speed: float, parameters: Mapping[str, float]) -> float:
        """Return the friction [N m or N] at a speed of that part of the drive which the effect is about; 0 if of none.

        It is linear in the linear parameters, and cannot be more than all of the drive's friction.

        Args:
            speed: positive [rad/s or m/s]; parameters: values by symbol.
        """
        return 0.0
