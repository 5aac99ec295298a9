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
        "Of 44 simulated drives with one hidden effect the first name was wrong in none; where the true effect was not "
        "on the list, a wrong one was named in 5 (docs/hidden_effects.md). Of 62 names on rough drives with several "
        "effects 3 were wrong (docs/rough_drives.md).",
        {
            "hidden_effects.md": (
                "| right class named first | ≥ 97 % | 100.0 % (92–100) of 44 |",
                "| – no wrong name | | 88.6 % (76–95) of 44 |",
            ),
            "rough_drives.md": ("| several: names given that are there | ≥ 95 % | 95.2 % (87–98) of 62 |",),
        },
    ),
    "undecided": Record(
        "Of 8 simulated drives whose recording cannot tell look-alikes apart, one effect was named alone in 1 "
        "(docs/hidden_effects.md).",
        {"hidden_effects.md": ("| look-alikes: no member asserted alone | ≥ 95 % | 87.5 % (53–98) of 8 |",)},
    ),
    "unknown-effect": Record(
        "Of 40 simulated drives with nothing hidden none was called so (docs/hidden_effects.md); of 58 rough drives "
        "with nothing hidden 7 were (docs/rough_drives.md).",
        {
            "hidden_effects.md": ("| nothing hidden: “unknown effect” | | 0.0 % (0–9) of 40 |",),
            "rough_drives.md": ("| nothing hidden: “unknown” | ≤ 3 % | 12.1 % (6–23) of 58 |",),
        },
    ),
    "adequate": Record(
        "Of 44 simulated drives with a hidden effect none was called adequate (docs/hidden_effects.md), nor of 30 "
        "rough drives with one that matters (docs/rough_drives.md). An effect that this recording could not show is "
        "not excluded.",
        {
            "hidden_effects.md": ("| right class named first | ≥ 97 % | 100.0 % (92–100) of 44 |",),
            "rough_drives.md": ("| single effect that matters: right class first | ≥ 97 % | 100.0 % (89–100) of 30 |",),
        },
    ),
}
"""By verdict."""
