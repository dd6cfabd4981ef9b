"""The microscope (key d): the last step in detail, from the agent's choice to the updated cell.

The step follows Sutton & Barto, 2nd ed., Fig. 3.1, the backup tree Fig. 3.4. The sections form two
columns where there is room. While steps pass too fast, only the history of the cell is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby
from typing import ClassVar, Final

import numpy as np
from rich.segment import Segment
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.live.last_step.backup import Backup, Leaf
from rl_tui.live.last_step.step_report import StepStory, story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.timeline.table_samples import CellHistory
from rl_tui.screen.draw import braille, names
from rl_tui.screen.draw.action_order import shown_place
from rl_tui.screen.draw.axes import draw_count_axis, draw_value_axis, value_axis_columns
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import KEPT_BLANK, Canvas, Line, Piece, first_that_fits, strips_of, wrapped
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.names import COUNTED
from rl_tui.screen.draw.number_form import number_form
from rl_tui.screen.draw.scale import round_range, round_scale
from rl_tui.screen.kit.scrolled_panel import ScrolledPanel, scroll_bindings
from rl_tui.screen.kit.snapshot_facts import is_secret, keeps_back, passes_too_fast
from rl_tui.screen.panels.last_step.last_step import ENDED, ENDED_SWEEP, nothing_yet
from rl_tui.screen.panels.last_step.words import StepWords, words_of
from rl_tui.screen.panels.microscope.backup_columns import outcome_rows
from rl_tui.screen.panels.microscope.section import MicroscopeSection, columns_of, stacked
from rl_tui.screen.panels.microscope.targets import target_lines
from rl_tui.screen.panels.microscope.update import (
    RETURN_HEADING,
    RETURN_ROWS,
    UPDATE_HEADING,
    return_section,
    update_rows,
    update_section,
)
from rl_tui.screen.panels.model.bellman import means_key
from rl_tui.screen.panels.q_table.layers import exact_q
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

# The backup as a tree


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
        mark = Piece(f" {glyphs.cursor if leaf.happened else ' '}", palette.strong)
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


# The history of a cell


HISTORY: Final = "History"
COMING: Final = "comes with the next picture"
NO_CELL: Final = "no cell was updated yet: the table's cursor chooses one"
NOT_KEPT: Final = "of a table as large as this no history is kept"
LEAST_HEIGHT: Final = 4
_LEAST_WIDTH: Final = 16
_TICK_COLUMNS: Final = 9
_VALUE_COLUMNS: Final = 7
_UNIT: Final = " step"
# What stands for a cell of which the line takes neither half, the upper one, the lower one, both
_HALVES: Final = np.array([ord(each) for each in " '.:"])


def history_strips(snapshot: Snapshot, pair: int | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return how the estimate of ``pair`` went, in ``height`` rows, heading included.

    The exact value is shown where it is known and not hidden.
    """
    rows = height - 1
    if pair is None:
        return _instead(NO_CELL, HISTORY, (), look, width, rows)
    known = exact_q(snapshot)
    exact = None if known is None else float(known[0][pair])
    values = _values_text(snapshot, pair, exact, look)
    name = f"Q({names.pair_name(snapshot.world, pair, look.glyphs)})"
    heading = f"{HISTORY} of {name}"
    if columns_of(f" {heading}  {values[0]} ", look) > width:
        heading = name
    cell = snapshot.cell
    if cell is None or cell.pair != pair:
        return _instead(COMING, heading, values, look, width, rows)
    if not _is_kept(cell):
        return _instead(NOT_KEPT, heading, values, look, width, rows)
    head = stacked([MicroscopeSection(heading, [], 0, values)], look, width)
    return [*head, *draw_history(cell, exact, look, width, rows)]


def _values_text(snapshot: Snapshot, pair: int, exact: float | None, look: Look) -> tuple[str, ...]:
    """Return the value now and the exact one, with as many decimals, longest form first."""
    q = float(snapshot.agent.q[pair])
    form = number_form([q] if exact is None else [q, exact], _VALUE_COLUMNS)
    now = form.text(q, look.glyphs) if snapshot.agent.holds(pair) else look.glyphs.ellipsis
    if exact is None and is_secret(snapshot) and not snapshot.exact_answer.refused:
        key = () if keeps_back(snapshot, "answer") else (f"now {now}, h shows the exact",)
        return *key, f"now {now}"
    if exact is None:
        return (f"now {now}",)
    return f"now {now}, exact {form.text(exact, look.glyphs)}", f"now {now}"


def _is_kept(cell: CellHistory) -> bool:
    return not cell.step[0]


def _instead(
    text: str, heading: str, values: tuple[str, ...], look: Look, width: int, rows: int
) -> list[Strip]:
    lines = wrapped(text, width, look.palette.dim, look, " ", " ")
    return stacked([MicroscopeSection(heading, lines, rows, values)], look, width)


