"""Flexible sets of basis functions in one channel, or in what went before: see :mod:`.predictability`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.diagnosis.history import MotionHistory
from fricmodels.diagnosis.places import Place
from fricmodels.diagnosis.policy import Policy
from fricmodels.diagnosis.sought_functions import frequencies_tried, frequency, in_time, jump, stretch, tents
from fricmodels.recording import OTHER, RATE
from fricmodels.results.words import ALONG, LINE
from fricmodels.signals import noise
from fricmodels.weakform.problem import WeakFormProblem
from fricmodels.weakform.regression import Regression
from fricmodels.weakform.search import periods

Sets = Mapping[str, Callable[[], Array]]
"""Name of a set, and what returns it: as integrals, shape (k, rows), or at the samples, shape (k, samples)."""

TORQUE_PAST = "motor torque shortly before"
TORQUE_RATE = "rate of the motor torque"
FINELY, FINELY_ALONG = "position, finely", "position, finely, along the motion"
FINELY_TORQUE = "position, finely, and motor torque"
OF_WAVES = frozenset({FINELY, FINELY_ALONG, FINELY_TORQUE})
"""Sets of several waves at numbers that were sought: of these one may be an effect's, and the next another cause's."""
_SLOWLY = "position", "position, along the motion", "position and motor torque"
OF_POSITION = OF_WAVES.union(_SLOWLY)
"""Sets of what any torque over position may be."""
JUMP = "time, in one jump"
ZERO = "time, the same in both directions"
STRETCH, STRETCH_ALONG = "position, in one stretch", "position, in one stretch, along the motion"
OF_TIME = frozenset(
    {
        "time, along the motion",
        "time, finely, along the motion",
        "time, along the motion, and speed",
        JUMP,
        ZERO,
    }
)
"""Sets of what friction, or a zero, that goes with the time itself may be."""
_HATS = 8
_PLACES = 32
_WAVES, _FINER = 6, 12
_FINE_WAVES = 3
_EARLIER = 16
_CLOSEST = 1e-5
"""Share of the longest distance or time since an event below which it is the event itself: less is rounding."""


def basis_functions(
    problem: WeakFormProblem,
    regression: Regression,
    policy: Policy,
    only: str | None = None,
    like: WeakFormProblem | None = None,
) -> Sets:
    """Return the basis functions in every channel that a recording has, and in its history, as integrals.

    Args:
        problem, regression: rows, and what is left of them.
        policy: decides which torques are clean.
        only: the one set that is wanted: others whose numbers have to be sought may be missing.
        like: another problem with the same samples, whose functions these are to be; this one if not given. What hats
            stand on is told by how signals are distributed, and with more noise that would be other functions.
    """
    like = like or problem
    lasting = {
        **_of_motion(problem, like),
        **_of_position(problem),
        **_of_load(problem),
        **_of_further_channels(problem),
        **_of_history(problem, like, regression, policy),
    }
    found: dict[str, Callable[[], Array]] = {
        name: partial(problem.integrated, name, partial(_integrals, problem, build)) for name, build in lasting.items()
    }
    found[JUMP] = partial(jump, problem, regression)
    line = frequency(problem, regression, policy) if only is None else 0.0
    if line > 0.0:
        found[f"{LINE} {line:.3g} Hz"] = partial(in_time, problem, line)
    if "position" in problem.recording:
        found[STRETCH] = partial(stretch, problem, regression, along=False)
        found[STRETCH_ALONG] = partial(stretch, problem, regression, along=True)
    if only is None or only in OF_WAVES:
        for name, build in _periodic(problem, regression).items():
            found[name] = partial(_integrals, problem, build)
    return found


def without_sign(problem: WeakFormProblem, regression: Regression, policy: Policy, name: str) -> Array | None:
    """Return what a set along the motion is without the sign of the motion, as integrals; ``None`` where it has none.

    It has as many columns or more, so that what both explain can be compared: slow waves that turn their sign with a
    slow motion are finer ones without.
    """
    if ALONG not in name or name == STRETCH_ALONG:  # a stretch has its own place
        return None
    if name.startswith("time"):
        return problem.integrals(_slow(problem.quadrature.recording.time, _FINER))
    other = name.replace(ALONG, "the same in both directions") if name.startswith("speed") else unsigned(name)
    build = basis_functions(problem, regression, policy, other).get(other)
    return None if build is None else build()


def unsigned(name: str) -> str:
    """Return the name of a set without the sign of the motion."""
    return name.replace(f", {ALONG}", "")


def terms(name: str, columns: Array) -> int:
    """Return the number of a set's columns, and of the instants or wave numbers that were sought beside them."""
    waves = (len(columns) + 1) // 2 if name in OF_WAVES else 0
    return len(columns) + waves + (name == JUMP or name.startswith(LINE))


