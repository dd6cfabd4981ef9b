"""The glossary: first the words at the mouse or focus."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, ClassVar, Final

from rich.cells import cell_len
from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.geometry import Offset, Region
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw import numbers
from rl_tui.screen.frame.key_sheet import FIND, KEYS, PAGES, WORDS, KeySheet, tabs
from rl_tui.screen.frame.number_here import NumberHere, number_here
from rl_tui.screen.glossary.glossary import (
    BOOK,
    FigureSetting,
    GlossaryTerm,
    figure_text,
    glossary,
    search,
    term_at,
    terms_called,
)
from rl_tui.screen.kit.bindings import ListInput
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.row import PanelRow, beside
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.screen.frame.action_screen import ActionScreen

# The screen


NUMBER: Final = "number under the cursor"  # takes the place of a term's id
_LONGEST_LINE: Final = 44  # cells of a word and its other names in the list
_LONGEST: Final = 40  # characters of a search


class GlossarySearch(ListInput):
    """A search field without ``?`` and page keys."""

    def check_consume_key(self, key: str, character: str | None) -> bool:
        """Return True if typed here, False for the question mark."""
        return key != "question_mark" and super().check_consume_key(key, character)

    def action_move(self, how: str) -> None:
        """Go to another word, or scroll."""
        of_list = how.startswith("cursor")
        getattr(self.screen.query_one("#words" if of_list else "#paragraph"), f"action_{how}")()


class GlossaryScreen(Dialog[str]):
    """The terms ``here``, or all, and ``number`` at ``NUMBER``.

    ``setting``: current values of the run. The answer is ``PAGES`` if the person asks for the pages.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "question_mark", "pages", "pages", id="glossary.pages", tooltip="Go to the pages.", priority=True
        ),
    ]

    def __init__(
        self,
        look: Look,
        here: Sequence[str] = (),
        number: NumberHere | None = None,
        setting: FigureSetting | None = None,
    ) -> None:
        super().__init__()
        self._look = look
        self._written = look.glyphs.spelled
        self._here = tuple(here)
        self._number = number
        self._setting = setting

    def compose(self) -> ComposeResult:
        """Yield search, list and paragraph."""
        keys = self._written("↑ ↓: word  pgdn: more  ?: pages  esc: close")
        with self.box("", keys, "whole") as box:
            box.border_title = tabs("Words")
            yield GlossarySearch(
                placeholder="type to search all words", compact=True, max_length=_LONGEST, id="search"
            )
            yield OptionList(id="words")
            with VerticalScroll(can_focus=False, id="paragraph"):
                yield Static(markup=False)

    def on_mount(self) -> None:
        """List the words, and send letters to the search."""
        words = self.query_one(OptionList)
        words.can_focus = False
        self._list(self._here or tuple(glossary()))
        self.query_one(Input).focus()

    @on(Input.Changed)
    def find(self, event: Input.Changed) -> None:
        """List the matches, or the place's words."""
        self._list(search(event.value) if event.value else self._here or tuple(glossary()))

    @on(OptionList.OptionHighlighted)
    def explain(self, event: OptionList.OptionHighlighted) -> None:
        """Show the word's paragraph."""
        if event.option_id == NUMBER and self._number is not None:
            number = self._number
            text = Text(self._written(f"{number.meaning}\n\n"))
            self._show(text.append(self._figure(glossary()[number.term])))
        elif event.option_id is not None:
            self._show(self._paragraph(glossary()[event.option_id]))

    def action_pages(self) -> None:
        """Close with the answer ``PAGES``."""
        self.dismiss(PAGES)

    def _list(self, ids: Sequence[str]) -> None:
        words = self.query_one(OptionList)
        words.clear_options()
        words.add_options(Option(self._line(each), id=each) for each in ids)
        if ids:
            words.highlighted = 0
        else:
            self._show(Text("nothing found"))

    def _line(self, id_: str) -> Text:
        if id_ == NUMBER and self._number is not None:
            return Text(self._written(self._number.name), "bold").append("  here", "not bold dim")
        term = glossary()[id_]
        word, others = self._written(term.word), ""
        for name in term.also:
            longer = f"{others}, {self._written(name)}" if others else f"  {self._written(name)}"
            if name in term.word or cell_len(word + longer) > _LONGEST_LINE:
                continue
            others = longer
        return Text(word, "bold").append(others, "not bold dim")

    def _paragraph(self, term: GlossaryTerm) -> Text:
        book = term.book if term.is_elsewhere else f"{BOOK}, {term.book}"
        text = Text(self._written(f"{term.text}\n\n"))
        text.append(self._written(f"    {term.equation}\n\n"), "bold")
        text.append(self._figure(term))
        return text.append(self._written(book), "italic")

    def _figure(self, term: GlossaryTerm) -> str:
        if term.figure is None:
            return ""
        return self._written(self._look.glyphs.separated(f"{figure_text(term.figure, self._setting)}\n\n"))

    def _show(self, text: Text) -> None:
        self.query_one("#paragraph", VerticalScroll).scroll_home(animate=False)
        self.query_one(Static).update(text)


