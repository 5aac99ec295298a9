"""Which effects explain the same data, and which experiment would tell them apart."""

from __future__ import annotations

from itertools import combinations

_EXPERIMENTS: tuple[tuple[frozenset[str], str], ...] = (
    (
        frozenset({"asymmetry", "torque-offset"}),
        "a static test: hold the drive at rest without torque, or turn it over by hand; an offset is there at rest too",
    ),
    (frozenset({"inertia-error", "torque-gain"}), "a known load: add a weight of known torque or inertia and repeat"),
    (frozenset({"gravity", "torque-gain"}), "another payload: gravity changes with it, the torque constant does not"),
    (frozenset({"directional-efficiency", "torque-gain"}), "a run without load: losses under load vanish with it"),
    (frozenset({"load-friction", "directional-efficiency"}), "the same load driven and driven back at equal speeds"),
    (
        frozenset({"sensor-delay", "inertia-error", "frictional-lag", "joint-compliance"}),
        "several frequencies: repeat the motion faster and slower",
    ),
    (
        frozenset({"nonlinear-viscous", "stribeck"}),
        "a wider speed range: constant speeds from a hundredth of the peak speed to the peak",
    ),
    (
        frozenset({"stribeck", "frictional-lag", "rising-stiction"}),
        "slow reversals at several accelerations, and rests of different lengths",
    ),
    (
        frozenset({"presliding", "backlash", "stribeck", "nonlinear-viscous", "rising-stiction", "frictional-lag"}),
        "small reversals recorded with a fine position sensor, at several accelerations",
    ),
    (frozenset({"gravity", "stiffness", "cogging"}), "a wider position range: a full turn or more"),
    (
        frozenset({"cogging", "position-friction", "torque-ripple", "gravity", "stiffness"}),
        "pass the same positions in both directions and with different torques",
    ),
    (frozenset({"thermal", "drift", "step-change"}), "a thermometer, and a record that warms and cools again"),
)


def experiment(first: str, second: str) -> str:
    """Return the experiment that would separate two effects, in words."""
    for members, text in _EXPERIMENTS:
        if {first, second} <= members:
            return text
    return f"a recording in which '{first}' and '{second}' vary independently"


def separated_by(members: list[str]) -> str:
    """Return the experiments that would separate the members of a class; empty for a class of one."""
    texts: list[str] = []
    for first, second in combinations(members, 2):
        text = experiment(first, second)
        if text not in texts:
            texts.append(text)
    return "; ".join(texts[:2])


def same_in_part(smaller: str, larger: str) -> bool:
    """Whether the larger effect, where it does no more than the smaller one, is still another physical cause.

    An asymmetry of the Coulomb torque alone is the same torque as an offset, but not the same cause. A spring without
    stiffness, or a load-dependent friction equal in both directions, is nothing of its own.
    """
    return {smaller, larger} == {"asymmetry", "torque-offset"}