def chances(name: str, problem: WeakFormProblem) -> int:
    """Return among how many frequencies the one of a set was sought; 1 where none was."""
    return frequencies_tried(problem) if name.startswith(LINE) else 1


def hats_within(problem: WeakFormProblem, place: Place) -> Array:
    """Return narrow hats over a place as integrals, shape (k, rows): a torque of any course there, and none elsewhere.

    Hats over the whole channel could draw whatever repeats itself where a path is repeated, an effect of the speed too.

    Args:
        problem: the rows.
        place: stretch of a channel; the torque is there in its direction of motion only, or in both.
    """
    return problem.integrals(_hats_of(problem, place))


def one_torque_within(problem: WeakFormProblem, place: Place) -> Array:
    """Return one torque all over a place, and its two ends apart, as integrals, shape (3, rows), or fewer.

    It is the least that a place can be: the ends are known to a hat only.
    """
    hats = _hats_of(problem, place)
    inner = hats[1:-1].sum(axis=0, keepdims=True) if len(hats) > 2 else hats[:0]
    return problem.integrals(np.vstack([hats[:1], inner, hats[1:][-1:]]))


def _hats_of(problem: WeakFormProblem, place: Place) -> Array:
    points = problem.quadrature.recording
    side = np.sign(points.velocity)
    values = np.abs(points.velocity) if place.channel == "speed" else points[place.channel]
    knots = np.unique(np.quantile(values, np.linspace(0, 1, _PLACES)))
    reach = np.r_[knots[1:], knots[-1]] >= place.low
    hats = tents(values, knots)[reach & (np.r_[knots[0], knots[:-1]] <= place.high)]
    if place.direction in ("forward", "backward"):
        return np.asarray(hats * (side == (1.0 if place.direction == "forward" else -1.0)))
    return np.asarray(side * hats if place.channel == "speed" or place.direction == ALONG else hats)


def _integrals(problem: WeakFormProblem, build: Callable[[], Array]) -> Array:
    return problem.integrals(build())


def _of_motion(problem: WeakFormProblem, like: WeakFormProblem) -> Sets:
    points = problem.quadrature.recording
    velocity, time = points.velocity, points.time
    speed, side = np.abs(velocity), np.sign(velocity)
    speeds = np.abs(like.quadrature.recording.velocity)
    found: dict[str, Callable[[], Array]] = {
        "speed, along the motion": lambda: _turned(side, _hats(speed, _HATS, speeds)),
        "speed, the same in both directions": lambda: _hats(speed, _HATS, speeds),
        "time, along the motion": lambda: side * _slow(time),
        "time, along the motion, and speed": lambda: np.vstack([side * _slow(time), velocity * _slow(time)]),
        "time, finely, along the motion": lambda: side * _slow(time, _FINER),
        ZERO: lambda: np.vstack([np.ones(len(time)), _slow(time)]),
        "motor torque": lambda: _characteristic(problem.motor_torque),
        "motor torque, along the motion": lambda: side * np.abs(_powers(problem.motor_torque)),
        TORQUE_RATE: lambda: np.vstack([points["torque_rate"], side * np.abs(points["torque_rate"])]),
        "acceleration": lambda: _either_way(points["acceleration"], side),
        # To first order friction that lags: the rate of what depends on speed.
        "acceleration and speed": lambda: _turned(points["acceleration"], _hats(speed, _HATS, speeds)),
    }
    if "temperature" in points:
        warm = points["temperature"] - np.mean(points["temperature"])
        found["temperature"] = lambda: np.vstack(
            [warm, side * warm, velocity * warm, side * warm**2, velocity * warm**2]
        )
    return found


