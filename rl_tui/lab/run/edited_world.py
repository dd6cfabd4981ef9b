"""The world of a run as it is in force: what it was made from, and what was edited on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.lab.run.recipe import EditWorld, Recipe, RedoEdit, UndoEdit, WorldChange
from rl_tui.worlds.editing.carried import Carried, carried
from rl_tui.worlds.editing.draft import Draft
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.world import World


class Drafts(NamedTuple):
    """Drafts that can be come back to, the next one first; None for the end of them."""

    draft: Draft
    further: Drafts | None


class Drawn(NamedTuple):
    """What is drawn of a world, be it built or not, and what was drawn before it."""

    draft: Draft
    undone: Drafts | None = None
    """What :class:`RedoEdit` comes back to."""
    done: Drafts | None = None
    """What :class:`UndoEdit` comes back to."""

    def after(self, change: WorldChange) -> Drawn:
        """Return what is drawn after ``change``. Raises UserError where it cannot be done."""
        match change:
            case EditWorld(edits):
                return Drawn(edited_draft(self.draft, edits), done=Drafts(self.draft, self.done))
            case UndoEdit():
                if self.done is None:
                    raise UserError("there is no edit of the world to undo")
                return Drawn(self.done.draft, Drafts(self.draft, self.undone), self.done.further)
            case RedoEdit():
                if self.undone is None:
                    raise UserError("there is no edit of the world to redo")
                return Drawn(self.undone.draft, self.undone.further, Drafts(self.draft, self.done))


@dataclass(frozen=True, slots=True, eq=False)
class EditedWorld:
    """A world, and what edits have made of it; it never changes, and checkpoints share it."""

    world: World
    """The world in force."""
    draft: Draft | None = None
    """The draft it was built from; None while nothing was edited."""
    undone: Drafts | None = None
    """What :class:`RedoEdit` comes back to."""
    done: Drafts | None = None
    """What :class:`UndoEdit` comes back to."""
    _first: Draft | None = field(default=None, init=False)
    """The draft of the scenario, once somebody has asked for it."""

    def draft_in(self, recipe: Recipe) -> Draft:
        """Return its draft, the first one where nothing was edited. Raises UserError where there is none."""
        if self.draft is not None:
            return self.draft
        if self._first is None:
            object.__setattr__(self, "_first", first_draft(recipe.scenario, recipe.seed))
        assert self._first is not None
        return self._first

    def drawn_in(self, recipe: Recipe) -> Drawn:
        """Return what is drawn of it in a run of ``recipe``. Raises UserError as :meth:`draft_in` does."""
        return Drawn(self.draft_in(recipe), self.undone, self.done)

    def after(self, change: WorldChange, recipe: Recipe) -> EditedWorld:
        """Return what comes of ``change`` in a run of ``recipe``.

        Raises UserError where it cannot be done, or does not come to a valid MDP.
        """
        drawn = self.drawn_in(recipe).after(change)
        return EditedWorld(drawn.draft.build(), *drawn)

    def carried_from(self, before: EditedWorld, recipe: Recipe) -> Carried:
        """Return which states and pairs there were in ``before``, of the same run of ``recipe``."""
        return carried((before.draft_in(recipe), before.world), (self.draft_in(recipe), self.world))


class NextWorld(NamedTuple):
    """What ``change`` makes of the world ``before``, and what of that there is in it."""

    before: EditedWorld
    change: WorldChange
    edited: EditedWorld
    carried: Carried


def next_world(before: EditedWorld, change: WorldChange, recipe: Recipe) -> NextWorld:
    """Return what ``change`` makes of the world ``before`` in a run of ``recipe``.

    Raises UserError where it cannot be done, or does not come to a valid MDP.
    """
    edited = before.after(change, recipe)
    return NextWorld(before, change, edited, edited.carried_from(before, recipe))


def edited_draft(draft: Draft, edits: Sequence[Edit]) -> Draft:
    """Return ``draft`` after ``edits``, valid or not. Raises UserError where one of them cannot be done."""
    for edit in edits:
        draft = draft.edited(edit)
    return draft
