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
        "Of 88 simulated drives with one hidden effect the first name was right in 87; where the true effect was not "
        "on the list, a wrong one was named in 11 (docs/hidden_effects.md). Of 116 names on rough drives with several "
        "effects 5 were wrong (docs/rough_drives.md).",
        {
            "hidden_effects.md": (
                "| right class named first | ≥ 97 % | 44 of 44 | 43 of 44 | 87 of 88 |",
                "| off the list: no wrong name | ≥ 90 % | 39 of 44 | 38 of 44 | 77 of 88 |",
            ),
            "rough_drives.md": ("| several: names given that are there | ≥ 95 % | 54 of 57 | 57 of 59 | 111 of 116 |",),
        },
    ),
    "undecided": Record(
        "Of 18 simulated drives whose recording cannot tell look-alikes apart, one effect was named alone in 1 "
        "(docs/hidden_effects.md).",
        {"hidden_effects.md": ("| look-alikes: no member asserted alone | ≥ 95 % | 7 of 8 | 10 of 10 | 17 of 18 |",)},
    ),
    "unknown-effect": Record(
        "Of 80 simulated drives with nothing hidden none was called so (docs/hidden_effects.md); of 100 rough drives "
        "with nothing hidden one was (docs/rough_drives.md).",
        {
            "hidden_effects.md": ("| nothing hidden: “unknown effect” | | 0 of 40 | 0 of 40 | 0 of 80 |",),
            "rough_drives.md": ("| nothing hidden: “unknown” | ≤ 3 % | 1 of 40 | 0 of 60 | 1 of 100 |",),
        },
    ),
    "adequate": Record(
        "Of 88 simulated drives with a hidden effect one had no right name (docs/hidden_effects.md), and of 46 rough "
        "drives with one that matters 7 (docs/rough_drives.md); one of these was called adequate. An effect that this "
        "recording could not show is not excluded.",
        {
            "hidden_effects.md": ("| right class named first | ≥ 97 % | 44 of 44 | 43 of 44 | 87 of 88 |",),
            "rough_drives.md": (
                "| single effect that matters: right class first | ≥ 97 % | 14 of 17 | 25 of 29 | 39 of 46 |",
            ),
        },
    ),
}
"""By verdict."""
