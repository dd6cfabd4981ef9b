"""What can go wrong in a way the user can mend: always one clear line, never a traceback."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any

from rl_tui.common.limits import MOST_FAULTS


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
    """A scenario file with faults: the first 100 of them, in the order of the file.

    ``tables`` is what the file says, as far as it could be read, and ``text`` the file as it was read.
    """

    def __init__(
        self, faults: Iterable[Fault], tables: Mapping[str, Any] | None = None, text: str = ""
    ) -> None:
        self.faults = first_of(faults)
        self.tables: Mapping[str, Any] = tables or {}
        self.text = text
        super().__init__("\n".join(str(fault) for fault in self.faults))


def first_of(faults: Iterable[Fault]) -> tuple[Fault, ...]:
    """Return the first 100 of ``faults``; where there are more, the last one says so."""
    reported = tuple(islice(faults, MOST_FAULTS + 1))
    if len(reported) <= MOST_FAULTS:
        return reported
    more = Fault(reported[0].file, "", f"more than {MOST_FAULTS} faults", "those above mended first")
    return (*reported[:MOST_FAULTS], more)
