"""An effect of which a recording determines no parameter is not what is missing, however the error falls."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.conftest import INERTIA, Made

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.refits import _is_nothing


@pytest.mark.parametrize(
    ("loose", "nothing"),
    [
        ((), False),
        (("gravity.a",), False),
        (("gravity.a", "gravity.b"), True),
        (("K_v", "K_c", "gravity.b"), False),
        (("K_v", "K_c"), False),
    ],
)
def test_an_effect_without_a_size_is_nothing(made: Made, loose: tuple[str, ...], nothing: bool) -> None:
    name = "coulomb-viscous+gravity"
    fitted = compare(made(name, {"gravity.a": 0.8, "gravity.b": 0.5}), name, INERTIA)
    assert not fitted.estimate.not_identified
    loosely = replace(fitted.estimate, not_identified=dict.fromkeys(loose, "a reason"))
    assert _is_nothing(replace(fitted, estimate=loosely), "gravity") is nothing
