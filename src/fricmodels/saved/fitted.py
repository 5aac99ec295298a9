"""A fitted model to keep: it gives torques, compensates, simulates, and goes into a file and out of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fricmodels.arrays import Array
from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.errors import InputError, suggestion
from fricmodels.files import write_text
from fricmodels.fitted_runs import numbered_as_fitted
from fricmodels.memory import Memory, MemoryStep
from fricmodels.model import Known, Model
from fricmodels.recording import Recording
from fricmodels.saved.document import ModelDocument
from fricmodels.saved.read import model_of, read_document
from fricmodels.saved.signals import Given, given
from fricmodels.saved.states import Along, Moving, along, begun, moved
from fricmodels.saved.words import described

if TYPE_CHECKING:
    from fricmodels.simulation import Between
    from fricmodels.tracking.compensator import AtRest

_TINY = 1e-9
"""Speed at which the two limits of the torque at rest are taken, in widths of rest; as a sticking drive is judged."""


class FittedModel:
    r"""A friction model with its numbers: ``τ_F`` of ``J dω/dt = τ_m − τ_L − τ_F``.

    All quantities are SI: rad, N m and s on a rotary drive; m, N and s on a linear axis; °C. Get one from
    :func:`fricmodels.load`, or from a result with :func:`fricmodels.keep`. It does not change; ``copy`` and ``pickle``
    work.

    Args:
        document: what stands in its file.
        place: where it came from, for errors.
        model: the model itself, where it is at hand; looked up by its name if not.

    Raises:
        InputError: where a law or an effect is not installed.
    """

    def __init__(self, document: ModelDocument, place: str = "this model", model: Model | None = None) -> None:
        self.document = document
        self.model: Model = model_of(document, place) if model is None else model
        inertia = next(iter(document.parameters.values()))
        self.drive = Drive(self.model, inertia.value if inertia.given else None, document.motion)

    # ---- what it is -----------------------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The model's name, such as ``coulomb-viscous+gravity``."""
        return self.model.name

    @property
    def equation(self) -> str:
        """The equations of law and effects in plain text."""
        return ";  ".join(f"{term.name}: {term.equation}" for term in self.document.terms)

    @property
    def motion(self) -> Motion:
        """Rotary or linear."""
        return self.document.motion

    @property
    def parameters(self) -> dict[str, float]:
        """Value of every parameter by key, the inertia first."""
        return {key: p.value for key, p in self.document.parameters.items()}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of every parameter that has one."""
        return {k: p.standard_error for k, p in self.document.parameters.items() if p.standard_error is not None}

    @property
    def units(self) -> dict[str, str]:
        """Unit of every parameter."""
        return {key: p.unit for key, p in self.document.parameters.items()}

    @property
    def covariance(self) -> tuple[tuple[str, ...], Array] | None:
        """Keys, and the covariance matrix in their order; ``None`` where it is not known."""
        stored = self.document.covariance
        return None if stored is None else (stored.keys, np.array(stored.values, dtype=float))

    @property
    def not_identified(self) -> dict[str, str]:
        """Key → reason, of every parameter that the recording did not determine."""
        return {k: p.reason or "not determined" for k, p in self.document.parameters.items() if not p.identified}

    @property
    def of_the_clock(self) -> str:
        """What to know of terms that go with the time itself; empty where there are none."""
        names = [term.name for term in self.model.terms if term.depends_on_time]
        if not names:
            return ""
        go, mean = ("goes", "it means") if len(names) == 1 else ("go", "they mean")
        return (
            f"{' and '.join(names)} {go} with the time since the first sample of this recording: at any other time "
            f"{mean} nothing; to take the model along, fit it without"
        )

    @property
    def fitted_runs(self) -> dict[str, int]:
        """Number of each run that it was fitted to, by the checksum of its torque; empty where none is known."""
        pairs = zip(self.document.run_checksums, self.document.runs, strict=False)
        return {checksum: number for checksum, number in pairs if checksum}

    @property
    def inertia(self) -> float:
        """J [kg m²] or M [kg]."""
        return next(iter(self.document.parameters.values())).value

    @property
    def needs(self) -> frozenset[str]:
        """The signals that its torque takes."""
        return self.model.needs

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Least and greatest value of each channel in the recording that it was fitted to."""
        return {name: (seen.least, seen.greatest) for name, seen in self.document.range.items()}

    def outside(self, **signals: ArrayLike) -> dict[str, float]:
        """Return, for each signal that leaves the range of the recording, the share of its samples outside.

        Raises:
            InputError: for a signal that neither the recording nor the model has.
        """
        names = {"motor_torque": "torque"}
        found, known = {}, {*self.ranges, *names, *self.model.signals}
        for name, values in signals.items():
            if name not in known:
                raise InputError(f"there is no signal '{name}'{suggestion(name, known)}")
            low, high = self.ranges.get(names.get(name, name), (-np.inf, np.inf))
            array = np.asarray(values, dtype=float)
            share = float(np.mean((array < low) | (array > high)))
            if share > 0:
                found[name] = share
        return found

    # ---- torque ---------------------------------------------------------------------------------------------------

    def torque(
        self,
        data: object = None,
        /,
        *,
        states: Sequence[ArrayLike] | None = None,
        channels: Mapping[str, ArrayLike] | None = None,
        **signals: ArrayLike | None,
    ) -> Any:
        r"""Return the friction torque τ_F [N m or N].

        Args:
            data: a table with a column for each signal (``velocity`` or ``velocity_rad_s``, …), or a recording. Of a
                recording, runs are told by their torque: one that the model was not fitted to has no offset of its own.
            states: one number or array for each internal state of a model with memory. Without them they are
                integrated along the motion, for which ``time`` is needed; ``run`` says where one begins anew.
            channels: further channels by name, such as ``{"other.j2_velocity": …}``.
            signals: ``velocity``, ``position``, ``acceleration``, ``motor_torque``, ``load_torque``, ``temperature``,
                ``time``, each a number or an array; they broadcast. ``time`` counts from the start of the recording.

        Returns:
            A float for numbers, an array of the common shape for arrays, a series for a table.

        Raises:
            InputError: where a signal that the model needs is missing.
        """
        call = given(self.model, self._known(data), {**signals, **(channels or {})})
        return call.answer(self._torque(call, self._states(call, states)))

    def compensation(
        self,
        data: object = None,
        /,
        *,
        at_rest: AtRest = "none",
        reference: ArrayLike | None = None,
        width: float | None = None,
        states: Sequence[ArrayLike] | None = None,
        channels: Mapping[str, ArrayLike] | None = None,
        **signals: ArrayLike | None,
    ) -> Any:
        r"""Return the torque to add to a controller's so that friction is cancelled: τ_F, defined at rest too.

        With the limits :math:`\tau_\pm` of the torque as the velocity goes to zero from either side, at
        :math:`|\omega| \le w`:

        - ``none``: :math:`(\tau_+ + \tau_-)/2`. Friction that opposes motion is left out, a weight is still held.
        - ``reference``: :math:`\tau_+` or :math:`\tau_-`, by the sign of ``reference``; where it is 0, as ``none``.
        - ``smooth``, at every speed: :math:`\tfrac{1+\tanh(\omega/w)}{2}\,\tau_F(\max(\omega, 0^+)) +
          \tfrac{1-\tanh(\omega/w)}{2}\,\tau_F(\min(\omega, 0^-))`, which is continuous and tends to τ_F for |ω| ≫ w.

        Inertia and load are not in it: the whole feed-forward is ``J·α + τ_L + compensation``.

        Args:
            data, states, channels, signals: as of :meth:`torque`. Take the reference velocity, or the measured one.
            at_rest: what is done at rest.
            reference: the velocity that is wanted next, or anything of its sign.
            width: w [rad/s or m/s]; the width of rest if not given, which ``smooth`` does not allow.

        Raises:
            InputError: for a missing signal, a missing reference, or a width that is not positive.
        """
        check_at_rest(at_rest, reference, width)
        call = given(self.model, self._known(data), {**signals, **(channels or {})})
        if "velocity" not in call.values:
            raise InputError("a compensation needs the velocity; give it as velocity=…")
        z, velocity = self._states(call, states), call.values["velocity"]
        tiny, w = _TINY * self.document.rest_width, width or self.document.rest_width
        above = self._torque(call, z, np.maximum(velocity, tiny))
        below = self._torque(call, z, np.minimum(velocity, -tiny))
        if at_rest == "smooth":
            share = np.tanh(velocity / w)
            return call.answer(np.atleast_1d((above * (1 + share) + below * (1 - share)) / 2))
        wanted = 0.0 if at_rest == "none" else np.sign(np.asarray(reference, dtype=float)).ravel()
        direction = np.where(np.abs(velocity) > w, np.sign(velocity), wanted)
        return call.answer(np.atleast_1d((above * (1 + direction) + below * (1 - direction)) / 2))

    def _known(self, data: object) -> object:
        """Return what is given; a recording with its runs numbered as the model knows them."""
        known = Known(runs=self.fitted_runs)
        return numbered_as_fitted(data, self.model.knowing(known)) if isinstance(data, Recording) else data

    def _torque(self, call: Given, states: Sequence[ArrayLike], velocity: Array | None = None) -> Array:
        values = dict(call.values) if velocity is None else {**call.values, "velocity": velocity}
        return self.drive.torque_of(values, self._values, states, self.document.rest_width)

    @cached_property
    def _values(self) -> Array:
        return self.drive.split(self.parameters)[1]

    def _states(self, call: Given, states: Sequence[ArrayLike] | None) -> Sequence[ArrayLike]:
        wanted = [state.symbol for state in self.model.states]
        if not wanted:
            return ()
        if states is not None:
            if len(states) != len(wanted):
                raise InputError(f"'{self.name}' has the states {', '.join(wanted)}; {len(states)} were given")
            return [np.broadcast_to(z, call.shape).ravel() if np.ndim(z) else z for z in states]
        if call.time is None or len(call.shape) != 1:
            raise InputError(
                f"'{self.name}' remembers ({', '.join(wanted)}); give the motion as arrays with time=…, or states=…, "
                f"or go sample by sample with follow()"
            )
        run = np.zeros(len(call.time), dtype=np.int64) if call.run is None else call.run
        return Memory(self.model, call.values, call.time, run, self.document.rest_width)(self._values)

    # ---- sample by sample -----------------------------------------------------------------------------------------

    @cached_property
    def memory(self) -> MemoryStep:
        """What advances the internal states by a sample; see :meth:`follow`."""
        return MemoryStep(self.model, self.document.rest_width)

    def follow(self, before: Along | None, interval: float = 0.0, **signals: float) -> tuple[float, Along]:
        """Return the friction torque at the next sample of a measured motion, and what to pass the next time.

        The internal states are advanced exactly as :meth:`torque` integrates them along arrays; memory is bounded.
        Effects that look back in a recording (``frictional-lag``) follow their rates instead.

        Args:
            before: what the last call returned; ``None`` at the first sample.
            interval: time since the last sample [s].
            signals: the signals at this sample, as of :meth:`torque`.
        """
        return along(self.model, self.memory, self.torque, self._values, before, interval, signals)

    def start(self, velocity: float = 0.0, position: float = 0.0, time: float = 0.0) -> Moving:
        """Return a drive at rest or in motion, its internal states as declared, for :meth:`step`."""
        return begun(self.model, velocity, position, time)

    def step(self, before: Moving, torque: float, interval: float, **signals: float) -> Moving:
        """Return the drive a sampling interval later, under a motor torque that is held through it.

        It sticks and slides as :meth:`simulate` has it, whose steps with ``between_samples="held"`` these are.

        Args:
            before: the drive now.
            torque: motor torque [N m or N].
            interval: [s].
            signals: ``load_torque``, ``temperature`` and whatever else the model needs beside the motion.
        """
        return moved(self.drive, self.parameters, self.document.rest_width, before, torque, interval, signals)

    def simulate(
        self,
        torque: ArrayLike,
        initial: Moving | Mapping[str, float] | None = None,
        *,
        time: ArrayLike | None = None,
        interval: float | None = None,
        between_samples: Between = "linear",
        **given: Any,
    ) -> Recording:
        """Return the motion of the drive under a motor torque, open loop, with stick and slip.

        Args:
            torque: at each sample, shape (N,) [N m or N].
            initial: the drive at the first sample, from :meth:`start` or as ``{"velocity": …, "position": …}``.
            time: of each sample [s]; or give ``interval``, the time between two.
            between_samples: whether the torque runs straight from sample to sample, or is held.
            given: ``load_torque``, ``temperature``, ``further``, ``run``, ``substeps``, as of
                :func:`fricmodels.simulation.simulate`.

        Returns:
            A recording with ``time``, ``torque``, ``velocity`` and ``position``.

        Raises:
            InputError: where neither time nor interval is given, or a signal is missing.
        """
        from fricmodels.simulation import simulate

        pushed = np.asarray(torque, dtype=float)
        if pushed.ndim != 1:
            raise InputError(f"simulate takes a torque of shape (N,), got {pushed.shape}")
        if (time is None) == (interval is None):
            raise InputError("give time=… of each sample, or interval=… between two; not both")
        if isinstance(initial, Mapping):
            unknown = set(initial) - {"velocity", "position", "time"}
            if unknown:
                raise InputError(f"initial has velocity, position and time, not '{min(unknown)}'")
            initial = self.start(**initial)
        first = initial or self.start()
        times = first.time + np.arange(len(pushed)) * float(interval or 0.0) if time is None else time
        return simulate(
            self.drive, self.parameters, times, pushed,
            initial_velocity=first.velocity, initial_position=first.position, initial_states=first.states,
            between_samples=between_samples, width=self.document.rest_width, with_position=True,
            name=given.pop("name", "simulated"), **given,
        )  # fmt: skip

    # ---- files ----------------------------------------------------------------------------------------------------

    def save(self, path: str | Path) -> Path:
        """Write the model into a file, whole or not at all; :func:`fricmodels.load` reads it."""
        return write_text(Path(path), self.document.to_json())

    @classmethod
    def load(cls, path: str | Path) -> FittedModel:
        """Read a model from its file.

        Raises:
            InputError: where the file cannot be used, or a law or an effect in it is not installed.
        """
        return cls(read_document(path), str(path))

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.document.to_json(),)

    def __copy__(self) -> FittedModel:
        return self

    def __deepcopy__(self, memo: object) -> FittedModel:
        return self

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FittedModel) and other.document == self.document

    def __hash__(self) -> int:
        return hash(self.document.to_json())

    def __repr__(self) -> str:
        return described(self.document)


def check_at_rest(at_rest: str, reference: object, width: float | None) -> None:
    """Refuse a compensation that is not defined.

    Raises:
        InputError: saying what to give.
    """
    if at_rest not in ("none", "reference", "smooth"):
        raise InputError(f"at_rest is 'none', 'reference' or 'smooth', not '{at_rest}'")
    if at_rest == "reference" and reference is None:
        raise InputError("at_rest='reference' needs reference=…: the velocity that is wanted next")
    if at_rest == "smooth" and width is None:
        raise InputError("at_rest='smooth' needs width=…: the speed within which the torque turns over")
    if width is not None and not (width > 0 and np.isfinite(width)):
        raise InputError(f"width must be positive and finite, got {width}")


def _again(text: str) -> FittedModel:
    """Return the model of a document's text."""
    return FittedModel(ModelDocument.model_validate_json(text))
