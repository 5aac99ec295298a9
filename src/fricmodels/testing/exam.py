"""The exam of laws and effects: a test class that a plugin's tests inherit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from fricmodels import plugins
from fricmodels.term import Term
from fricmodels.testing import term_checks, written
from fricmodels.testing.declared import Declared
from fricmodels.testing.faults import Fault, SkipTest
from fricmodels.testing.recovery import check_identifiable, check_places, check_recovered
from fricmodels.testing.subject import Subject, subject
from fricmodels.testing.units import check_units


def check_registered(kind: str, cls: type) -> None:
    """The plugin manager finds the class under its name."""
    loaded = plugins.load()
    registry = loaded.registries[kind]
    name = getattr(cls, "name", None)
    if name not in registry:
        reasons = [str(failure) for failure in loaded.failures if f"'{name}'" in failure.reason]
        raise Fault(
            f"{kind} {name!r} is not registered: {reasons[0]}"
            if reasons
            else f"{kind} {name!r} is not registered; return the class from the hook fricmodels_{kind}s and install "
            "the distribution with its entry point in the group 'fricmodels'"
        )
    entry = registry.entry(str(name))
    if entry.cls is not cls:
        raise Fault(f"the name {name!r} belongs to {entry.cls.__name__} of {entry.distribution}; choose another name")


class TermExam(Declared):
    """What laws and effects have in common.

    ``truth``, ``tolerance`` and ``estimators`` may also stand in the class itself, in its mapping ``exam``; then they
    count for ``fricmodels check`` as well.

    Attributes:
        term: the class that sits the exam.
        truth: values by symbol under which the drive of the exam moves, where the suggested ones do not fit.
        tolerance: relative error of a parameter that is recovered from a recording without noise.
        estimators: names of those that must recover the parameters; one that says that it cannot carry the
            model is left out.
    """

    of, _may_say = "term", ("truth", "tolerance", "estimators")
    kind: ClassVar[str]
    term: ClassVar[type[Term]]
    truth: ClassVar[Mapping[str, float] | None] = None
    tolerance: ClassVar[float] = 0.03
    estimators: ClassVar[tuple[str, ...]] = ("batch",)

    @property
    def subject(self) -> Subject:
        """The term and its functions."""
        return subject(self.term)

    def test_declaration(self) -> None:
        """Name, formula, docstring, units and meanings."""
        term_checks.check_declaration(self.term)

    def test_registered(self) -> None:
        """Found by the plugin manager."""
        check_registered(self.kind, self.term)

    def test_torque_is_an_expression(self) -> None:
        """One scalar, made without an exception; solvable for the acceleration."""
        term_checks.check_needs(self.subject)

    def test_own_functions(self) -> None:
        """The sign at rest is that of fricmodels.expressions."""
        written.check_own_functions(self.subject)

    def test_formula(self) -> None:
        """The formula as text says what the code computes."""
        written.check_formula(self.subject)

    def test_no_copy(self) -> None:
        """No built-in term has the same equation."""
        written.check_no_copy(self.subject)

    def test_parameters_matter(self) -> None:
        """No parameter is idle, and nonlinear ones can be searched for."""
        term_checks.check_parameters_matter(self.subject)
        check_places(self.subject)

    def test_depends_on_its_signals_alone(self) -> None:
        """The same at every call; on the time only where claimed."""
        term_checks.check_same_every_time(self.subject)

    def test_units(self) -> None:
        """Declared units are true: rescaled, the equation still holds."""
        check_units(self.subject)

    def test_finite_at_rest_and_at_bounds(self) -> None:
        """Torque and derivatives."""
        term_checks.check_finite(self.subject)

    def test_derivatives(self) -> None:
        """Against finite differences."""
        term_checks.check_derivatives(self.subject)

    def test_smooth_limit(self) -> None:
        """The smoothed torque is the same away from rest."""
        term_checks.check_smooth_limit(self.subject)

    def test_linear_parameters(self) -> None:
        """Superposition."""
        term_checks.check_linear(self.subject)

    def test_dissipative(self) -> None:
        """Never pushes, where claimed."""
        term_checks.check_dissipative(self.subject)

    def test_symmetry(self) -> None:
        """Odd or even, as claimed."""
        term_checks.check_symmetry(self.subject)

    def test_neutral(self) -> None:
        """An effect of size zero changes nothing."""
        term_checks.check_neutral(self.subject)

    def test_discrete_step(self) -> None:
        """States with a discrete step: a short one agrees with the rates."""
        term_checks.check_discrete_step(self.subject)

    def test_beginning(self) -> None:
        """First states that are found from the torque: what they are found by is linear in them."""
        term_checks.check_beginning(self.subject)

    def test_identifiable(self) -> None:
        """A rich motion determines every parameter."""
        check_identifiable(self.subject, self.truth)

    def test_compiled(self) -> None:
        """The compiled loop agrees with the evaluation on arrays."""
        term_checks.check_compiled(self.subject)

    def test_recovered(self) -> None:
        """Estimators find the true parameters from simulated data."""
        faults, reasons = [], []
        registered = plugins.load().estimators
        for name in self.estimators:
            try:
                check_recovered(self.subject, registered[name], self.truth, self.tolerance)
            except SkipTest as reason:
                reasons.append(str(reason))
            except Fault as fault:
                faults.append(str(fault))
        if faults:
            raise Fault("; ".join(faults))
        if len(reasons) == len(self.estimators):
            raise SkipTest("; ".join(reasons) or "no estimator was asked")


class LawExam(TermExam):
    """The exam of a law::

    class TestMyLaw(LawExam):
        term = MyLaw
    """

    kind = "law"


class EffectExam(TermExam):
    """The exam of an effect::

    class TestMyEffect(EffectExam):
        term = MyEffect
    """

    kind = "effect"
