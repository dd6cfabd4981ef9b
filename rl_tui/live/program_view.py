"""A watched program on screen, besides steps and table."""

from __future__ import annotations

from dataclasses import dataclass, field

from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.watched.notebook import Notebook
from rl_tui.programs.watched.program_log import FoundTable, OutputLine, ProgramError


@dataclass(frozen=True, slots=True, eq=False)
class ProgramView:
    """A watched program at one moment."""

    title: str
    """Name of the file, and of the class for an agent."""
    environment: str
    table: FoundTable | None = None
    table_from: int = 0
    """Step at which the table was found. It is 0 if that step is in the past."""
    wanted: str = ""
    """Name of the table that the user wants, if any."""
    looked_for: tuple[str, ...] = ()
    """If no table was found: the kinds of tables that were searched for, one per line."""
    verdict: ProgramVerdict = field(default_factory=ProgramVerdict)
    output: tuple[OutputLine, ...] = ()
    """Last lines of output, oldest first."""
    notes: tuple[str, ...] = ()
    """Workarounds that were necessary to run it."""
    error: ProgramError | None = None
    ended: bool = False
    refused: str = ""
    reloaded: str = ""
    """After the file was saved: a sentence that compares the new run with the old one, usually empty."""
    source: tuple[str, ...] = field(default=())
    """Lines of the file as it was read."""
    notebook: Notebook | None = None
    """The notebook that was read, or None for a script."""
    path: str = ""
    gamma: float | None = None
    """γ of the exact answers, or None if the world has no exact answers."""
    gamma_source: str = ""
    """Source of this γ: "found" (the update), "declared" (a number in the code), "usual" (neither)."""
    stands_at: str | None = None
    """The place in the code where it has been for a second or longer without a step: "line 12"."""
