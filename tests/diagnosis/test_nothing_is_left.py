"""An effect with which nothing is left of an error far above noise is named, though the rows beside it mislead."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.by_fit import all_of_the_error
from fricmodels.diagnosis.diagnose import examine
from fricmodels.recording import Recording

Made = Callable[..., Recording]
INERTIA = 2.0


def test_what_leaves_nothing_is_found_whatever_supports_it(made: Made) -> None:
    """A drive whose stated inertia is a fifth too small: with another one nothing but noise is left."""
    found = examine(compare(made(noise=0.2), "coulomb-viscous", 0.8 * INERTIA))
    assert found.judgement is not None
    assert found.refits is not None
    (there,) = all_of_the_error(found.refits, found.judgement)
    assert "inertia-error" in there.names


@pytest.mark.long
def test_what_leaves_a_part_is_not_named_for_it(made: Made) -> None:
    """Most of the error is that inertia, and a wave remains: it is for the rows to judge."""
    recording = made("coulomb-viscous+cogging", {"cogging.a": 6.0, "cogging.k": 7.3}, noise=0.2)
    found = examine(compare(recording, "coulomb-viscous", 0.9 * INERTIA))
    assert found.judgement is not None
    assert found.refits is not None
    assert any("inertia-error" in one.names for one, _ in found.judgement.members)
    assert all_of_the_error(found.refits, found.judgement) == []


def test_an_error_near_noise_is_not_asked(made: Made) -> None:
    """The rows alone judge there: a fall to noise says little."""
    recording = made("coulomb-viscous+cogging", {"cogging.a": 0.25, "cogging.k": 7.3}, noise=0.2)
    found = examine(compare(recording, "coulomb-viscous", INERTIA))
    assert found.judgement is not None
    assert found.refits is not None
    assert found.verdict == "missing-effect"
    assert all_of_the_error(found.refits, found.judgement) == []
