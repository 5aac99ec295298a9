"""The exam of readers: an example file comes back as it was written, and what is no such file is refused."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from fricmodels.errors import InputError
from fricmodels.readers.base import Reader
from fricmodels.testing.declared import Declared
from fricmodels.testing.exam import check_registered
from fricmodels.testing.faults import Fault, SkipTest

if TYPE_CHECKING:
    import pandas as pd


class ReaderExam(Declared):
    """The exam of a reader::

        class TestMyReader(ReaderExam):
            reader = MyReader

            def write(self, table, path):
                ...  # write the table as a file of this format

    The function may also stand in the reader, ``exam = {"write": write_example}``; then it counts for
    ``fricmodels check`` as well.

    Attributes:
        reader: the class that sits the exam.
    """

    of, _may_say = "reader", ("write",)
    kind: ClassVar[str] = "reader"
    reader: ClassVar[type[Reader]]

    def write(self, table: pd.DataFrame, path: Path) -> None:
        """Write a table of numbers as a file of this format."""
        raise SkipTest("the exam does not know how to write such a file; override write(table, path)")

    def test_declaration(self) -> None:
        """Name, summary, suffixes."""
        if not getattr(self.reader, "name", "") or not self.reader.summary:
            raise Fault("name or summary is empty; say what format it reads")
        suffixes = getattr(self.reader, "suffixes", ())
        if not suffixes or any(s != s.lower() or not s.startswith(".") for s in suffixes):
            raise Fault(f"suffixes is {suffixes!r}; give those of its files in lower case with the dot: ('.log',)")

    def test_registered(self) -> None:
        """Found by the plugin manager."""
        check_registered(self.kind, self.reader)

    def test_example_comes_back(self) -> None:
        """Columns, their order and their numbers are those of the file."""
        table = example()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"example{self.reader.suffixes[0]}"
            self.write(table, path)
            found = self.reader().table(path)
        if [*found.columns] != [*table.columns]:
            raise Fault(f"the columns come back as {[*found.columns]}, the file has {[*table.columns]}")
        for name in table.columns:
            if not np.allclose(found[name].astype(float), table[name], rtol=1e-6, atol=1e-9):
                raise Fault(f"the numbers of the column '{name}' are not those of the file")

    def test_other_files_are_refused(self) -> None:
        """A file of another kind gives an InputError that names it."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"strange{self.reader.suffixes[0]}"
            path.write_bytes(bytes(range(256)) * 4)
            try:
                self.reader().table(path)
            except InputError as error:
                if path.name not in str(error):
                    raise Fault(f"the error for a strange file does not name it: {error}") from None
                return
            except Exception as error:
                raise Fault(
                    f"a strange file raises {type(error).__name__}: {error}; raise InputError(f'{{path}}: …') instead"
                ) from None
        raise Fault("a file of random bytes is read without a word; check the format and raise InputError")


def example() -> pd.DataFrame:
    """Return a small table with the columns of a recording."""
    import pandas as pd

    time = 0.01 * np.arange(50)
    return pd.DataFrame({"time_s": time, "torque_Nm": np.sin(time), "velocity_rad_s": np.cos(3 * time)})
