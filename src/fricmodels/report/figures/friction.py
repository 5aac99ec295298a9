"""Friction torque against velocity, as measured and as modelled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.arrays import Array, rms
from fricmodels.recording import Recording
from fricmodels.report.figures.grid import even_edges
from fricmodels.report.figures.samples import Samples
from fricmodels.report.figures.style import LIGHT, Figure, graph_objects, stroke, styled, words

if TYPE_CHECKING:
    from fricmodels.diagnosis.comparison import Comparison


CELLS = 60
"""Cells of the density along each axis."""
_CURVE = 150
_BINS = 80
_OUTER = 0.002
"""Share of samples that may lie beyond the axis, so that a few outliers do not flatten all the rest."""
_BAND = 0.5
"""Share of the height of cloud and curve from which a band about the curve may leave the axis."""
_EVALUATED = 20_000
_GAP_BINS, _LEAST_IN_BIN = 40, 10


@dataclass(frozen=True)
class _Curve:
    """Friction torque of the model over velocity.

    Attributes:
        velocity, torque: of the curve.
        uncertainty: standard error of the torque from that of the parameters.
        spread: torque below and above which a twentieth of the samples lie at that velocity, where the friction
            depends on other signals too.
    """

    velocity: Array
    torque: Array
    uncertainty: Array
    spread: tuple[Array, Array] | None


def friction_curve(comparison: Comparison) -> Figure:
    """Draw friction torque against velocity: the density of what was measured, the model's curve and its band.

    Measured is the torque less every part of the model that is not friction. The narrow band is two standard errors of
    the curve, from those of the parameters. Where the friction depends on position, load, temperature, time or the
    past too, the curve is the mean at each velocity, and the dotted lines hold nine tenths of the samples.
    """
    go, samples = graph_objects(), Samples.of(comparison)
    curve = _curve(samples)
    velocity = curve.velocity
    torque = words("friction torque", samples.motion)
    figure = go.Figure()
    cloud = _density(samples, curve, torque)
    figure.add_trace(cloud)
    figure.add_trace(
        go.Scatter(
            x=[None], y=[None], mode="markers", name="measured (stronger: more samples)",
            marker={"symbol": "square", "size": 12, "color": LIGHT["some"]},
        )
    )  # fmt: skip
    low, high = curve.torque - 2 * curve.uncertainty, curve.torque + 2 * curve.uncertainty
    figure.add_trace(
        go.Scatter(
            x=np.concatenate([velocity, velocity[::-1]]),
            y=np.concatenate([high, low[::-1]]).astype(np.float32),
            fill="toself",
            fillcolor=LIGHT["vermillion_band"],
            line={"width": 0},
            mode="lines",
            name="±2 standard errors",
            hoverinfo="skip",
        )
    )
    for i, edge in enumerate(curve.spread or ()):
        name, once = "nine tenths of the model's samples", {"legendgroup": "spread", "showlegend": i == 0}
        y = edge.astype(np.float32)
        figure.add_trace(stroke(velocity, y, name, "vermillion", 1.2, "dot", hoverinfo="skip", **once))
    modelled = curve.torque.astype(np.float32)
    figure.add_trace(stroke(velocity, modelled, "", "surface", 3.8, showlegend=False, hoverinfo="skip"))
    name = "modelled" if curve.spread is None else "modelled (mean)"
    shown = f"model: %{{y:.4g}} {samples.torque_unit}<br>at %{{x:.4g}} {samples.unit('velocity')}<extra></extra>"
    figure.add_trace(stroke(velocity, modelled, name, "vermillion", 2.2, hovertemplate=shown))
    meta: dict[str, float | bool] = {**_largest_gap(samples)}
    held = np.concatenate([cloud.y, curve.torque])
    bottom, top = float(held.min()), float(held.max())
    reached = float(np.nanmax(2 * curve.uncertainty, initial=0.0))
    if reached > _BAND * (top - bottom) > 0:  # the band of what is not determined would leave nothing else to see
        figure.update_yaxes(range=[bottom - 0.15 * (top - bottom), top + 0.15 * (top - bottom)])
        meta["band beyond"] = True
    figure.update_layout(meta=meta)
    figure.update_xaxes(title_text=samples.axis("velocity"))
    figure.update_yaxes(title_text=samples.torque_axis("friction torque"))
    return styled(figure, f"{torque.capitalize()} against velocity", samples.subtitle, height=380)


def _largest_gap(samples: Samples) -> dict[str, float]:
    """Return where the means of measured and of modelled friction over a velocity differ most, and by how much."""
    moving = ~samples.resting
    velocity, error = samples.velocity[moving], samples.smoothed_error[moving]
    if len(velocity) < _GAP_BINS * _LEAST_IN_BIN:
        return {}
    parts = np.array_split(np.argsort(velocity), _GAP_BINS)
    gaps = np.array([error[part].mean() for part in parts])
    worst = int(np.argmax(np.abs(gaps)))
    return {"gap": float(gaps[worst]), "at": float(np.median(velocity[parts[worst]]))}


def _density(samples: Samples, curve: _Curve, name: str) -> Figure:
    """Return the two-dimensional histogram of what was measured while moving."""
    moving = ~samples.resting
    velocity, torque = samples.velocity[moving], samples.measured_friction[moving]
    low, high = (float(q) for q in np.quantile(torque, [_OUTER / 2, 1 - _OUTER / 2]))
    low, high = min(low, float(curve.torque.min())), max(high, float(curve.torque.max()))
    margin = 0.04 * (high - low)
    edges = [
        even_edges(float(velocity.min()), float(velocity.max()), CELLS),
        even_edges(low - margin, high + margin, CELLS),
    ]
    counts, across, up = np.histogram2d(velocity, torque, bins=edges)
    share = counts.T
    shown = np.full(share.shape, np.nan, dtype=np.float32)
    shown[share > 0] = np.log10(share[share > 0])
    return graph_objects().Heatmap(
        x=(across[:-1] + across[1:]) / 2,
        y=(up[:-1] + up[1:]) / 2,
        z=shown,
        customdata=share.astype(np.float32),
        colorscale=[[0, LIGHT["few"]], [0.5, LIGHT["some"]], [1, LIGHT["many"]]],
        showscale=False,
        hoverongaps=False,
        name=name,
        hovertemplate=(
            f"%{{customdata:.0f}} samples<br>{name} %{{y:.4g}} {samples.torque_unit}<br>"
            f"at %{{x:.4g}} {samples.unit('velocity')}<extra></extra>"
        ),
    )


def _curve(samples: Samples) -> _Curve:
    drive = samples.friction_drive
    alone = drive.model.needs <= {"velocity"} and not drive.model.states
    return _exact(samples) if alone else _from_samples(samples)


def _exact(samples: Samples) -> _Curve:
    """Evaluate friction that depends on the velocity alone; at zero stands the step from one side to the other."""
    speeds = samples.velocity[~samples.resting]
    low, high = float(speeds.min()), float(speeds.max())
    tiny = 1e-6 * max(abs(low), abs(high))
    rise = np.concatenate([np.geomspace(tiny, 1.0, _CURVE // 3), np.linspace(0, 1, _CURVE)[1:-1]])
    sides = [np.unique(np.clip(rise * abs(end), tiny, None)) * side for side, end in ((-1, low), (1, high))]
    velocity = np.concatenate([sides[0][::-1] if low < 0 else sides[0][:0], sides[1] if high > 0 else sides[1][:0]])
    zero = np.zeros_like(velocity)
    points = Recording(
        "curve", samples.motion, {"time": zero, "torque": zero, "velocity": velocity}, zero.astype(np.int64)
    )
    torque = samples.friction_drive.friction(points, samples.parameters)
    return _Curve(velocity, torque, _uncertainty(samples, points), None)


def _from_samples(samples: Samples) -> _Curve:
    """Summarise friction that depends on more than the velocity, over bins of velocity of as many samples each."""
    moving = np.flatnonzero(~samples.resting)
    stride = max(1, len(moving) // _EVALUATED)
    velocity = samples.velocity[moving]
    order = np.argsort(velocity)
    sides = [order[velocity[order] < 0], order[velocity[order] >= 0]]
    bins = [part for side in sides for part in np.array_split(side, min(_BINS, max(1, len(side) // 20))) if len(part)]
    chosen = samples.recording.with_channels(velocity=samples.velocity)
    torque = samples.modelled_friction[moving]
    error = np.zeros(len(moving))
    kept = np.arange(0, len(moving), stride)
    error[kept] = _uncertainty(samples, chosen)[moving[kept]]
    known = np.zeros(len(moving), dtype=bool)
    known[kept] = True
    middle = np.array([torque[part].mean() for part in bins])
    low, high = np.array([np.quantile(torque[part], [0.05, 0.95]) for part in bins]).T
    spread = np.array([rms(error[part[known[part]]]) if known[part].any() else np.nan for part in bins])
    centre = np.array([float(np.median(velocity[part])) for part in bins])
    return _Curve(centre, middle, spread, (low, high))


def _uncertainty(samples: Samples, points: Recording) -> Array:
    """Return the standard error of the friction torque from those of the parameters, to first order."""
    drive = samples.friction_drive
    estimate = samples.comparison.estimate
    known = list(estimate.standard_errors)
    covariance = estimate.covariance
    if covariance is None:
        covariance = np.diag(np.square(list(estimate.standard_errors.values())))
    slopes = np.zeros((len(known), len(points)))
    for parameter, slope in zip(drive.model.parameters, drive.jacobian(points, samples.parameters), strict=True):
        if parameter.key in known:
            slopes[known.index(parameter.key)] = slope
    variance = np.sum(slopes * (covariance @ slopes), axis=0)
    return np.asarray(np.sqrt(np.clip(variance, 0.0, None)))
