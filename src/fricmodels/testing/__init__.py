"""The exam that laws, effects, estimators, readers and controllers sit, the built-in ones and those of plugins alike.

A plugin's test is a class with one line::

    from fricmodels.testing import LawExam

    class TestMyLaw(LawExam):
        term = MyLaw

Each check that fails says what to change. ``fricmodels check NAME`` runs the same exam from the shell.
"""

from __future__ import annotations

from fricmodels.testing.controller_exam import ControllerExam
from fricmodels.testing.estimator_exam import EstimatorExam
from fricmodels.testing.exam import EffectExam, LawExam, TermExam
from fricmodels.testing.faults import Fault
from fricmodels.testing.reader_exam import ReaderExam
from fricmodels.testing.sitting import Outcome, checks, examine, sit

__all__ = [
    "ControllerExam",
    "EffectExam",
    "EstimatorExam",
    "Fault",
    "LawExam",
    "Outcome",
    "ReaderExam",
    "TermExam",
    "checks",
    "examine",
    "sit",
]
