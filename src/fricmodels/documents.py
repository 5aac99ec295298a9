"""Turns what stands in a YAML file into a typed document; errors name line, key and the nearest right key."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, Field, ValidationError

from fricmodels.errors import InputError, suggestion
from fricmodels.yaml_file import Document as Document
from fricmodels.yaml_file import Place
from fricmodels.yaml_file import read_yaml as read_yaml

M = TypeVar("M", bound=BaseModel)

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


def validate(document: Document, model: type[M]) -> M:
    """Turn a document into a pydantic model.

    Raises:
        InputError: for the first thing that is wrong, naming file, line, key and the nearest right key.
    """
    if not isinstance(document.content, dict):
        raise InputError(f"{document.file}:1: a mapping of keys is expected, got {type(document.content).__name__}")
    try:
        return model.model_validate(document.content)
    except ValidationError as error:
        problem = _first(error)
        place = _place(problem, document.lines)
        raise document.error(place, _message(problem, place, model)) from None


def _place(problem: Any, lines: Mapping[Place, int]) -> Place:
    """Return where a problem is in the file; pydantic names the kind too where a mapping is of one of several kinds."""
    place: Place = ()
    for part in problem["loc"]:
        if (*place, part) in lines:
            place = (*place, part)
    if problem["type"] == "missing":
        place = (*place, problem["loc"][-1])
    if problem["type"] == "union_tag_invalid":
        place = (*place, str(problem["ctx"]["discriminator"]).strip("'"))
    return place


def first_problem(error: ValidationError, model: type[BaseModel]) -> str:
    """Return the first problem of a validation in one line, without a place."""
    problem = _first(error)
    return _message(problem, problem["loc"], model)


def _first(error: ValidationError) -> Any:
    """Return the first problem; a misspelt key comes before the key that is missing because of it."""
    problems = error.errors(include_url=False)
    return next((problem for problem in problems if problem["type"] == "extra_forbidden"), problems[0])


def _message(problem: Any, place: Place, model: type[BaseModel]) -> str:
    names = [str(part) for part in place if isinstance(part, str)]
    key = names[-1] if names else "?"
    inside = f" in '{'.'.join(names[:-1])}'" if len(names) > 1 else ""
    if problem["type"] == "extra_forbidden":
        return f"key '{key}'{inside} is unknown{suggestion(key, _fields(model, problem['loc'][:-1]))}"
    if problem["type"] == "missing":
        return f"key '{key}'{inside} is missing"
    if problem["type"] == "union_tag_invalid":
        known = [tag.strip("' ") for tag in problem["ctx"]["expected_tags"].split(",")]
        return f"key '{key}'{inside} cannot be '{problem['ctx']['tag']}'{suggestion(problem['ctx']['tag'], known)}"
    text = str(problem["msg"]).removeprefix("Value error, ")
    value = problem.get("input")
    shown = f", got {_short(value)}" if isinstance(value, str | int | float | bool) or value is None else ""
    if problem["type"] in ("literal_error", "enum") and isinstance(value, str):
        expected = [word.strip("'") for word in str(problem["ctx"]["expected"]).replace(" or ", ", ").split(", ")]
        return f"key '{key}'{inside} cannot be '{value}'{suggestion(value, expected)}"
    if problem["type"] == "value_error":
        return f"key '{key}'{inside}: {text}" if names else text
    return f"key '{key}'{inside}: {text[:1].lower()}{text[1:]}{shown}"


def _short(value: object) -> str:
    """Return a value as it is written, its middle left out where it is long."""
    try:
        text = repr(value)
    except ValueError:  # Python writes no integer of more than some thousand digits
        return "an integer of thousands of digits"
    return text if len(text) <= 60 else f"{text[:40]}…{text[-10:]}"


def _fields(model: type[BaseModel], path: Sequence[str | int]) -> set[str]:
    """Return the keys that the model knows at ``path``, in which pydantic names the kind of each mapping of several."""
    here = [model]
    for part in path:
        if len(here) > 1 and any(part in _tags(kind) for kind in here):
            here = [kind for kind in here if part in _tags(kind)]
        elif isinstance(part, str):
            fields = [kind.model_fields[part] for kind in here if part in kind.model_fields]
            here = [inner for field in fields for inner in _models(field.annotation)]
    return {name for kind in here for name in kind.model_fields}


def _models(annotation: Any) -> list[type[BaseModel]]:
    """Return the models that an annotation names, however deep."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for inner in get_args(annotation) for model in _models(inner)]


def _tags(model: type[BaseModel]) -> set[Any]:
    """Return the values that say of a mapping that it is of this kind."""
    literals = (field.annotation for field in model.model_fields.values() if get_origin(field.annotation) is Literal)
    return {value for literal in literals for value in get_args(literal)}
