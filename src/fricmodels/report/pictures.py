"""Figures of a comparison, each with its message in words and its table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from fricmodels.diagnosis.where import grouped
from fricmodels.dimension import FORCE
from fricmodels.errors import InputError
from fricmodels.report.captions import (
    against_words,
    curve_words,
    loop_words,
    low_speed_words,
    map_words,
    spectrum_words,
    where_words,
    words_of,
)
from fricmodels.report.channels import channel_of_rest, shown_over
from fricmodels.report.figure_tables import axis_title, cells_of, points_of
from fricmodels.report.figures.residuals import changing
from fricmodels.report.page import Picture, Table, table
from fricmodels.report.wording import change, count, counted, number, percent, share, small
from fricmodels.results.words import ALONG

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from fricmodels.diagnosis.comparison import Comparison
    from fricmodels.results.diagnosis import Candidate, Correlation, Remaining
    from fricmodels.term import Effect


def over_time(comparison: Comparison, *, kept_back: bool = True, before: Comparison | None = None) -> Picture:
    """Return torque over time, measured and modelled.

    Args:
        comparison: a model and a recording.
        before: the model as given, whose residual is drawn behind.
        kept_back: whether part of the recording took no part in fitting; where not, its second part is the first again.
    """
    from fricmodels.report import figures

    errors, what = comparison.errors, words_of("torque", comparison)
    if kept_back:
        figure = figures.overlay(comparison, before=before)
        words = f"Test error {errors.averaged}: {percent(errors.held_out_percent)} of the RMS {what} on the shaded part"
        others = "on the others" if comparison.drive.model.known.fixed else "fit error"
        words += f" ({others} {percent(errors.percent)})"
    else:
        from fricmodels.report.figures.samples import Samples

        samples = Samples.of(comparison)
        first = samples.place[~samples.kept_back]
        figure = figures.overlay(comparison, (float(first[0]), float(first[-1])))
        words = f"Fit error {errors.averaged}: {percent(errors.percent)} of the RMS {what}"
    shown = f"{drawn(*figures.drawn_samples(figure))}{beyond_words(figure)}"
    words = f"{words}. {shown} {where_words(comparison)}"
    return Picture(f"{what.capitalize()} over time", words, figure, points_of(figure), "over-time")


def drawn(shown: int, total: int) -> str:
    """Say how many samples a figure draws, and of how many."""
    if shown >= total:
        return f"All {count(total)} samples are drawn."
    return f"{count(shown)} of {count(total)} samples are drawn, the extremes among them, the same for both curves."


def beyond_words(figure: Figure) -> str:
    """Say how many samples lie beyond the axes of a figure over time, where any do; with a space before it."""
    from fricmodels.report import figures

    samples = figures.beyond_axes(figure)
    return (
        f" {counted(samples, 'sample').capitalize()} far off {'lies' if samples == 1 else 'lie'} beyond the axes."
        if samples
        else ""
    )


def excerpt(comparison: Comparison) -> Picture | None:
    """Return the stretch with the largest error, every sample of it; ``None`` where all samples are drawn anyway."""
    from fricmodels.report import figures

    shown, total = figures.drawn_samples(figures.overlay(comparison))
    if shown >= total:
        return None
    begin, end = figures.worst_stretch(comparison)
    figure = figures.overlay(comparison, (begin, end))
    words = f"From {number(begin, 4)} to {number(end, 4)} s the error is largest; here every sample is drawn."
    return Picture("The stretch with the largest error", words, figure, points_of(figure), "excerpt")


def curve(comparison: Comparison) -> Picture:
    """Return friction against velocity, measured and modelled."""
    from fricmodels.report import figures

    figure = figures.friction_curve(comparison)
    words = curve_words(figure, comparison)
    return Picture("Friction against velocity", words, figure, points_of(figure), "friction-curve")


def low_speed(before: Comparison, after: Comparison | None = None, effect: str = "") -> Picture:
    """Return friction at low speed, both directions, over log speed; ``effect`` is what the larger model has more."""
    from fricmodels.report import figures

    figure = figures.stribeck(before, after)
    return Picture("Friction at low speed", low_speed_words(figure, effect), figure, points_of(figure), "low-speed")


def by_regime(comparison: Comparison) -> Picture:
    """Return in which regimes of motion the error lies."""
    from fricmodels.report import figures

    figure, words = figures.error_shares(comparison), where_words(comparison, most=3)
    shown, regimes_of = figure.layout.meta["rows"], figure.layout.meta["regimes"]
    if shown < regimes_of:
        words += f" Drawn are the groups with the largest errors; the table has all {regimes_of} regimes."
    return Picture("Error by regime", words, figure, regimes(comparison), "regimes")


def marks(comparison: Comparison) -> list[Picture]:
    """Return the residual over pairs of channels, its spectrum and the reversals; what was not recorded is left out."""
    from fricmodels.report import figures

    found = [mark(comparison, channel) for channel in changing(comparison)]
    spectrum = figures.residual_spectrum(comparison)
    words = spectrum_words(spectrum)
    found.append(Picture("Spectrum of the residual", words, spectrum, points_of(spectrum), "spectrum"))
    with suppress(InputError):  # a drive that never reverses has no loops
        loops = figures.hysteresis(comparison)
        found.append(
            Picture("Friction around reversals", loop_words(loops), loops, points_of(loops), "reversals", wide=True)
        )
    return found


def mark(comparison: Comparison, channel: str) -> Picture:
    """Return the map of the residual over velocity and another channel."""
    from fricmodels.report import figures

    figure = figures.residual_map(comparison, "velocity", channel)
    title = f"Residual over velocity and {words_of(channel, comparison)}"
    return Picture(title, map_words(figure), figure, cells_of(figure), f"map-{channel}".replace("_", "-"))


def evidence(
    before: Comparison, effect: Effect, after: Comparison | None = None, parameters: Mapping[str, Any] | None = None
) -> Picture:
    """Return the picture in which a missing effect is seen best: the error against the channel that shows it.

    Args:
        before: the model without the effect.
        effect: what is missing.
        after: the model with it.
        parameters: of the effect by symbol, for the period over which positions are folded.
    """
    from fricmodels.report import figures

    channel, period = shown_over(before, effect, parameters or {})
    if channel == "velocity":
        return low_speed(before, after, effect.name)
    along = {"odd": True, "even": False}.get(effect.symmetry or "")
    try:
        figure = figures.error_against(before, channel, after, period, along=along)
    except InputError:  # the drive never reverses, or the channel is one of another joint
        return low_speed(before, after, effect.name)
    title = f"What it looks like: the error against {axis_title(figure.layout.xaxis).partition(' within')[0]}"
    return Picture(title, against_words(figure, effect.name), figure, points_of(figure), f"evidence-{effect.name}")


def left_over(comparison: Comparison, rest: Remaining) -> Picture:
    """Return what remains that no effect was named for, against the channel that shows it.

    Args:
        comparison: the last model.
        rest: what remains.
    """
    from fricmodels.report import figures

    channel = channel_of_rest(rest, comparison.train)
    if rest.channel.startswith(FINELY):
        figure = figures.residual_spectrum(comparison)
        title = "What remains: the waves of the error over position"
        return Picture(title, spectrum_words(figure), figure, points_of(figure), "rest")
    along = True if ALONG in rest.channel else None
    try:
        figure = figures.error_against(comparison, channel, along=along)
    except InputError:
        figure = figures.error_against(comparison, "velocity", along=along)
    over = axis_title(figure.layout.xaxis)
    return Picture(
        f"What remains: the error against {over}", against_words(figure, ""), figure, points_of(figure), "rest"
    )


def covered(comparison: Comparison) -> Picture:
    """Return where the drive was: position and velocity."""
    from fricmodels.report import figures

    figure = figures.coverage(comparison)
    meta = figure.layout.meta
    words = (
        f"{100 * meta['visited']:.0f} % of the cells within the range of velocity and {meta['other']} were visited; "
        "elsewhere the model is extrapolated. Darker: longer."
    )
    return Picture(f"Coverage of velocity and {meta['other']}", words, figure, cells_of(figure), "coverage")


def correlated(known: Correlation) -> Picture | None:
    """Return how the estimates of the parameters are correlated; ``None`` where there are fewer than two."""
    from fricmodels.report import figures
    from fricmodels.report.figures.coverage import strongest

    names, matrix = known.parameters, known.matrix
    if len(names) < 2:
        return None
    one, other, value = strongest(names, matrix)
    words = f"The strongest correlation is {number(value, 2)}, between {one} and {other}."
    if abs(value) > _ALIKE:
        words += " This recording hardly tells them apart: only a combination of them is certain."
    rows = [(name, *(number(each, 2) for each in row)) for name, row in zip(names, matrix, strict=True)]
    shown = table("Correlation of the parameters", {"parameter": False, **dict.fromkeys(names, True)}, rows)
    return Picture("Correlation of the parameters", words, figures.correlation(names, matrix), shown, "correlation")


_ALIKE = 0.95
FINELY = "position, finely"
"""How a diagnosis calls many waves over the position, which means over it would hide."""


def ranked(best: Sequence[Candidate], model: str) -> Picture:
    """Return all candidates that were tested, ranked.

    Args:
        best: the candidates, the best first.
        model: that they were added to.
    """
    from fricmodels.report import figures

    words = f"{count(len(best))} effects were added to {model}, one at a time. {best[0].name} lowers the error on "
    words += f"test blocks most, by {share(best[0].held_out_gain)}"
    if len(best) > 1:
        words += f"; the runner-up is {best[1].name} with {share(best[1].held_out_gain)}"
    passing = counted(sum(row.gates for row in best), "effect").partition(" ")[0].replace("no", "none").capitalize()
    words += f". {passing} {'passes' if passing in ('One', 'None') else 'pass'} all three tests alone"
    words += f"; the best {figures.MOST} are drawn." if len(best) > figures.MOST else "."
    cells = [
        (
            row.name,
            change(row.held_out_gain),
            share(row.share_of_residual),
            small(row.p_value),
            "yes" if row.gates else "no",
        )
        for row in best
    ]
    titles = {
        "effect": False,
        "test error": True,
        "explains of the error": True,
        "p, corrected": True,
        "passes all tests": False,
    }
    shown = table("Candidates: change of the error on test blocks", titles, cells)
    return Picture("All candidates", f"{words}", figures.candidates(best, model), shown, "candidates")


def regimes(comparison: Comparison) -> Table:
    """Return the table of regimes in their groups, beside the whole."""
    unit = FORCE.unit(comparison.drive.motion)
    titles = {"regime": False, f"RMS error [{unit}]": True, "squared error": True, "samples": True}
    rows = [("all that was fitted", number(comparison.errors.SI), "100 %", "100 %")]
    rows += [
        (
            row.regime,
            number(row.rms_torque_error),
            share(row.share_of_squared_error),
            share(row.share_of_samples),
        )
        for group in grouped(comparison.where).values()
        for row in group
    ]
    return table("RMS error and share of the squared error, by regime of motion", titles, rows)
