"""The microscope: the last step in detail.

The step follows Sutton & Barto, 2nd ed., Fig. 3.1, the backup tree Fig. 3.4. While steps pass too fast, only
the history is drawn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import ClassVar, Final

import numpy as np
from rich.segment import Segment
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.common.words import counted
from rl_tui.live.last_step.step_report import StepStory, story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.timeline.table_samples import CellHistory
from rl_tui.screen.draw import braille, names
from rl_tui.screen.draw.axes import draw_count_axis, draw_value_axis, value_axis_columns
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import KEPT_BLANK, Canvas, Line, Piece, length, spelled, strips_of
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.names import COUNTED
from rl_tui.screen.draw.number_form import number_form
from rl_tui.screen.draw.scale import round_range, round_scale
from rl_tui.screen.kit.blocks import Labelled, Row, Section, Text, stacked
from rl_tui.screen.kit.layers import exact_q
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.kit.snapshot_facts import is_secret, keeps_back, passes_too_fast
from rl_tui.screen.panels.last_step.last_step import nothing_yet
from rl_tui.screen.panels.last_step.words import StepWords, words_of
from rl_tui.screen.panels.microscope import update
from rl_tui.screen.panels.microscope.backup import BACKUP_HEADING, backup_rows, backup_section
from rl_tui.screen.panels.model import means_key
from rl_tui.screen.theme.look import Look

# The history of a cell


HISTORY: Final = "History"
COMING: Final = "loading …"
NO_CELL: Final = "this step updated no cell: choose a state with the world's cursor"
NOT_KEPT: Final = "no history: the table is too large"
LEAST_HEIGHT: Final = 4
_LEAST_WIDTH: Final = 16
_TICK_COLUMNS: Final = 9
_VALUE_COLUMNS: Final = 7
# Characters by covered halves of a cell: none, upper, lower, both
_HALVES: Final = np.array([ord(each) for each in " '.:"])


def history_strips(snapshot: Snapshot, pair: int | None, look: Look, width: int, height: int) -> list[Strip]:
    """Draw a history, and the exact value unless hidden."""
    rows, dim, cell = height - 1, look.palette.dim, snapshot.cell
    if pair is None:
        return _strips([Section(HISTORY, [Text(NO_CELL, dim)], rows)], look, width)
    known = exact_q(snapshot)
    exact = None if known is None else float(known[0][pair])
    values = _values_text(snapshot, pair, exact, look)
    heading = name = f"Q({names.pair_name(snapshot.world, pair, look.glyphs)})"
    if length(spelled([Piece(f" {HISTORY} of {name}  {values[0]} ", dim)], look)) <= width:
        heading = f"{HISTORY} of {name}"
    if cell is None or cell.pair != pair:
        return _strips([Section(heading, [Text(COMING, dim)], rows, values)], look, width)
    if cell.step[0]:
        return _strips([Section(heading, [Text(NOT_KEPT, dim)], rows, values)], look, width)
    head = _strips([Section(heading, remarks=values)], look, width)
    return [*head, *draw_history(cell, exact, look, width, rows)]


def _values_text(snapshot: Snapshot, pair: int, exact: float | None, look: Look) -> tuple[str, ...]:
    q = float(snapshot.agent.q[pair])
    form = number_form([q] if exact is None else [q, exact], _VALUE_COLUMNS)
    now = form.text(q, look.glyphs) if snapshot.agent.holds(pair) else look.glyphs.ellipsis
    if exact is None and is_secret(snapshot) and not snapshot.exact_answer.refused:
        key = () if keeps_back(snapshot, "answer") else (f"now {now}, w h shows the exact value",)
        return *key, f"now {now}"
    if exact is None:
        return (f"now {now}",)
    return f"now {now}, exact {form.text(exact, look.glyphs)}", f"now {now}"


def draw_history(cell: CellHistory, exact: float | None, look: Look, width: int, height: int) -> list[Strip]:
    """Chart a history, whose values hold until the next step. ``exact`` is None if unknown or hidden."""
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
    draw_count_axis(canvas, plot, plot.right, plot.columns // _TICK_COLUMNS, " step", look)
    if exact is not None:
        dots = look.glyphs.level if look.glyphs.braille else f"{look.glyphs.level} "
        canvas.put(plot.left, plot.row(exact), (dots * plot.columns)[: plot.columns], look.palette.optimum)
    _draw_line(canvas, plot, cell, look)
    return canvas.strips()


def _draw_line(canvas: Canvas, plot: Plot, cell: CellHistory, look: Look) -> None:
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
ENDED: Final = "ended the episode"
STEP_ROWS: Final = 5
_LABEL: Final = 9

_Form = tuple[str, str, str]  # symbol, value and remark


def _step_section(words: StepWords, look: Look) -> Section:
    rows = [
        Labelled(label, look.palette.dim, _LABEL, Row(*(_pieces(form, look) for form in forms)))
        for label, forms in _parts(words)
    ]
    return Section(STEP_HEADING, rows, STEP_ROWS, _which(words.story))


def _parts(words: StepWords) -> Iterator[tuple[str, Sequence[_Form]]]:
    places = words.place, words.place.removesuffix(COUNTED), ""
    yield "state", [("s = ", words.state, place) for place in places]
    if words.story.last.planned:
        yield "action", _remarks("none: every action is tried", "every action")
        yield "reward", _remarks("all of them: see the backup", "all")
        yield "next", _remarks("all of them: see the backup", "all")
    else:
        yield "action", [("a = ", words.action, reason) for reason in (*words.choices, "")]
        yield "reward", [("r = ", words.reward, "")]
        yield (
            "next",
            _remarks("none: every pull is an episode", "none")
            if words.story.world.is_bandit
            else [
                *(
                    ("s′ = ", words.next_state, ", ".join(filter(None, (moved, words.landmark, ending))))
                    for ending in (words.endings or ("",))
                    for moved in _moved(words)
                ),
                ("s′ = ", words.next_state, ""),
            ],
        )
    change = f" {words.update.before} → {words.update.after}"
    yield (
        "update",
        [(words.estimate, change, remark) for remark in (words.story.algorithm.name, "")]
        if words.estimate
        else _remarks("none"),
    )


def _remarks(*texts: str) -> list[_Form]:
    return [("", "", text) for text in texts]


def _pieces(form: _Form, look: Look) -> Line:
    symbol, value, remark = form
    gap = "   " if value and remark else ""
    palette = look.palette
    return [Piece(symbol, palette.dim), Piece(value, palette.strong), Piece(f"{gap}{remark}", palette.text)]


def _moved(words: StepWords) -> list[str]:
    chance = f"p = {words.chance}" if words.chance else ""
    if not words.went:
        with_wind = [", ".join(filter(None, (words.wind, chance)))] if words.wind else []
        return [*with_wind, chance, ""]
    return [f"{words.outcome} ({chance})", f"{words.slip}, {chance}", words.slip]


def _which(story: StepStory) -> Sequence[str]:
    last, step = story.last, f"{story.last.step:,}"
    if last.planned:
        return f"{step}, {'ended the sweep' if story.ends_episode else f'sweep {last.episode:,}'}", step
    if story.world.is_bandit:
        return (step,)
    if story.ends_episode:
        within, episode = f"{ENDED} after {counted(last.episode_step, 'step')}", ENDED
    else:
        within, episode = (
            f"step {last.episode_step:,} of episode {last.episode:,}",
            f"episode {last.episode:,}",
        )
    longest = within if last.episode_step else episode
    return f"{step}, {longest}", f"{step}, {episode}", step


# The panel


ROOM_FOR_TWO: Final = 96
TOO_FAST: Final = f"steps pass too fast to show one: space pauses, −{KEPT_BLANK}slows down"
_HISTORY_ROWS: Final = 7  # a heading, some rows of dots and the steps below
_GAP: Final = 2


class Microscope(ScrolledPanel):
    """The last step in sections, and ``pair``'s history."""

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("microscope")
    title = "Microscope"
    pair: int | None = None

    @property
    def is_complete(self) -> bool:
        """True if the snapshot contains the history."""
        cell = None if self.snapshot is None else self.snapshot.cell
        return self.pair is None or (cell is not None and cell.pair == self.pair)

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows."""
        return page(snapshot, self.pair, self.look, width, height)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return forms of the keys."""
        return "tab: another cell · esc: close", "esc: close"


