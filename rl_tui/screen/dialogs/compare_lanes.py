"""Dialogs that compare runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import ClassVar, Final, NamedTuple

from rich.cells import cell_len
from rich.text import Text
from textual.binding import Binding, BindingType

from rl_tui.agents.catalogue import algorithm_row, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, why_idle
from rl_tui.common.errors import UserError
from rl_tui.live.commands import ChooseLane, DropLane, MarkLane
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import Recipe, SetParameter, Setting, SwitchAlgorithm, changed_recipe
from rl_tui.runs.settings import settings_for
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.runs.timeline.run_names import branch_in_words, difference
from rl_tui.screen.dialogs.form import MARKS, Candidate, Choice, Form
from rl_tui.screen.dialogs.options import SettingChoice
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.kit.snapshot_facts import current_study, hides_greedy, keeps_back, recent_name
from rl_tui.screen.panels import seed_figures
from rl_tui.screen.panels.budget import sum_decimals, sum_text
from rl_tui.screen.panels.curve.text import amount, decimals_for, no_end
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.studies.many_seeds.figures import SeedStudy
from rl_tui.worlds.mdp.space import FiniteSpace

# Differences of another run


ALGORITHM = "algorithm"


def what_may_differ(recipe: Recipe) -> tuple[str, ...]:
    """Return ``algorithm`` and the settings that count, schedules last."""
    names = [
        name
        for name in parameters_of(recipe.algorithm, recipe.hyperparameters.policy)
        if not recipe.scenario.is_bandit
        or not why_idle(name, recipe.algorithm, recipe.hyperparameters, is_bandit=True)
    ]
    return (ALGORITHM, *sorted(names, key=lambda name: PARAMETERS[name].schedule))


def lane_changes(space: FiniteSpace, recipe: Recipe, name: str, value: float | str) -> tuple[Setting, ...]:
    """Return another run's changes. Raises UserError if they do not work or make no difference."""
    setting = SwitchAlgorithm(str(value)) if name == ALGORITHM else SetParameter(name, value)
    changes = settings_for(space, recipe, setting)
    if not difference(recipe, changed_recipe(recipe, *changes)):
        raise UserError("this changes nothing. Choose another value")
    return changes


def branches_beside(snapshot: Snapshot) -> dict[int, str]:
    """Describe the branches that can be opened beside."""
    timeline, is_bandit = snapshot.timeline, snapshot.world.is_bandit
    unit, here = "pull" if is_bandit else "step", timeline.current.journal
    pasts = [lane.past for lane in snapshot.run_group.lanes if lane.past is not None]
    there = [past.journal for past in pasts if past.begun == snapshot.recipe]
    return {
        number: f"{branch_in_words(branch.name, branch.journal, [here], unit)} · to {unit} {branch.end:,}"
        for number, branch in enumerate(timeline.branches)
        if number != timeline.branch and branch.journal not in there
    }


# The runs as a table


_LEAST_NAME: Final = 8
_LEAST_COLUMN: Final = 8
_STEP: Final = 10  # cells of a number of steps


class _Column(NamedTuple):
    head: str
    own: Sequence[str]
    of_seeds: Sequence[str]
    rank: int

    @property
    def cells(self) -> int:
        return max(_LEAST_COLUMN, *map(cell_len, (self.head, *self.own, *self.of_seeds)))


def _recent_of(lanes: Sequence[LaneView]) -> str:
    return recent_name(*(lane.episodes for lane in lanes if lane.results.return_last_100 is not None))


def _room(columns: Sequence[_Column], width: int) -> int:
    return max(0, width - sum(1 + column.cells for column in columns))


def _columns(
    lanes: Sequence[LaneView], study: SeedStudy | None, look: Look, *, hidden: bool
) -> list[_Column]:
    nothing = [""] * len(lanes)
    algorithms = [look.glyphs.spelled(algorithm_row(lane.algorithm).name) for lane in lanes]
    steps = [numbers.count(lane.step, _STEP) for lane in lanes]
    recent = [lane.results.return_last_100 for lane in lanes]
    greedy = [lane.results.greedy_return for lane in lanes]
    sizes = [abs(each) for each in (*recent, *greedy) if each is not None]
    decimals = decimals_for(max(sizes, default=0.0))

    def returns(values: Sequence[float | None]) -> list[str]:
        return [_dash(look) if x is None else amount(x, decimals, look.glyphs) for x in values]

    def of_seeds(figure: seed_figures.StudyFigure, *, secret: bool = False) -> list[str]:
        if study is None or secret:
            return nothing
        found = seed_figures.figure_decimals(figure, study)
        estimates = (lane.estimates.get(figure.id) for lane in study.lanes)
        return [
            look.glyphs.spelled(seed_figures.estimate_text(each, found, look.glyphs)) for each in estimates
        ]

    width = max(map(cell_len, ("algorithm", *algorithms)))
    columns = [
        _Column(f"{'algorithm':<{width}}", [f"{each:<{width}}" for each in algorithms], nothing, 9),
        _Column("step", steps, nothing, 7),
        _Column(_recent_of(lanes), returns(recent), of_seeds(seed_figures.LAST_100), 1),
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
            _Column("winnings", won, of_seeds(seed_figures.WINNINGS), 2),
            _Column("regret", lost, of_seeds(seed_figures.REGRET, secret=hidden), 3),
        ]
    exact = [_dash(look)] * len(lanes) if hidden else returns(greedy)
    ends = [None if hidden else lane.results.greedy_ends for lane in lanes]
    exact = [text if end is None else no_end(end) for text, end in zip(exact, ends, strict=True)]
    return [*columns, _Column("greedy", exact, of_seeds(seed_figures.GREEDY, secret=hidden), 5)]


