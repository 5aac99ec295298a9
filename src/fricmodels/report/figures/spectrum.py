"""At which orders per turn the residual is periodic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmodels.arrays import Array, Index, rms
from fricmodels.dimension import Motion
from fricmodels.report.figures.downsample import extremes
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, graph_objects, label, logarithmic, stroke, styled
from fricmodels.signals.order_spectrum import MOST_BINS, PADDING

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison


_LEAST_PERIODS = 1.5
_CHANCE = 0.01
_LEAST_NEIGHBOURS = 8
_LEVEL_POINTS = 400
_NAMED = 4
_APART = 0.5
"""Octaves between orders that are written."""


@dataclass(frozen=True)
class Spectrum:
    """Amplitude of a signal's periodic part over the number of periods per unit of place.

    Attributes:
        order: periods per unit.
        amplitude: of the cosine of that order, in the signal's unit.
        span: units of place that were seen; a line is known to half a period in these.
    """

    order: Array
    amplitude: Array
    span: float = math.inf

    @property
    def resolution(self) -> float:
        """How well the order of a line is known."""
        return 0.5 / self.span

    def top(self, peak: int) -> float:
        """Return the order of a peak, from the parabola through it and its neighbours."""
        if not 0 < peak < len(self.order) - 1:
            return float(self.order[peak])
        low, high, other = (float(value) for value in self.amplitude[peak - 1 : peak + 2])
        bend = low - 2 * high + other
        step = 0.5 * (low - other) / bend if bend < 0 else 0.0
        return float(self.order[peak] + step * (self.order[peak + 1] - self.order[peak]))

    def level(self) -> Array:
        r"""Return the amplitude that noise alone exceeds anywhere with a probability of one percent.

        The amplitudes of noise are Rayleigh distributed, and of M independent ones the greatest exceeds
        :math:`a_{50}\sqrt{\ln(M/0.01)/\ln 2}` once in a hundred times. The median :math:`a_{50}`, which a few peaks do
        not move, is that within half an octave, and at least eight independent orders, to either side.
        """
        if not len(self.order):
            return np.zeros(0)
        octave = np.log2(self.order)
        centres = np.arange(octave[0], octave[-1] + 0.25, 0.25)
        at, least = np.searchsorted(octave, centres), _LEAST_NEIGHBOURS * PADDING
        starts = np.maximum(np.minimum(np.searchsorted(octave, centres - 0.5), at - least), 0)
        stops = np.maximum(np.searchsorted(octave, centres + 0.5, side="right"), at + least)
        medians = np.array([np.median(self.amplitude[a:b]) for a, b in zip(starts, stops, strict=True)])
        independent = max(2.0, len(self.order) / PADDING)
        factor = np.sqrt(np.log(independent / _CHANCE) / np.log(2.0))
        return np.asarray(factor * np.interp(octave, centres, medians))

    def peaks(self) -> list[int]:
        """Return where peaks stand that rise above :meth:`level`, the highest first."""
        amplitude, level = self.amplitude, self.level()
        inner = np.flatnonzero((amplitude[1:-1] >= amplitude[:-2]) & (amplitude[1:-1] > amplitude[2:])) + 1
        above = inner[amplitude[inner] > level[inner]]
        ranked: list[int] = above[np.argsort(-amplitude[above])].tolist()
        return ranked


def spectrum(place: Array, values: Array, finest: float) -> Spectrum:
    r"""Return :math:`\tfrac2B|\sum_b \bar v_b\,e^{-2\pi\mathrm{j} n x_b}|` with the signal's mean in each of B bins.

    Means over even bins of place, not sums over samples, so that where the drive dwells counts no more than where it
    passes. Bins that were never visited are left out.

    Args:
        place: x of each sample, shape (N,).
        values: signal, shape (N,).
        finest: greatest number of periods per unit of place.
    """
    low, span = float(place.min()), float(np.ptp(place))
    bins = int(min(MOST_BINS, max(64, 2 ** np.ceil(np.log2(4 * finest * span)))))
    index = np.minimum(((place - low) / span * bins).astype(np.int64), bins - 1)
    count = np.bincount(index, minlength=bins)
    visited = count > 0
    mean = np.bincount(index, weights=values, minlength=bins)[visited] / count[visited]
    profile = np.zeros(bins)
    profile[visited] = mean - mean.mean()
    amplitude = 2 / np.count_nonzero(visited) * np.abs(np.fft.rfft(profile, PADDING * bins))
    order = np.arange(len(amplitude)) / (PADDING * span)
    inside = (order >= _LEAST_PERIODS / span) & (order <= min(finest, bins / (4 * span)))
    return Spectrum(order[inside], amplitude[inside], span)


def _line(of: Spectrum, index: Index, amplitude: Array, name: str, units: str, style: tuple[str, float, str]) -> Any:
    """Return a line through some orders of a spectrum."""
    order, amplitude = of.order[index].astype(np.float32), amplitude[index].astype(np.float32)
    return stroke(order, amplitude, name, *style, hovertemplate=f"{name}: {units}<extra></extra>")


def _name_peaks(figure: Figure, found: Sequence[Spectrum]) -> None:
    """Write the order beside the highest peaks that noise does not explain, where there is room for it."""
    peaks = [(each.amplitude[peak], each.top(peak), each.resolution) for each in found for peak in each.peaks()]
    named: list[float] = []
    for amplitude, order, resolution in sorted(peaks, reverse=True):
        if len(named) < _NAMED and all(abs(np.log2(order / other)) > _APART for other in named):
            named.append(order)
            figure.add_annotation(
                x=np.log10(order),
                y=amplitude,
                text=f"{order:.{_digits(order, resolution)}f}",
                showarrow=False,
                yshift=9,
                font={"size": 12, "color": LIGHT["text"]},
            )


def _digits(order: float, resolution: float) -> int:
    """Return the digits after the point that the resolution allows, and no more than three that count."""
    return max(0, min(math.ceil(-math.log10(resolution)), 2 - math.floor(math.log10(order))))


def strongest(figure: Figure) -> tuple[str, float, float, float] | None:
    """Return name, order, resolution and amplitude of the strongest line; ``None`` where none rises above noise."""
    found = (figure.layout.meta or {}).get("strongest")
    return tuple(found) if found else None


def residual_spectrum(comparison: Comparison) -> Figure:
    """Draw the amplitude of the residual by order per turn, or per metre; by frequency where no position was measured.

    One line is what acts the same in both directions, as cogging does; the other what opposes the motion, as friction
    that varies with the position does. The orders of the highest peaks that noise does not explain are written beside
    them.
    """
    go, samples = graph_objects(), Samples.of(comparison)
    moving = ~samples.resting
    error, side = samples.error[moving], np.sign(samples.velocity[moving])
    figure = go.Figure()
    lines: tuple[tuple[str, Array], ...]
    if samples.recording.measures("position") and float(np.ptp(samples.recording["position"])) > 0:
        turn = 2 * np.pi if samples.motion is Motion.ROTARY else 1.0
        place = samples.recording["position"][moving] / turn
        speed = rms(samples.velocity[moving]) / turn
        lines = (("the same in both directions", error), ("along the motion", side * error))
        axis = label("order", "1/turn") if samples.motion is Motion.ROTARY else label("order", "1/m")
        name = "per turn" if samples.motion is Motion.ROTARY else "per metre"
    else:
        place, speed = samples.place[moving], 1.0
        lines = (("residual", error),)
        axis, name = label("frequency", "Hz"), "by frequency"
    finest = 0.25 / (speed * samples.comparison.train.interval)
    found = [spectrum(place, values, finest) for _, values in lines]
    units = f"%{{y:.3g}} {samples.torque_unit} at %{{x:.4g}} {axis.partition('[')[2].removesuffix(']')}"
    styles = (("blue", 1.4, "solid"), ("vermillion", 1.4, "4px,2px"))
    for (what, _), each, style in zip(lines, found, styles, strict=False):
        index = extremes(np.log(each.order), each.amplitude)
        figure.add_trace(_line(each, index, each.amplitude, what, units, style))
    level = np.max([each.level() for each in found], axis=0)
    few = np.unique(np.linspace(0, len(level) - 1, _LEVEL_POINTS).astype(int))
    figure.add_trace(_line(found[0], few, level, "1 % noise threshold", units, ("muted", 1.2, "dot")))
    _name_peaks(figure, found)
    tops = [(each, what, peak) for each, (what, _) in zip(found, lines, strict=True) for peak in each.peaks()[:1]]
    tops.sort(key=lambda top: -float(top[0].amplitude[top[2]]))
    if len(found[0].order):
        named = [[what, each.top(peak), each.resolution, float(each.amplitude[peak])] for each, what, peak in tops[:1]]
        figure.update_layout(meta={"strongest": named[0] if named else []})
    figure.update_xaxes(
        title_text=axis, tickangle=0, **logarithmic(float(x) for trace in figure.data for x in trace.x[[0, -1]])
    )
    figure.update_yaxes(title_text=samples.torque_axis("amplitude of the residual"), rangemode="tozero")
    return styled(figure, f"Periodic parts of the residual, {name}", samples.subtitle, height=360)
