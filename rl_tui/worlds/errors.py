"""What can go wrong in a way the user can mend: always one clear line, never a traceback."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


class UserError(Exception):
    """Something the user can mend. Its text is one line that says what is wrong, where, and what to do."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault of a scenario file.

    ``file`` is the path as the user wrote it, ``place`` the spot in it (``mdp.transition[2].to``; empty for
    the file as a whole), ``found`` what stands there and ``expected`` what should.
    """

    file: str
    place: str
    found: str
    expected: str

    def __str__(self) -> str:
        where = f"{self.file}: {self.place}" if self.place else self.file
        return f"{where}: found {self.found}; expected {self.expected}"


class ScenarioError(UserError):
    """A scenario file with faults: all of them, in the order of the file."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))
