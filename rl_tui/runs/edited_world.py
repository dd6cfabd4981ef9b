"""The current world of a run, with its edits."""

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
    """A linked list of drafts, next one first."""

    draft: Draft
    further: Drafts | None


class Drawn(NamedTuple):
    """A draft with the drafts for undo and redo."""

    draft: Draft
    undone: Drafts | None = None
    """Drafts for `RedoEdit`."""
    done: Drafts | None = None
    """Drafts for `UndoEdit`."""

    def after(self, change: WorldChange) -> Drawn:
        """Return the draft after `change`. Raises UserError."""
        draft, undone, done = self
        match change:
            case EditWorld(edits):
                if len(written_edits(edits)) > LONGEST_EDIT:
                    raise UserError("this edit is too large for a session file: draw it in parts")
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
    """An immutable world with its edits. The same change returns the same object while referenced."""

    world: World
    draft: Draft | None = None
    """The draft it was built from, or None before the first edit."""
    undone: Drafts | None = None
    """Drafts for `RedoEdit`."""
    done: Drafts | None = None
    """Drafts for `UndoEdit`."""
    _first: Draft | None = field(default=None, init=False, repr=False)
    """The draft of the scenario, made on first use."""
    _next: WeakValueDictionary[WorldChange, EditedWorld] = field(
        default_factory=WeakValueDictionary, init=False, repr=False
    )

    def draft_in(self, recipe: Recipe) -> Draft:
        """Return its draft. Raises UserError if the world has none."""
        if self.draft is not None:
            return self.draft
        if self._first is None:
            object.__setattr__(self, "_first", first_draft(recipe.scenario, recipe.seed))
        assert self._first is not None
        return self._first

    def drawn_in(self, recipe: Recipe) -> Drawn:
        """Return its draft with undo and redo. Raises UserError."""
        return Drawn(self.draft_in(recipe), self.undone, self.done)

    def after(self, change: WorldChange, recipe: Recipe) -> EditedWorld:
        """Apply `change`. Raises UserError if the result is not a valid MDP."""
        known = self._next.get(change)
        if known is None:
            known = self._next[change] = self._made_by(change, recipe)
        return known

    def after_all(self, changes: Iterable[WorldChange], recipe: Recipe) -> EditedWorld:
        """Apply `changes` in order. Raises UserError."""
        edited = self
        for change in changes:
            edited = edited.after(change, recipe)
        return edited

    def _made_by(self, change: WorldChange, recipe: Recipe) -> EditedWorld:
        drawn = self.drawn_in(recipe).after(change)
        return EditedWorld(drawn.draft.build(), *drawn)

    def carried_from(self, before: EditedWorld, recipe: Recipe) -> Carried:
        """Map states and pairs to those of the earlier world `before`."""
        return carried((before.draft_in(recipe), before.world), (self.draft_in(recipe), self.world))


class NextWorld(NamedTuple):
    """The result of `change`, with the map of states and pairs."""

    before: EditedWorld
    change: WorldChange
    edited: EditedWorld
    carried: Carried


def next_world(before: EditedWorld, change: WorldChange, recipe: Recipe) -> NextWorld:
    """Apply `change` to `before`. Raises UserError."""
    edited = before.after(change, recipe)
    return NextWorld(before, change, edited, edited.carried_from(before, recipe))


def drawn_recipe(recipe: Recipe, changes: Sequence[WorldChange]) -> Recipe:
    """Return `recipe` with an edited world. Raises UserError."""
    if not changes:
        return recipe
    drawn = Drawn(first_draft(recipe.scenario, recipe.seed))
    for change in changes:
        drawn = drawn.after(change)
    section, kind = drawn.draft.section, drawn.draft.kind
    return replace(recipe, scenario=replace(recipe.scenario, section=section, kind=kind))


def edited_draft(draft: Draft, edits: Sequence[Edit]) -> Draft:
    """Apply `edits` without checking the result. Raises UserError."""
    for edit in edits:
        draft = draft.edited(edit)
    return draft
