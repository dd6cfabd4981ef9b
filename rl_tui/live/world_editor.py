"""What a person draws of the world: strokes that are made at once, and those that wait for others."""

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
    """Builds one world at a time, so that no more than one is in memory beside that in force.

    One that nobody waits for any more is built to its end and dropped; the next begins then.
    """

    def __init__(self) -> None:
        self._work: _Work | None = None

    def of(self, before: EditedWorld, change: WorldChange, recipe: Recipe) -> NextWorld | None:
        """Return what ``change`` makes of ``before``, once; None while it is built. It begins where it can.

        Raises what made it fail.
        """
        work = self._work
        if work is None or (work.is_over and not work.is_of(before, change)):
            self._work = work = _Work(before, change, recipe)
        if not work.is_over or not work.is_of(before, change):
            return None
        self._work = None
        return work.result()

    def give_up(self) -> None:
        """Drop what is built, or is being built: nobody waits for it."""
        if self._work is not None and self._work.give_up():
            self._work = None


class _Work:
    """One world that is built, in a thread that does not keep the process alive."""

    def __init__(self, before: EditedWorld, change: WorldChange, recipe: Recipe) -> None:
        self._before, self._change, self._recipe = before, change, recipe
        self._lock = threading.Lock()
        self._is_wanted = True
        self._outcome: NextWorld | BaseException | None = None
        self.is_over = False
        """Whether it has been built, or has failed."""
        threading.Thread(target=self._build, name="world", daemon=True).start()

    def is_of(self, before: EditedWorld, change: WorldChange) -> bool:
        """Return whether it is what ``change`` makes of ``before``, and was not given up."""
        return self._is_wanted and self._before is before and self._change == change

    def result(self) -> NextWorld:
        """Return what was built; raises what made it fail."""
        if isinstance(self._outcome, NextWorld):
            return self._outcome
        assert self._outcome is not None
        raise self._outcome

    def give_up(self) -> bool:
        """Keep nothing of it; return whether it is over."""
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
    """What is being drawn of the world, and what came of the last stroke."""

    draft: Draft | None = None
    """What is drawn, valid or not; None: the editor is closed, or this world cannot be edited."""
    base: Draft | None = None
    """The draft of the world in force: another one than ``draft`` while what is drawn is not in force."""
    rebuilding: bool = False
    """Whether the draft is ahead of the world in force, which is being rebuilt; learning waits for it."""
    refused: str = ""
    """Why this world cannot be edited; empty where it can, or the editor is closed."""
    unfinished: tuple[Finding, ...] = ()
    """Why the draft is no valid MDP, so that learning goes on in the world before; none where it is one."""
    can_undo: bool = False
    """Whether there is a stroke to undo."""
    can_redo: bool = False
    """Whether there is a stroke to make again."""
    turned: frozenset[int] = frozenset()
    """The states whose best actions the last stroke turned, as far as the exact answers are known.

    None while these are hidden.
    """
    endless: frozenset[int] = frozenset()
    """The states from which no end can be reached, but by the time limit; none of a very large world.

    None too where a time limit is what ends every episode.
    """


class _Ahead(NamedTuple):
    """A change whose world takes long to build, and all that is drawn once it is made."""

    change: WorldChange
    drawn: Drawn


class _Unfinished(NamedTuple):
    """What ``strokes`` that wait make of the draft ``base``."""

    base: Draft
    strokes: tuple[tuple[Edit, ...], ...]
    draft: Draft


class WorldEditor:
    """Strokes in the world of one run at a time.

    What is no valid MDP is not made, but waits here, and so do changes whose worlds take long to build, in
    order; all that is forgotten where the run comes to another world.
    """

    def __init__(self) -> None:
        self.is_open = False
        """Whether a person draws."""
        self._base: EditedWorld | None = None
        self._ahead: list[_Ahead] = []
        self._rebuild = Rebuild()
        self._waiting: list[tuple[Edit, ...]] = []
        self._unfinished: _Unfinished | None = None
        self._dropped: list[tuple[Edit, ...]] = []
        self._endless: tuple[TabularMDP | None, frozenset[int]] = (None, frozenset())
        self._turned = TurnedStates()

    def draw(self, run: Run, edits: Sequence[Edit]) -> EditWorld | None:
        """Take in a stroke; return what it changes, with all that waited, or None where that has to wait.

        Raises UserError where it cannot be done.
        """
        self._come_to(run)
        stroke = tuple(edits)
        together = (*(edit for each in self._waiting for edit in each), *stroke)
        draft = edited_draft(self._with_waiting(self._drawn(run).draft), stroke)
        self._dropped.clear()
        if draft.findings:
            self._waiting.append(stroke)
            return None
        return EditWorld(together)  # should the run refuse it, what waited goes on waiting

    def undo(self, run: Run) -> WorldChange | None:
        """Drop the last stroke that waits, and return None; else return what undoes the last one made."""
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
        """Return what makes the last stroke again that was undone; None where it waits once more."""
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
        """Return whether ``change``, drawn already, waits for its world, which takes long to build.

        Raises UserError where it cannot be done.
        """
        drawn = self._drawn(run).after(change)
        if not self._ahead and not takes_long(drawn.draft, run.world):
            return False
        self._ahead.append(_Ahead(change, drawn))
        self._waiting.clear()
        if isinstance(change, UndoEdit):
            self._dropped.clear()  # what was undone before that is no longer the next to be made again
        return True

    @property
    def is_ahead(self) -> bool:
        """Whether changes wait for their worlds."""
        return bool(self._ahead)

    def to_come(self, run: Run) -> tuple[WorldChange, ...]:
        """Return the changes that wait for their worlds, as far as ``run`` will make them."""
        return () if run.stop_reason else tuple(each.change for each in self._ahead)

    def next_change(self, run: Run) -> WorldChange | None:
        """Return the next change that waits for its world, once ``run`` has that ready; None before.

        Raises what made building it fail.
        """
        change = self._ahead[0].change
        run.ready = self._rebuild.of(run.edited, change, run.recipe)
        return None if run.ready is None else change

    def take_in(self, run: Run) -> None:
        """Take in that the next change that waited was made in ``run``: all others wait on."""
        del self._ahead[0]
        self._base = run.edited

    def forget(self) -> None:
        """Forget all that waits."""
        self._ahead.clear()
        self._waiting.clear()
        self._dropped.clear()
        self._rebuild.give_up()

    def view(self, run: Run, answer: Answer, *, is_hidden: bool) -> EditorView:
        """Return what is drawn in the world of ``run``, of which ``answer`` is known, and maybe hidden."""
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
        """Return the endless states of ``mdp``, which are worked out once."""
        if mdp is None or mdp.states > LIVE_STATES:
            return frozenset()
        if self._endless[0] is not mdp:
            self._endless = mdp, frozenset(np.flatnonzero(states_without_end(mdp)).tolist())
        return self._endless[1]

    def _drawn(self, run: Run) -> Drawn:
        """Return what is drawn of the world of ``run``, but for strokes that come to no valid MDP yet."""
        return self._ahead[-1].drawn if self._ahead else run.edited.drawn_in(run.recipe)

    def _with_waiting(self, draft: Draft) -> Draft:
        """Return ``draft`` with the strokes that wait, which is worked out once and not in every frame."""
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
