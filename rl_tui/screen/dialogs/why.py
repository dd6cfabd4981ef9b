"""The dialog "why is nothing learned"."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import ClassVar, Final

from rich.cells import cell_len
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.exact.first_update import Remedy
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers import first_update_words
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.precision import magnitude
from rl_tui.screen.kit.bindings import RowList, as_sentence
from rl_tui.screen.kit.snapshot_facts import ANSWER_KEPT, hides_means, keeps_back
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

_EXPONENT_BELOW: Final = 1e-3
_COLUMNS: Final = (13, 11, 16, 9)  # remedy, chance, mean and median
EXACT: Final = "w h"
_SECRET: Final = f"Hidden: it would reveal the arms. {EXACT} shows both."
_KEPT: Final = f"Hidden: it would reveal the arms ({ANSWER_KEPT})."
_IS_OVER: Final = "The agent has begun to learn: an estimate has changed."
_STARTS_AGAIN: Final = "the run starts again with this change"
_CHANGES: Final = "enter: change   "
_CLOSES: Final = "esc: close"
_HEAD: Final = ("change", "chance", "episodes: mean", "median")


class Why(Dialog[Remedy]):
    """The first update. The answer is a remedy."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("Y,q", "cancel", "back", id="close_why", tooltip="Close without a change."),
    ]

    def __init__(self, look: Look, snapshot: Snapshot) -> None:
        super().__init__()
        self._look = look
        self._snapshot = snapshot
        self._remedies: dict[str, Remedy] = {}

    def compose(self) -> ComposeResult:
        """Yield text, remedies, and a sentence."""
        with self.box("Why is nothing learned?", _CLOSES):
            yield Static(id="said", markup=False)
            yield Static(self._row(_HEAD), classes="hint", id="head", markup=False)
            yield RowList()
            yield Static(classes="hint", id="about", markup=False)

    def on_mount(self) -> None:
        """Show the current snapshot."""
        self.show(self._snapshot)

    def show(self, snapshot: Snapshot) -> None:
        """Show text and remedies."""
        self._snapshot = snapshot
        if not self.query("#said"):
            return  # it is not composed yet
        is_hidden = hides_means(snapshot)
        sentences = _said_in_secret(snapshot) if is_hidden else said(snapshot, self._look.glyphs)
        words = "\n".join(sentences)
        self.query_one("#said", Static).update(self._look.glyphs.spelled(words))
        remedies = {} if is_hidden else {remedy.setting: remedy for remedy in remedies_of(snapshot)}
        for part in ("#head", "OptionList", "#about"):
            self.query_one(part).display = bool(remedies)
        self.query_one("#box").border_subtitle = f"{_CHANGES if remedies else ''}{_CLOSES}"
        if remedies != self._remedies:
            self._remedies = remedies
            choices = self.query_one(OptionList)
            choices.set_options(
                Option(self._row(_cells(each, self._look.glyphs)), id=setting)
                for setting, each in remedies.items()
            )
            choices.highlighted = 0 if remedies else None
            choices.focus()  # a hidden list has lost it

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Describe the setting under the cursor."""
        parameter = PARAMETERS[str(event.option_id)]
        # one line each, so that the box keeps its size
        is_initial = parameter.name == "initial_q"
        about = _STARTS_AGAIN if is_initial else parameter.help.partition(";")[0]
        self.query_one("#about", Static).update(self._look.glyphs.spelled(about))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the remedy under the cursor."""
        remedy = self._remedies.get(str(event.option_id))
        if remedy is not None:  # None: an update came in between
            self.dismiss(remedy)

    def _row(self, cells: Iterable[str]) -> str:
        first, *figures = (self._look.glyphs.spelled(cell) for cell in cells)
        name, *widths = _COLUMNS
        aligned = [f"{text:>{width}}" for text, width in zip(figures, widths, strict=True)]
        return "".join((first, " " * (name - cell_len(first)), *aligned))


def remedies_of(snapshot: Snapshot) -> tuple[Remedy, ...]:
    """Return remedies, none after an estimate has changed."""
    view = snapshot.answers.first_update
    return () if view is None or view.answer is None or view.has_moved else view.answer.remedies


def said(snapshot: Snapshot, glyphs: Glyphs) -> list[str]:
    """Describe the first update."""
    view = snapshot.answers.first_update
    if view is None:
        return ["Computing in the background …"]
    episodes = snapshot.counters.episodes
    since = f" in {counted(episodes, 'episode')}" if episodes else ""
    lines = [_IS_OVER if view.has_moved else f"No estimate has changed{since}.", ""]
    if view.answer is None:
        return [*lines, "The wait is unknown.", as_sentence(view.refused)]
    in_words = partial(written, glyphs=glyphs)
    wait = first_update_words.wait_in_words(view.answer.wait, in_words)
    if view.has_moved:
        return [*lines, f"With the current settings, from the start: {wait}."]
    settings, time_limit = snapshot.agent.hyperparameters, snapshot.world.space.time_limit
    cause = first_update_words.cause_in_words(view.answer, settings, time_limit, in_words)
    lines.append(as_sentence(wait))
    if cause:
        lines += ["", f"Why: {cause}."]
    return [*lines, ""] if view.answer.remedies else lines


def _said_in_secret(snapshot: Snapshot) -> list[str]:
    view = snapshot.answers.first_update
    if view is not None and view.has_moved:
        return [_IS_OVER]
    return [_KEPT if keeps_back(snapshot, "answer") else _SECRET]


def written(number: float, glyphs: Glyphs) -> str:
    """Write three digits: ``.1``, ``.0139``, ``5.42e-6``, ``>.999``."""
    if 0.9995 <= number < 1.0:
        return ">.999"
    is_small = 0.0 < abs(number) < _EXPONENT_BELOW
    decimals = numbers.DECIMALS if is_small else max(0, 2 - magnitude(number))
    return numbers.brief(number, glyphs, decimals=decimals)


def _cells(remedy: Remedy, glyphs: Glyphs) -> tuple[str, str, str, str]:
    wait = remedy.wait
    assert wait.mean_episodes is not None
    assert wait.median_episodes is not None
    return (
        first_update_words.setting_in_words(remedy.setting, remedy.value, partial(written, glyphs=glyphs)),
        written(wait.chance, glyphs),
        first_update_words.episodes_in_words(wait.mean_episodes),
        first_update_words.episodes_in_words(wait.median_episodes),
    )
