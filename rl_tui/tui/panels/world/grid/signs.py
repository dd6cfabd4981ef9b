"""The signs of a map that its legend explains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rl_tui.tui.panels.legend import LegendSign
from rl_tui.tui.panels.world.grid.cells import differing_style, reward_style
from rl_tui.tui.panels.world.grid.form import LEAST_ARROWS, CellForm
from rl_tui.tui.panels.world.grid.map import GridMap
from rl_tui.tui.panels.world.grid.rewards import CellReward
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import CellKind


def differing_sign(form: CellForm, look: Look) -> LegendSign:
    """Return how cells say that the lane beside this one has other greedy actions."""
    glyphs, strong = look.glyphs, look.palette.strong
    has_room = form.width > LEAST_ARROWS
    sign, style = (glyphs.differs, strong) if has_room else (glyphs.up, differing_style(strong))
    return LegendSign(sign, "differs", style, "greedy in the other lane differs")


def end_signs(of: GridMap, look: Look) -> Iterator[LegendSign]:
    """Yield the signs of the cells in which nothing can be done."""
    palette, glyphs = look.palette, look.glyphs
    ends = (
        (CellKind.HOLE, glyphs.hole, palette.hole),
        (CellKind.CLIFF, glyphs.cliff, palette.cliff),
        (CellKind.GOAL, glyphs.goal, palette.goal),
    )
    yield from (LegendSign(sign, kind.value, style) for kind, sign, style in ends if kind in of.ends)


def reward_signs(rewards: Sequence[CellReward], texts: Sequence[str], look: Look) -> Iterator[LegendSign]:
    """Yield how cells show what they pay: as a number, or whether it is more or less than usual.

    ``texts`` are what they show for each of ``rewards``.
    """
    if len(texts[0]) > 1:
        yield LegendSign(texts[0], "reward", reward_style(rewards[0], look))
        return
    signs = "".join(dict.fromkeys(texts))
    in_full = f"{' or '.join({'+': 'more'}.get(each, 'less') for each in signs)} reward than usual"
    yield LegendSign(signs, "reward", look.palette.strong, in_full)
