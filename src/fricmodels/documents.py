"""Reads a YAML file and remembers where every key stands, so that an error can name its line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin

import yaml
from pydantic import BaseModel, ValidationError

from fricmodels.errors import InputError, suggestion

Place = tuple[str | int, ...]
M = TypeVar("M", bound=BaseModel)
_MOST_NODES = 100_000
_DEEPEST = 50


@dataclass(frozen=True)
class Document:
    """The content of a YAML file, and the line of each of its keys and items."""

    file: Path
    content: Any
    lines: dict[Place, int]

    def line(self, path: Sequence[str | int]) -> int:
        """Return the line of the innermost part of ``path`` that the file has."""
        parts = tuple(path)
        while parts and parts not in self.lines:
            parts = parts[:-1]
        return self.lines.get(parts, 1)

    def error(self, path: Sequence[str | int], message: str) -> InputError:
        """Return an error that names file and line."""
        return InputError(f"{self.file}:{self.line(path)}: {message}")


def read_yaml(file: str | Path) -> Document:
    """Read a YAML file safely: no tag builds an object, no key stands twice.

    Raises:
        InputError: naming file and line.
    """
    path = Path(file)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text: {error}") from None
    loader = None
    try:
        loader = yaml.SafeLoader(text)
        node = loader.get_single_node()
        if node is None:
            raise InputError(f"{path}: the file is empty")
        lines = _lines(node, path)
        content = loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f"{path}:{mark.line + 1}" if mark else str(path)
        raise InputError(f"{where}: {_one_line(error)}") from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError(f"{path}: is not valid YAML: {' '.join(str(error).split())}") from None
    finally:
        if loader is not None:
            loader.dispose()
    return Document(path, content, lines)


def _one_line(error: yaml.MarkedYAMLError) -> str:
    problem = " ".join(str(error.problem or error.context or "is not valid YAML").split())
    if "could not determine a constructor for the tag" in problem:
        tag = problem.split("'")[1] if "'" in problem else "?"
        return f"the tag '{tag}' is refused: a configuration builds no objects; write plain values"
    return f"is not valid YAML: {problem}"


def _lines(root: yaml.Node, file: Path) -> dict[Place, int]:
    lines: dict[Place, int] = {(): root.start_mark.line + 1}
    waiting: list[tuple[Place, yaml.Node]] = [((), root)]
    while waiting:
        if len(lines) > _MOST_NODES:
            raise InputError(f"{file}: has more than {_MOST_NODES} entries after its anchors are followed")
        path, node = waiting.pop()
        if len(path) > _DEEPEST:
            raise InputError(f"{file}:{node.start_mark.line + 1}: is nested more than {_DEEPEST} deep")
        if isinstance(node, yaml.MappingNode):
            waiting.extend(_keys(path, node, file, lines))
        elif isinstance(node, yaml.SequenceNode):
            for index, item in enumerate(node.value):
                lines[(*path, index)] = item.start_mark.line + 1
                waiting.append(((*path, index), item))
    return lines


def _keys(path: Place, node: yaml.MappingNode, file: Path, lines: dict[Place, int]) -> list[tuple[Place, yaml.Node]]:
    inside: list[tuple[Place, yaml.Node]] = []
    seen: dict[str, int] = {}
    for key, value in node.value:
        line = key.start_mark.line + 1
        name = str(key.value)
        if name in seen and key.tag != "tag:yaml.org,2002:merge":
            raise InputError(f"{file}:{line}: key '{name}' stands twice; it is already on line {seen[name]}")
        seen[name] = line
        if key.tag == "tag:yaml.org,2002:merge":
            merged = value.value if isinstance(value, yaml.SequenceNode) else [value]
            for source in merged:
                if isinstance(source, yaml.MappingNode):
                    inside.extend(_keys(path, source, file, lines))
            continue
        lines[(*path, name)] = line
        inside.append(((*path, name), value))
    return inside


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
    shown = f", got {value!r}" if isinstance(value, str | int | float | bool) or value is None else ""
    if problem["type"] in ("literal_error", "enum") and isinstance(value, str):
        expected = [word.strip("'") for word in str(problem["ctx"]["expected"]).replace(" or ", ", ").split(", ")]
        return f"key '{key}'{inside} cannot be '{value}'{suggestion(value, expected)}"
    if problem["type"] == "value_error":
        return f"key '{key}'{inside}: {text}" if names else text
    return f"key '{key}'{inside}: {text[:1].lower()}{text[1:]}{shown}"


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
