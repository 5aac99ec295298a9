"""Sums of rows: what a file says of a model, small, typed, and the same when added in whatever order."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt, ValidationError

from fricmodels.arrays import Array, deviations
from fricmodels.documents import Finite, first_problem
from fricmodels.errors import InputError
from fricmodels.files import write_text
from fricmodels.sums.plan import Plan

PARTS = 24
"""Parts of which sums are kept apart, each a share of every file or some of the files: what they differ by is the
error of their sum. As many as the standard errors of one recording take."""
SUFFIX = ".sums.json"
_ROUNDING = 1e-9
"""Share of the sizes by which sums that are added in another order, and written in 17 digits, may differ."""
_LONGEST = 50_000_000


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class SumsDocument(_Part):
    """Sums as they stand in a file.

    Attributes:
        plan: what the rows are.
        columns: names of the columns of the rows.
        stretches, apart: number of a part → products of the columns in it, the upper triangle row by row; see
            :class:`Sums`.
        rows, samples: how many. files: digest of a file's sums → its name.
        range: channel → least and greatest value.
    """

    schema_: Literal["fricmodels/sums/1"] = Field("fricmodels/sums/1", alias="schema")
    plan: Plan
    columns: tuple[str, ...]
    stretches: dict[int, tuple[Finite, ...]]
    apart: dict[int, tuple[Finite, ...]]
    rows: NonNegativeInt
    samples: NonNegativeInt
    files: dict[str, str]
    range: dict[str, tuple[Finite, Finite]]


@dataclass(frozen=True, eq=False)
class Sums:
    """Products of the columns of the rows of some files, summed.

    Attributes:
        plan: what the rows are.
        stretches: of the rows of each part of every file's time, shape (PARTS, columns, columns).
        apart: of the rows of files that fall into a part as a whole, shape (PARTS, columns, columns). Both have the
            same sum. Parts of files differ by noise and by what changes within a file, files by what changes from one
            to the next.
        rows, samples: how many.
        files: digest of a file's sums → its name.
        range: channel → least and greatest value.
    """

    plan: Plan
    stretches: Array
    apart: Array
    rows: int
    samples: int
    files: Mapping[str, str] = field(default_factory=dict)
    range: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, plan: Plan, name: str, stretches: Array, rows: int, samples: int, seen: Mapping[str, Array]) -> Self:
        """Return the sums of one file.

        Args:
            plan: what the rows are.
            name: of the file.
            stretches: products by part, shape (PARTS, columns, columns).
            rows: how many.
            samples: how many.
            seen: channel → least and greatest value.
        """
        limits = {channel: (float(least), float(most)) for channel, (least, most) in sorted(seen.items())}
        text = json.dumps([plan.model_dump(mode="json"), samples, rows, list(limits.items())])
        digest = hashlib.sha256(text.encode() + np.ascontiguousarray(stretches, dtype="<f8").tobytes()).hexdigest()
        apart = np.zeros_like(stretches)
        apart[int(digest[:8], 16) % PARTS] = stretches.sum(axis=0)
        return cls(plan, stretches, apart, rows, samples, {digest[:16]: name}, limits)

    @property
    def whole(self) -> Array:
        """Products of the columns over all rows, shape (columns, columns)."""
        return np.asarray(self.stretches.sum(axis=0))

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of the rows."""
        linear = [p.key for p in self.plan.drive.model_parameters]
        return ("push", self.plan.drive.inertia_key, *linear, "shift of reversals", "shift of time")

    def plus(self, other: Self) -> Self:
        """Return the sums of the files of both.

        Raises:
            InputError: where their rows are not the same, or a file is in both.
        """
        if other.plan != self.plan:
            mine, theirs = self.plan.model_dump(), other.plan.model_dump()
            key = next(key for key in mine if mine[key] != theirs[key])
            raise InputError(
                f"the sums of {_some(self.files)} and of {_some(other.files)} are not of the same rows: '{key}' is "
                f"{mine[key]} and {theirs[key]}; make both with one plan, by --like FILE{SUFFIX}"
            )
        twice = [name for digest, name in other.files.items() if digest in self.files]
        if twice:
            raise InputError(f"the samples of {twice[0]} would count twice; add each file once")
        limits = dict(self.range)
        for channel, (least, most) in other.range.items():
            before = limits.get(channel, (least, most))
            limits[channel] = (min(before[0], least), max(before[1], most))
        return replace(
            self,
            stretches=self.stretches + other.stretches,
            apart=self.apart + other.apart,
            rows=self.rows + other.rows,
            samples=self.samples + other.samples,
            files={**self.files, **other.files},
            range=limits,
        )

    # ---- the file -------------------------------------------------------------------------------------------------

    def to_json(self) -> str:
        """Return the text of the file: every number to the last bit."""
        document = SumsDocument(
            schema="fricmodels/sums/1",
            plan=self.plan,
            columns=self.columns,
            stretches=_triangles(self.stretches),
            apart=_triangles(self.apart),
            rows=self.rows,
            samples=self.samples,
            files=dict(self.files),
            range=dict(self.range),
        )
        return json.dumps(document.model_dump(mode="json", by_alias=True), ensure_ascii=False, allow_nan=False) + "\n"

    def save(self, path: str | Path) -> Path:
        """Write the file; see :func:`fricmodels.files.replaced`."""
        return write_text(Path(path), self.to_json())


