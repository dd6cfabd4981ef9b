"""The world editor, with applied and pending strokes."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.solve import states_without_end
from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding
from rl_tui.runs.answers.turned import TurnedStates
from rl_tui.runs.edited_world import Drawn, EditedWorld, NextWorld, edited_draft, next_world
from rl_tui.runs.exact_answers import LIVE_STATES, Answer
from rl_tui.runs.large_worlds import takes_long
from rl_tui.runs.recipe import EditWorld, Recipe, RedoEdit, UndoEdit, WorldChange
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.runs.run import Run


# The next world of a run, built in a thread of its own


class Rebuild:
    """Builds one world at a time, so that at most one further world is in memory.

    An unneeded world is built to the end and dropped; then the next one begins.
    """

    def __init__(self) -> None:
        self._work: _Work | None = None

    def of(self, before: EditedWorld, change: WorldChange, recipe: Recipe) -> NextWorld | None:
        """Return the result of `change` in `before` once, or None while it is built.

        Starts the build if possible. Raises the exception of a failed build.
        """
        work = self._work
        if work is None or (work.is_over and not work.is_of(before, change)):
            self._work = work = _Work(before, change, recipe)
        if not work.is_over or not work.is_of(before, change):
            return None
        self._work = None
        return work.result()

    def give_up(self) -> None:
        """Drop the world that is being built."""
        if self._work is not None and self._work.give_up():
            self._work = None


class _Work:
    def __init__(self, before: EditedWorld, change: WorldChange, recipe: Recipe) -> None:
        self._before, self._change, self._recipe = before, change, recipe
        self._lock = threading.Lock()
        self._is_wanted = True
        self._outcome: NextWorld | BaseException | None = None
        self.is_over = False
        """True once it is built or has failed."""
        threading.Thread(target=self._build, name="world", daemon=True).start()

    def is_of(self, before: EditedWorld, change: WorldChange) -> bool:
        return self._is_wanted and self._before is before and self._change == change

    def result(self) -> NextWorld:
        if isinstance(self._outcome, NextWorld):
            return self._outcome
        assert self._outcome is not None
        raise self._outcome

    def give_up(self) -> bool:
        with self._lock:
            self._is_wanted, self._outcome = False, None
            return self.is_over

    def _build(self) -> None:
        try:
            outcome: NextWorld | BaseException = next_world(self._before, self._change, self._recipe)
        except BaseException as fault:
            outcome = fault
        with self._lock:
            self._outcome = outcome if self._is_wanted else None
            self.is_over = True


IN_LESSON: Final = "the world of a lesson cannot be edited; open a scenario on the start screen"


@dataclass(frozen=True, slots=True, eq=False)
class EditorView:
    """The draft in the editor, and the last stroke's result."""

    draft: Draft | None = None
    """The draft, valid or not, or None if the editor is closed or the world cannot be edited."""
    base: Draft | None = None
    """Draft of the current world; differs from `draft` while strokes are pending."""
    rebuilding: bool = False
    """True while the edited world is being built, and learning waits."""
    refused: str = ""
    """Reason why this world cannot be edited, else empty."""
    unfinished: tuple[Finding, ...] = ()
    """Errors that prevent the draft from becoming the current world, empty if it is valid."""
    can_undo: bool = False
    """True if a stroke can be undone."""
    can_redo: bool = False
    """True if a stroke can be redone."""
    turned: frozenset[int] = frozenset()
    """States whose optimal actions changed with the last stroke, as far as known, empty while answers are
    hidden.
    """
    endless: frozenset[int] = frozenset()
    """States from which no terminal state can be reached, empty in a very large world, or if a time limit
    ends every episode.
    """


class _Ahead(NamedTuple):
    change: WorldChange
    drawn: Drawn


class _Unfinished(NamedTuple):
    base: Draft
    strokes: tuple[tuple[Edit, ...], ...]
    draft: Draft