def _dash(look: Look) -> str:
    return numbers.missing(look.glyphs)


# The setting in which another run differs


MOST_LANES: Final = 4
EXACT: Final = "w h"  # the keys that show hidden values


def setting_choice(recipe: Recipe, glyphs: Glyphs) -> SettingChoice:
    """Return the settings that can differ."""
    names = what_may_differ(recipe)[1:]
    return SettingChoice(
        "Another run that differs in", lambda: names, lambda: recipe, glyphs, another_run=True
    )


def branch_choice(branches: Mapping[int, str], glyphs: Glyphs) -> Choice:
    """Return the branches, the newest first."""
    rows = [Candidate(str(number), words) for number, words in sorted(branches.items(), reverse=True)]
    return Choice("A branch of this run beside it", rows, "", glyphs)


# The table of the runs


_PAIR: Final = 2
_CONTROL: Final = "control"
_BESIDE: Final = "beside"
_RETURNS: Final = "Undiscounted returns: mean of the {recent}, and the exact value for the greedy policy."
_HIDDEN: Final = f"Hidden until {EXACT}."
_MANY_SEEDS: Final = "Below each: mean ± standard error of many seeds."
Answer = ChooseLane | MarkLane | DropLane
"""The run to control, to show next to it, or to end."""


class RunTable(Form):
    """The runs, one controlled and maybe another in view."""

    least_room: ClassVar[int] = 90
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("delete,backspace", "end", "end run", id="compare.end", tooltip="End the run."),
        Binding("space", "mark", "beside", id="compare.mark", tooltip="Show the run beside yours."),
    ]

    def __init__(self, look: Look, snapshot: Snapshot) -> None:
        group, self._look = snapshot.run_group, look
        self._lanes, self._shown = group.lanes, group.shown
        self._hidden, self._study = hides_greedy(snapshot), current_study(snapshot)
        self._roles = [""] * len(self._lanes)
        self._roles[self._shown] = _CONTROL
        if group.beside is not None and len(self._lanes) > _PAIR:
            self._roles[group.beside] = _BESIDE
        more = "t m runs many" if snapshot.program is None else "rl-tui grade runs your program under many"
        secret = "The lesson hides it." if keeps_back(snapshot, "answer") else _HIDDEN
        self.about_lanes = [
            _RETURNS.format(recent=_recent_of(self._lanes)),
            f"One seed proves nothing: {more}." if self._study is None else _MANY_SEEDS,
            *([secret] if self._hidden else []),
        ]
        runs = (Candidate(str(number), lane.name) for number, lane in enumerate(self._lanes))
        keys = "space: beside   del: end" if len(self._lanes) > _PAIR else "del: end"
        super().__init__("Runs", (Candidate("", "run"), *runs), str(self._shown), look.glyphs, keys=keys)

    def describe(self, candidate: Candidate) -> Text:
        """Return a run's row, or the heading."""
        head, rows = self._rows(self.room - MARKS)
        if not candidate.id:
            return Text(f"{' ' * MARKS}{head}")
        own, of_seeds = rows[int(candidate.id)]
        text = Text.assemble(
            self.mark(candidate), (own, "bold" if candidate.id == self.current else "not bold")
        )
        return text.append(f"\n{' ' * MARKS}{of_seeds}", "not bold") if of_seeds else text

    def _rows(self, width: int) -> tuple[str, list[tuple[str, str]]]:
        lanes, study, look = self._lanes, self._study, self._look
        longest = max(map(cell_len, self._roles))
        roles = _Column("", [f"{each:<{longest}}" for each in self._roles], [""] * len(lanes), 8)
        columns = [*_columns(lanes, study, look, hidden=self._hidden), roles]
        while len(columns) > 1 and _room(columns, width) < _LEAST_NAME:
            columns.remove(max(columns, key=lambda column: column.rank))
        room = _room(columns, width)

        def row(name: str, texts: Sequence[str], skipped: int = 0) -> str:
            cells = [f" {text:>{column.cells}}" for text, column in zip(texts, columns, strict=True)]
            name_room = room + sum(map(cell_len, cells[:skipped]))
            name = shortened(name, name_room, look.glyphs.ellipsis)
            return f"{name:<{name_room}}{''.join(cells[skipped:])}"

        seeds, empty = "", sum(1 for _ in takewhile(lambda column: not any(column.of_seeds), columns))
        if study is not None:
            seeds = f"  {study.seeds} seeds"
            whole = f"{seeds}{seed_figures.until_of(study, [lane.episodes for lane in lanes])}"
            free = room + sum(1 + column.cells for column in columns[:empty])
            seeds = whole if cell_len(whole) <= free else seeds
        found = []
        for number, lane in enumerate(lanes):
            own = row(look.glyphs.spelled(lane.name), [column.own[number] for column in columns])
            below = row(seeds, [column.of_seeds[number] for column in columns], empty) if seeds else ""
            found.append((own, below))
        return row("run", [column.head for column in columns]), found

    def about(self, candidate: Candidate) -> str:
        """Describe how far to trust the numbers."""
        return self.glyphs.spelled("\n".join(self.about_lanes))

    def choose(self, id: str) -> None:  # noqa: A002
        """Answer the run to control."""
        self.dismiss(ChooseLane(int(id)))

    def action_end(self) -> None:
        """Answer the run to end."""
        self.dismiss(DropLane(int(self.at or 0)))

    def action_mark(self) -> None:
        """Answer the run to show too."""
        lane = int(self.at or 0)
        if len(self._lanes) <= _PAIR:
            self.tell_about("Not here: both runs are shown. A choice needs three or more.")
        elif lane == self._shown:
            self.tell_about("Not here: you control this one. Choose another to put beside it.")
        else:
            self.dismiss(MarkLane(lane))
