"""The backup of the last step as a tree (Sutton & Barto, 2nd ed., Fig. 3.4), and its two targets."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Final

import numpy as np

from rl_tui.lab.last_step.backup import Backup, Leaf
from rl_tui.tui.draw import names
from rl_tui.tui.draw.action_order import shown_place
from rl_tui.tui.draw.pieces import Line, Piece, wrapped
from rl_tui.tui.panels.last_step.words import StepWords
from rl_tui.tui.panels.microscope.backup_columns import outcome_rows
from rl_tui.tui.panels.microscope.section import MicroscopeSection
from rl_tui.tui.panels.microscope.targets import target_lines
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

BACKUP_HEADING: Final = "The backup"
AFTER_END: Final = "the episode has ended: after its end there is nothing to look up"
NOT_KNOWN: Final = "which estimates your program looked up is not known"
MOST_LEAVES: Final = 8
TARGET_ROWS: Final = 4
_HEAD_ROWS: Final = 3
_TRUNK: Final = 5  # the cells of the tree before the first column


def backup_section(words: StepWords, look: Look, width: int, *, secret: Sequence[str]) -> MicroscopeSection:
    """Return the tree over all outcomes and the targets below it.

    ``secret`` stands in place of what true rewards decide, the longest form first; none where they may be
    seen.
    """
    world, backup = words.story.world, words.story.backup
    if backup is None:
        text = _why_none(words)
        waiting = wrapped(text, width, look.palette.dim, look, " ", " ")
        return MicroscopeSection(BACKUP_HEADING, waiting, 1)
    lines = _tree(world, backup, look, width, secret=bool(secret))
    lines += [[Piece("", look.palette.text)]] * (_HEAD_ROWS + _leaf_rows(world) - len(lines))
    lines += target_lines(words, backup, look, width, secret=secret)
    return MicroscopeSection(BACKUP_HEADING, lines, backup_rows(world), _remarks(world, backup))


def _why_none(words: StepWords) -> str:
    """Return why there is no backup: nothing was looked up, it is not known what, or it is not the book's."""
    story = words.story
    if story.program is None or story.program.table is None or story.reads_by_the_book:
        return story.terms.waiting
    if story.last.terminated and not story.bootstraps:
        return AFTER_END
    if story.has_equation and words.bootstrap:
        return f"your program looked up {words.bootstrap}: the book has no such backup"
    return NOT_KNOWN  # the update says why


def backup_rows(world: World) -> int:
    """Return how many rows the tree of any pair of ``world`` and the targets take."""
    return _HEAD_ROWS + _leaf_rows(world) + TARGET_ROWS


def _remarks(world: World, backup: Backup) -> Sequence[str]:
    if world.mdp is None:
        return ("what else may follow is not known", "one sample")
    return () if backup.is_current else ("estimates as they are now", "as they are now")


@lru_cache(maxsize=1)  # one world is on screen; no other is kept alive
def _most_outcomes(mdp: TabularMDP) -> int:
    return int(np.diff(mdp.first_outcome).max())


def _leaf_rows(world: World) -> int:
    """Return how many rows the leaves of any pair of ``world`` take."""
    return 1 if world.mdp is None else min(_most_outcomes(world.mdp), MOST_LEAVES)


def _tree(world: World, backup: Backup, look: Look, width: int, *, secret: bool) -> list[Line]:
    """Return the state, the action below it, and the leaves that hang from it."""
    palette, glyphs = look.palette, look.glyphs
    leaves = sorted(backup.leaves, key=lambda leaf: shown_place(world, leaf.action))
    shown, left_out = _chosen(leaves)
    heads, *rows = outcome_rows(world, backup, shown, look, width - _TRUNK, secret=secret)
    state = names.state_name(world, backup.state, glyphs)
    action = names.action_name(world, int(world.space.pair_action[backup.pair]), glyphs)
    lines: list[Line] = [
        [Piece(f" {glyphs.state_node} ", palette.strong), Piece(state, palette.text)],
        [
            Piece(f" {glyphs.axis_corner}", palette.dim),
            Piece(f"{glyphs.action_node} ", palette.strong),
            Piece(action, palette.text),
        ],
        [Piece(f"  {glyphs.thin_vertical}  ", palette.dim), Piece(heads, palette.dim)],
    ]
    for number, (leaf, row_text) in enumerate(zip(shown, rows, strict=True), start=1):
        is_last = number == len(shown) and not left_out
        mark = Piece(f" {glyphs.cursor if leaf.happened else ' '}", palette.accent)
        branch = Piece(glyphs.axis_corner if is_last else glyphs.fork, palette.dim)
        node = Piece(f"{glyphs.state_node} ", palette.strong if leaf.happened else palette.dim)
        row = Piece(row_text, palette.strong if leaf.happened else palette.text)
        lines.append([mark, branch, node, row])
    if left_out:
        chance = names.chance(sum(leaf.probability or 0.0 for leaf in left_out), glyphs)
        lines.append(
            [
                Piece(f"  {glyphs.axis_corner}{glyphs.ellipsis} ", palette.dim),
                Piece(f"{len(left_out):,} more, together p {chance}", palette.dim),
            ]
        )
    return lines


def _chosen(leaves: Sequence[Leaf]) -> tuple[list[Leaf], list[Leaf]]:
    """Return the leaves that are drawn, in their order, and those that have no room: the least likely.

    What happened always is drawn.
    """
    if len(leaves) <= MOST_LEAVES:
        return list(leaves), []
    ranked = sorted(enumerate(leaves), key=lambda each: (not each[1].happened, -(each[1].probability or 0.0)))
    kept, left_out = ranked[: MOST_LEAVES - 1], ranked[MOST_LEAVES - 1 :]
    return [leaf for _, leaf in sorted(kept, key=lambda each: each[0])], [leaf for _, leaf in left_out]
