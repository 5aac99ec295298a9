"""YAML is read safely, and every error names its line."""

from __future__ import annotations

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