def lit_sources(snapshot: Snapshot) -> frozenset[int]:
    """Return the looked-up pairs for the table."""
    story = None if passes_too_fast(snapshot) else story_of(snapshot)
    return frozenset() if story is None else frozenset(story.sources)


def page(snapshot: Snapshot | None, pair: int | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return all rows, with a growing history."""
    columns = 2 if width >= ROOM_FOR_TWO else 1
    room = (width - _GAP * (columns - 1)) // columns
    story = None if snapshot is None else story_of(snapshot)
    if snapshot is None or story is None:
        nothing = [[Piece(f" {nothing_yet(snapshot)}", look.palette.dim)]]
        return strips_of(nothing, width, 1, look)
    sections = _sections(snapshot, story, look)
    parts = (sections,) if columns == 1 else (sections[:2] + sections[3:], sections[2:3])
    least = _HISTORY_ROWS if columns == 1 else _HISTORY_ROWS - 1
    sides = [
        _strips(part, look, room, height - below)
        for part, below in zip(parts, (0, least + 1)[-columns:], strict=True)
    ]
    left = max(least, height - len(sides[-1]))
    sides[-1] = [*sides[-1], *history_strips(snapshot, pair, look, room, left)]
    return sides[0] if columns == 1 else _beside(sides[0], sides[1], room, width, look)


def _sections(snapshot: Snapshot, story: StepStory, look: Look) -> list[Section]:
    if passes_too_fast(snapshot):
        return [
            Section(STEP_HEADING, [Text(TOO_FAST, look.palette.dim)], STEP_ROWS),
            Section(update.UPDATE_HEADING, rows=update.update_rows(story.terms)),
            Section(BACKUP_HEADING, rows=backup_rows(story.world)),
            Section(update.RETURN_HEADING, rows=update.RETURN_ROWS),
        ]
    words = words_of(story, look.glyphs)
    return [
        _step_section(words, look),
        update.update_section(words, look),
        backup_section(words, look, secret=means_key(snapshot)),
        update.return_section(story, look),
    ]


def _strips(sections: Sequence[Section], look: Look, width: int, height: int = 0) -> list[Strip]:
    lines = stacked(sections, width, height, look)
    return strips_of(lines, width, len(lines), look)


def _beside(left: list[Strip], right: list[Strip], room: int, width: int, look: Look) -> list[Strip]:
    text = look.palette.text
    rows = max(len(left), len(right))
    blank = Strip.blank(room, text)
    padded = ([*side, *([blank] * (rows - len(side)))] for side in (left, right))
    gap = Segment(" " * (width - 2 * room), text)
    return [Strip([*one, gap, *other], width) for one, other in zip(*padded, strict=True)]
