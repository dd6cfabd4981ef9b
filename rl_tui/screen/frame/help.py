"""The pages of ``?``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING, ClassVar, Final

from rich.text import Text
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.widgets import Static

from rl_tui.screen.frame.key_sheet import FIND, KEYS, WORDS, HelpPage
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from textual.widgets import Markdown

_LEFT: Final = 14  # columns
_ASKING: Final = (
    "Point with the mouse at a word and press ?, or give a panel or slider the focus with tab and press ? "
    "twice. You get meaning, equation and place in Sutton and Barto. / finds any word. Return always means "
    "the plain sum of the rewards of an episode. With γ it is called discounted return, or value."
)
_HIDING: Final = "m l hides or shows the legends of panels."
_TOPICS: Final = (
    (
        "Two runs",
        "c a opens a second run with another algorithm, and with the same scenario and seed. Up to four runs "
        "advance together, step by step, and share one chart. World and table of two runs are side by side "
        "if they fit. ▸ marks the run that you control. c l controls the next run.",
    ),
    (
        "Rewards",
        "A cell with an unusual reward shows this reward in its corner: the number, or only + if it is above "
        "the usual reward and − if it is below.",
    ),
    (
        "Planners",
        "Value iteration and policy iteration take no steps: they read the transition table. s updates "
        "one state, e runs a sweep over all states, and space runs and pauses. The curve has only the exact "
        "return of the greedy policy. A planner is done when no value changes any more. Change γ, and it "
        "continues.",
    ),
    (
        "Simulated",
        "An environment without a transition table can only be simulated. Its exact values are unknown, "
        "so Q*, the error, the optimal return and planners are missing. Everything else is the same.",
    ),
    (
        "Breakpoints",
        "t b sets a breakpoint at the cursor: on a state of the world, a pair of the table, or an arm. ! "
        "marks it, and the run pauses there each time. u lists all breakpoints, and other moments to "
        "stop at.",
    ),
    (
        "You",
        "y makes you the agent. An arrow key takes the action of its direction. A digit takes the action "
        "that has this number on the border of the world. The agent learns from your steps as from its own. "
        "s lets the agent take one step. y or esc gives control back.",
    ),
    (
        "Focus",
        "tab and shift+tab go from panel to panel. Arrows move the cursor of world and table, which "
        "scroll with it. f shows only the panel in focus.",
    ),
)


class HelpScreen(HelpPage):
    """The page of all explanations, ``notes`` last."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("question_mark,q", "cancel", "back", id="close_help", tooltip="Close the pages."),
        Binding("1,tab", f"dismiss('{KEYS}')", "keys", id="help.keys", tooltip="Go to the keys."),
        Binding("2", f"dismiss('{WORDS}')", "words", id="help.words", tooltip="Go to words."),
        Binding("slash", f"dismiss('{FIND}')", "find", id="help.find", tooltip="Find anything by its name."),
    ]

    def __init__(
        self,
        look: Look,
        panels: Sequence[PanelRow] = (),
        notes: str = "",
        topics: Sequence[tuple[str, str]] = (),
    ) -> None:
        super().__init__(look, "Pages", "1: keys   2: words   /: find   esc: close")
        self._panels = panels
        self._topics = topics
        self._notes = notes

    def on_mount(self) -> None:
        """Add the notes when the page is scrolled, or has room."""
        if self._notes:
            self.watch(self.query_one(VerticalScroll), "scroll_y", self._add_notes, init=False)
            self.call_after_refresh(self._fill)

    async def _fill(self) -> None:
        page = self.query_one(VerticalScroll)
        if page.is_attached and not page.max_scroll_y:  # nothing to scroll, so the notes fit
            await self._add_notes()

    async def _add_notes(self) -> None:
        """Put the notes at the end late, because Markdown is slow to load."""
        if not self._notes:
            return
        notes, self._notes = _notes_markdown(self._notes, self._look.glyphs), ""
        page = self.query_one(VerticalScroll)
        # Stay at the beginning of a page that was not scrolled to its end
        to_end = 0 < page.max_scroll_y <= page.scroll_target_y
        await page.mount(Static(Text("\nNotes", "bold")), notes)
        if to_end:
            self.call_after_refresh(page.scroll_end, animate=False)

    def _lines(self, width: int) -> list[Text]:
        lines, spelled, room = list[Text](), self._look.glyphs.spelled, max(1, width - _LEFT)
        for term, meaning in self._explanations():
            name = Text.assemble((spelled(term).ljust(_LEFT), "" if meaning else "bold"))
            for words in wrap(spelled(meaning), room, break_on_hyphens=False) or [""]:
                lines.append(name.append(words.ljust(room)))
                name = Text(" " * _LEFT)
        return lines

    def _explanations(self) -> Iterator[tuple[str, str]]:
        yield "Words", ""
        yield "  ?", f"{_ASKING} {_HIDING}" if self._panels else _ASKING
        for title, sentences in self._topics:
            yield f"  {title}", sentences
        yield "", ""
        if self._panels:
            yield "Panels", ""
            for title, sentences in (*((row.title, row.help) for row in self._panels), *_TOPICS):
                yield f"  {title}", sentences
            yield "", ""


def _notes_markdown(markdown: str, glyphs: Glyphs) -> Markdown:
    from textual.widgets import Markdown  # slow to load: must not delay the first paint

    widget = Markdown(glyphs.spelled(markdown), open_links=True)
    if glyphs.name == "ascii":
        widget.BULLETS = ["* "]
    return widget
