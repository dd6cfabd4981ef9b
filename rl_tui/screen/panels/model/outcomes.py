"""The outcomes of one pair as a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rich.cells import cell_len

from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_outcomes
from rl_tui.screen.draw.canvas import Line, Piece
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION, TabularMDP
from rl_tui.worlds.world import World

HIDDEN: Final = "···"


def outcome_lines(world: World, mdp: TabularMDP, pair: int, look: Look, *, secret: bool) -> list[Line]:
    """Return a table: probability, what happened where the world slips, reward, next state."""
    palette, glyphs = look.palette, look.glyphs
    meant = int(mdp.pair_action[pair])
    slips = any(mdp.outcome_action[each] not in (UNKNOWN_ACTION, meant) for each in mdp.outcomes_of(pair))
    rows = []
    for outcome in shown_outcomes(world, mdp, pair):
        next_state = int(mdp.next_state[outcome])
        happened = int(mdp.outcome_action[outcome])
        landing = names.state_name(world, next_state, glyphs)
        if landmark := names.landmark(world, next_state):
            landing += f": {landmark}"
        rows.append(
            (
                names.chance(float(mdp.probability[outcome]), glyphs),
                (names.action_name(world, happened, glyphs) if happened != UNKNOWN_ACTION else "?")
                if slips
                else "",
                HIDDEN if secret else numbers.brief(float(mdp.reward[outcome]), glyphs, decimals=4),
                landing,
                "ends" if mdp.terminated[outcome] else "",
            )
        )
    noise = float(mdp.reward_std[mdp.first_outcome[pair]])
    heads = ("p", "went" if slips else "", "r at the start" if mdp.drift_std else "r", "s′", "")
    lines = _aligned((heads, *rows), look)
    if noise > 0.0:
        for cells in lines[1:]:
            cells.append(Piece(f"   r ± {numbers.brief(noise, glyphs, decimals=3)} (normal)", palette.dim))
    return list(lines)


def prospect_lines(world: World, pair: int, look: Look) -> list[Line]:
    """Return the same of a pair whose outcomes depend on how one came there, as far as they do not."""
    glyphs, space = look.glyphs, world.space
    rows = [
        (
            names.DEPENDS if each.probability is None else names.chance(each.probability, glyphs),
            " or ".join(numbers.brief(reward, glyphs, decimals=4) for reward in each.rewards)
            + (f" {names.DEPENDS}" if len(each.rewards) > 1 else ""),
            names.state_name(world, each.next_state, glyphs),
            "" if space.pairs_of(each.next_state) else "ends",
        )
        for each in world.prospects[pair]
    ]
    lines: list[Line] = [*_aligned((("p", "r", "s′", ""), *rows), look)]
    depends = any(each.probability is None or len(each.rewards) > 1 for each in world.prospects[pair])
    note: Line = [Piece(f"   {names.DEPENDS} {names.DEPENDS_IN_FULL}", look.palette.dim)]
    return [*lines, note] if depends else lines


def _aligned(rows: Sequence[tuple[str, ...]], look: Look) -> list[list[Piece]]:
    """Return ``rows``, the first their heads, in columns; columns that are empty are left out."""
    palette, glyphs = look.palette, look.glyphs
    spelled = [tuple(to_ascii(cell, glyphs) for cell in row) for row in rows]
    widths = [max(cell_len(row[column]) for row in spelled) for column in range(len(rows[0]))]
    return [
        [
            Piece(
                f"   {cell}{' ' * (columns - cell_len(cell))}",
                palette.strong if cell == "ends" else palette.text if number else palette.dim,
            )
            for cell, columns in zip(row, widths, strict=True)
            if columns
        ]
        for number, row in enumerate(spelled)
    ]
