"""Rig files: YAML in, errors that name file, line and key."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from fricmodels.errors import InputError, suggestion
from fricmodels.rig.rig import Rig


def load_rig(path: str | Path) -> Rig:
    """Read a rig file.

    Raises:
        InputError: for a file that is not there, is not YAML, or does not describe a rig; names line and key.
    """
    import yaml

    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read the rig file {file}: {error}") from None
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
        content = yaml.safe_load(text)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise InputError(f"{file}:{line}: not valid YAML: {error.problem}") from None
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(f"{file}: not valid YAML: {str(error).splitlines()[0]}") from None
    _refuse_duplicates(file, root)
    if not isinstance(content, dict):
        raise InputError(f"{file}:1: a rig file is a mapping with inertia, friction, excitation, rate, …")
    content.setdefault("name", file.stem)
    try:
        return Rig.model_validate(content)
    except ValidationError as error:
        raise InputError(_message(file, root, error)) from None


def _refuse_duplicates(file: Path, root: Any) -> None:
    waiting = [root]
    while waiting:
        node = waiting.pop()
        children = node.value if node is not None and isinstance(node.value, list) else []
        seen: dict[str, int] = {}
        for child in children:
            if not isinstance(child, tuple):
                waiting.append(child)
                continue
            key, value = child
            waiting.append(value)
            line = key.start_mark.line + 1
            if key.value in seen:
                raise InputError(f"{file}:{line}: key '{key.value}' stands twice, first on line {seen[key.value]}")
            seen[key.value] = line


def _message(file: Path, root: Any, error: ValidationError) -> str:
    first = min(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
    path = [part for part in first["loc"] if part not in _TAGS]
    key = ".".join(str(part) for part in path) or "rig"
    if first["type"] == "union_tag_invalid":
        path.append(str(first["ctx"]["discriminator"]).strip("'"))
    place = f"{file}:{_line(root, path)}"
    if first["type"] == "extra_forbidden":
        return f"{place}: unknown key '{key}'{suggestion(str(path[-1]), _known(root, path))}"
    if first["type"] == "missing":
        return f"{place}: '{key}' is missing"
    if first["type"] == "union_tag_invalid":
        context = first["ctx"]
        tags = [tag.strip().strip("'") for tag in context["expected_tags"].split(",")]
        return f"{place}: unknown {path[-1]} '{context['tag']}' in '{key}'{suggestion(context['tag'], tags)}"
    return f"{place}: '{key}': {first['msg'].removeprefix('Value error, ')}"


def _line(node: Any, path: Iterable[Any]) -> int:
    """Return the line of the deepest node on the path that is there."""
    line = node.start_mark.line + 1
    for part in path:
        if hasattr(node, "value") and isinstance(node.value, list):
            if isinstance(part, int) and part < len(node.value):
                node = node.value[part]
                line = node.start_mark.line + 1
                continue
            pair = next((p for p in node.value if isinstance(p, tuple) and p[0].value == part), None)
            if pair is not None:
                line, node = pair[0].start_mark.line + 1, pair[1]
                continue
        break
    return int(line)


def _models(model: type[BaseModel]) -> Iterable[type[BaseModel]]:
    import typing

    yield model
    for field in model.model_fields.values():
        waiting = [field.annotation]
        while waiting:
            annotation = waiting.pop()
            waiting.extend(typing.get_args(annotation))
            if isinstance(annotation, type) and issubclass(annotation, BaseModel):
                yield from _models(annotation)


def _default(model: type[BaseModel], field: str) -> Any:
    return model.model_fields[field].default if field in model.model_fields else None


_MODELS = tuple(dict.fromkeys(_models(Rig)))
_TAGS = {_default(model, "name") for model in _MODELS if model is not Rig} | {
    _default(model, "kind") for model in _MODELS
} - {None}


def _known(root: Any, path: list[Any]) -> list[str]:
    """Return the keys that are right beside a wrong one."""
    siblings: set[str] = set()
    node = root
    for part in path[:-1]:
        if isinstance(part, int):
            node = node.value[part]
        else:
            node = next((value for key, value in node.value if key.value == part), node)
    if hasattr(node, "value") and isinstance(node.value, list):
        siblings = {key.value for key, _ in node.value}
        tags = {value.value for key, value in node.value if key.value in ("name", "kind")}
        for model in _MODELS:
            if tags & {_default(model, "name"), _default(model, "kind")}:
                return list(model.model_fields)
    fitting = [model for model in _MODELS if len(path) > 1 or model is Rig]
    best = max(fitting, key=lambda model: len(siblings & set(model.model_fields)) - 0.01 * len(model.model_fields))
    return list(best.model_fields)
