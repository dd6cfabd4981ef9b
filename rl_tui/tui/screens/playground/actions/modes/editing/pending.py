"""What is drawn, strokes included that the player has not taken in yet."""

from __future__ import annotations

from collections.abc import Sequence

from rl_tui.common.errors import UserError
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.run.edited_world import edited_draft
from rl_tui.worlds.editing.draft import Draft
from rl_tui.worlds.editing.edit import Edit


class PendingStrokes:
    """Strokes that were sent: two quick keys are two steps, though no picture came between them."""

    def __init__(self) -> None:
        self._sent: list[tuple[int, tuple[Edit, ...]]] = []
        # A draft, the first stroke beyond it, how many are drawn, and what comes of them
        self._drawn: tuple[Draft, int | None, int, Draft] | None = None

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._sent)

    def note(self, number: int, edits: Sequence[Edit]) -> None:
        """Keep ``edits``, which were sent as command ``number``."""
        self._sent.append((number, tuple(edits)))

    def forget(self) -> None:
        """Wait for the next picture: what comes next undoes, or makes again, something else."""
        self._sent.clear()

    def draft(self, snapshot: Snapshot) -> Draft | None:
        """Return the draft of ``snapshot`` with all that it does not have yet; None where there is none.

        Each stroke is drawn once for a snapshot, however often this is asked for: a wheel sends hundreds.
        """
        self._sent = [each for each in self._sent if each[0] > snapshot.playback.handled]
        base = snapshot.editor.draft
        if base is None:
            return None
        first = self._sent[0][0] if self._sent else None
        if self._drawn is None or self._drawn[:2] != (base, first):
            self._drawn = base, first, 0, base
        _, _, count, draft = self._drawn
        try:
            for _, edits in self._sent[count:]:
                draft = edited_draft(draft, edits)
        except UserError:
            return base
        self._drawn = base, first, len(self._sent), draft
        return draft
