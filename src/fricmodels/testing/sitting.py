"""Sits an exam outside of a test runner: check by check, here or in a process that may die or hang."""

from __future__ import annotations

import multiprocessing
import os
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

from fricmodels import plugins
from fricmodels.errors import InputError, suggestion
from fricmodels.plugins.registry import Failure
from fricmodels.processes import end_with_parent
from fricmodels.testing.controller_exam import ControllerExam
from fricmodels.testing.estimator_exam import EstimatorExam
from fricmodels.testing.exam import EffectExam, LawExam
from fricmodels.testing.faults import SkipTest
from fricmodels.testing.reader_exam import ReaderExam

EXAMS: dict[str, type[Any]] = {
    "law": LawExam,
    "effect": EffectExam,
    "estimator": EstimatorExam,
    "reader": ReaderExam,
    "controller": ControllerExam,
}
"""Kind of plugin → its exam."""

_THOROUGH_SEEDS = 100


@dataclass(frozen=True)
class Outcome:
    """How one check ended.

    Attributes:
        check: its name.
        result: ``passed``, ``failed``, ``skipped``, ``timeout`` or ``crashed``.
        message: what to change, or why it was skipped.
        seconds: how long it took.
    """

    check: str
    result: str
    message: str = ""
    seconds: float = 0.0

    @property
    def good(self) -> bool:
        """Whether nothing needs to change."""
        return self.result in ("passed", "skipped")


def checks(exam: type[Any]) -> list[str]:
    """Return the names of an exam's checks, in order."""
    names = [name for cls in reversed(exam.__mro__) for name in vars(cls) if name.startswith("test_")]
    return list(dict.fromkeys(names))


def exam_of(kind: str, cls: type[Any], *, thorough: bool = False) -> type[Any]:
    """Return the exam of one class: every estimator and many seeds where it is thorough."""
    attributes: dict[str, Any] = {EXAMS[kind].of: cls}
    if thorough and kind in ("law", "effect"):
        attributes["estimators"] = tuple(plugins.load().estimators)
    if thorough and kind == "estimator":
        attributes["seeds"] = _THOROUGH_SEEDS
    return type(f"ExamOf{cls.__name__}", (EXAMS[kind],), attributes)


def sit(exam: type[Any], check: str) -> Outcome:
    """Do one check of an exam, here."""
    begin = time.perf_counter()
    result, message = "passed", ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            getattr(exam(), check)()
        except SkipTest as reason:
            result, message = "skipped", str(reason)
        except AssertionError as fault:
            result, message = "failed", str(fault)
        except (Exception, SystemExit) as error:
            result, message = "failed", f"{type(error).__name__}: {error}"
    return Outcome(check, result, " ".join(message.split()), time.perf_counter() - begin)


def once(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Return outcomes in which what fails every check for the same reason fails one, and the others are skipped."""
    first: dict[str, str] = {}
    found = []
    for outcome in outcomes:
        before = None if outcome.good else first.setdefault(outcome.message, outcome.check)
        if before is not None and before != outcome.check:
            title = before.removeprefix("test_").replace("_", " ")
            outcome = replace(outcome, result="skipped", message=f"not tried: see '{title}'")
        found.append(outcome)
    return found


def named(name: str) -> list[tuple[str, str]]:
    """Return kind and name of what a name, or the name of a distribution, stands for.

    Raises:
        InputError: where nothing has that name, naming the nearest known one.
    """
    loaded = plugins.load()
    entries = [
        (kind, own, registry.entry(own).distribution)
        for kind, registry in loaded.registries.items()
        for own in registry.names
    ]
    found = [(kind, own) for kind, own, distribution in entries if name in (own, distribution)]
    if not found:
        reasons = [str(failure) for failure in loaded.failures if name in _called(failure)]
        if reasons:
            raise InputError(reasons[0])
        unknown = [str(failure) for failure in loaded.failures if failure.concerns is None]
        if unknown:
            raise InputError(f"nothing is registered as '{name}' ({'; '.join(unknown)})")
        known = {own for _, own, _ in entries} | {distribution for *_, distribution in entries}
        near = get_close_matches(name, known, cutoff=0.5)
        way_out = suggestion(name, known) if near else "; 'fricmodels list' and 'fricmodels plugins' show what is there"
        raise InputError(f"nothing is registered as '{name}'{way_out}")
    return found


def _called(failure: Failure) -> set[str]:
    """Return what somebody may call a plugin that is left out: its own names, and those of its classes."""
    classes = (*([failure.concerns] if failure.concerns else []), *failure.lost)
    return {failure.distribution, failure.plugin, *(name for _, name in classes)}


def examine(kind: str, name: str, *, timeout: float = 120.0, thorough: bool = False) -> Iterator[Outcome]:
    """Let a registered class sit its exam, each check in a process of its own that may die or hang.

    Args:
        kind: ``law``, ``effect``, ``estimator``, ``reader`` or ``controller``.
        name: under which it is registered.
        timeout: seconds for one check.
        thorough: recovery by every estimator, coverage over 100 seeds.
    """
    from pebble import ProcessExpired, ProcessPool

    context = multiprocessing.get_context("spawn")
    with ProcessPool(max_workers=1, context=context, initializer=end_with_parent, initargs=[os.getpid()]) as pool:
        for check in checks(EXAMS[kind]):
            future = pool.schedule(_sit_registered, args=[kind, name, check, thorough], timeout=timeout)
            try:
                yield future.result()
            except TimeoutError:
                message = f"took longer than {timeout:g} s; is there an endless loop?"
                yield Outcome(check, "timeout", message, timeout)
                break
            except ProcessExpired as error:
                message = f"the interpreter died with exit code {error.exitcode}; look for os._exit and compiled code"
                yield Outcome(check, "crashed", message)
                break


def _sit_registered(kind: str, name: str, check: str, thorough: bool) -> Outcome:
    registry = plugins.load().registries[kind]
    return sit(exam_of(kind, registry[name], thorough=thorough), check)