def _of_position(problem: WeakFormProblem) -> Sets:
    points = problem.quadrature.recording
    if "position" not in points:
        return {}

    @cache
    def waves() -> Array:
        return _waves(points["position"])

    return {
        _SLOWLY[0]: waves,
        _SLOWLY[1]: lambda: np.sign(points.velocity) * waves(),
        _SLOWLY[2]: lambda: problem.motor_torque * waves(),
    }


def _of_load(problem: WeakFormProblem) -> Sets:
    points = problem.quadrature.recording
    if "load_torque" not in points:
        return {}
    load, side = points.load_torque, np.sign(points.velocity)
    return {
        "load torque": lambda: _powers(load),
        "load torque, along the motion": lambda: side * np.abs(_powers(load)),
        "load torque and direction": lambda: np.vstack([load, np.abs(load), side * load, side * np.abs(load)]),
    }


def _of_further_channels(problem: WeakFormProblem) -> Sets:
    """Return powers of each further channel, or waves over it where it is an angle, also along the motion."""
    points = problem.quadrature.recording
    side = np.sign(points.velocity)
    found: dict[str, Callable[[], Array]] = {}
    for channel in points.further:
        name = channel.removeprefix(OTHER).replace("_", " ")
        values = points[channel] - np.mean(points[channel])
        build = partial(_waves if points.units.get(channel) == "rad" else _powers, values)
        found[name] = build
        found[f"{name}, along the motion"] = partial(_along, side, build)
        if points.units.get(channel) in ("rad/s", "m/s"):
            found[f"rate of {name}"] = partial(_powers, points[RATE + channel])
    return found


def _along(side: Array, build: Callable[[], Array]) -> Array:
    return np.asarray(side * build())


