"""Names of states, actions, pairs and probabilities."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Final

from rl_tui.live.pace.until import Breakpoints
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.world import World

LONGEST_NAME: Final = 14
DEPENDS: Final = "?"  # a probability or reward that depends on earlier steps
DEPENDS_IN_FULL: Final = "depends on how you got here"
_LARGEST_DENOMINATOR: Final = 12
COUNTED: Final = ", counted from 0"
_SIGN: Final = re.compile(r"(?<![\w.])-(?=[\d.])")


def state_name(world: World, state: int, glyphs: Glyphs) -> str:
    """Name a state, shortened if long."""
    return shortened(with_minus(world.space.state_names[state], glyphs), LONGEST_NAME, glyphs.ellipsis)


def with_minus(name: str, glyphs: Glyphs) -> str:
    """Write the screen's minus sign: ``−0.5, 0.01``."""
    return _SIGN.sub(glyphs.minus, name)


def action_name(world: World, action: int, glyphs: Glyphs) -> str:
    """Return an action's arrow or name."""
    if isinstance(world.drawing, Grid):
        direction = world.drawing.directions[action]
        if direction is not None:
            return glyphs.direction(direction)
    return shortened(world.space.action_names[action], LONGEST_NAME, glyphs.ellipsis)


def is_direction(world: World, action: int) -> bool:
    """Return whether the action is an arrow."""
    return isinstance(world.drawing, Grid) and world.drawing.directions[action] is not None


def pair_name(world: World, pair: int, glyphs: Glyphs) -> str:
    """Return Q's arguments, such as ``6,←``, or the arm."""
    action = action_name(world, int(world.space.pair_action[pair]), glyphs)
    if world.is_bandit:
        return action
    return f"{state_name(world, world.space.state_of(pair), glyphs)},{action}"


def place(world: World, state: int) -> str:
    """Return ``row 1, column 2, counted from 0``, else ""."""
    if not isinstance(world.drawing, Grid) or not world.space.state_names[state].isdecimal():
        return ""
    row, column = divmod(world.drawing.cell_of_state[state], world.drawing.columns)
    return f"row {row}, column {column}{COUNTED}"


def is_word(name: str) -> bool:
    """Return whether it is a word, such as ``lost``."""
    return len(name) > 1 and name.isalpha()


def landmark(world: World, state: int) -> str:
    """Return ``hole``, ``cliff``, ``goal`` or ""."""
    if isinstance(world.drawing, Grid) and not is_word(world.space.state_names[state]):
        kind = world.drawing.kinds[world.drawing.cell_of_state[state]]
        if kind in (CellKind.HOLE, CellKind.CLIFF, CellKind.GOAL):
            return str(kind)
    return ""


def chance(probability: float, glyphs: Glyphs) -> str:
    """Write a probability: ``.8``, ``1/3``, ``1``."""
    short = numbers.brief(probability, glyphs, decimals=3)
    if abs(round(probability, 3) - probability) < numbers.NEGLIGIBLE:
        return short
    fraction = Fraction(probability).limit_denominator(_LARGEST_DENOMINATOR)
    if abs(float(fraction) - probability) < numbers.NEGLIGIBLE:
        return f"{fraction.numerator}/{fraction.denominator}"
    return short


def estimate_name(world: World, pair: int, glyphs: Glyphs) -> str:
    """Return ``Q(6,←)``, or ``Q(3)`` for a bandit."""
    return f"Q({pair_name(world, pair, glyphs)})"


def pair_in_words(world: World, pair: int, glyphs: Glyphs) -> str:
    """Name a pair: ``6,←``, or ``arm 3``."""
    name = pair_name(world, pair, glyphs)
    return f"arm {name}" if world.is_bandit else name


def breakpoint_names(world: World, breakpoints: Breakpoints, glyphs: Glyphs) -> list[str]:
    """Name the breakpoints: ``state 6``, ``4,←``."""
    names = [f"state {state_name(world, state, glyphs)}" for state in sorted(breakpoints.states)]
    return names + [pair_in_words(world, pair, glyphs) for pair in sorted(breakpoints.pairs)]
