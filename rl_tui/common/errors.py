"""Errors that the user can fix, printed without a traceback."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import Any, Final

from rl_tui.common.limits import MOST_FAULTS

NO_FILE: Final = "no such file"


class UserError(Exception):
    """An error that the user can fix. Its text is one line: place, problem, fix."""

    def _render_traceback_(self) -> list[str]:
        """Return what a notebook shows instead of the traceback."""
        return [f"rl_tui.Error: {self}"]


def complaint(found: str, expected: str) -> str:
    """Return the words of an error. Without `expected`, `found` is all."""
    if not expected:
        return found
    if found == "nothing":
        return f"missing; expected {expected}"
    return f"{found}; expected {expected}" if found == NO_FILE else f"found {found}; expected {expected}"


@dataclass(frozen=True, slots=True)
class Fault:
    """One error of a scenario file.

    Args:
        file: Path as the user wrote it.
        place: Such as ``mdp.transition[2].to``. Empty for the whole file.
        found: Current content.
        expected: Correct content. Empty if `found` says how to fix it.
    """

    file: str
    place: str
    found: str
    expected: str = ""

    def __str__(self) -> str:
        where = f"{self.file}: {self.place}" if self.place else self.file
        return f"{where}: {complaint(self.found, self.expected)}"


class ScenarioError(UserError):
    """A scenario file with errors: the first 100, in file order.

    `tables` holds the readable part.
    """

    def __init__(
        self, faults: Iterable[Fault], tables: Mapping[str, Any] | None = None, text: str = ""
    ) -> None:
        self.faults = first_of(faults)
        self.tables: Mapping[str, Any] = tables or {}
        self.text = text
        super().__init__("\n".join(str(fault) for fault in self.faults))


def first_of(faults: Iterable[Fault]) -> tuple[Fault, ...]:
    """Return the first 100, and a last entry if there are more."""
    reported = tuple(islice(faults, MOST_FAULTS + 1))
    if len(reported) <= MOST_FAULTS:
        return reported
    more = Fault(reported[0].file, "", f"more than {MOST_FAULTS} errors; fix these first")
    return (*reported[:MOST_FAULTS], more)
