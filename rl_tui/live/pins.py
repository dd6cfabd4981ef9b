"""Breakpoints and drawn policy, which follow edits of the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.live.pace.until import Breakpoints
from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.worlds.editing.carried import Carried
from rl_tui.worlds.mdp.space import FiniteSpace

if TYPE_CHECKING:
    from rl_tui.runs.edited_world import EditedWorld
    from rl_tui.runs.recipe import Recipe


class Pins(NamedTuple):
    """Breakpoints and drawn policy in one world's numbers."""

    breakpoints: Breakpoints
    """Where runs pause."""
    drawn: DrawnPolicy
    """The drawn policy."""

    def carried(self, carried: Carried, before: FiniteSpace, now: FiniteSpace) -> Pins:
        """Return the pins that the world `now` has."""
        states, pairs = self.breakpoints.states, self.breakpoints.pairs
        drawn = carried.pairs_now(self.drawn.pairs(before).values())
        choices = sorted((now.state_of(pair), int(now.pair_action[pair])) for pair in drawn)
        return Pins(
            Breakpoints(carried.states_now(states), carried.pairs_now(pairs)), DrawnPolicy(tuple(choices))
        )


NO_PINS: Final = Pins(Breakpoints(), DrawnPolicy())


class NamedPins:
    """Keeps pins by name when a run changes worlds, all edits of one.

    A pin that is gone in one world returns in the next that has it, unless pins were changed in between.
    """

    def __init__(self, edited: EditedWorld, pins: Pins) -> None:
        self.edited = edited
        """The world whose numbers count."""
        self._set_in = edited
        self._set = self._shown = pins
        self._seen: tuple[EditedWorld, Pins, Pins] | None = None

    def come_to(self, edited: EditedWorld, pins: Pins, recipe: Recipe) -> Pins:
        """Change to the world `edited`, and return its pins."""
        self._shown = self.seen_from(edited, pins, recipe)
        self.edited = edited
        return self._shown

    def seen_from(self, edited: EditedWorld, pins: Pins, recipe: Recipe) -> Pins:
        """Return `pins` in the numbers of `edited`."""
        self._note(pins)
        if self._set == NO_PINS or edited is self._set_in:
            return self._set
        # a second run asks for this in every frame
        if self._seen is None or self._seen[0] is not edited or self._seen[1] is not self._set:
            carried = edited.carried_from(self._set_in, recipe)
            seen = self._set.carried(carried, self._set_in.world.space, edited.world.space)
            self._seen = edited, self._set, seen
        return self._seen[2]

    def pair_in(self, edited: EditedWorld, pair: int | None, recipe: Recipe) -> int | None:
        """Return `pair` in the numbers of `edited`, if still there."""
        if pair is None or edited is self.edited:
            return pair
        return next(iter(edited.carried_from(self.edited, recipe).pairs_now((pair,))), None)

    def _note(self, pins: Pins) -> None:
        if pins != self._shown:
            self._set_in, self._set, self._shown = self.edited, pins, pins
