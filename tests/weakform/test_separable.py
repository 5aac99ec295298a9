"""A model split term by term: the same torque as the whole, and only what moved is evaluated again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from fricmodels.dimension import Motion
from fricmodels.drive import Drive
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.weakform.separable import Separable, SeparableTerm, separable

Array = NDArray[np.float64]
TIME = 1e-3 * np.arange(2000)
VALUES = {
    "K_v": 0.3,
    "K_c": 2.0,
    "stribeck.F_s": 0.8,
    "stribeck.omega_s": 0.4,
    "stribeck.delta": 1.3,
    "cogging.a": 0.2,
    "cogging.b": -0.1,
    "cogging.a_2": 0.05,
    "cogging.b_2": 0.02,
    "cogging.k": 7.3,
    "presliding.F_1": 1.1,
    "presliding.F_2": 0.9,
    "presliding.D": 0.2,
    "presliding.x_s": 0.03,
}


@pytest.fixture(scope="module")
def recording() -> Recording:
    velocity = np.sin(7 * TIME) + 0.3 * np.sin(23 * TIME)
    position = np.cumsum(velocity) * 1e-3
    channels = {"time": TIME, "torque": np.cos(7 * TIME), "velocity": velocity, "position": position}
    return Recording("one", Motion.ROTARY, channels, np.zeros(len(TIME), dtype=np.int64))


def model(*effects: str) -> Model:
    return Model.parse("+".join(["coulomb-viscous", *effects]))


def rows(recording: Recording, drive: Drive, alpha: Array, *, slopes: bool) -> tuple[Array, Array]:
    """Return the fixed and the moving rows."""
    split = separable(drive.model)

    def states(part: Model, parameters: Array) -> Sequence[Array]:
        return Drive(part, None).states(recording, parameters)

    def of_term(term: SeparableTerm, own: tuple[float, ...]) -> Array:
        return term.moving_rows(recording, np.array(own), states, slopes=slopes)

    blocks = list(zip(split.moving_terms, split.moving_blocks(alpha, of_term), strict=True))
    values = [block[: len(term.moving)] for term, block in blocks]
    of_slopes = [block[len(term.moving) :] for term, block in blocks if slopes]
    return split.fixed_rows(recording), np.concatenate([*values, *of_slopes])


def moving(split: Separable) -> list[int]:
    return [row for term in split.terms for row in term.moving]


@pytest.mark.parametrize(
    "effects", [("stribeck",), ("cogging", "stribeck"), ("presliding",), ("cogging", "presliding", "stribeck")]
)
def test_the_rows_add_up_to_the_torque_of_the_whole(effects: tuple[str, ...], recording: Recording) -> None:
    drive = Drive(model(*effects), 1.0)
    split = separable(drive.model)
    values = np.array([VALUES[p.key] for p in drive.model.parameters])
    theta, alpha = values[list(split.linear)], values[list(split.nonlinear)]
    fixed, others = rows(recording, drive, alpha, slopes=False)
    factor = np.append(theta, 1.0)
    total = factor[list(split.fixed)] @ fixed + factor[moving(split)] @ others
    np.testing.assert_allclose(total, drive.friction(recording, VALUES), atol=1e-12)


@pytest.mark.parametrize("effects", [("cogging", "stribeck"), ("presliding", "cogging")])
def test_the_slopes_are_those_of_the_torque(effects: tuple[str, ...], recording: Recording) -> None:
    drive = Drive(model(*effects), 1.0)
    split = separable(drive.model)
    keys = [p.key for p in drive.model.parameters]
    values = np.array([VALUES[key] for key in keys])
    alpha, factor = values[list(split.nonlinear)], np.append(values[list(split.linear)], 1.0)
    found = rows(recording, drive, alpha, slopes=True)[1][len(moving(split)) :]
    assert len(found) == len(split.slopes)
    for j, place in enumerate(split.nonlinear):
        step = 1e-4 * values[place]
        ends = [drive.friction(recording, {**VALUES, keys[place]: values[place] + side * step}) for side in (1, -1)]
        own = sum(factor[row] * slope for (row, i), slope in zip(split.slopes, found, strict=True) if i == j)
        reference = (ends[0] - ends[1]) / (2 * step)
        np.testing.assert_allclose(own, reference, atol=2e-3 * np.max(np.abs(reference)))


def test_only_the_term_of_a_parameter_moves() -> None:
    split = separable(model("cogging", "stribeck", "presliding"))
    law = split.terms[0]
    assert not law.moving  # the columns of the law are evaluated once, though another term has internal states
    for term in split.terms[1:]:
        assert {j for _, j in term.slopes} == set(term.nonlinear)
    assert sorted(j for term in split.terms for j in term.nonlinear) == list(range(len(split.nonlinear)))


@pytest.mark.parametrize(
    ("law", "of"), [("exponential-stick-slip", (3, 4)), ("asymmetric-exponential-stick-slip", (6, 8))]
)
def test_of_rows_that_are_alike_one_is_evaluated(law: str, of: tuple[int, int], recording: Recording) -> None:
    split = separable(Model.parse(law))
    (term,) = split.terms
    alpha = np.linspace(0.4, 0.7, len(split.nonlinear))
    distinct = term.distinct_rows(recording, alpha, lambda *_: (), slopes=True)
    found = term.moving_rows(recording, alpha, lambda *_: (), slopes=True)
    assert (len(distinct), len(found)) == of
    values = dict(zip(moving(split), found, strict=False))
    slopes = dict(zip(split.slopes, found[len(moving(split)) :], strict=True))
    speed, forward = np.abs(recording.velocity), recording.velocity >= 0.0
    sides = [(2, 4, forward), (3, 5, ~forward)] if len(alpha) > 1 else [(1, 2, forward | True)]
    for j, (coulomb, stick, where) in enumerate(sides):
        fall = np.exp(-alpha[j] * speed)
        sign = np.where(where, np.where(forward, 1.0, -1.0), 0.0)
        np.testing.assert_allclose(values[coulomb], fall * sign, atol=1e-15)
        np.testing.assert_allclose(values[stick], (1.0 - fall) * sign, atol=1e-15)
        np.testing.assert_allclose(slopes[coulomb, j], -speed * fall * sign, atol=1e-15)
        np.testing.assert_allclose(slopes[stick, j], speed * fall * sign, atol=1e-15)
