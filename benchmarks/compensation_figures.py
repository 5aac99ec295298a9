"""Figures of the compensation benchmark from its rows, as lines of Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

Row = dict[str, Any]
GOALS = ((0.4, "RMS error −60 % against none, in the median"), (0.8, "−20 % further than Coulomb and viscous"))


def share(row: Row, way: str, of: str = "none") -> float:
    """Return the RMS error of a way over that of another."""
    return float(row["ways"][way]["rms"]) / float(row["ways"][of]["rms"])


def lines(rows: Iterable[Row]) -> list[str]:
    """Return the tables: all drives, by effect, by mode, and the drives that fall short."""
    given = list(rows)
    drawn = [row for row in given if row["status"] == "ok"]
    named = [row for row in drawn if row["named"]]
    other = [row for row in given if row["status"] != "ok"]
    text = [
        f"{len(drawn)} drives, {len(named)} of them with an effect named; {len(other)} were not drawn or failed.",
        "",
    ]
    text += _goals(drawn, named)
    text += ["", *_effects(drawn), "", *_modes(drawn), "", *_short(drawn)]
    return text


def _goals(drawn: Sequence[Row], named: Sequence[Row]) -> list[str]:
    improved = np.array([share(row, "improved") for row in drawn])
    coulomb = np.array([share(row, "coulomb-viscous") for row in drawn])
    true = np.array([share(row, "true") for row in drawn])
    further = np.array([share(row, "improved", "coulomb-viscous") for row in named])
    bound = np.array([share(row, "true", "coulomb-viscous") for row in named])
    swings = {way: sum(row["ways"][way]["limit_cycle"] for row in drawn) for way in drawn[0]["ways"]}
    middle = lambda values: f"{100 * float(np.median(values)):.2g} %"  # noqa: E731
    better, best = (100 * float(np.mean(values <= 0.8)) for values in (further, bound))
    return [
        "| what | goal | measured | the true drive |",
        "|---|---|---|---|",
        f"| RMS error left of that without compensation, median | ≤ 40 % | {middle(improved)} (Coulomb and viscous "
        f"{middle(coulomb)}) | {middle(true)} |",
        f"| where an effect was named: left of that with Coulomb and viscous, median | ≤ 80 % | {middle(further)} | "
        f"{middle(bound)} |",
        f"| the same, share of drives with ≤ 80 % | | {better:.0f} % | {best:.0f} % |",
        f"| never worse than none | ≥ 98 % | {100 * float(np.mean(improved <= 1)):.1f} % (worst drive leaves "
        f"{100 * float(improved.max()):.0f} %) | {100 * float(np.mean(true <= 1)):.1f} % |",
        f"| limit cycle at rest, drives | 0 | {swings['improved']} | {swings['true']} |",
        f"| the same without compensation; with Coulomb and viscous | | {swings['none']}; {swings['coulomb-viscous']} "
        f"| |",
    ]


def _effects(drawn: Sequence[Row]) -> list[str]:
    text = [
        "| hidden effect | drives | named it | named something | Coulomb and viscous | improved | the true drive |",
        "|---|---|---|---|---|---|---|",
    ]
    for effect in dict.fromkeys(row["effect"] for row in drawn):
        own = [row for row in drawn if row["effect"] == effect]
        shares = (_range([share(row, way) for row in own]) for way in ("coulomb-viscous", "improved", "true"))
        right = sum(effect in row["named"] for row in own)
        some = sum(bool(row["named"]) for row in own)
        text.append(f"| `{effect}` | {len(own)} | {right} | {some} | {' | '.join(shares)} |")
    return text


def _range(values: Sequence[float]) -> str:
    low, middle, high = (100 * float(np.quantile(values, q)) for q in (0.0, 0.5, 1.0))
    return f"{middle:.2g} % ({low:.2g} to {high:.2g})"


def _modes(drawn: Sequence[Row]) -> list[str]:
    text = ["| where, and at rest | model | leaves, median | worse than none | limit cycles |", "|---|---|---|---|---|"]
    for mode, given in drawn[0]["modes"].items():
        for strength, words in (("once", "improved"), ("too much", "1.3 times its torque")):
            if strength not in given:
                continue
            found = [(row["modes"][mode][strength], row["ways"]["none"]["each"][0]) for row in drawn]
            shares = np.array([one["rms"] / none for one, none in found])
            swings = sum(one["limit_cycle"] for one, _ in found)
            middle, worse = 100 * float(np.median(shares)), int(np.sum(~(shares <= 1)))
            text.append(f"| {mode} | {words} | {middle:.2g} % | {worse} | {swings} |")
    return text


def _short(drawn: Sequence[Row]) -> list[str]:
    text = ["| drive | named | Coulomb and viscous | improved | true | |", "|---|---|---|---|---|---|"]
    for row in drawn:
        reasons = []
        if share(row, "improved") > 0.4:
            reasons.append("more than 40 % left")
        if row["named"] and share(row, "improved", "coulomb-viscous") > 0.8:
            reasons.append("less than 20 % further")
        if any(row["ways"][way]["limit_cycle"] for way in row["ways"]):
            reasons.append("swings: " + ", ".join(w for w in row["ways"] if row["ways"][w]["limit_cycle"]))
        if reasons:
            shares = (f"{100 * share(row, way):.2g} %" for way in ("coulomb-viscous", "improved", "true"))
            named = ", ".join(row["named"]) or "nothing"
            text.append(f"| {row['key']} | {named} | {' | '.join(shares)} | {'; '.join(reasons)} |")
    return text if len(text) > 2 else ["No drive falls short."]
