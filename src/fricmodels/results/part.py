"""What the documents of results have in common: read strictly, never changed, written as they were made."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from fricmodels.documents import first_problem
from fricmodels.errors import InputError
from fricmodels.stored import read_results


def finite(value: Any) -> Any:
    """Return a value; ``None`` for a number that JSON does not have."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


Number = Annotated[float | None, BeforeValidator(finite)]
"""A number; ``None`` where it is none that JSON has."""
Numbers = dict[str, Number]


class Part(BaseModel):
    """Part of a document. Keys that this version does not know are kept: a later one may have added them."""

    model_config = ConfigDict(
        extra="allow", frozen=True, strict=True, populate_by_name=True, use_attribute_docstrings=True
    )


class ResultDocument(Part):
    """A file of results. Fields are only ever added to a schema."""

    schema_: str = Field(validation_alias="schema", serialization_alias="schema")
    """What the document is, with its version."""

    @classmethod
    def read(cls, path: Path, again: str) -> Self:
        """Read a document.

        Args:
            path: the file.
            again: the command that makes it anew.

        Raises:
            FileNotFoundError: when it is not there.
            InputError: when it is no JSON, of another schema, or something in it is not as it should be.
        """
        return cls.checked(read_results(path, cls.model_fields["schema_"].default, again), path, again)

    @classmethod
    def checked(cls, content: Any, path: Path, again: str) -> Self:
        """Return what was read from a file as a document.

        Raises:
            InputError: when something in it is not as it should be.
        """
        try:
            return cls.model_validate_json(json.dumps(content))
        except ValidationError as error:
            raise InputError(f"{path}: {first_problem(error, cls)}; make it anew with: {again}") from None

    def plain(self) -> dict[str, Any]:
        """Return the content of the file: what was never set is left out."""
        return {"schema": self.schema_, **self.model_dump(mode="json", by_alias=True, exclude_unset=True)}

    def to_json(self) -> str:
        """Return the text of the file; equal documents have equal texts."""
        return json.dumps(self.plain(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
