"""What the screen says while a person draws a policy."""

from __future__ import annotations

from collections.abc import Iterator

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.names import action_name
from rl_tui.tui.screens.key_line import Hints
from rl_tui.tui.screens.playground.actions.modes.action_keys import (
    actions_in_a_line,
    digits_in_words,
    has_directions,
)
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.world import World

_END = "D: end"


def title(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return what the world is called while a policy is drawn on it, the longest form first."""
    said = " · ".join(_figures(snapshot, glyphs))
    return f"You draw a policy · {said}", f"You draw · {said}", said, "You draw a policy", "You draw"


def _figures(snapshot: Snapshot, glyphs: Glyphs) -> Iterator[str]:
    world, drawn = snapshot.world, snapshot.answers.drawn
    if isinstance(world.drawing, Arms):
        arm = drawn.action_in(0)
        yield "no arm yet" if arm is None else f"arm {action_name(world, arm, glyphs)}"
        return
    left = snapshot.answers.left_to_chance
    if left is not None:
        yield f"{left:,} state{'' if left == 1 else 's'} at random" if left else "nothing at random"


def prompts(world: World, state: int | None, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the keys for ``state``, under the cursor, the longest form first; None: nothing to choose."""
    if state is None:
        return f"nothing to choose here · {_END}", _END
    forms = actions_in_a_line(world, state, glyphs) or (f"{digits_in_words(world, state)}: arm",)
    ends = f" · del: none · C: clear · {_END}", f" · {_END}"
    return (*(f"{form}{end}" for end in ends for form in forms[:2]), *forms, _END)


def hints(world: World) -> Hints:
    """Return the keys for the key line, with what they do in a word; the last but one goes first."""
    moves = (("arrows", "cursor"),)
    if isinstance(world.drawing, Arms):
        draws: Hints = (("enter", "draw"),)
    elif has_directions(world):
        draws = (("shift+arrow", "draw"),)
    else:
        draws = ()
    return (*draws, ("1…", "draw"), ("D", "end"), ("del", "none"), ("C", "clear"), *moves, ("?", "help"))