def added(sums: Iterable[Sums]) -> Sums:
    """Return the sums of all files: the same to the last bit in whatever order they are given.

    Raises:
        InputError: where there are none, rows are not the same, or a file is given twice.
    """
    ordered = sorted(sums, key=lambda one: sorted(one.files))
    if not ordered:
        raise InputError("there are no sums to be added; give at least one file of them")
    total, *others = ordered
    for other in others:
        total = total.plus(other)
    return total


def load(path: str | Path) -> Sums:
    """Read sums from their file.

    Raises:
        InputError: for a file that holds none; one line with what is wrong.
    """
    source = Path(path)
    try:
        if source.stat().st_size > _LONGEST:
            raise InputError(f"{source}: has {source.stat().st_size} bytes, which no sums have")
        document = SumsDocument.model_validate(json.loads(source.read_text(encoding="utf-8")))
    except ValidationError as error:
        raise InputError(f"{source}: holds no sums: {first_problem(error, SumsDocument)}") from None
    except OSError as error:
        raise InputError(f"{source}: cannot be opened: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{source}: holds no sums: {str(error)[:200]}") from None
    empty = np.zeros((PARTS, len(document.columns), len(document.columns)))
    found = Sums(
        document.plan, empty, empty, document.rows, document.samples, dict(document.files), dict(document.range)
    )
    if found.columns != document.columns:
        raise InputError(f"{source}: has the columns {', '.join(document.columns)}; '{found.plan.model}' has others")
    stretches, apart = (_squares(source, each, empty) for each in (document.stretches, document.apart))
    whole = stretches.sum(axis=0)
    size = np.sqrt(np.diag(whole))
    if np.any(np.abs(apart.sum(axis=0) - whole) > _ROUNDING * np.outer(size, size)):
        raise InputError(f"{source}: its sums by time and by file differ; was it changed?")
    return replace(found, stretches=stretches, apart=apart)


def _triangles(parts: Array) -> dict[int, tuple[float, ...]]:
    upper = np.triu_indices(parts.shape[1])
    return {number: tuple(part[upper].tolist()) for number, part in enumerate(parts) if part.any()}


def _squares(source: Path, given: Mapping[int, tuple[float, ...]], empty: Array) -> Array:
    parts, upper = empty.copy(), np.triu_indices(empty.shape[1])
    for number, values in given.items():
        if not 0 <= number < PARTS or len(values) != len(upper[0]):
            raise InputError(f"{source}: part {number} has {len(values)} sums; there are {PARTS} of {len(upper[0])}")
        parts[number][upper] = values
        parts[number].T[upper] = values
        size = deviations(parts[number])
        with np.errstate(all="ignore"):  # what is not finite is refused
            scaled = np.divide(parts[number], np.outer(size, size) + (parts[number] == 0.0))
        if not (np.all(np.isfinite(scaled)) and np.linalg.eigvalsh(scaled)[0] > -_ROUNDING * len(size)):
            raise InputError(f"{source}: part {number} holds no sums of products; was it changed?")
    return parts


def _some(files: Mapping[str, str]) -> str:
    first = next(iter(files.values()), "no file")
    return first if len(files) <= 1 else f"{first} and {len(files) - 1} more"
