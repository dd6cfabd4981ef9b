"""Which keys mean which actions of a state, and how that is told."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.names import LONGEST_NAME, action_name
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.world import World

DIGITS: Final = "1234567890"
_SHORTENED: Final = (LONGEST_NAME, 8, 5, 3)  # the cells that the name of an action gets
_STRAIGHT: Final = ((-1, 0), (1, 0), (0, -1), (0, 1))


def acts_in(snapshot: Snapshot) -> int:
    """Return the state in which the next action is taken: after an episode where the next one starts."""
    return snapshot.counters.state if snapshot.counters.step_from is None else snapshot.counters.step_from


def legal_actions(world: World, state: int) -> tuple[int, ...]:
    """Return the actions of ``state``, by their numbers, in the order in which they are shown."""
    pairs = shown_pairs(world, world.space.pairs_of(state))
    return tuple(int(world.space.pair_action[pair]) for pair in pairs)


def digit_keys(world: World, state: int) -> dict[str, int]:
    """Return the legal action behind each digit: the first to the tenth, or the one that is called so."""
    names, legal = world.space.action_names, legal_actions(world, state)
    if all(name in DIGITS for name in names) and len(set(names)) == len(names):
        return {names[action]: action for action in legal}
    return dict(zip(DIGITS, legal, strict=False))


def action_towards(world: World, state: int, step: tuple[int, int]) -> int | None:
    """Return the legal action that means ``step`` (rows down, columns right), None if there is none."""
    drawing = world.drawing
    if not isinstance(drawing, Grid):
        return None
    return next(
        (action for action in legal_actions(world, state) if drawing.directions[action] == step), None
    )


def has_directions(world: World) -> bool:
    """Return whether some action is a step up, down, left or right."""
    drawing = world.drawing
    return isinstance(drawing, Grid) and any(step in _STRAIGHT for step in drawing.directions)


def digits_in_words(world: World, state: int) -> str:
    """Return which digits are actions of ``state``: ``1…4``, ``1 or 2``; empty where none is."""
    keys = list(digit_keys(world, state))
    return f"{keys[0]}…{keys[-1]}" if len(keys) > 2 else " or ".join(keys)


def acting_keys(world: World, state: int) -> str:
    """Return which keys act where arrows do: ``arrows or 1…4``, ``1 or 2``."""
    digits = digits_in_words(world, state)
    return f"arrows or {digits}" if has_directions(world) else digits


def actions_in_a_line(world: World, state: int, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the legal actions with their digits, the longest form first; nothing where they say the same."""
    names = {key: action_name(world, each, glyphs) for key, each in digit_keys(world, state).items()}
    if all(key == name for key, name in names.items()):
        return ()
    in_full = "  ".join(f"{key} {name}" for key, name in names.items())
    return (in_full, *(_close_together(names, longest, glyphs) for longest in _SHORTENED))


def _close_together(names: Mapping[str, str], longest: int, glyphs: Glyphs) -> str:
    """Return ``1↓ 2↑ 3 pickup``, the names in ``longest`` cells."""
    return " ".join(
        f"{key}{name}"
        if len(name) == 1 or name in glyphs.diagonals
        else f"{key} {shortened(name, longest, glyphs.ellipsis)}"
        for key, name in names.items()
    )
