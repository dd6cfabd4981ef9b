"""The signs of a map that its legend explains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.legend import GREEDY_IN_FULL, LegendSign
from rl_tui.tui.panels.world.grid.action_form import ActionForm, Places
from rl_tui.tui.panels.world.grid.cells import SEVERAL, START, differing_style, reward_style
from rl_tui.tui.panels.world.grid.form import LEAST_ARROWS, CellForm
from rl_tui.tui.panels.world.grid.map import GridMap
from rl_tui.tui.panels.world.grid.rewards import CellReward
from rl_tui.tui.panels.world.grid.trail import traces, trail_signs
from rl_tui.tui.panels.world.grid.wind import wind_sign
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import CellKind


def differing_sign(width: int, name: str, arrows: str, look: Look) -> LegendSign:
    """Return how cells say that the lane beside this one has other ``arrows``, greedy ones or a policy's.

    They have room for ``width`` characters, of which ``name``, if any, takes that of the arrows.
    """
    glyphs, strong = look.glyphs, look.palette.strong
    if width - len(name) > LEAST_ARROWS:
        sign, style = glyphs.differs, strong
    else:
        is_name = width - len(name) < LEAST_ARROWS
        sign, style = name if is_name else glyphs.up, differing_style(strong)
    return LegendSign(sign, "differs", style, f"{arrows} in the other lane differs")


def tie_sign(look: Look, *, is_kept: bool) -> LegendSign:
    """Return how a narrow cell says that there are several actions; ``is_kept``: of a planner's policy."""
    return LegendSign(SEVERAL, "tie", look.palette.strong, f"tie: equally {'likely' if is_kept else 'good'}")


def action_signs(form: ActionForm, look: Look) -> Iterator[LegendSign]:
    """Yield the signs of cells with every action."""
    palette, glyphs = look.palette, look.glyphs
    # first: between others it would be taken for the dot that separates them
    yield LegendSign(glyphs.stay, "not tried", palette.unvisited)
    if form.places is Places.TINTS:
        yield LegendSign(glyphs.up, "greedy", palette.strong, GREEDY_IN_FULL)
    else:
        frame = glyphs.mark_left + glyphs.mark_right if form.is_framed else glyphs.mark_after
        yield LegendSign(frame, "greedy", palette.greedy, GREEDY_IN_FULL)
    if palette.tints:
        yield LegendSign(" tint ", "Q", palette.value(1.0), "value Q(s,a)")


def ground_signs(of: GridMap, look: Look) -> Iterator[LegendSign]:
    """Yield the signs of what takes the agent elsewhere than it would: wind, and cells with one way out."""
    if of.grid.wind:
        yield wind_sign(of.grid, look)
    if of.ways:
        sign = "".join(sorted(set(of.ways.values())))
        yield LegendSign(sign, "one-way", look.palette.start, "left in that direction only")


def place_signs(of: GridMap, kinds: frozenset[CellKind], look: Look) -> Iterator[LegendSign]:
    """Yield the signs of the cells in which nothing can be done, and of the start among ``kinds``."""
    palette, glyphs = look.palette, look.glyphs
    ends = (
        (CellKind.HOLE, glyphs.hole, palette.hole),
        (CellKind.CLIFF, glyphs.cliff, palette.cliff),
        (CellKind.GOAL, glyphs.goal, palette.goal),
    )
    yield from (LegendSign(sign, of.ends[kind], style) for kind, sign, style in ends if kind in of.ends)
    if CellKind.START in kinds:
        yield LegendSign(START, "start", palette.start)


def trace_signs(
    of: GridMap, snapshot: Snapshot, form: CellForm, actions: ActionForm | None, look: Look
) -> Iterator[LegendSign]:
    """Yield the signs of the trail of the episode, as cells of ``form`` have them."""
    tints_alone = actions is not None and actions.places is Places.TINTS
    left = traces(snapshot.trail, of.grid, of.signs)
    yield from trail_signs(left.values(), look, is_high=form.height > 1 and not tints_alone)


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
