"""When an answer is right: what is there, which effects cannot be told apart in a recording, and what counts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Row = dict[str, Any]
LAG = 0.1
"""Delay of motion behind torque from sampling and sensors [samples] from which ``sensor-delay`` is there."""
STANDS = 0.005
"""Share of samples at rest from which a drive shows what acts at rest."""
HALF_TURN = 3.14


def there(row: Row) -> set[str]:
    """Return the listed effects that are in the recording: those hidden, and a delay that the sensors make."""
    lagging = abs(row["lag_samples"]) >= LAG
    return {*row["listed"], *(["sensor-delay"] if lagging else [])}


def alike(row: Row, true: str) -> set[str]:
    """Return the effects that cannot be told from a true one in this recording, by the list of look-alikes.

    Each rule asks for what the list says makes them alike: no rests, no known load, one frequency, one payload, less
    than half a turn. With one frequency a position is an acceleration, so that of a spring an inertia that is estimated
    leaves what its neutral point makes: an offset.
    """
    pair: list[set[str]] = []
    hidden = {one["name"]: one for one in row["hidden"]}
    if row["rests"] < STANDS and "viscous_forward" not in _fields(hidden.get("asymmetry")):
        pair.append({"asymmetry", "torque-offset"})
    if not row["load"]:
        pair.append({"inertia-error", "torque-gain"})
    if row["load"] == "payload":
        pair.append({"gravity", "torque-gain"})
    if row["motion"] == "sine":
        pair.append({"sensor-delay", "inertia-error", "frictional-lag"})
        if not row["inertia_given"]:
            pair.append({"stiffness", "torque-offset"})
    if row["turned"] is not None and row["turned"] < HALF_TURN:
        pair.append({"gravity", "stiffness"})
    return {true}.union(*(group for group in pair if true in group))


def _fields(one: Row | None) -> dict[str, float]:
    return {key: value for key, value in (one or {}).get("fields", {}).items() if value}


def is_right(row: Row, names: Sequence[str]) -> bool:
    """Whether a class of look-alikes holds something that is there, or cannot be told from it."""
    return any(not alike(row, true).isdisjoint(names) for true in there(row))


def named(row: Row, true: str) -> bool:
    """Whether a true effect is in a class that ``improve`` ends with."""
    return any(not alike(row, true).isdisjoint(names) for names in row["last_names"])


def first_right(row: Row) -> bool:
    """Whether the class that ``diagnose`` names is that of the one effect that is hidden."""
    return bool(row["names"]) and not alike(row, row["name"]).isdisjoint(row["names"][0])


def wrong(row: Row) -> list[list[str]]:
    """Return the classes that ``improve`` ends with in which nothing is there."""
    return [names for names in row["last_names"] if not is_right(row, names)]


def matters(row: Row) -> bool:
    """Whether a single effect lowers the test error by a tenth when it is added and fitted."""
    return row["name"] in row.get("matter", [])


def rest_matters(row: Row) -> bool:
    """Whether what is on no list raises the test error of the model with the true effects by a tenth."""
    known = row.get("true_percent", row["base_percent"])
    return bool(row["clean_percent"] <= 0.9 * known)


def rest_is_unknown(row: Row) -> bool:
    """Whether the answer says that something remains that no listed effect explains."""
    return bool(
        row["last_verdict"] == "unknown-effect" or row["last_unknown"] or (row["remaining"] or {}).get("channel")
    )
