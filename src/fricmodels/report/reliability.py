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


ROUGH = (
    "| 2101 to 5601 together | 5, 23 / 1910 | **1464 / 1562** | 1181 / 1240 | 997 / 1178 | **341 / 495** | "
    "1017 / 1056 | **87 / 1111** | **2415 / 2563** |"
)
"""Nothing hidden: false, unknown; right first names; of several: names there, named; beside a cause off the list:
named, rest unknown; only such a cause: a wrong name."""

_BY_SEED = (
    "44 of 44 | 43 of 44 | 65 of 66 | 64 of 66 | 66 of 66 | 42 of 44 | 42 of 44 | 22 of 22 | 64 of 66 | 44 of 44 | "
    "496 of 506"
)
_RIGHT_CLASS = f"| right class named first | ≥ 97 % | {_BY_SEED} |"

RECORDS: Mapping[str, Record] = {
    "missing-effect": Record(
        "Where the truth was known, the right effect or a look-alike came first on all but 10 of 506 drives with one "
        "hidden effect (docs/hidden_effects.md); with several, 59 of 1240 names were wrong (docs/rough_drives.md). "
        "Where the true effect was on no list, 78 of 506 and 87 of 1111 drives got a wrong name.",
        {
            "hidden_effects.md": (
                _RIGHT_CLASS,
                "| off the list: no wrong name | ≥ 90 % | 39 of 44 | 38 of 44 | 61 of 66 | 56 of 66 | 53 of 66 | "
                "35 of 44 | 35 of 44 | 19 of 22 | 54 of 66 | 38 of 44 | 428 of 506 |",
            ),
            "rough_drives.md": (ROUGH,),
        },
    ),
    "undecided": Record(
        "Of 99 simulated drives whose recording cannot tell look-alikes apart, one effect was named alone in 5 "
        "(docs/hidden_effects.md).",
        {
            "hidden_effects.md": (
                "| look-alikes: no member asserted alone | ≥ 95 % | 7 of 8 | 10 of 10 | 14 of 14 | 13 of 14 | "
                "13 of 14 | 6 of 7 | 7 of 7 | 6 of 6 | 7 of 7 | 11 of 12 | 94 of 99 |",
            )
        },
    ),
    "unknown-effect": Record(
        "Of 420 simulated drives with nothing hidden none was called so (docs/hidden_effects.md); of 1910 rough drives "
        "with nothing hidden 23 were (docs/rough_drives.md).",
        {
            "hidden_effects.md": (
                "| nothing hidden: “unknown effect” | | 0 of 40 | 0 of 40 | 0 of 60 | 0 of 60 | 0 of 60 | 0 of 24 | "
                "0 of 24 | 0 of 12 | 0 of 40 | 0 of 60 | 0 of 420 |",
            ),
            "rough_drives.md": (ROUGH,),
        },
    ),
    "adequate": Record(
        "Where the truth was known, a hidden effect was missed, or had another name, on 10 of 506 drives "
        "(docs/hidden_effects.md), and on 98 of 1562 rougher ones (docs/rough_drives.md). An effect that this "
        "recording could not show is not excluded.",
        {"hidden_effects.md": (_RIGHT_CLASS,), "rough_drives.md": (ROUGH,)},
    ),
}
"""By verdict."""

ONE_SINE = Record(
    "The motion is one sine, and effects that are not there can fit one. On rough drives where a cause off the list "
    "acted too, 14 of 18 names were wrong on such a motion and 23 of 90 on others (docs/rough_drives.md). Record a "
    "second frequency to be sure.",
    {"rough_drives.md": ("| a cause off the list acts too | 14 of 18 | 23 of 90 |",)},
)
"""Of names that were given on such a motion."""

CHANGING = Record(
    "On rough drives 10 of 20 names of such effects were wrong, and 50 of 700 others (docs/decisions/constancy.md).",
    {"decisions/constancy.md": ("| not the same throughout | 10 of 20 |", "| the same | 50 of 700 |")},
)
"""Of names of effects that are not the same throughout the motion."""
