"""What the screen shows of a program that is watched, beside its steps and its table."""

from __future__ import annotations

from dataclasses import dataclass, field

from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.watched.program_log import FoundTable, OutputLine, ProgramError


@dataclass(frozen=True, slots=True, eq=False)
class ProgramView:
    """A program at one moment. What is shown of the past is only shown: it cannot be changed."""

    title: str
    """Its file's name, of an agent also its class."""
    environment: str
    """The id of the environment that is shown."""
    table: FoundTable | None = None
    """The table that was found."""
    looked_for: tuple[str, ...] = ()
    """Where no table was found: what was looked for, a line each."""
    verdict: ProgramVerdict = field(default_factory=ProgramVerdict)
    """The update that it makes, and what is wrong with it, as far as it is known now."""
    output: tuple[OutputLine, ...] = ()
    """The last lines that it wrote, oldest first."""
    notes: tuple[str, ...] = ()
    """What had to be done otherwise for it to run."""
    error: ProgramError | None = None
    """What it raised, if it did."""
    ended: bool = False
    """Whether it is over."""
    refused: str = ""
    """Why it cannot be watched; empty if it can."""
    reloaded: str = ""
    """After its file was saved: what became better or worse than before, as a sentence; mostly empty."""
    source: tuple[str, ...] = field(default=())
    """The lines of its file as it was read."""
    path: str = ""
    """Its file."""
    first_step: int = 0
    """The first step that can still be shown."""
    gamma: float | None = None
    """The γ of the exact answers."""
    gamma_source: str = ""
    """Where that γ is from: "found" (the update), "declared" (a number in the code), "usual" (neither)."""
    stands_at: int | None = None
    """The line of the code where it has stood for a second or longer without a step."""
    is_agent: bool = False
    """Whether it is an agent without a loop, in one of our scenarios."""
