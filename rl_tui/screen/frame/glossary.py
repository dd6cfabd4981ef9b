"""The glossary screen: words at the mouse or the focus, then all others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Final

from rich.cells import cell_len
from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.geometry import Region
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw.to_ascii import separated, to_ascii
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
from rl_tui.screen.kit.snapshot_facts import figure_setting
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
    """A search field without the question mark and page keys."""

    def check_consume_key(self, key: str, character: str | None) -> bool:
        """Return True if ``key`` is typed here, False for the question mark."""
        return key != "question_mark" and super().check_consume_key(key, character)

    def action_move(self, how: str) -> None:
        """Go to another word of the list, or scroll its paragraph."""
        of_list = how.startswith("cursor")
        getattr(self.screen.query_one("#words" if of_list else "#paragraph"), f"action_{how}")()


class GlossaryScreen(Dialog[str]):
    """The terms ``here``, or all. ``NUMBER`` among them stands for ``number``.

    ``setting`` fills in the current values of the run. The answer is ``PAGES`` if the person asks for the
    pages.
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
        self._here = tuple(here)
        self._number = number
        self._setting = setting

    def compose(self) -> ComposeResult:
        """Yield the search, the list and the paragraph."""
        keys = self._written("↑ ↓: word  pgdn: more  ?: pages  esc: close")
        with self.box("", keys, "tall") as box:
            box.border_title = tabs("Words")
            yield GlossarySearch(
                placeholder="type to search all words", compact=True, max_length=_LONGEST, id="search"
            )
            yield OptionList(id="words")
            with VerticalScroll(can_focus=False, id="paragraph"):
                yield Static(markup=False)

    def on_mount(self) -> None:
        """List the words of the place, and send letters to the search."""
        words = self.query_one(OptionList)
        words.can_focus = False
        self._list(self._here or tuple(glossary()))
        self.query_one(Input).focus()

    @on(Input.Changed)
    def find(self, event: Input.Changed) -> None:
        """List the matches, or the words of the place without a query."""
        self._list(search(event.value) if event.value else self._here or tuple(glossary()))

    @on(OptionList.OptionHighlighted)
    def explain(self, event: OptionList.OptionHighlighted) -> None:
        """Show the paragraph of the word under the cursor."""
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
        return self._written(separated(f"{figure_text(term.figure, self._setting)}\n\n", self._look.glyphs))

    def _show(self, text: Text) -> None:
        self.query_one("#paragraph", VerticalScroll).scroll_home(animate=False)
        self.query_one(Static).update(text)

    def _written(self, text: str) -> str:
        return to_ascii(text, self._look.glyphs)


# What the person points at


def words_here(
    screen: Screen[None],
    rows: Mapping[str, PanelRow],
    glyphs: Glyphs,
    *,
    has_number: bool = False,
    is_number_first: bool = False,
) -> tuple[str, ...]:
    """Return the ids of the terms to explain, the one pointed at first.

    A word under the mouse comes before the words in focus. ``has_number`` adds ``NUMBER``, before the word if
    ``is_number_first``.
    """
    under_mouse, word = _word_under_mouse(screen, rows, glyphs)
    found = [word] if word is not None else []
    if has_number:
        found.insert(0 if is_number_first else len(found), NUMBER)
    for widget in (under_mouse if word is not None or is_number_first else None, screen.focused):
        if widget is not None:
            found += _words_of(widget, rows)
    return tuple(dict.fromkeys(found))


def number_under_mouse(screen: Screen[None], look: Look) -> NumberHere | None:
    """Return the number of the cell under the mouse, or None."""
    position = screen.app.mouse_position
    if not screen.region.contains_point(position):
        return None
    widget, _ = screen.get_widget_at(*position)
    if not widget.content_region.contains_point(position):
        return None
    return number_here(widget, look, position - widget.content_region.offset)


def setting_here(screen: Screen[None], glyphs: Glyphs) -> FigureSetting | None:
    """Return the current values of the run on ``screen``, or None."""
    shown = (panel.snapshot for panel in screen.query(Panel) if panel.snapshot is not None)
    snapshot = next(shown, None)
    return None if snapshot is None else figure_setting(snapshot, glyphs)


def _word_under_mouse(
    screen: Screen[None], rows: Mapping[str, PanelRow], glyphs: Glyphs
) -> tuple[Widget | None, str | None]:
    position = screen.app.mouse_position
    if not screen.region.contains_point(position):
        return None, None
    widget, region = screen.get_widget_at(*position)
    if widget is screen:
        return None, None
    column, row = position.x - region.x, position.y - region.y
    lines = widget.render_lines(Region(0, row, region.width, 1))
    about = [term for panel in _panels_of(widget, rows) for term in panel.terms] or None
    return (widget, term_at(lines[0].text, column, glyphs, about)) if lines else (widget, None)


def _words_of(widget: Widget, rows: Mapping[str, PanelRow]) -> Iterator[str]:
    if isinstance(widget, Slider):
        yield from terms_called([widget.parameter.symbol])
    for panel in _panels_of(widget, rows):
        yield from panel.terms


def _panels_of(widget: Widget, rows: Mapping[str, PanelRow]) -> Iterator[PanelRow]:
    for node in widget.ancestors_with_self:
        if node.id is not None and node.id in rows:
            yield rows[node.id]


# The pages of ?


class HelpPages:
    """The pages about ``screen``, one after the other with each ``?``."""

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
        titles = {name: row.title for row in screen.panel_rows for name in (row.id, beside(row.id))}
        nodes = () if focused is None else focused.ancestors_with_self
        name = next((titles[node.id] for node in nodes if node.id in titles), "")
        screen.app.push_screen(KeySheet(screen.look, screen.actions, focused, name), self._turn)

    def show_words(self, here: Sequence[str], number: NumberHere | None = None) -> None:
        """Show the terms ``here``, or all. ``NUMBER`` among them stands for ``number``."""
        screen = self._screen
        setting = setting_here(screen, screen.look.glyphs)
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
        screen, look = self._screen, self._screen.look
        rows = {name: row for row in screen.panel_rows for name in (row.id, beside(row.id))}
        pointed = number_under_mouse(screen, look) if self._is_pointing or screen.focused is None else None
        number = pointed or number_here(screen.focused, look)
        words = words_here(
            screen,
            rows,
            look.glyphs,
            has_number=number is not None,
            is_number_first=pointed is not None,
        )
        return words, number
