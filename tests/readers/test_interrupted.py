"""An interrupt while a table is read is an interrupt, not a file that cannot be read."""

from __future__ import annotations

import io
from pathlib import Path
from typing import NoReturn

import pandas as pd
import pytest

from fricmodels.errors import InputError
from fricmodels.readers import csv, read


class Interrupted(io.StringIO):
    """A file whose reading is interrupted."""

    def read(self, _: int | None = -1) -> NoReturn:
        """Raise what a signal raises: an exception without a text."""
        raise KeyboardInterrupt


class Broken(io.StringIO):
    """A file on a disk that fails."""

    def read(self, _: int | None = -1) -> NoReturn:
        """Raise what a system raises."""
        raise OSError(5, "Input/output error")


def recorded(folder: Path) -> Path:
    """Return a small recording."""
    path = folder / "log.csv"
    path.write_text("time_s,torque_Nm,velocity_rad_s\n" + "".join(f"{k / 100},{k % 7},{k % 5}\n" for k in range(200)))
    return path


def test_an_interrupt_stays_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = recorded(tmp_path)
    assert len(read(path)) == 200
    monkeypatch.setattr(csv, "_frame", lambda *_: pd.read_csv(Interrupted("1,2\n3,4\n")))
    with pytest.raises(KeyboardInterrupt):
        read(path)


def test_a_disk_that_fails_is_no_interrupt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = recorded(tmp_path)
    monkeypatch.setattr(csv, "_frame", lambda *_: pd.read_csv(Broken("1,2\n3,4\n")))
    with pytest.raises((InputError, OSError), match="Input/output error"):
        read(path)
