"""What the screen says while a person draws the world, and how what is typed is read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.common.findings import place
from rl_tui.common.limits import LARGEST_NUMBER
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot

END: Final = "esc: end"
_MISSING: Final = "nothing"  # is found where the world needs what is not there


def title(snapshot: Snapshot) -> tuple[str, ...]:
    """Return what the world is called while it is drawn, the longest form first."""
    editor = snapshot.editor
    if editor.unfinished:
        first = editor.unfinished[0]
        found = f"no {first.location[-1]}" if first.found == _MISSING else first.found
        why = f"{found}, but {first.expected} is needed"
        return (
            f"Not a world yet: {why} · learning goes on in the one before",
            f"Not a world yet: {why}",
            f"Not yet: {found}",
            f"unfinished: {place(first.location)}",
        )
    notes = []
    if editor.turned:
        notes.append(f"optimal action changed in {counted(len(editor.turned), 'state')}")
    if editor.endless:
        notes.append(f"no end from {counted(len(editor.endless), 'state')}")
    together = " · ".join(notes)
    if not together:
        return "You draw the world", "You draw"
    return f"You draw the world · {together}", f"You draw · {together}", together, *notes, "You draw"


def prompts(snapshot: Snapshot, about: Sequence[str]) -> tuple[str, ...]:
    """Return what stands below the picture: what is ``about`` the cursor, and how to leave."""
    undo = " · z: undo" if snapshot.editor.can_undo else ""
    return (*(f"{each}{undo} · {END}" for each in about), *(f"{each} · {END}" for each in about), *about, END)


def number_text(value: float, digits: int = 6) -> str:
    """Return a number as the screen says it, with its minus sign."""
    return f"{value:.{digits}g}".replace("-", "−")


def number_in(text: str) -> float:
    """Return the number that was typed. Raises ValueError."""
    try:
        number = float(text.replace("−", "-"))
    except ValueError:
        raise ValueError("expected a number, such as -1 or 0.5") from None
    if not abs(number) <= LARGEST_NUMBER:
        raise ValueError(f"expected a number from {-LARGEST_NUMBER:g} to {LARGEST_NUMBER:g}")
    return number