def _of_history(problem: WeakFormProblem, like: WeakFormProblem, regression: Regression, policy: Policy) -> Sets:
    @cache
    def history() -> MotionHistory:
        return MotionHistory.of(problem)

    @cache
    def past() -> MotionHistory:
        return history() if like is problem else MotionHistory.of(like)

    def after_reversal() -> Array:
        near = _log_hats(history().travelled, _HATS, past().travelled)
        again = problem.quadrature.recording["acceleration"] * near[: _HATS // 2]
        return np.vstack([_turned(history().side, near), again])

    def after_start(since: Array, of: Array) -> Array:
        near = _log_hats(since, _HATS, of)
        both = np.empty((2, *near.shape))
        both[0] = near
        np.multiply(np.log1p(history().dwell / problem.recording.interval), near, out=both[1])
        return _turned(history().side, both.reshape(-1, near.shape[1]))

    recording = problem.recording
    lags: Index = np.unique(np.arange(1, _EARLIER + 1) * problem.test_functions.width // _EARLIER)
    apart = problem.test_functions.width + problem.half_width
    found: dict[str, Callable[[], Array]] = {
        "distance since the last reversal": after_reversal,
        "time since the last reversal": lambda: _turned(
            history().side, _log_hats(history().turned, _HATS, past().turned)
        ),
        "distance since motion began, and the rest before": lambda: after_start(history().moved, past().moved),
        "time since motion began, and the rest before": lambda: after_start(history().started, past().started),
        # Far enough before to share no noise with the rows.
        "acceleration shortly before": lambda: _earlier(problem, recording["acceleration"], apart + 2 * lags),
    }
    # With an estimated inertia, clean torques give back what the momentum would be without noise, and so the noise.
    tells_noise = problem.drive.inertia is None and _inertia_is_noisy(problem)
    if not tells_noise and _torque_noise(problem) < policy.clean_torque * float(
        np.sqrt(np.mean(regression.residual**2))
    ):
        found[TORQUE_PAST] = lambda: _earlier(problem, recording.torque, lags)
    return found


def _periodic(problem: WeakFormProblem, regression: Regression) -> Sets:
    """Return waves over position at the wave numbers at which the residual is most periodic."""
    if "position" not in problem.recording:
        return {}
    points = problem.quadrature.recording
    side = np.sign(points.velocity)
    count = len(problem.recording)
    factors = {
        FINELY: np.ones(len(side)),
        FINELY_ALONG: side,
        FINELY_TORQUE: problem.motor_torque,
    }

    def waves(factor: Array, strongest: tuple[float, ...]) -> Array:
        phases = np.outer(strongest, points["position"])
        return np.asarray(factor * np.vstack([np.cos(phases), np.sin(phases)]))

    found: dict[str, Callable[[], Array]] = {}
    for name, factor in factors.items():
        strongest = periods(problem, regression, factor[:count], 0.0).strongest[:_FINE_WAVES]
        if strongest:
            found[name] = partial(waves, factor, strongest)
    return found


def _either_way(values: Array, side: Array) -> Array:
    """Return values and their sizes, each the same in both directions and along the motion."""
    both = np.vstack([values, np.abs(values)])
    return np.vstack([both, side * both])


def _hats(values: Array, count: int, of: Array) -> Array:
    """Return hats that stand as closely as some values do, ``of`` which they are the quantiles."""
    return tents(values, np.quantile(of, np.linspace(0, 1, count)))


def _log_hats(values: Array, count: int, of: Array) -> Array:
    """Return hats that are the finer the nearer to zero; the last one reaches to the end of the values ``of`` all."""
    positive = of[of > _CLOSEST * np.max(of)]
    if not len(positive):
        return np.zeros((1, len(values)))
    largest, smallest = np.quantile(positive, [0.9, 0.01])
    return tents(values, np.concatenate([[0.0], np.geomspace(smallest, largest, count - 1)]))


def _turned(factor: Array, rows: Array) -> Array:
    """Return rows times a factor at each sample; they are written to: there may be many."""
    return np.multiply(factor, rows, out=rows)


def _powers(values: Array) -> Array:
    scale = float(np.max(np.abs(values))) or 1.0
    return np.vstack([values / scale, (values / scale) ** 2, (values / scale) ** 3])


def _characteristic(values: Array) -> Array:
    """Return powers and the signed square: a torque that falls short of the current is odd in it, and no cubic."""
    first, second, third = _powers(values)
    return np.vstack([first, second, np.sign(values) * second, third])


def _slow(time: Array, count: int = _WAVES) -> Array:
    """Return waves of half a period over the record, a whole one, one and a half, and so on, shape (count, N).

    Six are slow enough to reach over a block that is kept back; with twelve some of its course is guessed.
    """
    phase = np.pi * (time - np.min(time)) / (float(np.ptp(time)) or 1.0)
    return np.cos(np.arange(1, count + 1)[:, None] * phase)


def _waves(position: Array) -> Array:
    low, high = float(np.min(position)), float(np.max(position))
    phase = np.pi * (position - low) / ((high - low) or 1.0)
    numbers = np.arange(1, _WAVES + 1)[:, None]
    return np.vstack([np.cos(numbers * phase), np.sin(numbers * phase)])


def _earlier(problem: WeakFormProblem, values: Array, lags: Index) -> Array:
    """Return a signal as it was some samples before, one row a lag."""
    recording, cell = problem.recording, problem.quadrature.cell
    run = recording.run
    first = np.maximum.accumulate(np.where(np.concatenate([[True], np.diff(run) != 0]), np.arange(len(run)), 0))
    rows = np.empty((len(lags), len(run) + 2 * len(cell)))
    for row, lag in zip(rows, lags, strict=True):
        index = np.maximum(np.arange(len(run)) - lag, first)
        after = index[np.minimum(cell + 1, len(run) - 1)]
        row[:] = values[np.concatenate([index, index[cell], after])]
    return rows


def _inertia_is_noisy(problem: WeakFormProblem) -> bool:
    """Whether noise of the momentum makes an inertia fitted to it too small by a tenth of its standard error.

    By least squares it is too small by the share λ of noise in the squared momentum; its standard error is no less than
    √(λ/n) of it, with n independent rows.
    """
    return problem.momentum_noise * problem.independent > 0.01 * float(problem.momentum @ problem.momentum)


def _torque_noise(problem: WeakFormProblem) -> float:
    """Return the noise of the motor torque as a row sees it, in units of the residual."""
    recording = problem.recording
    return float(noise(recording.time, recording.torque, recording.run) * recording.interval)
