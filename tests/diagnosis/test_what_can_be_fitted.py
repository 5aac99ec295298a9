"""What cannot be fitted gives way to what explains the rows nearly as well; what only accompanies is no effect."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import by_fit, compare
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.diagnosis.refits import is_undetermined, is_void
from fricmodels.diagnosis.support import Support
from fricmodels.diagnosis.supported import Judgement
from fricmodels.diagnosis.verdict import LookAlikes

CONTACT = {"presliding.F_1": 2.0, "presliding.F_2": 2.0, "presliding.D": 1.0, "presliding.x_s": 0.2}


@dataclass(frozen=True)
class Result:
    """Candidates, best first, that are no look-alikes of each other."""

    tested: tuple[Any, ...]
    policy: Policy = POLICY


@pytest.mark.parametrize(
    ("losses", "refused", "left"),
    [
        ([1.0, 1.2, 4.0], "", "abc"),
        ([1.0, 1.2, 4.0], "a", "bc"),
        ([1.0, 2.2, 4.0], "ab", "abc"),  # c leaves 1.5 times the RMS of a and more: it has another form
        ([1.0, 1.2, 1.4], "ab", "c"),
        ([1.0, 1.2, 1.4], "abc", "abc"),
    ],
)
def test_the_next_one_is_asked_if_it_explains_nearly_as_much(
    losses: list[float], refused: str, left: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    tested = tuple(
        SimpleNamespace(name=name, evidence=SimpleNamespace(loss=[loss]))
        for name, loss in zip("abc", losses, strict=True)
    )

    def first_of(result: Result) -> Any:
        return LookAlikes(result.tested[0], result.tested[:1]) if result.tested else None

    monkeypatch.setattr(by_fit, "select_effect", first_of)
    refits = SimpleNamespace(with_effect=lambda t: None if t.name in refused else t)
    assert "".join(t.name for t in by_fit.that_can_be_fitted(refits, Result(tested)).tested) == left


SMALL = Support(own_share=0.4, of_channel=float("inf"), torque=0.1, p_value=1e-9)


@pytest.mark.parametrize(
    ("support", "once", "unpredicted", "is_one"),
    [
        (SMALL, 1e-9, 0.01, True),
        (SMALL, 1e-9, 0.0, False),  # a channel predicts the rest: there is more than this effect
        (SMALL, 0.5, 0.01, False),
        (replace(SMALL, p_value=0.1), 1e-9, 0.01, False),
        (replace(SMALL, of_channel=0.9), 1e-9, 0.01, False),
        (replace(SMALL, torque=1e-4), 1e-9, 0.01, False),
        (replace(SMALL, own_share=0.6), 1e-9, 0.01, False),  # it is there
    ],
)
def test_what_only_lacks_its_share_is_asked_by_the_printed_error(
    support: Support, once: float, unpredicted: float, is_one: bool
) -> None:
    """Of 5 % with noise of 1 % a half is explained where no more than 3.6 % is left."""
    first: Any = SimpleNamespace(name="a", once=once)
    found = LookAlikes(first, (first,))
    judgement = Judgement(((found, support),), (), (), 0.0, unpredicted)
    assert judgement.unsure_of_its_share(POLICY) is (found if is_one else None)
    assert replace(judgement, one_cause=(found,)).unsure_of_its_share(POLICY) is None  # it only imitates a cause

    def error(percent: float) -> Any:
        headline = SimpleNamespace(noise_floor_percent=1.0)
        return SimpleNamespace(errors=SimpleNamespace(held_out_percent=percent, headline=headline))

    for left, enough in ((3.5, True), (3.7, False), (6.0, False)):
        after = error(left)
        refits: Any = SimpleNamespace(comparison=error(5.0), policy=POLICY, with_effect=lambda _, after=after: after)
        assert by_fit.most_of_the_error(refits, judgement) == ([found] if is_one and enough else [])
    nothing: Any = SimpleNamespace(comparison=error(5.0), policy=POLICY, with_effect=lambda _: None)
    assert by_fit.most_of_the_error(nothing, judgement) == []


def test_damping_alone_is_no_contact_that_bends(made: Made) -> None:
    fitted = compare(made("coulomb-viscous+presliding", CONTACT, samples=4000), "coulomb-viscous+presliding", INERTIA)
    assert not is_void(fitted, "presliding")
    assert not is_undetermined(fitted, "presliding")

    def with_values(**values: float) -> Any:
        own = {f"presliding.{symbol}": value for symbol, value in values.items()}
        estimate = replace(fitted.estimate, parameters={**fitted.estimate.parameters, **own})
        return replace(fitted, estimate=estimate)

    assert is_undetermined(with_values(F_1=0.0, F_2=0.0), "presliding")
    assert not is_undetermined(with_values(F_1=0.0), "presliding")

    def with_wide_intervals(**values: float) -> Any:
        """Give the torques intervals that hold zero, as where their sizes trade with a length that was sought."""
        result = with_values(**values)
        torques = ["presliding.F_1", "presliding.F_2"]
        wide = {**result.estimate.standard_errors, **dict.fromkeys(torques, 100.0)}
        unknown = dict.fromkeys(torques, "its 95 % interval contains zero")
        return replace(result, estimate=replace(result.estimate, standard_errors=wide, not_identified=unknown))

    assert is_undetermined(with_wide_intervals(), "presliding")
    assert not is_undetermined(
        with_wide_intervals(F_1=0.0), "presliding"
    )  # zero at its bound: the other is a single one


def test_an_inertia_that_takes_all_that_it_may_is_no_wrong_inertia(made: Made) -> None:
    fitted = compare(
        made("coulomb-viscous+inertia-error", {"inertia-error.dJ": 0.2}), "coulomb-viscous+inertia-error", INERTIA
    )

    def with_value(share: float) -> Any:
        own = {"inertia-error.dJ": share * INERTIA}
        estimate = replace(fitted.estimate, parameters={**fitted.estimate.parameters, **own})
        return replace(fitted, estimate=estimate)

    assert [is_void(with_value(share), "inertia-error") for share in (-0.9, -0.89, 0.0, 0.9)] == [
        True,
        False,
        True,
        False,
    ]
