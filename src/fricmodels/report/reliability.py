"""How often an answer of each kind was wrong where the truth was known: figures of the challenges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Record:
    """How often answers of one kind were wrong.

    Attributes:
        said: in one sentence.
        cited: page of the documentation → figures of the sentence as they stand there; a test looks for them.
    """

    said: str
    cited: Mapping[str, tuple[str, ...]]


RECORDS: Mapping[str, Record] = {
    "missing-effect": Record(
        "Of 88 simulated drives with one hidden effect the first name was wrong in 2; where the true effect was not on "
        "the list, a wrong one was named in 3 of 22 (docs/hidden_effects.md). Of 18 names on rough drives with several "
        "effects 2 were wrong (docs/rough_drives.md).",
        {
            "hidden_effects.md": ("right class first 97.7 % (92–99) of 88", "no wrong name 19 of 22"),
            "rough_drives.md": ("| several: names given that are there | ≥ 95 % | 88.9 % (67–97) of 18 |",),
        },
    ),
    "undecided": Record(
        "Of 13 simulated drives whose recording cannot tell look-alikes apart, one effect was named alone in 1 "
        "(docs/hidden_effects.md).",
        {"hidden_effects.md": ("look-alikes none alone 12 of 13",)},
    ),
    "unknown-effect": Record(
        "Of 100 simulated drives with nothing hidden none was called so (docs/hidden_effects.md); of 18 rough drives "
        "with nothing hidden 3 were (docs/rough_drives.md).",
        {
            "hidden_effects.md": ('"unknown" 0 % (0–4) of 100',),
            "rough_drives.md": ("| nothing hidden: “unknown” | ≤ 3 % | 16.7 % (6–39) of 18 |",),
        },
    ),
    "adequate": Record(
        "Of 264 simulated drives with a hidden effect none was called adequate (docs/hidden_effects.md). An effect "
        "that this recording could not show is not excluded.",
        {"hidden_effects.md": ("| right class named first | ≥ 97 % | 98.9 % (97–100) of 264 |",)},
    ),
}
"""By verdict."""