class WorldEditor:
    """The strokes in the world of one run.

    Pending strokes have no valid result, or worlds that take long to build. All are dropped when the run
    changes worlds.
    """

    def __init__(self) -> None:
        self.is_open = False
        """True if the editor is open."""
        self._base: EditedWorld | None = None
        self._ahead: list[_Ahead] = []
        self._rebuild = Rebuild()
        self._waiting: list[tuple[Edit, ...]] = []
        self._unfinished: _Unfinished | None = None
        self._dropped: list[tuple[Edit, ...]] = []
        self._endless: tuple[TabularMDP | None, frozenset[int]] = (None, frozenset())
        self._turned = TurnedStates()

    def draw(self, run: Run, edits: Sequence[Edit]) -> EditWorld | None:
        """Return the change by all pending strokes, if valid. Raises UserError for an impossible stroke."""
        self._come_to(run)
        stroke = tuple(edits)
        together = (*(edit for each in self._waiting for edit in each), *stroke)
        draft = edited_draft(self._with_waiting(self._drawn(run).draft), stroke)
        self._dropped.clear()
        if draft.findings:
            self._waiting.append(stroke)
            return None
        return EditWorld(together)  # if the run refuses it, the other strokes remain pending

    def undo(self, run: Run) -> WorldChange | None:
        """Drop the last pending stroke, or return the last change's undo."""
        self._come_to(run)
        if self._waiting:
            self._dropped.append(self._waiting.pop())
            return None
        last = self._ahead[-1].change if self._ahead else None
        if last is None or isinstance(last, UndoEdit):
            return UndoEdit()
        self._ahead.pop()
        if isinstance(last, EditWorld):
            self._dropped.append(last.edits)
        return None

    def redo(self, run: Run) -> WorldChange | None:
        """Return the redo of the last undone stroke, unless pending."""
        self._come_to(run)
        if self._dropped:
            stroke, rest = self._dropped.pop(), list(self._dropped)
            change = self.draw(run, stroke)
            self._dropped = rest
            return change
        if not self._waiting and self._ahead and isinstance(self._ahead[-1].change, UndoEdit):
            self._ahead.pop()
            return None
        return RedoEdit()

    def puts_off(self, run: Run, change: WorldChange) -> bool:
        """Return True if a drawn `change` waits for its world. Raises UserError if impossible."""
        drawn = self._drawn(run).after(change)
        if not self._ahead and not takes_long(drawn.draft, run.world):
            return False
        self._ahead.append(_Ahead(change, drawn))
        self._waiting.clear()
        if isinstance(change, UndoEdit):
            self._dropped.clear()  # an earlier undone stroke is no longer next
        return True

    @property
    def is_ahead(self) -> bool:
        """True if changes wait."""
        return bool(self._ahead)

    def to_come(self, run: Run) -> tuple[WorldChange, ...]:
        """Return the waiting changes of `run`."""
        return () if run.stop_reason else tuple(each.change for each in self._ahead)

    def next_change(self, run: Run) -> WorldChange | None:
        """Return the next change with a ready world. Raises a failed build's exception."""
        change = self._ahead[0].change
        run.ready = self._rebuild.of(run.edited, change, run.recipe)
        return None if run.ready is None else change

    def take_in(self, run: Run) -> None:
        """Record that `run` has made the next change."""
        del self._ahead[0]
        self._base = run.edited

    def forget(self) -> None:
        """Drop everything that is pending."""
        self._ahead.clear()
        self._waiting.clear()
        self._dropped.clear()
        self._rebuild.give_up()

    def view(self, run: Run, answer: Answer, *, is_hidden: bool) -> EditorView:
        """Return the state of the editor. `is_hidden` hides results."""
        turned = self._turned.of(run, None if run.learner.drifted else answer.solution)
        self._come_to(run)
        if not self.is_open:
            return EditorView(rebuilding=bool(self._ahead))
        try:
            base = run.edited.draft_in(run.recipe)
            drawn = self._drawn(run)
        except UserError as reason:
            return EditorView(refused=str(reason))
        waits, draft = bool(self._waiting), self._with_waiting(drawn.draft)
        return EditorView(
            draft=draft,
            base=base,
            rebuilding=bool(self._ahead),
            unfinished=draft.findings if waits else (),
            can_undo=waits or drawn.done is not None,
            can_redo=bool(self._dropped) or (not waits and drawn.undone is not None),
            turned=frozenset() if is_hidden else turned,
            endless=self._endless_in(run.edited.world.mdp),
        )

    def _endless_in(self, mdp: TabularMDP | None) -> frozenset[int]:
        if mdp is None or mdp.states > LIVE_STATES:
            return frozenset()
        if self._endless[0] is not mdp:
            self._endless = mdp, frozenset(np.flatnonzero(states_without_end(mdp)).tolist())
        return self._endless[1]

    def _drawn(self, run: Run) -> Drawn:
        return self._ahead[-1].drawn if self._ahead else run.edited.drawn_in(run.recipe)

    def _with_waiting(self, draft: Draft) -> Draft:
        strokes = tuple(self._waiting)
        if not strokes:
            return draft
        known = self._unfinished
        if known is None or known.base is not draft or known.strokes != strokes:
            drawn = edited_draft(draft, [edit for each in strokes for edit in each])
            known = self._unfinished = _Unfinished(draft, strokes, drawn)
        return known.draft

    def _come_to(self, run: Run) -> None:
        if self._base is not run.edited:
            self._base = run.edited
            self.forget()
