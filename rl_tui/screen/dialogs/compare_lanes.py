"""The dialog that compares runs (key c): choose a run, or add one that differs in one setting.

At most four runs are compared. After a study of many seeds, a second row below each run shows the mean
and the standard error.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, Final, NamedTuple

from rich.cells import cell_len
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.live.commands import AddBranch, ChooseLane, DropLane, MarkLane
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.lane_changes import ALGORITHM, what_may_differ
from rl_tui.screen.dialogs.options import in_force
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
from rl_tui.screen.theme.glyphs import ASCII
from rl_tui.screen.theme.look import Look
from rl_tui.studies.many_seeds.figures import SeedStudy

# The runs as a table


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


# The dialog


MOST_LANES: Final = 4
MOST_BRANCHES: Final = 4
Answer = ChooseLane | MarkLane | DropLane | AddBranch | str
"""A lane to show, to mark or to end, a branch as another one, or the name of what another has otherwise."""

_PAIR: Final = 2
_LANE: Final = "lane-"
_WITH: Final = "with-"
_BRANCH: Final = "branch-"
_HINTS: Final = {
    "marked": "+ stands beside the one shown, and space chooses it",
    "lanes": "returns, undiscounted: mean of the {recent}; exact one of the greedy policy",
    "branch": "this run as it went on that branch; each lane is changed by itself from now on",
    ALGORITHM: "another way to learn, or to plan",
}
INSTEAD_OF: Final = "instead of"
_ONE_SEED: Final = "One seed decides nothing"
_COUNTS: Final = ": M counts many."
_GRADES: Final = "; rl-tui grade runs your program under many."
_HIDDEN: Final = " –: hidden until h."
_KEPT: Final = " –: the lesson keeps it back."
_MANY_SEEDS: Final = "Below each: mean ± standard error of many seeds."
_LEAST_SYMBOL: Final = 12


class Compare(Dialog[Answer]):
    """A list of ``lanes``, at least one, of which ``shown`` is on screen; below it what else to compare with.

    ``beside`` is the one that stands beside it, None without one. ``recipe`` is what is in force in the one
    shown. Of a bandit that is ``hidden`` nothing exact is shown, where it ``is_kept`` no key shows it.
    ``study`` is what many seeds say of these lanes, None where that is not known. ``branches`` of the one
    shown can stand beside it, in words by their numbers: the last few are offered. ``is_program`` says that
    one of them is somebody's program.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("delete,backspace", "end", "end lane", id="compare.end", tooltip="End the run chosen."),
        Binding("space", "mark", "beside", id="compare.mark", tooltip="Have the run beside the one shown."),
    ]

    def __init__(
        self,
        look: Look,
        lanes: Sequence[LaneView],
        shown: int,
        recipe: Recipe,
        *,
        hidden: bool,
        beside: int | None = None,
        study: SeedStudy | None = None,
        branches: Mapping[int, str] | None = None,
        is_program: bool = False,
        is_kept: bool = False,
    ) -> None:
        super().__init__()
        self._look = look
        self._lanes = lanes
        self._shown = shown
        self._beside = beside
        self._recipe = recipe
        self._hidden = hidden
        self._is_kept = is_kept
        self._study = study
        self._branches = branches or {}
        self._one_seed = _ONE_SEED + (_GRADES if is_program else _COUNTS)

    def compose(self) -> ComposeResult:
        """Yield the list and the sentence about the entry under the cursor."""
        marks = "   space: beside" if len(self._lanes) > _PAIR else ""
        with self.box("Compare", f"enter: choose{marks}   del: end lane   esc: close"):
            yield OptionList()
            yield Static(classes="hint", markup=False)

    def on_mount(self) -> None:
        """Start on the run shown, or on what may be different where there is only one."""
        choices = self.query_one(OptionList)
        choices.set_options(self._options())
        start = f"{_LANE}{self._shown}" if len(self._lanes) > 1 else f"{_WITH}{ALGORITHM}"
        choices.highlighted = choices.get_option_index(start)
        choices.focus()

    def on_resize(self) -> None:
        """Fit the rows to the new width; the cursor stays."""
        choices = self.query_one(OptionList)
        at = choices.highlighted
        choices.set_options(self._options())
        choices.highlighted = at

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Describe the entry under the cursor."""
        entry = str(event.option_id)
        name = entry.removeprefix(_WITH)
        if entry.startswith(_LANE):
            hint = _HINTS["lanes"].format(recent=recent_of(self._lanes))
            if len(self._lanes) > _PAIR:
                hint = f"{hint}. {_HINTS['marked']}"
        elif entry.startswith(_BRANCH):
            hint = _HINTS["branch"]
        else:
            hint = _HINTS.get(name, "") or PARAMETERS[name].help
        self.query_one(".hint", Static).update(to_ascii(hint, self._look.glyphs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the lane to show, or what is to be different."""
        entry = str(event.option_id)
        if entry.startswith(_LANE):
            self.dismiss(ChooseLane(int(entry.removeprefix(_LANE))))
        elif entry.startswith(_BRANCH):
            self.dismiss(AddBranch(int(entry.removeprefix(_BRANCH))))
        else:
            self.dismiss(entry.removeprefix(_WITH))

    def action_end(self) -> None:
        """Answer the lane to end."""
        option = self.query_one(OptionList).highlighted_option
        if option is None or not str(option.id).startswith(_LANE):
            return
        if len(self._lanes) > 1:
            self.dismiss(DropLane(int(str(option.id).removeprefix(_LANE))))
        else:
            self.notify("the only run cannot be ended; esc leaves it")

    def action_mark(self) -> None:
        """Answer the lane to have beside the one shown."""
        option = self.query_one(OptionList).highlighted_option
        if option is None or not str(option.id).startswith(_LANE):
            return
        lane = int(str(option.id).removeprefix(_LANE))
        if len(self._lanes) <= _PAIR:
            self.notify("of three or four lanes one is chosen to stand beside the one shown")
        elif lane == self._shown:
            self.notify("this one is shown; choose another to stand beside it")
        else:
            self.dismiss(MarkLane(lane))

    def _options(self) -> Iterator[Option | None]:
        yield from self._lane_options()
        # Textual draws the line between the options itself, and not in ASCII
        yield None if self._look.glyphs is not ASCII else Option("", disabled=True)
        if len(self._lanes) >= MOST_LANES:
            yield Option("Four lanes are the most: end one to open another.", disabled=True)
            return
        yield from self._branch_rows()
        yield Option("Another lane, the same but for", disabled=True)
        names = what_may_differ(self._recipe)
        columns = max(_LEAST_SYMBOL, *(len(self._symbol(name)) for name in names))
        for name in names:
            yield Option(self._entry(name, columns), id=f"{_WITH}{name}")

    def _branch_rows(self) -> Iterator[Option]:
        if not self._branches:
            return
        yield Option("Another lane, a branch of this run", disabled=True)
        glyphs, room = self._look.glyphs, self._room - 2
        for number in list(self._branches)[-MOST_BRANCHES:]:
            words = to_ascii(self._branches[number], glyphs)
            yield Option(Text(f"  {shortened(words, room, glyphs.ellipsis)}"), id=f"{_BRANCH}{number}")
        more = len(self._branches) - MOST_BRANCHES
        if more > 0:
            yield Option(f"  {more:,} more: j lists them", disabled=True)

    def _lane_options(self) -> Iterator[Option]:
        """Yield a heading, the lanes, and how far to trust their figures."""
        head, rows = lane_rows(
            self._lanes,
            self._shown,
            self._study,
            self._look,
            self._room,
            hidden=self._hidden,
            marked=self._beside if len(self._lanes) > _PAIR else None,
        )
        yield Option(head, disabled=True)
        for number, row in enumerate(rows):
            text = Text(row.own, "bold" if number == self._shown else "not bold")
            if row.of_seeds:
                text.append(f"\n{row.of_seeds}", "not bold")
            yield Option(text, id=f"{_LANE}{number}")
        if len(rows) > 1 or self._study is not None:
            said = self._one_seed if self._study is None else _MANY_SEEDS
            hidden = _KEPT if self._is_kept else _HIDDEN
            if self._hidden and len(said) + len(hidden) <= self._room:
                said += hidden
            yield Option(to_ascii(said, self._look.glyphs), disabled=True)

    def _symbol(self, name: str) -> str:
        return name if name == ALGORITHM else to_ascii(PARAMETERS[name].symbol, self._look.glyphs)

    def _entry(self, name: str, columns: int) -> Text:
        values = self._recipe.hyperparameters
        now = algorithm_row(self._recipe.algorithm).name if name == ALGORITHM else in_force(name, values)[0]
        glyphs = self._look.glyphs
        text = Text(f"  {self._symbol(name):<{columns}} ")
        return text.append(to_ascii(f"{INSTEAD_OF} {now}", glyphs))

    @property
    def _room(self) -> int:
        """The cells of a row: the box takes nine tenths of the screen, ninety at the most.

        Its border and padding take four of them, the bar to scroll with one.
        """
        return min(90, self.app.size.width * 9 // 10) - 5
