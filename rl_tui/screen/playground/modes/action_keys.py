"""The keys of a state's actions."""

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
_SHORTENED: Final = (LONGEST_NAME, 8, 5)  # cells of the name of an action
_STRAIGHT: Final = ((-1, 0), (1, 0), (0, -1), (0, 1))


def acts_in(snapshot: Snapshot) -> int:
    """Return the next action's state."""
    return snapshot.counters.state if snapshot.counters.step_from is None else snapshot.counters.step_from


def legal_actions(world: World, state: int) -> tuple[int, ...]:
    """Return the available actions in screen order."""
    pairs = shown_pairs(world, world.space.pairs_of(state))
    return tuple(int(world.space.pair_action[pair]) for pair in pairs)


def digit_keys(world: World, state: int) -> dict[str, int]:
    """Return each digit's action, by name if all names are digits."""
    names, legal = world.space.action_names, legal_actions(world, state)
    if all(name in DIGITS for name in names) and len(set(names)) == len(names):
        return {names[action]: action for action in legal}
    return dict(zip(DIGITS, legal, strict=False))


def action_towards(world: World, state: int, step: tuple[int, int]) -> int | None:
    """Return the action of ``step`` (rows down, columns right)."""
    drawing = world.drawing
    if not isinstance(drawing, Grid):
        return None
    return next(
        (action for action in legal_actions(world, state) if drawing.directions[action] == step), None
    )


def has_directions(world: World) -> bool:
    """Return whether some action is a step."""
    drawing = world.drawing
    return isinstance(drawing, Grid) and any(step in _STRAIGHT for step in drawing.directions)


def digits_in_words(world: World, state: int) -> str:
    """Write the actions' digits: ``1…4``, ``1 or 2``, or empty."""
    keys = list(digit_keys(world, state))
    return f"{keys[0]}…{keys[-1]}" if len(keys) > 2 else " or ".join(keys)


def acting_keys(world: World, state: int) -> str:
    """Write ``arrows or 1…4``, ``1 or 2``."""
    digits = digits_in_words(world, state)
    return f"arrows or {digits}" if has_directions(world) else digits


def actions_in_a_line(world: World, state: int, glyphs: Glyphs) -> tuple[str, ...]:
    """List the available actions with their digits."""
    names = {key: action_name(world, each, glyphs) for key, each in digit_keys(world, state).items()}
    if all(key == name for key, name in names.items()):
        return ()
    in_full = "  ".join(f"{key} {name}" for key, name in names.items())
    return (in_full, *(_close_together(names, longest, glyphs) for longest in _SHORTENED))


def _close_together(names: Mapping[str, str], longest: int, glyphs: Glyphs) -> str:
    return " ".join(
        f"{key}{name}"
        if len(name) == 1 or name in glyphs.diagonals
        else f"{key} {shortened(name, longest, glyphs.ellipsis)}"
        for key, name in names.items()
    )
