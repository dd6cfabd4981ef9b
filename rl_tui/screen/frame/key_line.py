"""As many keys as fit, in the bottom line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.cells import cell_len
from rich.segment import Segment
from textual import events
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.screen.keys.action import MENUS, Action
from rl_tui.screen.kit.bindings import key_of_hint
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

_GAPS = (3, 2)
_EDGE = 1  # column at either end

Hints = tuple[tuple[str, str], ...]
"""Pairs of a key and its label."""


def fitting(actions: Sequence[Action], width: int, glyphs: Glyphs) -> tuple[tuple[Action, ...], int]:
    """Return the actions whose hints fit, and the gap between hints.

    Hints of the highest rank are dropped first. The lowest one (help) always comes last.
    """
    ranked = sorted((a for a in actions if a.rank is not None), key=lambda a: a.rank or 0)
    wide, narrow = (_as_many_as_fit(ranked, width, gap, glyphs) for gap in _GAPS)
    shown, gap = (wide, _GAPS[0]) if len(wide) == len(narrow) else (narrow, _GAPS[1])
    last, *others = shown
    return (*sorted(others, key=actions.index), last), gap


def _as_many_as_fit(ranked: Sequence[Action], width: int, gap: int, glyphs: Glyphs) -> tuple[Action, ...]:
    shown: list[Action] = []
    used = 2 * _EDGE
    for action in ranked:
        used += _columns(action, glyphs, gap) + (gap if shown else 0)
        if used > width and shown:
            break
        shown.append(action)
    return tuple(shown)


def _columns(action: Action, glyphs: Glyphs, gap: int) -> int:
    """Return the columns of a hint, which keep later hints in place.

    A longer label while the run goes on takes all but one blank of the gap.
    """
    keys, label = action.key_hint
    usual, running = (cell_len(glyphs.spelled(word)) for word in (label, action.while_running))
    return cell_len(glyphs.spelled(keys)) + 1 + max(usual, running + 1 - gap)


def _line_columns(hints: Sequence[tuple[str, str]], gap: int, glyphs: Glyphs) -> int:
    texts = [glyphs.spelled(f"{keys} {label}".strip()) for keys, label in hints]
    return 1 + sum(map(cell_len, texts)) + gap * (len(texts) - 1)


class KeyLine(Widget):
    """The key hints of ``actions``, or of a mode in ``hints``. A click runs the action.

    ``first``: forms of a hint for the focus. ``idle``: ids to leave out. Without ``names_all`` only a
    beginner's actions are shown.
    """

    hints: reactive[Hints] = reactive(())
    first: reactive[tuple[Hints, ...]] = reactive(())
    is_running: reactive[bool] = reactive(False)
    names_all: reactive[bool] = reactive(True)
    idle: reactive[frozenset[str]] = reactive(frozenset())

    def __init__(self, look: Look, actions: Sequence[Action], *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self.look = look
        self._actions = actions

    def render_line(self, y: int) -> Strip:
        """Draw the line."""
        palette, glyphs = self.look.palette, self.look.glyphs
        segments, used = list[Segment](), 0
        for column, (keys, label) in self._placed():
            hint = [
                Segment(" " * (column - used), palette.text),
                Segment(glyphs.spelled(keys), palette.press),
                Segment(glyphs.spelled(f" {label}" if keys else label), palette.text),
            ]
            segments += hint
            used += sum(segment.cell_length for segment in hint)
        strip = Strip(segments).adjust_cell_length(self.size.width, palette.text)
        return strip.apply_style(self.rich_style)

    def _placed(self) -> Iterator[tuple[int, tuple[str, str]]]:
        """Yield hints with their columns."""
        first = self._fitting_hints() if self.hints else self._fitting_first()
        shown, gap = ((), _GAPS[1]) if self.hints else self._fitting_actions()
        end = _EDGE
        for hint in first:
            yield end, hint
            end += _line_columns([hint], 0, self.look.glyphs) - _EDGE + gap
        for action, column in self._columns_of(shown, gap, end):
            keys, label = action.key_hint
            yield column, (keys, action.while_running if self.is_running and action.while_running else label)

    def _columns_of(self, shown: Sequence[Action], gap: int, column: int) -> Iterator[tuple[Action, int]]:
        """Yield actions from ``column`` on, the last one at the right edge."""
        for action in shown:
            columns = _columns(action, self.look.glyphs, gap)
            if action is shown[-1]:
                column = max(column, self.size.width - _EDGE - columns)
            yield action, column
            column += columns + gap

    def _fitting_first(self) -> Hints:
        last = min((a for a in self._actions if a.rank is not None), key=lambda action: action.rank or 0)
        room = self.size.width - _EDGE - _columns(last, self.look.glyphs, _GAPS[0]) - _GAPS[0]
        fitting = (each for each in self.first if _line_columns(each, _GAPS[0], self.look.glyphs) <= room)
        return next(fitting, self.first[-1] if self.first else ())

    def _fitting_hints(self) -> list[tuple[str, str]]:
        hints = list(self.hints)
        while len(hints) > 1 and _line_columns(hints, _GAPS[1], self.look.glyphs) > self.size.width - _EDGE:
            hints.pop(-2)
        return hints

    async def on_click(self, event: events.Click) -> None:
        """Run the hint under the pointer."""
        offset = event.get_content_offset(self)
        if offset is None:
            return
        if self.hints:
            self._press_hint(self._fitting_hints(), _GAPS[1], offset.x)
            return
        shown, gap = self._fitting_actions()
        first = self._press_hint(self._fitting_first(), gap, offset.x)
        for action, column in self._columns_of(shown, gap, first):
            if column <= offset.x < column + _columns(action, self.look.glyphs, gap):
                await self.screen.run_action(action.textual_action)

    def _fitting_actions(self) -> tuple[tuple[Action, ...], int]:
        first = self._fitting_first()
        taken = {keys for keys, _ in first}
        actions = [
            action
            for action in self._actions
            if action.shown not in taken
            and action.id not in self.idle
            and (action.is_first or self.names_all)
        ]
        room = self.size.width
        if first:
            room -= _line_columns(first, _GAPS[0], self.look.glyphs) - 1 + _GAPS[0]
        return fitting(actions, room, self.look.glyphs)

    def _press_hint(self, hints: Sequence[tuple[str, str]], gap: int, x: int) -> int:
        """Press the keys of the hint in column ``x``, and return the end of the hints."""
        column = 1
        for hint in hints:
            end = column + _line_columns([hint], 0, self.look.glyphs) - 1
            menu, _, letter = hint[0].partition(" ")
            keys = (menu, letter) if menu in MENUS and letter else (key_of_hint(hint[0]),)
            for key in keys if column <= x < end else ():
                if key is not None:
                    self.app.simulate_key(key)
            column = end + gap
        return column
