"""The error against the channel that shows it: means with 95 % bars, and what an added effect says there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fricmodels.arrays import Array, Index, Mask
from fricmodels.dimension import DISPLACEMENT
from fricmodels.errors import InputError
from fricmodels.report.figures.grid import even_edges
from fricmodels.report.figures.hysteresis import reversals
from fricmodels.report.figures.residuals import Pieces, resemblance
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import (
    LIGHT,
    Figure,
    graph_objects,
    label,
    logarithmic,
    stroke,
    styled,
    unit_of,
    words,
)
from fricmodels.results.words import NORMAL_95

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison

SINCE_REVERSAL = "distance since reversal"
"""The channel of effects with a memory: how far the drive went since it last turned."""
TORQUE_RATE = "torque_rate"
"""The channel of effects of the rate of the motor torque, which every recording has."""
_BINS = 40
_LEAST = 8
"""Samples from which a mean is shown."""
_OUTER = 0.002
_PERIODS = 1.5
"""A position is folded where it covers more periods than this."""
_BLOCK = 1 << 17
"""Samples that are looked at together, so that memory stays bounded."""

_Block: TypeAlias = tuple[Array, Array, Array, Index]
"""Where some samples lie, two signals of them, and the uninterrupted piece that each belongs to."""


@dataclass(frozen=True)
class Means:
    """Means of a signal in bins of a channel.

    Attributes:
        at: middle of each bin.
        mean, half: mean and half of its 95 % interval, for residuals that are alike for a while.
        other: mean of a second signal in the same bins.
    """

    at: Array
    mean: Array
    half: Array
    other: Array

    @property
    def rms(self) -> float:
        """RMS of the means."""
        return float(np.sqrt(np.mean(self.mean**2))) if len(self.mean) else float("nan")


def means(x: Array, values: Array, other: Array, piece: Index, edges: Array) -> Means:
    """Return the means of two signals in bins.

    Args:
        x, values, other: in order of time, shape (N,).
        piece: uninterrupted pieces of the samples.
        edges: of the bins; what lies beyond them is left out.
    """

    def blocks() -> Iterator[_Block]:
        for start in range(0, len(x), _BLOCK):
            part = slice(start, start + _BLOCK)
            yield x[part], values[part], other[part], piece[part]

    return _means(blocks, edges)


def _means(blocks: Callable[[], Iterator[_Block]], edges: Array) -> Means:
    """Return :func:`means` of samples that come in blocks, in order of time, twice: memory stays bounded."""
    size = len(edges) - 1
    count, total, second = np.zeros(size, dtype=np.int64), np.zeros(size), np.zeros(size)
    pieces = Pieces()
    for x, values, other, piece in blocks():
        place, inside = _bins(x, edges)
        count += np.bincount(place, minlength=size)
        total, second = _added(total, place, values[inside]), _added(second, place, other[inside])
        pieces.follow(piece[inside])
    some = np.maximum(count, 1)
    mean, square, taken = total / some, np.zeros(size), 0
    longest = pieces.beginning_of_longest()
    excerpt = [np.zeros(0)]
    for x, values, _, _ in blocks():
        place, inside = _bins(x, edges)
        rest = values[inside]
        rest -= mean[place]
        square = _added(square, place, rest**2)
        excerpt.append(rest[max(longest.start - taken, 0) : max(longest.stop - taken, 0)])
        taken += len(rest)
    deviation, alike = np.sqrt(square / some), resemblance(np.concatenate(excerpt))
    shown = count >= _LEAST
    half = NORMAL_95 * deviation / np.sqrt(np.maximum(count / alike, 1.0))
    return Means(((edges[:-1] + edges[1:]) / 2)[shown], mean[shown], half[shown], (second / some)[shown])


def _bins(x: Array, edges: Array) -> tuple[Index, Mask]:
    """Return the bin of each sample that lies in one, and which samples do."""
    place = np.searchsorted(edges, x, side="right") - 1
    inside = (place >= 0) & (place < len(edges) - 1)
    return place[inside], inside


def _added(total: Array, place: Index, values: Array) -> Array:
    """Return sums in bins with further values added to them one after the other, as if all were added at once."""
    size = len(total)
    places, weights = np.concatenate([np.arange(size), place]), np.concatenate([total, values])
    return np.asarray(np.bincount(places, weights, size), dtype=float)


@dataclass(frozen=True)
class ErrorOver:
    """The mean error over a channel.

    Attributes:
        before: means of the error without an effect; beside them what the effect adds to the modelled torque.
        left: means of the error with it; ``None`` where no larger model is given.
        axis: title of the channel, with its unit.
        opposes: whether the error is counted along the motion, as it turns its sign with that.
    """

    before: Means
    left: Means | None
    axis: str
    opposes: bool


def error_over(
    before: Comparison,
    channel: str,
    after: Comparison | None = None,
    period: float | None = None,
    *,
    along: bool | None = None,
) -> ErrorOver:
    """Return the mean error over a channel; see :func:`error_against`."""
    samples = Samples.of(before)
    error = samples.error
    larger = None if after is None else Samples.of(after).error
    place, title, folded = _place(samples, channel, period)
    edges = even_edges(*((0.0, folded) if folded else place.reach()), _BINS)

    def found(turn: bool, left: bool = False) -> Means:
        def blocks() -> Iterator[_Block]:
            for index, x in place.blocks():
                own = error[index]
                added = np.broadcast_to(0.0, len(own)) if larger is None else own - larger[index]
                shown = own - added if left else own
                side = np.sign(samples.velocity[index]) if turn else 1.0
                what = added if left or larger is None else side * added
                yield x, side * shown, what, samples.recording.run[index]

        return _means(blocks, edges)

    plain, turned = found(turn=False), found(turn=True)
    stronger = _strength(turned, after is not None) > _strength(plain, after is not None)
    opposes = bool(stronger) if along is None else along
    return ErrorOver(
        turned if opposes else plain, found(opposes, left=True) if larger is not None else None, title, opposes
    )


def error_against(
    before: Comparison,
    channel: str,
    after: Comparison | None = None,
    period: float | None = None,
    *,
    along: bool | None = None,
) -> Figure:
    """Draw the mean error over a channel, and what a larger model adds to the modelled torque there.

    Args:
        before: the model without the effect.
        channel: of the recording, or :data:`SINCE_REVERSAL`.
        after: the same recording with the effect in the model; without it only the error is shown.
        period: over which a position is folded, where the recording covers several.
        along: whether to count the error along the motion; where that shows more, if not given.

    Raises:
        InputError: when the recording has no such channel, it never changes, or the drive never reverses.
    """
    samples, over = Samples.of(before), error_over(before, channel, after, period, along=along)
    torque = words("torque error", samples.motion)
    what = f"{torque}, opposing motion" if over.opposes else torque
    figure, unit = graph_objects().Figure(), samples.torque_unit
    name = "mean error" if over.left is None else "mean error without it"
    figure.add_trace(_points(over.before, name, unit, "measured", "circle"))
    if over.left is not None:
        x, y, shown = over.before.at, over.before.other, f"the effect: %{{y:.3g}} {unit}<extra></extra>"
        figure.add_trace(stroke(x, y, "what the effect adds to the model", "vermillion", 2.4, hovertemplate=shown))
        figure.add_trace(_points(over.left, "mean error with it", unit, "blue", "square-open"))
        figure.update_layout(meta={"left": over.left.rms})
    figure.update_layout(meta={**(figure.layout.meta or {}), "means": over.before.rms, "opposes": over.opposes})
    figure.update_xaxes(title_text=over.axis)
    figure.update_yaxes(title_text=label(what, unit))
    name = f"Error against {over.axis.partition(' [')[0]}"
    return styled(figure, name, samples.subtitle, height=335)


def _points(shown: Means, name: str, unit: str, colour: str, symbol: str) -> Figure:
    return graph_objects().Scatter(
        x=shown.at,
        y=shown.mean,
        name=f"{name}, 95 % bars",
        mode="markers",
        marker={"color": LIGHT[colour], "symbol": symbol, "size": 6},
        error_y={"type": "data", "array": shown.half, "thickness": 1.2, "width": 2, "color": LIGHT[colour]},
        hovertemplate=f"{name}: %{{y:.3g}} {unit}<extra></extra>",
    )


def _strength(shown: Means, modelled: bool) -> float:
    return float(np.mean((shown.other if modelled else shown.mean) ** 2)) if len(shown.at) else 0.0


@dataclass(frozen=True)
class _Place:
    """Samples, and where they lie on an axis.

    Attributes:
        samples: which ones, in order: a mask of all, or their numbers.
        at: where each of all samples lies; where they are numbered, each of these.
        period: over which that is folded, or 0.
    """

    samples: Mask | Index
    at: Array
    period: float = 0.0

    def blocks(self) -> Iterator[tuple[Index, Array]]:
        """Yield the numbers of some samples after the other, and where they lie."""
        for start in range(0, len(self.at), _BLOCK):
            part = slice(start, start + _BLOCK)
            some = self.samples[part]
            numbers = np.flatnonzero(some) + start if some.dtype == bool else np.asarray(some, np.int64)
            at = self.at[part][some] if some.dtype == bool else self.at[part]
            yield numbers, np.mod(at, self.period) if self.period else at

    def reach(self) -> tuple[float, float]:
        """Return between which places all but a few samples lie."""
        at = self.at[self.samples] if self.samples.dtype == bool else self.at.copy()
        low, high = np.quantile(at, [_OUTER / 2, 1 - _OUTER / 2], overwrite_input=True)
        return float(low), float(high)


def _place(samples: Samples, channel: str, period: float | None) -> tuple[_Place, str, float]:
    """Return where the samples lie, the title of that axis, and the period over which they are folded, or 0."""
    moving = ~samples.resting
    length = unit_of(DISPLACEMENT, samples.motion)
    if channel == SINCE_REVERSAL:
        near = reversals(samples)
        after = near.select(near.leaving)
        after = after.select(after.common(after.way))
        return _Place(after.index, after.way), label(SINCE_REVERSAL, length), 0.0
    if channel == "velocity":
        return _Place(moving, samples.velocity), samples.axis("velocity"), 0.0
    if channel == TORQUE_RATE:
        rate = samples.recording.signal("motor_torque_rate")
        title = label(words("rate of the motor torque", samples.motion), samples.unit(channel))
        return _Place(moving, rate), title, 0.0
    if channel not in samples.recording or not float(np.ptp(samples.recording[channel])) > 0:
        raise InputError(f"the channel '{channel}' of recording '{samples.recording.name}' never changes")
    values = samples.recording[channel]
    if channel == "position" and period and float(np.ptp(values[moving])) > _PERIODS * period:
        return _Place(moving, values, period), label("position within one period", length), period
    return _Place(moving, values), samples.axis(channel), 0.0


def stribeck(before: Comparison, after: Comparison | None = None) -> Figure:
    """Draw friction torque over the speed on a logarithmic axis, both directions, as measured and as modelled.

    Measured is the friction of the model before plus the error; see :attr:`Samples.measured_friction`.

    Args:
        before: a model and a recording.
        after: a larger model of the same recording, drawn beside it.
    """
    samples = Samples.of(before)
    moving = np.flatnonzero(~samples.resting & (samples.velocity != 0))
    speed, side = np.abs(samples.velocity[moving]), np.sign(samples.velocity[moving])
    measured = side * samples.measured_friction[moving]
    modelled = side * samples.modelled_friction[moving]
    larger = None
    if after is not None:
        larger = modelled + side * (samples.smoothed_error - Samples.of(after).smoothed_error)[moving]
    low, high = float(np.quantile(speed, 0.01)), float(speed.max())
    edges = np.geomspace(max(low, 1e-4 * high), high * (1 + 1e-9), _BINS // 2 + 1)
    figure = graph_objects().Figure()
    piece = samples.recording.run[moving]
    unit, gaps = samples.torque_unit, dict[str, list[Array]](means=[], left=[])
    for direction, name, colour, symbol in ((1, "forward", "blue", "circle"), (-1, "backward", "purple", "square")):
        own = side == direction
        if np.count_nonzero(own) < _LEAST:
            continue
        held = means(speed[own], measured[own], modelled[own], piece[own], edges)
        figure.add_trace(_points(held, f"measured {name}", unit, colour, symbol))
        lines = [(f"{'modelled' if larger is None else 'without it'}, {name}", held.other, "4px,2px", 1.6)]
        gaps["means"].append(held.mean - held.other)
        if larger is not None:
            other = means(speed[own], measured[own], larger[own], piece[own], edges).other
            lines.append((f"with it, {name}", other, "solid", 2.2))
            gaps["left"].append(held.mean - other)
        for named, values, dash, width in lines:
            shown = f"{named}: %{{y:.3g}} {unit}<extra></extra>"
            figure.add_trace(stroke(held.at, values, named, colour, width, dash, hovertemplate=shown))
    figure.update_xaxes(title_text=label("speed", samples.unit("velocity")), **logarithmic(edges[[0, -1]].tolist()))
    figure.update_yaxes(title_text=samples.torque_axis("friction torque"))
    apart = {name: np.concatenate(each) for name, each in gaps.items() if each}
    figure.update_layout(meta={name: float(np.sqrt(np.mean(gap**2))) for name, gap in apart.items() if len(gap)})
    return styled(figure, "Friction at low speed, both directions", samples.subtitle, height=350)
