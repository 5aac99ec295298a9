"""At which orders per turn the residual is periodic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.report.figures.downsample import extremes
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, graph_objects, label, logarithmic, styled

if TYPE_CHECKING:
    from fricmodels.diagnosis.diagnose import Comparison

Array = NDArray[np.float64]

_MOST_BINS = 2**15
_PADDING = 4
_LEAST_PERIODS = 1.5


@dataclass(frozen=True)
class Spectrum:
    """Amplitude of a signal's periodic part over the number of periods per unit of place.

    Attributes:
        order: periods per unit.
        amplitude: of the cosine of that order, in the signal's unit.
    """

    order: Array
    amplitude: Array


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
    bins = int(min(_MOST_BINS, max(64, 2 ** np.ceil(np.log2(4 * finest * span)))))
    index = np.minimum(((place - low) / span * bins).astype(np.int64), bins - 1)
    count = np.bincount(index, minlength=bins)
    visited = count > 0
    mean = np.bincount(index, weights=values, minlength=bins)[visited] / count[visited]
    profile = np.zeros(bins)
    profile[visited] = mean - mean.mean()
    amplitude = 2 / np.count_nonzero(visited) * np.abs(np.fft.rfft(profile, _PADDING * bins))
    order = np.arange(len(amplitude)) / (_PADDING * span)
    inside = (order >= _LEAST_PERIODS / span) & (order <= min(finest, bins / (4 * span)))
    return Spectrum(order[inside], amplitude[inside])


def residual_spectrum(comparison: Comparison) -> Figure:
    """Draw the amplitude of the residual by order per turn, or per metre; by frequency where no position was measured.

    One line is what acts the same in both directions, as cogging does; the other what opposes the motion, as friction
    that varies with the position does.
    """
    go, samples = graph_objects(), Samples.of(comparison)
    moving = ~samples.resting
    error, side = samples.error[moving], np.sign(samples.velocity[moving])
    figure = go.Figure()
    lines: tuple[tuple[str, Array], ...]
    if "position" in samples.recording and float(np.ptp(samples.recording["position"])) > 0:
        turn = 2 * np.pi if samples.motion is Motion.ROTARY else 1.0
        place = samples.recording["position"][moving] / turn
        speed = float(np.median(np.abs(samples.velocity[moving]))) / turn
        lines = (("the same in both directions", error), ("along the motion", side * error))
        axis = label("order", "1/turn") if samples.motion is Motion.ROTARY else label("order", "1/m")
        name = "per turn" if samples.motion is Motion.ROTARY else "per metre"
    else:
        place, speed = samples.place[moving], 1.0
        lines = (("residual", error),)
        axis, name = label("frequency", "Hz"), "by frequency"
    finest = 0.25 / (speed * samples.comparison.train.interval)
    for (words_, values), (colour, dash) in zip(lines, (("blue", "solid"), ("vermillion", "4px,2px")), strict=False):
        found = spectrum(place, values, finest)
        index = extremes(np.log(found.order), found.amplitude)
        figure.add_trace(
            go.Scatter(
                x=found.order[index].astype(np.float32),
                y=found.amplitude[index].astype(np.float32),
                name=words_,
                mode="lines",
                line={"color": LIGHT[colour], "width": 1.4, "dash": dash},
                hovertemplate=f"%{{y:.3g}} {samples.torque_unit} at %{{x:.4g}}<extra>{words_}</extra>",
            )
        )
    figure.update_xaxes(title_text=axis, **logarithmic(float(x) for trace in figure.data for x in trace.x[[0, -1]]))
    figure.update_yaxes(title_text=samples.torque_axis("amplitude of the residual"), rangemode="tozero")
    return styled(figure, f"Periodic parts of the residual, {name}", samples.subtitle, height=420)
