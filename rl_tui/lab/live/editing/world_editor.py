"""What a person draws of the world: strokes that are made at once, and those that wait for others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.agents.exact.ways_out import endless_states
from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding
from rl_tui.lab.run.edited_world import EditedWorld, edited_draft
from rl_tui.lab.run.exact_answers import LIVE_STATES
from rl_tui.lab.run.recipe import EditWorld, RedoEdit, UndoEdit, WorldChange
from rl_tui.worlds.editing.draft import Draft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run


@dataclass(frozen=True, slots=True, eq=False)
class EditorView:
    """What is being drawn of the world, and what came of the last stroke."""

    draft: Draft | None = None
    """What is drawn, valid or not; None: the editor is closed, or this world cannot be edited."""
    refused: str = ""
    """Why this world cannot be edited; empty where it can, or the editor is closed."""
    unfinished: tuple[Finding, ...] = ()
    """Why the draft is no valid MDP, so that learning goes on in the world before; none where it is one."""
    can_undo: bool = False
    """Whether there is a stroke to undo."""
    can_redo: bool = False
    """Whether there is a stroke to make again."""
    turned: frozenset[int] = frozenset()
    """The states whose best actions the last stroke turned, as far as the exact answers are known."""
    endless: frozenset[int] = frozenset()
    """The states from which no end can be reached, without a time limit; none of a very large one."""


class WorldEditor:
    """Strokes in the world of one run at a time.

    What is no valid MDP is not made, but waits here; it is forgotten where the run comes to another world.
    """

    def __init__(self) -> None:
        self.is_open = False
        """Whether a person draws."""
        self._base: EditedWorld | None = None
        self._waiting: list[tuple[Edit, ...]] = []
        self._dropped: list[tuple[Edit, ...]] = []
        self._endless: tuple[TabularMDP | None, frozenset[int]] = (None, frozenset())

    def draw(self, run: Run, edits: Sequence[Edit]) -> EditWorld | None:
        """Take in a stroke; return what it changes, with all that waited, or None where that has to wait.

        Raises UserError where it cannot be done.
        """
        self._come_to(run)
        stroke = tuple(edits)
        together = (*(edit for each in self._waiting for edit in each), *stroke)
        draft = edited_draft(run.edited.draft_in(run.recipe), together)
        self._dropped.clear()
        if draft.findings:
            self._waiting.append(stroke)
            return None
        return EditWorld(together)  # should the run refuse it, what waited goes on waiting

    def undo(self, run: Run) -> WorldChange | None:
        """Drop the last stroke that waits, and return None; else return what undoes the last one made."""
        self._come_to(run)
        if not self._waiting:
            return UndoEdit()
        self._dropped.append(self._waiting.pop())
        return None

    def redo(self, run: Run) -> WorldChange | None:
        """Return what makes the last stroke again that was undone; None where it waits once more."""
        self._come_to(run)
        if not self._dropped:
            return RedoEdit()
        stroke, rest = self._dropped.pop(), list(self._dropped)
        change = self.draw(run, stroke)
        self._dropped = rest
        return change

    def view(self, run: Run) -> EditorView:
        """Return what is drawn in the world of ``run``."""
        if not self.is_open:
            return EditorView()
        self._come_to(run)
        try:
            draft = run.edited.draft_in(run.recipe)
        except UserError as reason:
            return EditorView(refused=str(reason))
        waiting = [edit for each in self._waiting for edit in each]
        draft = edited_draft(draft, waiting)
        return EditorView(
            draft=draft,
            unfinished=draft.findings if waiting else (),
            can_undo=bool(waiting) or run.edited.done is not None,
            can_redo=bool(self._dropped) or (not waiting and run.edited.undone is not None),
            endless=self._endless_in(run.edited.world.mdp),
        )

    def _endless_in(self, mdp: TabularMDP | None) -> frozenset[int]:
        """Return the endless states of ``mdp``, which are worked out once."""
        if mdp is None or mdp.states > LIVE_STATES:
            return frozenset()
        if self._endless[0] is not mdp:
            self._endless = mdp, frozenset(np.flatnonzero(endless_states(mdp)).tolist())
        return self._endless[1]

    def _come_to(self, run: Run) -> None:
        if self._base is not run.edited:
            self._base = run.edited
            self._waiting.clear()
            self._dropped.clear()
