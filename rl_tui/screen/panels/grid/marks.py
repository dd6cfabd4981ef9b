"""What cells of a map are marked with: agent and start, what they pay, which way leads out, what differs."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from rich.style import Style

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.block_signs import Direction, Sign
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Rewards: which cells pay something, so that they differ from the floor around them


MOST_CELLS: Final = 10_000


class CellReward(NamedTuple):
    """The ``reward`` of a cell; ``good`` says that it is more than the usual step's."""

    reward: float
    good: bool


def cell_rewards(space: FiniteSpace, grid: Grid) -> dict[int, CellReward]:
    """Return the cells in which every way to leave them, or else to enter them, pays the same unusual reward.

    Usual is the commonest reward of the world. Cells where an episode has ended are left out: they have signs
    of their own. Empty where it is not known what the actions lead to, where no action is a direction and for
    maps of more than 10,000 cells.
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
    """Return the reward of all outcomes at each state, [S]; NaN where they differ or there is none."""
    low, high = np.full(states, np.inf), np.full(states, -np.inf)
    np.minimum.at(low, state, reward)
    np.maximum.at(high, state, reward)
    return np.where(low == high, low, np.nan)


# Marks of a cell


SEVERAL: Final = "*"  # in place of the arrows where they do not fit
START: Final = "S"
_ONE_WAYS: Final = ((0, -1), (0, 1), (-1, 0), (1, 0))
_BOLD: Final = Style(bold=True)


def value_text(x: float, number_form: NumberForm, look: Look) -> str:
    """Return a value in the form of all; a dash for NaN."""
    return numbers.missing(look.glyphs) if math.isnan(x) else number_form.text(x, look.glyphs)


def sign_text(sign: Sign, look: Look) -> str:
    """Return the arrow of a direction, else the letter of the action."""
    return look.glyphs.direction(sign) if isinstance(sign, tuple) else sign


def differing_style(style: Style) -> Style:
    """Return ``style`` of an arrow for one that differs, where there is no room for a sign beside it."""
    return style + Style(reverse=not style.reverse)


def one_way_sign(way: Direction, look: Look) -> str:
    """Return the sign of a cell that is left in one direction only."""
    return look.glyphs.one_way[_ONE_WAYS.index(way)]


def mark_of(kind: CellKind, agent: bool, way: Direction | None, look: Look) -> str:
    """Return what marks a cell of ``kind``, in which the ``agent`` is or not, or the only ``way`` out of it.

    Empty where nothing does.
    """
    if agent:
        return look.glyphs.agent
    return START if kind is CellKind.START else "" if way is None else one_way_sign(way, look)


def put_reward(canvas: Canvas, x: int, y: int, room: int, reward: CellReward | None, look: Look) -> None:
    """Put what a cell pays; where it does not fit, whether that is more or less than usual.

    It stands on the background of the panel, so that it is seen on every tint.
    """
    if reward is None or room < 1:
        return
    canvas.put(x, y, reward_text(reward, room, look), reward_style(reward, look))


def reward_text(reward: CellReward, room: int, look: Look) -> str:
    """Return what a cell pays in ``room`` characters; where it does not fit, whether that is much."""
    text = ("+" if reward.reward > 0.0 else "") + numbers.brief(reward.reward, look.glyphs, decimals=2)
    if len(text) <= room:
        return text
    return "+" if reward.good else look.glyphs.minus


def reward_style(reward: CellReward, look: Look) -> Style:
    """Return the style of what a cell pays."""
    return (look.palette.good if reward.good else look.palette.bad) + _BOLD
