"""The runs side by side, and what may be different in another one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.lab.live.commands import ChooseLane, DropLane, MarkLane
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.timeline.lane_view import LaneView
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.curve.text import amount, decimals_for
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.dialogs.lane_changes import ALGORITHM, what_may_differ
from rl_tui.tui.screens.dialogs.options import in_force
from rl_tui.tui.theme.glyphs import ASCII
from rl_tui.tui.theme.look import Look

MOST_LANES: Final = 4
Answer = ChooseLane | MarkLane | DropLane | str
"""A lane to show, to have beside that or to end, or the name of what is to be different in another one."""

_PAIR: Final = 2
_MARK: Final = "+"
_LANE: Final = "lane-"
_WITH: Final = "with-"
_HINTS: Final = {
    "marked": "+ stands beside the one shown, and space chooses it",
    "lanes": "returns, undiscounted: mean of the last 100; exact one of the greedy policy",
    ALGORITHM: "another way to learn, or to plan",
}
_LEAST_NAME: Final = 8
_NUMBER: Final = 10
_LEAST_SYMBOL: Final = 12


class Compare(Dialog[Answer]):
    """A list of ``lanes``, at least one, of which ``shown`` is on screen; below it what else to compare with.

    ``beside`` is the one that stands beside it, None without one. ``recipe`` is what is in force in the one
    shown. Of a bandit that is ``hidden`` no greedy return is shown.
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
    ) -> None:
        super().__init__()
        self._look = look
        self._lanes = lanes
        self._shown = shown
        self._beside = beside
        self._recipe = recipe
        self._hidden = hidden

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
        hint = _HINTS["lanes"] if entry.startswith(_LANE) else _HINTS.get(name, "") or PARAMETERS[name].help
        if entry.startswith(_LANE) and len(self._lanes) > _PAIR:
            hint = f"{hint}. {_HINTS['marked']}"
        self.query_one(".hint", Static).update(to_ascii(hint, self._look.glyphs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the lane to show, or what is to be different."""
        entry = str(event.option_id)
        if entry.startswith(_LANE):
            self.dismiss(ChooseLane(int(entry.removeprefix(_LANE))))
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
        yield Option(self._head(), disabled=True)
        for number, lane in enumerate(self._lanes):
            yield Option(self._lane_row(number, lane), id=f"{_LANE}{number}")
        # Textual draws the line between the options itself, and not in ASCII
        yield None if self._look.glyphs is not ASCII else Option("", disabled=True)
        if len(self._lanes) >= MOST_LANES:
            yield Option("Four lanes are the most: end one to open another.", disabled=True)
            return
        yield Option("Another lane, the same but for", disabled=True)
        names = what_may_differ(self._recipe)
        columns = max(_LEAST_SYMBOL, *(len(self._symbol(name)) for name in names))
        for name in names:
            yield Option(self._entry(name, columns), id=f"{_WITH}{name}")

    def _head(self) -> Text:
        return Text(self._columns("", "lane", "algorithm", "step", "last 100", "greedy"))

    def _lane_row(self, number: int, lane: LaneView) -> Text:
        mark = self._look.glyphs.cursor if number == self._shown else ""
        if number == self._beside and len(self._lanes) > _PAIR:
            mark = _MARK
        greedy = None if self._hidden else lane.results.greedy_return
        text = self._columns(
            f"{mark:<1} {number + 1}",
            lane.name,
            BY_ID[lane.algorithm].name,
            numbers.count(lane.step, _NUMBER),
            self._figure(lane.results.return_last_100),
            self._figure(greedy),
        )
        return Text(text, "bold" if number == self._shown else "not bold")

    def _columns(self, mark: str, name: str, algorithm: str, step: str, mean: str, greedy: str) -> str:
        glyphs = self._look.glyphs
        algorithms = max(len(to_ascii(BY_ID[lane.algorithm].name, glyphs)) for lane in self._lanes)
        algorithms = max(algorithms, len("algorithm"))
        right = "".join(f" {each:>{_NUMBER}}" for each in (step, mean, greedy))
        room = self._room - len("> 1 ") - len(right)
        if room - 1 - algorithms >= _LEAST_NAME:  # else the name alone has to tell the lanes apart
            room -= 1 + algorithms
            right = f" {to_ascii(algorithm, glyphs):<{algorithms}}{right}"
        return f"{mark:<3} {shortened(to_ascii(name, glyphs), room, glyphs.ellipsis):<{room}}{right}"

    def _figure(self, value: float | None) -> str:
        if value is None:
            return "-" if self._look.glyphs.name == "ascii" else "–"
        known = [
            each
            for lane in self._lanes
            for each in (lane.results.return_last_100, lane.results.greedy_return)
        ]
        sizes = [abs(each) for each in known if each is not None]
        return amount(value, decimals_for(0.0, max(sizes)), self._look.glyphs)

    def _symbol(self, name: str) -> str:
        return name if name == ALGORITHM else to_ascii(PARAMETERS[name].symbol, self._look.glyphs)

    def _entry(self, name: str, columns: int) -> Text:
        values = self._recipe.hyperparameters
        now = BY_ID[self._recipe.algorithm].name if name == ALGORITHM else in_force(name, values)[0]
        glyphs = self._look.glyphs
        text = Text(f"  {self._symbol(name):<{columns}} ")
        return text.append(to_ascii(f"instead of {now}", glyphs))

    @property
    def _room(self) -> int:
        """The cells of a row: the box takes nine tenths of the screen, ninety at the most.

        Its border and padding take four of them, the bar to scroll with one.
        """
        return min(90, self.app.size.width * 9 // 10) - 5
