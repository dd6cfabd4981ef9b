"""All keys of a place, the first page of ``?``."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from typing import ClassVar, Final, NamedTuple

from rich.style import Style
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.content import Content
from textual.geometry import Size
from textual.widget import Widget

from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.keys.action import MENUS, Action, Group, menu_title
from rl_tui.screen.theme.look import Look

KEYS: Final = "keys"
WORDS: Final = "words"
PAGES: Final = "pages"
FIND: Final = "find"
_TABS: Final = ("Keys", "Words", "Pages")
_MENU_NAME: Final = 11  # columns
_AROUND_LABEL: Final = 3  # columns of the letter and the blanks
_ROOMY: Final = (108, 34)  # columns and rows from which each menu is a list
_MOVING: Final = {
    **dict.fromkeys(("up", "down", "left", "right"), "move"),
    **dict.fromkeys(("page up", "page down"), "page"),
}
_SIGNS: Final = {
    "up": "↑",
    "down": "↓",
    "left": "←",
    "right": "→",
    "pageup": "pgup",
    "pagedown": "pgdn",
    "escape": "esc",
    "delete": "del",
    "less_than_sign": "<",
    "greater_than_sign": ">",
    "left_curly_bracket": "{",
    "right_curly_bracket": "}",
    "full_stop": ".",
    "comma": ",",
}


def tabs(current: str) -> Content:
    """Return a title with all pages of ``?``, ``current`` marked."""
    parts = [(f" {name} ", "reverse" if name == current else "not bold") for name in _TABS]
    return Content.assemble(*parts)


class _Entry(NamedTuple):
    key: str
    label: str
    is_dim: bool = False


class KeyPage(Widget):
    """The ``lines`` of a page at a width."""

    DEFAULT_CSS = """
    KeyPage {
        width: 1fr;
        height: auto;
    }
    """

    def __init__(self, lines: Callable[[int], list[Text]]) -> None:
        super().__init__()
        self._lines = lines

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Count the lines at ``width`` columns."""
        return len(self._lines(width))

    def render(self) -> Text:
        """Draw all lines."""
        return Text("\n", no_wrap=True, overflow="crop").join(self._lines(self.size.width))


class HelpPage(Dialog[str]):
    """A page of ``?`` that scrolls. The answer is the next one, or ``FIND``."""

    def __init__(self, look: Look, tab: str, keys: str) -> None:
        super().__init__()
        self._look = look
        self._tab = tab
        self._keys = keys

    def compose(self) -> ComposeResult:
        """Yield the lines in a box."""
        with self.box("", self._keys, "whole") as box:
            box.border_title = tabs(self._tab)
            with VerticalScroll():
                yield KeyPage(self._lines)

    def on_mount(self) -> None:
        """Focus the lines to scroll them."""
        self.query_one(VerticalScroll).focus()

    def _lines(self, width: int) -> list[Text]:
        raise NotImplementedError