# What the person points at


def _setting_here(screen: Screen[None], glyphs: Glyphs) -> FigureSetting | None:
    shown = (panel.snapshot for panel in screen.query(Panel) if panel.snapshot is not None)
    snapshot = next(shown, None)
    if snapshot is None:
        return None
    return FigureSetting(
        gamma=numbers.brief(snapshot.agent.hyperparameters.gamma, glyphs),
        time_limit=snapshot.world.space.time_limit,
        steps=snapshot.counters.step,
        episodes=snapshot.counters.episodes,
        is_bandit=snapshot.world.is_bandit,
        budget=snapshot.world.budget,
    )


def _under_mouse(screen: Screen[None]) -> Widget | None:
    position = screen.app.mouse_position
    widget = screen.get_widget_at(*position)[0] if screen.region.contains_point(position) else screen
    return None if widget is screen else widget


def _number_at(widget: Widget, position: Offset, look: Look) -> NumberHere | None:
    is_inside = widget.content_region.contains_point(position)
    return number_here(widget, look, position - widget.content_region.offset) if is_inside else None


def _word_at(widget: Widget, position: Offset, glyphs: Glyphs) -> str | None:
    column, row = position - widget.region.offset
    lines = widget.render_lines(Region(0, row, widget.region.width, 1))
    about = [term for panel in _panels_of(widget) for term in panel.terms] or None
    return term_at(lines[0].text, column, glyphs, about) if lines else None


def _words_of(widget: Widget) -> Iterator[str]:
    if isinstance(widget, Slider):
        yield from terms_called([widget.parameter.symbol])
    for panel in _panels_of(widget):
        yield from panel.terms


def _panels_of(widget: Widget) -> Iterator[PanelRow]:
    ids = [node.id for node in widget.ancestors_with_self]
    return (row for row in PANELS if row.id in ids or beside(row.id) in ids)


class HelpPages:
    """The pages of ``?`` about ``screen``."""

    def __init__(self, screen: ActionScreen) -> None:
        self._screen = screen

    @property
    def _is_pointing(self) -> bool:
        return bool(self._screen.app.mouse_position != self._screen.mouse_at_key)

    def open(self) -> None:
        """Show the keys, or explain what the mouse was moved to."""
        words, number = self._words_here() if self._is_pointing else ((), None)
        if words:
            self.show_words(words, number)
        else:
            self._show_keys()

    def _show_keys(self) -> None:
        screen, focused = self._screen, self._screen.focused
        name = "" if focused is None else next((row.title for row in _panels_of(focused)), "")
        screen.app.push_screen(KeySheet(screen.look, screen.actions, focused, name), self._turn)

    def show_words(self, here: Sequence[str], number: NumberHere | None = None) -> None:
        """Show the terms ``here``, or all, and ``number`` at ``NUMBER``."""
        screen = self._screen
        setting = _setting_here(screen, screen.look.glyphs)
        screen.app.push_screen(GlossaryScreen(screen.look, here, number, setting), self._turn)

    def _turn(self, page: str | None) -> None:
        if page == KEYS:
            self._show_keys()
        elif page == WORDS:
            self.show_words(*self._words_here())
        elif page == PAGES:
            self._screen.app.push_screen(self._screen.help_screen(), self._turn)
        elif page == FIND:
            self._screen.call_later(self._screen.app.run_action, "find")

    def _words_here(self) -> tuple[Sequence[str], NumberHere | None]:
        """Return first what is under the mouse, then what is in focus, and the number, if any."""
        screen, look, position = self._screen, self._screen.look, self._screen.app.mouse_position
        under_mouse, number, word = _under_mouse(screen), None, None
        if under_mouse is not None:
            word = _word_at(under_mouse, position, look.glyphs)
            if self._is_pointing or screen.focused is None:
                number = _number_at(under_mouse, position, look)
        found = [NUMBER] if number is not None else []
        found += [word] if word is not None else []
        widgets = (under_mouse if found else None, screen.focused)
        if number is None and (number := number_here(screen.focused, look)) is not None:
            found.append(NUMBER)
        for widget in widgets:
            found += () if widget is None else _words_of(widget)
        return tuple(dict.fromkeys(found)), number
