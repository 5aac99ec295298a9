"""Declared units against the torque equation: the size of newton, radian, second and kelvin must not matter."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from fricmodels.arrays import Array
from fricmodels.dimension import TIME, Dimension, Scales
from fricmodels.testing.faults import Fault
from fricmodels.testing.subject import Subject

_COLUMNS = 6
_BASES = {"force": "N m", "displacement": "rad", "time": "s", "temperature": "K"}
_HALVES = [Fraction(n, 2) for n in (0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6)]
_WHOLE = [Fraction(n) for n in (0, 1, -1)]


@dataclass(frozen=True)
class _Trial:
    """Columns at which the equation is evaluated, before and after a change of the sizes of units."""

    subject: Subject
    columns: list[Array]
    scales: Scales

    def holds(self, dimensions: list[Dimension]) -> bool:
        """Whether the torque and the rates are the same quantities in either system of units."""
        states = self.subject.model.states
        sizes = np.array([self.scales.of(d) for d in dimensions])
        back = np.array([self.scales.force, *(self.scales.of(z.dimension * TIME**-1) for z in states)])
        for column in self.columns:
            before, after = self.subject.values(column), self.subject.values(column / sizes) * back
            if not np.allclose(after, before, rtol=1e-8, atol=1e-8 * float(np.max(np.abs(before), initial=1e-9))):
                return False
        return True


def check_units(subject: Subject) -> None:
    """Change the sizes of the base units by powers of two; the torque must stay the same torque."""
    rng = np.random.default_rng(11)
    columns = [subject.column(rng, velocity=v) for v in (1.3, -0.7, 0.4, -1.9, 0.0, 1.0)[:_COLUMNS]]
    moving = columns[:4] + columns[5:]
    angle = 1.0 if subject.term.angular else 4.0
    trials = {
        base: _Trial(subject, columns, Scales(**{base: size}))
        for base, size in (("force", 8.0), ("displacement", angle), ("time", 2.0), ("temperature", 16.0))
    }
    declared = list(subject.dimensions)
    wrong = [base for base, trial in trials.items() if not trial.holds(declared)]
    if not wrong:
        return
    if not all(np.isfinite(subject.values(column)).all() for column in columns):
        from fricmodels.testing.term_checks import check_finite

        check_finite(subject)  # what is no number is never the same in other units
    both = _Trial(subject, moving, Scales(3.0, 5.0 if angle > 1 else 1.0, 7.0, 11.0))
    for i, p in enumerate(subject.term.parameters):
        right = _right_dimension(both, declared, subject.place(i))
        if right is not None and right != declared[subject.place(i)]:
            raise Fault(
                f"{p.symbol} has the wrong unit '{p.unit}': the torque equation needs '{right.unit()}'; declare that"
            )
    units = " and ".join(_BASES[base] for base in wrong)
    hint = "; where the position enters as an angle (sin q), say angular = True" if wrong == ["displacement"] else ""
    raise Fault(
        f"the torque is not the same when the size of {units} changes, and no single unit mends it: "
        f"a sum or a function mixes quantities of different units; give each number in torque() a parameter{hint}"
    )


def _right_dimension(trial: _Trial, declared: list[Dimension], place: int) -> Dimension | None:
    """Return the simplest dimension of one parameter under which the equation holds."""
    candidates = sorted(
        (Dimension(*e) for e in itertools.product(_WHOLE, _HALVES, _HALVES, _WHOLE)),
        key=lambda d: sum(abs(e) for e in (d.force, d.displacement, d.time, d.temperature)),
    )
    for candidate in candidates:
        if trial.holds([*declared[:place], candidate, *declared[place + 1 :]]):
            return candidate
    return None
