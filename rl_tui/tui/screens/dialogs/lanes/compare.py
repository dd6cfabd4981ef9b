"""The runs side by side, and what may be different in another one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, Final

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.lab.live.commands import AddBranch, ChooseLane, DropLane, MarkLane
from rl_tui.lab.many_seeds.figures import SeedStudy
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.timeline.lane_view import LaneView
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.dialogs.lanes.changes import ALGORITHM, what_may_differ
from rl_tui.tui.screens.dialogs.lanes.table import lane_rows, recent_of
from rl_tui.tui.screens.dialogs.options import in_force
from rl_tui.tui.theme.glyphs import ASCII
from rl_tui.tui.theme.look import Look

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
