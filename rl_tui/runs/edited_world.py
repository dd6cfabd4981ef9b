"""The world of a run as it is in force: what it was made from, and what was edited on the way."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple
from weakref import WeakValueDictionary

from rl_tui.common.errors import UserError
from rl_tui.common.limits import LONGEST_EDIT
from rl_tui.runs.recipe import EditWorld, Recipe, RedoEdit, UndoEdit, WorldChange
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.carried import Carried, carried
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.edit import Edit, written_edits
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
        draft, undone, done = self
        match change:
            case EditWorld(edits):
                if len(written_edits(edits)) > LONGEST_EDIT:
                    raise UserError(
                        "this is too much for one stroke, as sessions keep them: draw it in parts"
                    )
                return Drawn(edited_draft(draft, edits), None, Drafts(draft, done))
            case UndoEdit():
                if done is None:
                    raise UserError("there is no edit of the world to undo")
                return Drawn(done.draft, Drafts(draft, undone), done.further)
            case RedoEdit():
                if undone is None:
                    raise UserError("there is no edit of the world to redo")
                return Drawn(undone.draft, undone.further, Drafts(draft, done))


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class EditedWorld:
    """A world, and what edits have made of it; it never changes, and checkpoints share it.

    The same change comes to the same object, as long as anything holds that: a run that goes back and comes
    by again, or a run beside it, has the same world once more, and nothing is built or solved anew.
    """

    world: World
    """The world in force."""
    draft: Draft | None = None
    """The draft it was built from; None while nothing was edited."""
    undone: Drafts | None = None
    """What :class:`RedoEdit` comes back to."""
    done: Drafts | None = None
    """What :class:`UndoEdit` comes back to."""
    _first: Draft | None = field(default=None, init=False, repr=False)
    """The draft of the scenario, once somebody has asked for it."""
    _next: WeakValueDictionary[WorldChange, EditedWorld] = field(
        default_factory=WeakValueDictionary, init=False, repr=False
    )

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
        known = self._next.get(change)
        if known is None:
            known = self._next[change] = self._made_by(change, recipe)
        return known

    def after_all(self, changes: Iterable[WorldChange], recipe: Recipe) -> EditedWorld:
        """Return what comes of all ``changes``, one after the other. Raises UserError like :meth:`after`."""
        edited = self
        for change in changes:
            edited = edited.after(change, recipe)
        return edited

    def _made_by(self, change: WorldChange, recipe: Recipe) -> EditedWorld:
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


def drawn_recipe(recipe: Recipe, changes: Sequence[WorldChange]) -> Recipe:
    """Return ``recipe`` with the world that ``changes`` make of its own; itself where there are none.

    Raises UserError where they cannot be made.
    """
    if not changes:
        return recipe
    drawn = Drawn(first_draft(recipe.scenario, recipe.seed))
    for change in changes:
        drawn = drawn.after(change)
    section, kind = drawn.draft.section, drawn.draft.kind
    return replace(recipe, scenario=replace(recipe.scenario, section=section, kind=kind))


def edited_draft(draft: Draft, edits: Sequence[Edit]) -> Draft:
    """Return ``draft`` after ``edits``, valid or not. Raises UserError where one of them cannot be done."""
    for edit in edits:
        draft = draft.edited(edit)
    return draft
