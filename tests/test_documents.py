"""YAML is read safely, and every error names its line."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricmodels.documents import read_yaml
from fricmodels.errors import InputError


def written(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "config.yaml"
    file.write_text(text, encoding="utf-8")
    return file


def test_lines_of_keys_and_items(tmp_path: Path) -> None:
    document = read_yaml(written(tmp_path, "a: 1\nb:\n  - x\n  - y: 2\n    z: 3\n"))
    assert document.content == {"a": 1, "b": ["x", {"y": 2, "z": 3}]}
    assert document.line(("a",)) == 1
    assert document.line(("b", 0)) == 3
    assert document.line(("b", 1, "z")) == 5
    assert document.line(("b", 1, "z", "deeper", 7)) == 5


def test_anchors_and_merge_keys(tmp_path: Path) -> None:
    document = read_yaml(written(tmp_path, "base: &base {p: 1, q: 2}\nmore:\n  <<: *base\n  q: 3\n"))
    assert document.content["more"] == {"p": 1, "q": 3}
    assert document.line(("more", "q")) == 4
    assert document.line(("more", "p")) == 1


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: 1\nb: !!python/object/apply:os.system ['true']\n", 2, "refused"),
        ("a: 1\nb: !mine {c: 1}\n", 2, "refused"),
        ("a: 1\nb: 2\na: 3\n", 3, "stands twice; it is already on line 1"),
        ("a: 1\nb: [1, 2\n", 3, "not valid YAML"),
        ("a: 1\n\tb: 2\n", 2, "not valid YAML"),
        ("a: *nowhere\n", 1, "not valid YAML"),
    ],
)
def test_errors_name_their_line(tmp_path: Path, text: str, line: int, words: str) -> None:
    file = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_yaml(file)
    message = str(caught.value)
    assert message.startswith(f"{file}:{line}: ")
    assert words in message
    assert "\n" not in message


def test_missing_and_empty(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_yaml(tmp_path / "nowhere.yaml")
    for text in ("", "# only a comment\n"):
        with pytest.raises(InputError, match="the file is empty"):
            read_yaml(written(tmp_path, text))


def test_anchors_that_explode_are_refused(tmp_path: Path) -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 9)]
    with pytest.raises(InputError, match="more than 100000 entries"):
        read_yaml(written(tmp_path, "\n".join(lines)))


def test_anchor_that_contains_itself_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nested more than"):
        read_yaml(written(tmp_path, "a: &a [*a]\n"))


@given(st.text(max_size=200))
def test_any_text_gives_content_or_one_line(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    file = tmp_path_factory.getbasetemp() / "any.yaml"
    file.write_bytes(text.encode("utf-8", errors="surrogatepass"))
    message = ""
    try:
        read_yaml(file)
    except InputError as error:
        message = str(error)
    assert len(message.splitlines()) <= 1


BOMB = "a0: &a0 {x: 1}\n" + "\n".join(f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 9)}]}}" for n in range(1, 11))
HOSTILE = {
    "merge bomb": (BOMB, "more than 100000 entries"),
    "merge of itself": ("a: 1\nb: &b {<<: *b}\n", ":2: is merged more than 50 deep"),
    "open brackets": ("a: 1\nb: " + "[" * 3000, ":2: is nested more than 50 deep"),
    "mappings in mappings": ("{a: " * 3000 + "}" * 3000, ":1: is nested more than 50 deep"),
    "indented ever more": ("\n".join(" " * depth + "a:" for depth in range(2000)), "is nested more than 50 deep"),
    "no truth value": ("a: 1\nb: !!bool maybe\n", ":2: is not valid YAML: 'maybe' is no bool"),
    "no time": ("b: !!timestamp never\n", ":1: is not valid YAML: 'never' is no timestamp"),
    "no integer": ("a: 1\nb: !!int ''\n", ":2: is not valid YAML: '' is no int"),
    "no day": ("a: 1\nb: 2020-13-45\n", ":2: is not valid YAML: '2020-13-45' is no timestamp"),
    "digits without end": ("a: 1\nb: " + "1" * 5000, ":2: is not valid YAML: '1111"),
    "key that is a number": ("a: 1\n5: 1\n", ":2: the key '5' is no text"),
    "key that is a truth value": ("a: 1\ntrue: 1\n", ":2: the key 'true' is no text"),
    "key that is a list": ("a: 1\n[1, 2]: 1\n", ":2: the key of several values is no text"),
    "megabytes": ("# " + "x" * 5_000_000, "longer than 4 MB"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_files_are_refused_at_once_with_their_line(case: str, tmp_path: Path) -> None:
    text, expected = HOSTILE[case]
    file = written(tmp_path, text)
    begin = time.monotonic()
    with pytest.raises(InputError) as refused:
        read_yaml(file)
    assert expected in str(refused.value)
    assert time.monotonic() - begin < 10


def test_what_is_no_file_is_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.yaml"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="is no file but a device or a pipe"):
        read_yaml(pipe)
