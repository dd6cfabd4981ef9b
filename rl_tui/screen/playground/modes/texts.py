"""Texts of the screen while a person edits the world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.common.findings import place
from rl_tui.common.limits import LARGEST_NUMBER
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot

END: Final = "esc: end"
_MISSING: Final = "nothing"  # "found" in findings about missing parts


def title(snapshot: Snapshot) -> tuple[str, ...]:
    """Return the title of the world during editing, longest form first."""
    editor = snapshot.editor
    if editor.unfinished:
        first = editor.unfinished[0]
        found = f"no {first.location[-1]}" if first.found == _MISSING else first.found
        why = f"{found}, but {first.expected} is needed"
        return (
            f"Not a world yet: {why} · the agent learns on in the previous world",
            f"Not a world yet: {why}",
            f"Not yet: {found}",
            f"unfinished: {place(first.location)}",
        )
    notes = []
    if editor.turned:
        notes.append(f"optimal action changed in {counted(len(editor.turned), 'state')}")
    if editor.endless:
        notes.append(f"no path to an end from {counted(len(editor.endless), 'state')}")
    together = " · ".join(notes)
    if not together:
        return "You draw the world", "You draw"
    return f"You draw the world · {together}", f"You draw · {together}", together, *notes, "You draw"


def prompts(snapshot: Snapshot, about: Sequence[str]) -> tuple[str, ...]:
    """Return the texts below the picture: ``about`` the cursor, and how to leave."""
    undo = " · z: undo" if snapshot.editor.can_undo else ""
    return (*(f"{each}{undo} · {END}" for each in about), *(f"{each} · {END}" for each in about), *about, END)


def number_text(value: float, digits: int = 6) -> str:
    """Return a number with the minus sign of the screen."""
    return f"{value:.{digits}g}".replace("-", "−")


def number_in(text: str) -> float:
    """Return the typed number.

    Raises:
        ValueError: It is not a number, or too large.
    """
    try:
        number = float(text.replace("−", "-"))
    except ValueError:
        raise ValueError("expected a number, such as -1 or 0.5") from None
    if not abs(number) <= LARGEST_NUMBER:
        raise ValueError(f"expected a number from {-LARGEST_NUMBER:g} to {LARGEST_NUMBER:g}")
    return number
