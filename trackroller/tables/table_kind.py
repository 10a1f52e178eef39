"""What a table of users holds, and the file in which it stands."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from trackroller.errors import Collector, InputError, raise_all

Row = tuple[int, list[str]]  # number and cells of a line


@dataclass(frozen=True)
class TableKind:
    """What a table of users holds.

    Parameters
    ----------
    field : str
        Key of the study or spectrum that names the file, for messages.
    row : str
        What a row describes, such as 'case'.
    units : mapping
        Units of the known columns of numbers by their names.
    words : collection of str
        Names of known columns of words.
    aliases : mapping
        Names that stand for known ones.
    optional : collection of str
        Names of columns whose cells may be empty.
    names : sequence of str
        Names of the columns of a file without a line of names; () if it needs one.
    blanks : bool
        Whether blanks may separate the cells.
    small : bool
        Whether no number reaches 1000 in the unit of its column, so that `4.472` has decimals if no
        cell decides.
    """

    field: str
    row: str
    units: Mapping[str, str]
    words: Collection[str] = ()
    aliases: Mapping[str, str] = dataclasses.field(default_factory=dict)
    optional: Collection[str] = ()
    names: Sequence[str] = ()
    blanks: bool = False
    small: bool = False

    def knows(self, name: str) -> bool:
        """Return whether a name is that of a known column."""
        return name in self.units or name in self.words or name in self.aliases


@dataclass(frozen=True)
class Source:
    """The file of a table, what it holds, and the errors of its lines and cells."""

    path: Path
    kind: TableKind
    wrong: Collector

    def refuse(
        self, number: int, name: str, value: object, allowed: str, remedy: str = "", wrong: str = ""
    ) -> None:
        """Add the error of a line."""
        error = InputError(name, value, allowed, remedy, wrong)
        self.wrong.errors.append(error.at(self.path, number))

    @contextmanager
    def in_line(self, number: int) -> Iterator[None]:
        """Name file and line in the errors of a block."""
        try:
            yield
        except InputError as error:
            raise_all(one.at(self.path, number) for one in error.errors)
