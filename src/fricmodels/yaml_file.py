"""Reads a YAML file safely and bounded, and remembers where every key stands, so that an error can name its line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from fricmodels.errors import InputError

Place = tuple[str | int, ...]
_MOST_BYTES = 4_000_000
_MOST_NODES = 100_000
_DEEPEST = 50
_MERGE = "tag:yaml.org,2002:merge"
_TEXTS = ("tag:yaml.org,2002:str", "tag:yaml.org,2002:value")


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
    """Read a YAML file safely: no tag builds an object, no key stands twice, nothing grows beyond what was written.

    Raises:
        InputError: naming file and line.
    """
    path = Path(file)
    text = _text(path)
    loader = None
    try:
        loader = _Loader(text)
        node = loader.get_single_node()
        if node is None:
            raise InputError(f"{path}: the file is empty")
        lines = _Lines(path).of(node)
        content = loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f"{path}:{mark.line + 1}" if mark else str(path)
        raise InputError(f"{where}: {_one_line(error)}") from None
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not valid YAML: {' '.join(str(error).split())}") from None
    finally:
        if loader is not None:
            loader.dispose()
    return Document(path, content, lines)


def _text(path: Path) -> str:
    try:
        if path.exists() and not path.is_file():
            raise InputError(f"{path}: is no file but a {'directory' if path.is_dir() else 'device or a pipe'}")
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(
                f"{path}: is longer than {_MOST_BYTES // 10**6} MB; is it the recording, not its description?"
            )
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except (OSError, UnicodeError) as error:
        raise InputError(f"{path}: cannot be read as text: {error}") from None


class _Loader(yaml.SafeLoader):
    """The safe loader; it goes no deeper than a person writes, and tells the line of a value that is none."""

    _depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose a node, unless it is too deep."""
        self._depth += 1
        if self._depth > _DEEPEST:
            event = self.peek_event()  # type: ignore[no-untyped-call]
            raise yaml.composer.ComposerError(None, None, f"is nested more than {_DEEPEST} deep", event.start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """Make the value of a node; what goes wrong with it stands on its line."""
        try:
            return super().construct_object(node, deep)
        except yaml.YAMLError:
            raise
        except Exception:  # whatever the conversion of a text makes of this one
            shown = f" '{node.value[:40]}'" if isinstance(node.value, str) else ""
            kind = str(node.tag).rpartition(":")[2]
            raise yaml.constructor.ConstructorError(None, None, f"{shown} is no {kind}", node.start_mark) from None


def _one_line(error: yaml.MarkedYAMLError) -> str:
    problem = " ".join(str(error.problem or error.context or "is not valid YAML").split())
    if "could not determine a constructor for the tag" in problem:
        tag = problem.split("'")[1] if "'" in problem else "?"
        return f"the tag '{tag}' is refused: a configuration builds no objects; write plain values"
    return problem if problem.startswith("is nested") else f"is not valid YAML: {problem}"


class _Lines:
    """Finds the line of every key and item, and refuses what grows or says one thing twice."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._lines: dict[Place, int] = {}
        self._seen = 0

    def of(self, root: yaml.Node) -> dict[Place, int]:
        self._lines[()] = root.start_mark.line + 1
        waiting: list[tuple[Place, yaml.Node]] = [((), root)]
        while waiting:
            path, node = waiting.pop()
            if len(path) > _DEEPEST:
                raise self._error(node, f"is nested more than {_DEEPEST} deep")
            if isinstance(node, yaml.MappingNode):
                waiting.extend(self._keys(path, node))
            elif isinstance(node, yaml.SequenceNode):
                for index, item in enumerate(node.value):
                    self._count(item)
                    self._lines[(*path, index)] = item.start_mark.line + 1
                    waiting.append(((*path, index), item))
        return self._lines

    def _keys(self, path: Place, node: yaml.MappingNode, merged: int = 0) -> list[tuple[Place, yaml.Node]]:
        if merged > _DEEPEST:
            raise self._error(node, f"is merged more than {_DEEPEST} deep")
        inside: list[tuple[Place, yaml.Node]] = []
        seen: dict[str, int] = {}
        for key, value in node.value:
            self._count(key)
            line = key.start_mark.line + 1
            if key.tag == _MERGE:
                sources = value.value if isinstance(value, yaml.SequenceNode) else [value]
                for source in sources:
                    if isinstance(source, yaml.MappingNode):
                        inside.extend(self._keys(path, source, merged + 1))
                continue
            if not isinstance(key, yaml.ScalarNode) or key.tag not in _TEXTS:
                shown = f"'{key.value}'" if isinstance(key, yaml.ScalarNode) else "of several values"
                raise self._error(
                    key, f"the key {shown} is no text; a key is a name, in quotes if it looks like a number"
                )
            name = str(key.value)
            if name in seen:
                raise self._error(key, f"key '{name}' stands twice; it is already on line {seen[name]}")
            seen[name] = line
            self._lines[(*path, name)] = line
            inside.append(((*path, name), value))
        return inside

    def _count(self, node: yaml.Node) -> None:
        self._seen += 1
        if self._seen > _MOST_NODES:
            raise self._error(node, f"has more than {_MOST_NODES} entries after its anchors are followed")

    def _error(self, node: yaml.Node, message: str) -> InputError:
        return InputError(f"{self._file}:{node.start_mark.line + 1}: {message}")
