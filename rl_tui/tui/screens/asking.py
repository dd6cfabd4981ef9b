"""The words of the place that a person points at, with the mouse or with the focus."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from textual.geometry import Region
from textual.screen import Screen
from textual.widget import Widget

from rl_tui.tui.glossary.figure_text import FigureSetting
from rl_tui.tui.glossary.glossary import term_at, terms_called
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.row import PanelRow
from rl_tui.tui.panels.snapshot_facts import figure_setting
from rl_tui.tui.screens.glossary import NUMBER
from rl_tui.tui.screens.number_here import NumberHere, number_here
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.look import Look


def words_here(
    screen: Screen[None],
    rows: Mapping[str, PanelRow],
    glyphs: Glyphs,
    *,
    has_number: bool = False,
    is_number_first: bool = False,
) -> tuple[str, ...]:
    """Return the ids of the terms to explain, the one pointed at first; none where nothing is asked about.

    A word under the mouse comes before what is in focus, and brings those of its panel with it.
    ``has_number`` says that there is a number, ``NUMBER``, to ask about next; ``is_number_first`` that the
    mouse is on it. Then a word there comes behind it.
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
    """Return the number of the cell of world or table that the mouse is on, None where it is on none."""
    position = screen.app.mouse_position
    if not screen.region.contains_point(position):
        return None
    widget, _ = screen.get_widget_at(*position)
    if not widget.content_region.contains_point(position):
        return None
    return number_here(widget, look, position - widget.content_region.offset)


def setting_here(screen: Screen[None], glyphs: Glyphs) -> FigureSetting | None:
    """Return what is in force for the figures on ``screen``, None where it shows no run."""
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
