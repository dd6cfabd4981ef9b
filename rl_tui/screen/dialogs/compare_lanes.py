"""The dialogs that compare runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import ClassVar, Final, NamedTuple

from rich.cells import cell_len
from rich.text import Text
from textual.binding import Binding, BindingType

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.live.commands import ChooseLane, DropLane, MarkLane
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.dialogs.form import MARKS, Candidate, Choice, Form
from rl_tui.screen.dialogs.lane_changes import what_may_differ
from rl_tui.screen.dialogs.options import SettingChoice
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.snapshot_facts import recent_name
from rl_tui.screen.panels.budget import sum_decimals, sum_text
from rl_tui.screen.panels.curve.text import amount, decimals_for, no_end
from rl_tui.screen.panels.seed_figures import (
    GREEDY,
    LAST_100,
    REGRET,
    WINNINGS,
    StudyFigure,
    estimate_text,
    figure_decimals,
    until_of,
)
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.studies.many_seeds.figures import SeedStudy

# The runs as a table


_LEAST_NAME: Final = 8
_LEAST_COLUMN: Final = 8
_STEP: Final = 10  # cells of a number of steps


class LaneRow(NamedTuple):
    """The row of a run, and the one below with mean and standard error."""

    own: str
    of_seeds: str


class _Column(NamedTuple):
    head: str
    own: Sequence[str]
    of_seeds: Sequence[str]
    rank: int

    @property
    def cells(self) -> int:
        return max(_LEAST_COLUMN, *map(cell_len, (self.head, *self.own, *self.of_seeds)))


def lane_rows(
    lanes: Sequence[LaneView],
    roles: Sequence[str],
    study: SeedStudy | None,
    look: Look,
    width: int,
    *,
    hidden: bool,
) -> tuple[str, list[LaneRow]]:
    """Return a heading and a row of ``width`` cells per run."""
    columns = [*_columns(lanes, study, look, hidden=hidden), _role_column(roles)]
    while len(columns) > 1 and _room(columns, width) < _LEAST_NAME:
        last = max(columns, key=lambda column: column.rank)
        columns = [column for column in columns if column is not last]
    room = _room(columns, width)

    def row(name: str, texts: Sequence[str], skipped: int = 0) -> str:
        cells = [f" {text:>{column.cells}}" for text, column in zip(texts, columns, strict=True)]
        name_room = room + sum(map(cell_len, cells[:skipped]))
        name = shortened(name, name_room, look.glyphs.ellipsis)
        return f"{name:<{name_room}}{''.join(cells[skipped:])}"

    seeds, empty = "", sum(1 for _ in takewhile(lambda column: not any(column.of_seeds), columns))
    if study is not None:
        seeds = f"  {study.seeds} seeds"
        whole = f"{seeds}{until_of(study, [lane.episodes for lane in lanes])}"
        free = room + sum(1 + column.cells for column in columns[:empty])
        seeds = whole if cell_len(whole) <= free else seeds
    found = []
    for number, lane in enumerate(lanes):
        own = row(to_ascii(lane.name, look.glyphs), [column.own[number] for column in columns])
        below = row(seeds, [column.of_seeds[number] for column in columns], empty) if seeds else ""
        found.append(LaneRow(own, below))
    return row("run", [column.head for column in columns]), found


def recent_of(lanes: Sequence[LaneView]) -> str:
    """Return the name of the mean of the last 100 episodes for all ``lanes``."""
    return recent_name(*(lane.episodes for lane in lanes if lane.results.return_last_100 is not None))


def _room(columns: Sequence[_Column], width: int) -> int:
    return max(0, width - sum(1 + column.cells for column in columns))


def _role_column(roles: Sequence[str]) -> _Column:
    width = max(map(cell_len, roles))
    return _Column("", [f"{each:<{width}}" for each in roles], [""] * len(roles), 8)


def _columns(
    lanes: Sequence[LaneView], study: SeedStudy | None, look: Look, *, hidden: bool
) -> list[_Column]:
    nothing = [""] * len(lanes)
    algorithms = [to_ascii(algorithm_row(lane.algorithm).name, look.glyphs) for lane in lanes]
    steps = [numbers.count(lane.step, _STEP) for lane in lanes]
    recent = [lane.results.return_last_100 for lane in lanes]
    greedy = [lane.results.greedy_return for lane in lanes]
    sizes = [abs(each) for each in (*recent, *greedy) if each is not None]
    decimals = decimals_for(max(sizes, default=0.0))

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
    exact = [text if end is None else no_end(end) for text, end in zip(exact, ends, strict=True)]
    return [*columns, _Column("greedy", exact, of_seeds(GREEDY, secret=hidden), 5)]


def _dash(look: Look) -> str:
    return numbers.missing(look.glyphs)


# The setting in which another run differs


MOST_LANES: Final = 4
EXACT: Final = "w h"  # the keys that show hidden values


def setting_choice(recipe: Recipe, glyphs: Glyphs) -> SettingChoice:
    """Return the choice of the setting in which another run differs."""
    names = what_may_differ(recipe)[1:]
    return SettingChoice(
        "Another run that differs in", lambda: names, lambda: recipe, glyphs, another_run=True
    )


def branch_choice(branches: Mapping[int, str], glyphs: Glyphs) -> Choice:
    """Return the choice of a branch to compare with, the newest first."""
    rows = [Candidate(str(number), words) for number, words in sorted(branches.items(), reverse=True)]
    return Choice("A branch of this run beside it", rows, "", glyphs)


# The table of the runs


_PAIR: Final = 2
_KEYS: Final = "del: end"
_KEYS_OF_MORE: Final = "space: beside   del: end"
_CONTROL: Final = "control"
_BESIDE: Final = "beside"
_RETURNS: Final = "Undiscounted returns: mean of the {recent}, and the exact value for the greedy policy."
_ONE_SEED: Final = "One seed decides nothing"
_HIDDEN: Final = f"Hidden until {EXACT}."
_KEPT: Final = "The lesson hides it."
_MANY_SEEDS: Final = "Below each: mean ± standard error of many seeds."
Answer = ChooseLane | MarkLane | DropLane
"""The run to control, to show next to it, or to end."""


class RunTable(Form):
    """Two or more ``lanes``, of which you control ``shown`` and see ``beside``."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("delete,backspace", "end", "end run", id="compare.end", tooltip="End the run."),
        Binding("space", "mark", "beside", id="compare.mark", tooltip="Show the run beside yours."),
    ]

    def __init__(
        self,
        look: Look,
        lanes: Sequence[LaneView],
        shown: int,
        *,
        hidden: bool,
        beside: int | None = None,
        study: SeedStudy | None = None,
        is_program: bool = False,
        is_kept: bool = False,
    ) -> None:
        self._look = look
        self._lanes = lanes
        self._shown = shown
        self._hidden = hidden
        self._study = study
        roles = [""] * len(lanes)
        roles[shown] = _CONTROL
        if beside is not None and len(lanes) > _PAIR:
            roles[beside] = _BESIDE
        self._roles = roles
        more = "rl-tui grade runs your program under many" if is_program else "t m runs many"
        seeds = f"{_ONE_SEED}: {more}."
        self.about_lanes = [
            _RETURNS.format(recent=recent_of(lanes)),
            _MANY_SEEDS if study is not None else seeds,
            *([_KEPT if is_kept else _HIDDEN] if hidden else []),
        ]
        rows = [
            Candidate("", "run"),
            *(Candidate(str(number), lane.name) for number, lane in enumerate(lanes)),
        ]
        keys = _KEYS_OF_MORE if len(lanes) > _PAIR else _KEYS
        super().__init__("Runs", rows, str(shown), look.glyphs, keys=keys)

    def describe(self, candidate: Candidate) -> Text:
        """Return the row of a run, or the heading."""
        head, rows = lane_rows(
            self._lanes, self._roles, self._study, self._look, self.room - MARKS, hidden=self._hidden
        )
        if not candidate.id:
            return Text(f"{' ' * MARKS}{head}")
        own, of_seeds = rows[int(candidate.id)]
        text = Text.assemble(
            self.mark(candidate), (own, "bold" if candidate.id == self.current else "not bold")
        )
        return text.append(f"\n{' ' * MARKS}{of_seeds}", "not bold") if of_seeds else text

    def about(self, candidate: Candidate) -> str:
        """Return how far to trust the numbers, the same for every run."""
        return to_ascii("\n".join(self.about_lanes), self.glyphs)

    def choose(self, id: str) -> None:  # noqa: A002
        """Answer the run to control."""
        self.dismiss(ChooseLane(int(id)))

    def action_end(self) -> None:
        """Answer the run to end."""
        self.dismiss(DropLane(int(self.at or 0)))

    def action_mark(self) -> None:
        """Answer the run to show next to yours."""
        lane = int(self.at or 0)
        if len(self._lanes) <= _PAIR:
            self.tell_about("Not here: both runs are shown. A choice needs three or more.")
        elif lane == self._shown:
            self.tell_about("Not here: you control this one. Choose another to put beside it.")
        else:
            self.dismiss(MarkLane(lane))
