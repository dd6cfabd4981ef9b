"""What the screen shows about a watched program, besides its steps and its table."""

from __future__ import annotations

from dataclasses import dataclass, field

from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.watched.program_log import FoundTable, OutputLine, ProgramError


@dataclass(frozen=True, slots=True, eq=False)
class ProgramView:
    """A watched program at one moment. The past can be viewed, but not changed."""

    title: str
    """Name of the file, and of the class for an agent."""
    environment: str
    """Id of the shown environment."""
    table: FoundTable | None = None
    """The table that was found."""
    looked_for: tuple[str, ...] = ()
    """If no table was found: the kinds of tables that were searched for, one per line."""
    verdict: ProgramVerdict = field(default_factory=ProgramVerdict)
    """The update rule and the findings so far."""
    output: tuple[OutputLine, ...] = ()
    """Last lines of output, oldest first."""
    notes: tuple[str, ...] = ()
    """Workarounds that were necessary to run it."""
    error: ProgramError | None = None
    """The exception that it raised, if any."""
    ended: bool = False
    """True if it has ended."""
    refused: str = ""
    """Reason why it cannot be watched, else ""."""
    reloaded: str = ""
    """After the file was saved: a sentence that compares the new run with the old one, usually empty."""
    source: tuple[str, ...] = field(default=())
    """Lines of the file as it was read."""
    path: str = ""
    """Path of the file."""
    first_step: int = 0
    """First step that can still be shown."""
    gamma: float | None = None
    """γ of the exact answers."""
    gamma_source: str = ""
    """Source of this γ: "found" (the update), "declared" (a number in the code), "usual" (neither)."""
    stands_at: int | None = None
    """Line of the code at which it has been for a second or longer without a step."""
    is_agent: bool = False
    """True for an agent without a loop, in one of our scenarios."""