class KeySheet(HelpPage):
    """The keys of ``actions`` and of the focused ``panel``."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("question_mark,tab,2", f"dismiss('{WORDS}')", "words", id="keys.words", tooltip="Words."),
        Binding("3", f"dismiss('{PAGES}')", "pages", id="keys.pages", tooltip="Pages."),
        Binding("slash", f"dismiss('{FIND}')", "find", id="keys.find", tooltip="Find."),
        Binding("q", "cancel", "close", id="keys.close", tooltip="Close the keys."),
    ]

    def __init__(self, look: Look, actions: Sequence[Action], panel: Widget | None, name: str) -> None:
        super().__init__(look, "Keys", "?: words   /: find   esc: close")
        self._written = look.glyphs.spelled
        self._actions = actions
        self._panel = panel
        self._name = name

    def _lines(self, width: int) -> list[Text]:
        return list(self._all_keys(width))

    def _all_keys(self, width: int) -> Iterator[Text]:
        room = self.app.size
        is_roomy = room.width >= _ROOMY[0] and room.height >= _ROOMY[1]
        strong = self._look.palette.strong
        count = 3 if width < 72 else 4
        for heading, entries in self._sections():
            if entries:
                yield Text(self._written(heading), strong)
                yield from self._columns(entries, count, width)
                yield Text("")
        yield from self._wide_menus(width) if is_roomy else self._narrow_menus(count, width)

    def _sections(self) -> Iterator[tuple[str, list[_Entry]]]:
        taken = {key for each in self._actions if each.group is Group.DRAWING for key in each.keys}
        yield f"{self._name}, in focus" if self._name else "In focus", _panel_entries(self._panel, taken)
        for group in (Group.DRAWING, Group.LISTS, Group.LESSON):
            entries = [_entry(each) for each in self._actions if not each.menu and each.group == group]
            yield group, entries
        rest = (Group.RUN, Group.PROGRAM)
        singles = [each for each in self._actions if not each.menu and each.group in rest]
        # Menus have their own heading; keys for emergencies are explained under words
        listed = [each for each in singles if each.key not in MENUS and not each.everywhere]
        if self._panel is not None:  # it takes the moving keys
            listed = [each for each in listed if not each.unfocused]
        yield "Everywhere", [entry for each in listed if (entry := _entry(each)).key]

    def _columns(self, entries: Sequence[_Entry], count: int, width: int) -> Iterator[Text]:
        keys = max((len(entry.key) for entry in entries), default=0)
        least = keys + max((len(entry.label) for entry in entries), default=0) + 1
        count = max(1, min(count, width // least))
        lines, column = -(-len(entries) // count), width // count
        for line in range(lines):
            yield Text().join(self._item(each, column, keys) for each in entries[line::lines])

    def _wide_menus(self, width: int) -> Iterator[Text]:
        column = width // 3
        menus = self._menus()
        for three in (menus[:3], menus[3:]):
            yield Text().join(
                Text(f"{key}  {title}".ljust(column), self._look.palette.strong) for key, title, _ in three
            )
            for line in range(max((len(entries) for *_, entries in three), default=0)):
                yield Text().join(
                    self._item(entries[line], column, 5) if line < len(entries) else Text(" " * column)
                    for *_, entries in three
                )
            yield Text("")

    def _narrow_menus(self, count: int, width: int) -> Iterator[Text]:
        palette, room = self._look.palette, width - _MENU_NAME
        menus = [
            (key, title, [each._replace(key=each.key[-1]) for each in entries if not each.is_dim])
            for key, title, entries in self._menus()
        ]
        longest = max((len(each.label) for *_, entries in menus for each in entries), default=0)
        count = min(count, room // (longest + _AROUND_LABEL))
        for key, title, entries in menus:
            name = Text(f"{key} ", palette.press).append(title.ljust(_MENU_NAME - 2), palette.strong)
            for line in self._columns(entries, count, room):
                yield name + line
                name = Text(" " * _MENU_NAME)

    def _menus(self) -> list[tuple[str, str, list[_Entry]]]:
        menus = [(key, [each for each in self._actions if each.menu == key]) for key in MENUS]
        return [(key, menu_title(key, listed), list(map(_entry, listed))) for key, listed in menus if listed]

    def _item(self, entry: _Entry, width: int, keys: int) -> Text:
        palette = self._look.palette
        key, label = self._written(entry.key), self._written(entry.label)
        style: Style = palette.dim if entry.is_dim else palette.text
        text = Text(key.rjust(keys), palette.dim if entry.is_dim else palette.press)
        return text.append(f" {label}".ljust(width - keys), style)


def _entry(action: Action) -> _Entry:
    key, label = action.entry or (action.shown, action.label)
    return _Entry(key, label, bool(action.refused))


def _panel_entries(panel: Widget | None, taken: Collection[str]) -> list[_Entry]:
    meanings = dict[str, list[str]]()
    for base in type(panel).__mro__ if panel is not None else ():
        for each in Binding.make_bindings(base.__dict__.get("BINDINGS", ())):
            word = each.description.lower()
            if each.tooltip and not each.key.startswith("shift+") and each.key not in (*taken, "j", "k"):
                meanings.setdefault(_MOVING.get(word, word), []).append(_SIGNS.get(each.key, each.key))
    return [_Entry(" ".join(dict.fromkeys(keys)), meaning) for meaning, keys in meanings.items()]
