"""What a person can do in place of the agent, and with which keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.action_order import shown_pairs
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.names import LONGEST_NAME, action_name, state_name
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms, Grid

DIGITS: Final = "1234567890"
MANUAL_TITLE: Final = "You are the agent"
_HAND_BACK: Final = " · y: hand back"
_SHORTENED: Final = (LONGEST_NAME, 8, 5, 3)  # the cells that the name of an action gets
_STRAIGHT: Final = ((-1, 0), (1, 0), (0, -1), (0, 1))


def legal_actions(snapshot: Snapshot) -> tuple[int, ...]:
    """Return the actions that may be taken next, by their numbers, in the order in which they are shown."""
    world, space = snapshot.world, snapshot.world.space
    pairs = shown_pairs(world, space.pairs_of(_acts_in(snapshot)))
    return tuple(int(space.pair_action[pair]) for pair in pairs)


def _acts_in(snapshot: Snapshot) -> int:
    return snapshot.counters.state if snapshot.counters.step_from is None else snapshot.counters.step_from


def title(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return what a panel is called while a person acts in it, the longest form first.

    After an episode it tells where the next one starts: the agent is still seen where the last one ended.
    """
    state = _acts_in(snapshot)
    if isinstance(snapshot.world.drawing, Arms) or state == snapshot.counters.state:
        return (MANUAL_TITLE,)
    start = f"starts at {state_name(snapshot.world, state, glyphs)}"
    return f"{MANUAL_TITLE} · {start}", f"You act · {start}", MANUAL_TITLE


def digit_keys(snapshot: Snapshot) -> dict[str, int]:
    """Return the legal action behind each digit: the first to the tenth, or the one that is called so."""
    names, legal = snapshot.world.space.action_names, legal_actions(snapshot)
    if all(name in DIGITS for name in names) and len(set(names)) == len(names):
        return {names[action]: action for action in legal}
    return dict(zip(DIGITS, legal, strict=False))


def action_towards(snapshot: Snapshot, step: tuple[int, int]) -> int | None:
    """Return the legal action that means ``step`` (rows down, columns right), None if there is none."""
    drawing = snapshot.world.drawing
    if not isinstance(drawing, Grid):
        return None
    return next((action for action in legal_actions(snapshot) if drawing.directions[action] == step), None)


def has_directions(snapshot: Snapshot) -> bool:
    """Return whether some action is a step up, down, left or right."""
    drawing = snapshot.world.drawing
    return isinstance(drawing, Grid) and any(step in _STRAIGHT for step in drawing.directions)


def acting_keys(snapshot: Snapshot) -> str:
    """Return which keys act: ``arrows or 1…4``, ``1 or 2``."""
    keys = list(digit_keys(snapshot))
    digits = f"{keys[0]}…{keys[-1]}" if len(keys) > 2 else " or ".join(keys)
    return f"arrows or {digits}" if has_directions(snapshot) else digits


def prompts(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the legal actions with their digits, and how to hand back, the longest form first."""
    names = {key: action_name(snapshot.world, each, glyphs) for key, each in digit_keys(snapshot).items()}
    keys = acting_keys(snapshot)
    brief = (f"{keys}: act{_HAND_BACK}", f"{keys}: act", "y: hand back")
    if all(key == name for key, name in names.items()):
        return brief
    in_full = "  ".join(f"{key} {name}" for key, name in names.items())
    close = [_close_together(names, longest, glyphs) for longest in _SHORTENED]
    return (in_full + _HAND_BACK, close[0] + _HAND_BACK, in_full, *close, *brief)


def _close_together(names: Mapping[str, str], longest: int, glyphs: Glyphs) -> str:
    """Return ``1↓ 2↑ 3 pickup``, the names in ``longest`` cells."""
    return " ".join(
        f"{key}{name}" if len(name) == 1 else f"{key} {shortened(name, longest, glyphs.ellipsis)}"
        for key, name in names.items()
    )