def draw_history(cell: CellHistory, exact: float | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return ``height`` strips of ``width`` cells; ``exact`` is None where it is not known, or secret.

    The value holds from the step after which it was reached to the next one in the history.
    """
    canvas = Canvas(width, height, look.palette.text)
    if width < _LEAST_WIDTH or height < LEAST_HEIGHT or not len(cell.step):
        return canvas.strips()
    finite = cell.value[np.isfinite(cell.value)]
    known = [
        *([] if exact is None else [exact]),
        *([float(finite.min()), float(finite.max())] if len(finite) else [0.0]),
    ]
    scale, last = round_scale(min(known), max(known)), float(cell.step[-1])
    left = 1 + value_axis_columns(scale, look)
    plot = Plot(left, width - left, height - 1, round_range(last), scale)
    draw_value_axis(canvas, plot, look)
    draw_count_axis(canvas, plot, plot.right, plot.columns // _TICK_COLUMNS, _UNIT, look)
    if exact is not None:
        dots = look.glyphs.level if look.glyphs.braille else f"{look.glyphs.level} "
        canvas.put(plot.left, plot.row(exact), (dots * plot.columns)[: plot.columns], look.palette.optimum)
    _draw_line(canvas, plot, cell, look)
    return canvas.strips()


def _draw_line(canvas: Canvas, plot: Plot, cell: CellHistory, look: Look) -> None:
    """Draw the estimate over what is there."""
    begins = cell.step.astype(np.float64)
    steps = Steps(begins, np.append(begins[1:], begins[-1]), cell.value, cell.value)
    codes = plot.braille_line(steps) if look.glyphs.braille else _HALVES[plot.halves(steps)]
    blank = braille.BLANK if look.glyphs.braille else ord(" ")
    for row, line in enumerate(codes.tolist()):
        start = 0
        for is_blank, cells in groupby(line, blank.__eq__):
            text = "".join(map(chr, cells))
            if not is_blank:
                canvas.put(plot.left + start, row, text, look.palette.episodes)
            start += len(text)


# The step in five parts


STEP_HEADING: Final = "The step"
STEP_ROWS: Final = 5
_LABEL: Final = 8
_STEP_GAP: Final = "   "

_Form = tuple[str, str, str]  # symbol, value and remark


def step_section(words: StepWords, look: Look, width: int) -> MicroscopeSection:
    """Return state, action and why, reward, next state, and what was updated: a line each."""
    parts = {
        "state": [
            ("s = ", words.state, remark) for remark in (words.place, words.place.removesuffix(COUNTED), "")
        ],
        **(_planned() if words.story.last.planned else _taken(words)),
        "update": _update(words),
    }
    lines = [_line(label, forms, look, width) for label, forms in parts.items()]
    return MicroscopeSection(STEP_HEADING, lines, STEP_ROWS, _which(words.story))


def _planned() -> dict[str, list[_Form]]:
    return {
        "action": _step_remarks("none: every action is tried", "every action"),
        "reward": _step_remarks("all of them: see the backup", "all"),
        "next": _step_remarks("all of them: see the backup", "all"),
    }


def _taken(words: StepWords) -> dict[str, list[_Form]]:
    landings = [
        ("s′ = ", words.next_state, ", ".join(filter(None, (moved, words.landmark, ending))))
        for ending in (words.endings or ("",))
        for moved in _moved(words)
    ]
    return {
        "action": [("a = ", words.action, reason) for reason in (*words.choices, "")],
        "reward": [("r = ", words.reward, "")],
        "next": _step_remarks("none: every pull is an episode", "none")
        if words.story.is_bandit
        else [*landings, ("s′ = ", words.next_state, "")],
    }


def _update(words: StepWords) -> list[_Form]:
    waiting = words.story.terms.waiting
    if not words.estimate:
        return _step_remarks(f"none: {waiting}", waiting, "none")
    change = f" {words.update.before} → {words.update.after}"
    return [(words.estimate, change, remark) for remark in (words.story.algorithm.name, "")]


def _step_remarks(*texts: str) -> list[_Form]:
    return [("", "", text) for text in texts]


def _line(label: str, forms: Sequence[_Form], look: Look, width: int) -> Line:
    """Return the first of ``forms`` that fits, behind ``label``."""
    palette = look.palette
    head = Piece(f" {label:<{_LABEL}}", palette.dim)
    lines = []
    for symbol, value, remark in forms:
        gap = _STEP_GAP if value else ""
        tail = [Piece(f"{gap}{remark}", palette.text)] if remark else []
        lines.append([head, Piece(symbol, palette.dim), Piece(value, palette.strong), *tail])
    return first_that_fits(lines, width, look)


def _moved(words: StepWords) -> list[str]:
    """Return what became of the action, the longest form first; empty where there is nothing to tell."""
    chance = f"p {words.chance}" if words.chance else ""
    if not words.went:
        with_wind = [", ".join(filter(None, (words.wind, chance)))] if words.wind else []
        return [*with_wind, chance, ""]
    return [f"{words.outcome} ({chance})", f"{words.slip}, {chance}", words.slip]


def _which(story: StepStory) -> Sequence[str]:
    """Return which step of the run it is, longest form first; an episode that has ended has no number."""
    last = story.last
    step = f"{last.step:,}"
    if last.planned:
        return f"{step}, {ENDED_SWEEP if story.ends_episode else f'sweep {last.episode:,}'}", step
    if story.is_bandit:
        return (step,)
    episode = f"{step}, {ENDED if story.ends_episode else f'episode {last.episode:,}'}"
    where = f"with step {last.episode_step:,}" if story.ends_episode else f"its step {last.episode_step:,}"
    place = f"{episode}, {where}" if last.episode_step else episode
    return place, episode, step


# The panel


ROOM_FOR_TWO: Final = 96
PASS_TOO_FAST: Final = "steps pass too fast"
TOO_FAST: Final = f"{PASS_TOO_FAST} to take one apart: space pauses, −{KEPT_BLANK}slows down"
_HISTORY_ROWS: Final = 7  # its heading, some rows of dots and the steps below them
_GAP: Final = 2


class Microscope(ScrolledPanel):
    """Sections below one another, in two columns where there is room; arrows and pgup, pgdn scroll them.

    ``pair`` is the one whose history is shown. Where steps pass too fast to be taken apart, only that history
    is drawn.
    """

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("microscope")
    title = "Microscope"

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self.pair: int | None = None

    @property
    def is_complete(self) -> bool:
        """Whether the newest snapshot has the history that is to be shown."""
        cell = None if self.snapshot is None else self.snapshot.cell
        return self.pair is None or (cell is not None and cell.pair == self.pair)

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of the page."""
        return page(snapshot, self.pair, self.look, width, height)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it."""
        return ("d: close",)


def lit_sources(snapshot: Snapshot) -> frozenset[int]:
    """Return the pairs that the table lights up as looked up; none where steps pass too fast to follow."""
    story = None if passes_too_fast(snapshot) else story_of(snapshot)
    return frozenset() if story is None else frozenset(story.sources)


def page(snapshot: Snapshot | None, pair: int | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return all rows of the microscope, at least ``height`` where the history may grow.

    ``pair`` is the one whose history is shown.
    """
    columns = 2 if width >= ROOM_FOR_TWO else 1
    room = (width - _GAP * (columns - 1)) // columns
    story = None if snapshot is None else story_of(snapshot)
    if snapshot is None or story is None:
        nothing: list[Line] = [[Piece(f" {nothing_yet(snapshot)}", look.palette.dim)]]
        return strips_of(nothing, width, 1, look)
    sections = _sections(snapshot, story, look, room, secret=means_key(snapshot))
    parts = (sections,) if columns == 1 else (sections[:2] + sections[3:], sections[2:3])
    least = _HISTORY_ROWS if columns == 1 else _HISTORY_ROWS - 1
    sides = [
        stacked(part, look, room, height - below)
        for part, below in zip(parts, (0, least + 1)[-columns:], strict=True)
    ]
    left = max(least, height - len(sides[-1]))
    sides[-1] = [*sides[-1], *history_strips(snapshot, pair, look, room, left)]
    return sides[0] if columns == 1 else _beside(sides[0], sides[1], room, width, look)


def _sections(
    snapshot: Snapshot, story: StepStory, look: Look, width: int, *, secret: Sequence[str]
) -> list[MicroscopeSection]:
    """Return the step, the update, the backup and the return."""
    if passes_too_fast(snapshot):
        return _calm(story, look, width)
    words = words_of(story, look.glyphs)
    return [
        step_section(words, look, width),
        update_section(words, look, width),
        backup_section(words, look, width, secret=secret),
        return_section(story, look, width),
    ]


def _calm(story: StepStory, look: Look, width: int) -> list[MicroscopeSection]:
    """Return the headings with nothing below them that changes from frame to frame."""
    return [
        MicroscopeSection(
            STEP_HEADING,
            wrapped(TOO_FAST, width, look.palette.dim, look, " ", " "),
            STEP_ROWS,
        ),
        MicroscopeSection(UPDATE_HEADING, [], update_rows(story.terms)),
        MicroscopeSection(BACKUP_HEADING, [], backup_rows(story.world)),
        MicroscopeSection(RETURN_HEADING, [], RETURN_ROWS),
    ]


def _beside(left: list[Strip], right: list[Strip], room: int, width: int, look: Look) -> list[Strip]:
    """Return two columns of ``room`` cells side by side, as long as the longer one."""
    text = look.palette.text
    rows = max(len(left), len(right))
    blank = Strip.blank(room, text)
    padded = ([*side, *([blank] * (rows - len(side)))] for side in (left, right))
    gap = Segment(" " * (width - 2 * room), text)
    return [Strip([*one, gap, *other], width) for one, other in zip(*padded, strict=True)]
