"""Marks of map cells."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from rich.style import Style

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.block_signs import Direction, Sign
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Rewards that distinguish a cell from the floor around it


MOST_CELLS: Final = 10_000


class CellReward(NamedTuple):
    """A cell's reward. ``good``: above the usual one."""

    reward: float
    good: bool


def cell_rewards(space: FiniteSpace, grid: Grid) -> dict[int, CellReward]:
    """Return cells with one unusual reward for leaving, or else entering them.

    Usual is the most frequent reward of the world. Ends have their own signs. Empty without table or
    directions, and for over 10,000 cells.
    """
    if not isinstance(space, TabularMDP) or not any(grid.directions) or len(grid.kinds) > MOST_CELLS:
        return {}
    rewards, counts = np.unique(space.reward, return_counts=True)
    usual = float(rewards[counts.argmax()])
    source = space.pair_state[space.outcome_pair]
    moved = source != space.next_state
    leaving = _only_reward(space.states, source, space.reward)
    entering = _only_reward(space.states, space.next_state[moved], space.reward[moved])
    pays = np.full(space.states, np.nan)
    for each in (entering, leaving):
        np.copyto(pays, each, where=np.isfinite(each) & (each != usual))
    pays[np.diff(space.first_pair) == 0] = np.nan
    unusual = np.flatnonzero(np.isfinite(pays))
    return {
        grid.cell_of_state[state]: CellReward(reward, reward > usual)
        for state, reward in zip(unusual.tolist(), pays[unusual].tolist(), strict=True)
    }


def _only_reward(states: int, state: IntArray, reward: FloatArray) -> FloatArray:
    """Return the common reward of each state's outcomes, [S], or NaN."""
    low, high = np.full(states, np.inf), np.full(states, -np.inf)
    np.minimum.at(low, state, reward)
    np.maximum.at(high, state, reward)
    return np.where(low == high, low, np.nan)


# Marks of a cell


SEVERAL: Final = "*"  # replaces arrows that do not fit
START: Final = "S"
_ONE_WAYS: Final = ((0, -1), (0, 1), (-1, 0), (1, 0))
_BOLD: Final = Style(bold=True)


def value_text(x: float, number_form: NumberForm, look: Look) -> str:
    """Write a value, or a dash."""
    return numbers.missing(look.glyphs) if math.isnan(x) else number_form.text(x, look.glyphs)


def sign_text(sign: Sign, look: Look) -> str:
    """Return an action's arrow or letter."""
    return look.glyphs.direction(sign) if isinstance(sign, tuple) else sign


def differing_style(style: Style) -> Style:
    """Restyle a differing arrow without space beside it."""
    return style + Style(reverse=not style.reverse)


def one_way_sign(way: Direction, look: Look) -> str:
    """Return the sign of a single exit."""
    return look.glyphs.one_way[_ONE_WAYS.index(way)]


def mark_of(kind: CellKind, agent: bool, way: Direction | None, look: Look) -> str:
    """Return agent, start, or only exit."""
    if agent:
        return look.glyphs.agent
    return START if kind is CellKind.START else "" if way is None else one_way_sign(way, look)


def put_reward(canvas: Canvas, x: int, y: int, room: int, reward: CellReward | None, look: Look) -> None:
    """Put a reward or its sign, on a readable background."""
    if reward is None or room < 1:
        return
    canvas.put(x, y, reward_text(reward, room, look), reward_style(reward, look))


def reward_text(reward: CellReward, room: int, look: Look) -> str:
    """Write a reward, or only its sign."""
    text = ("+" if reward.reward > 0.0 else "") + numbers.brief(reward.reward, look.glyphs, decimals=2)
    if len(text) <= room:
        return text
    return "+" if reward.good else look.glyphs.minus


def reward_style(reward: CellReward, look: Look) -> Style:
    """Return the style of a reward."""
    return (look.palette.good if reward.good else look.palette.bad) + _BOLD


# Shares of the range of V. By factors: if γ is near 1 or a step costs little, even clear leads are small
_LEADS: Final = (0.0005, 0.002, 0.008, 0.03)
MOST_LEAD: Final = len(_LEADS)


def lead_steps(range_of_v: ValueScale) -> tuple[float, ...]:
    """Return the leads at which a greedy action's colour gets stronger, up to full colour."""
    return tuple(share * (range_of_v.high - range_of_v.low) for share in _LEADS)
