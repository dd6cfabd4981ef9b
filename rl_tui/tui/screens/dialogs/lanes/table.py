"""Runs side by side as rows of figures, with what many seeds say of each below its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.lab.many_seeds.figures import SeedStudy
from rl_tui.lab.timeline.lane_view import LaneView
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.budget import sum_decimals, sum_text
from rl_tui.tui.panels.curve.text import amount, decimals_for, no_end
from rl_tui.tui.panels.many_seeds.figures import (
    GREEDY,
    LAST_100,
    REGRET,
    WINNINGS,
    StudyFigure,
    estimate_text,
    figure_decimals,
    until_of,
)
from rl_tui.tui.panels.snapshot_facts import recent_name
from rl_tui.tui.theme.look import Look

_LEAST_NAME: Final = 8
_LEAST_COLUMN: Final = 8
_STEP: Final = 10  # cells of a number of steps
_MARK: Final = 4  # cells before a name: cursor and number


class LaneRow(NamedTuple):
    """The row of a lane, and the one below it with mean and standard error; empty without a study."""

    own: str
    of_seeds: str


class _Column(NamedTuple):
    """A column with its heading; of every lane its own text and that of many seeds.

    Where room is short, columns are left out, those of the highest ``rank`` first.
    """

    head: str
    own: Sequence[str]
    of_seeds: Sequence[str]
    rank: int

    @property
    def cells(self) -> int:
        """How many cells it takes."""
        return max(_LEAST_COLUMN, *map(cell_len, (self.head, *self.own, *self.of_seeds)))


def lane_rows(
    lanes: Sequence[LaneView],
    shown: int,
    study: SeedStudy | None,
    look: Look,
    width: int,
    *,
    hidden: bool,
    marked: int | None = None,
) -> tuple[str, list[LaneRow]]:
    """Return a heading and a row for each of ``lanes``, of ``width`` cells; the lane ``shown`` is marked.

    So is the one ``marked`` to stand beside it, None where that goes without saying.

    ``study`` is one of these lanes, or None. Of a bandit that is ``hidden`` nothing exact is told. Columns
    for which the names leave no room are left out.
    """
    columns = _columns(lanes, study, look, hidden=hidden)
    while len(columns) > 1 and _room(columns, width) < _LEAST_NAME:
        last = max(columns, key=lambda column: column.rank)
        columns = [column for column in columns if column is not last]
    room = _room(columns, width)

    def row(mark: str, name: str, texts: Sequence[str]) -> str:
        cells = (f" {text:>{column.cells}}" for text, column in zip(texts, columns, strict=True))
        return f"{mark:<{_MARK}}{shortened(name, room, look.glyphs.ellipsis):<{room}}{''.join(cells)}"

    seeds = ""
    if study is not None:
        seeds = f"  {study.seeds} seeds"
        whole = f"{seeds}{until_of(study, [lane.episodes for lane in lanes])}"
        seeds = whole if cell_len(whole) <= room else seeds
    found = []
    for number, lane in enumerate(lanes):
        mark = look.glyphs.cursor if number == shown else "+" if number == marked else ""
        own = row(
            f"{mark:<1} {number + 1}", to_ascii(lane.name, look.glyphs), [c.own[number] for c in columns]
        )
        below = row("", seeds, [column.of_seeds[number] for column in columns]) if seeds else ""
        found.append(LaneRow(own, below))
    return row("", "lane", [column.head for column in columns]), found


def recent_of(lanes: Sequence[LaneView]) -> str:
    """Return what the mean of the last 100 episodes is called in all of ``lanes``."""
    return recent_name(*(lane.episodes for lane in lanes if lane.results.return_last_100 is not None))


def _room(columns: Sequence[_Column], width: int) -> int:
    return max(0, width - _MARK - sum(1 + column.cells for column in columns))


def _columns(
    lanes: Sequence[LaneView], study: SeedStudy | None, look: Look, *, hidden: bool
) -> list[_Column]:
    nothing = [""] * len(lanes)
    algorithms = [to_ascii(algorithm_row(lane.algorithm).name, look.glyphs) for lane in lanes]
    steps = [numbers.count(lane.step, _STEP) for lane in lanes]
    recent = [lane.results.return_last_100 for lane in lanes]
    greedy = [lane.results.greedy_return for lane in lanes]
    sizes = [abs(each) for each in (*recent, *greedy) if each is not None]
    decimals = decimals_for(0.0, max(sizes, default=0.0))

    def returns(values: Sequence[float | None]) -> list[str]:
        return [_dash(look) if x is None else amount(x, decimals, look.glyphs) for x in values]

    def of_seeds(figure: StudyFigure, *, secret: bool = False) -> list[str]:
        if study is None or secret:
            return nothing
        found = figure_decimals(figure, study)
        estimates = (lane.estimates.get(figure.id) for lane in study.lanes)
        return [to_ascii(estimate_text(each, found, look.glyphs), look.glyphs) for each in estimates]

    width = max(map(cell_len, ("algorithm", *algorithms)))
    columns = [
        _Column(f"{'algorithm':<{width}}", [f"{each:<{width}}" for each in algorithms], nothing, 9),
        _Column("step", steps, nothing, 7),
        _Column(recent_of(lanes), returns(recent), of_seeds(LAST_100), 1),
    ]
    spent = [lane.results.bandit for lane in lanes]
    known = [each for each in spent if each is not None]
    sums = [each.winnings for each in known] + [each.regret for each in known if not hidden]
    if sums:
        digits = sum_decimals(sums)
        won = [_dash(look) if each is None else sum_text(each.winnings, digits, look) for each in spent]
        lost = [
            _dash(look) if each is None or hidden else sum_text(each.regret, digits, look) for each in spent
        ]
        columns += [
            _Column("winnings", won, of_seeds(WINNINGS), 2),
            _Column("regret", lost, of_seeds(REGRET, secret=hidden), 3),
        ]
    exact = [_dash(look)] * len(lanes) if hidden else returns(greedy)
    ends = [None if hidden else lane.results.greedy_ends for lane in lanes]
    exact = [text if end is None else no_end(end, short=True) for text, end in zip(exact, ends, strict=True)]
    return [*columns, _Column("greedy", exact, of_seeds(GREEDY, secret=hidden), 5)]


def _dash(look: Look) -> str:
    return numbers.missing(look.glyphs)
