"""Key bindings, and how texts name keys."""

from __future__ import annotations

from functools import cache
from typing import ClassVar, Final

from textual.binding import Binding, BindingsMap, BindingType
from textual.widget import Widget
from textual.widgets import Input, OptionList

_NAMES: Final = {
    "esc": "escape",
    "space": "space",
    "enter": "enter",
    "tab": "tab",
    "?": "question_mark",
    "↑": "up",
    "↓": "down",
    "←": "left",
    "→": "right",
}
_ENDS: Final = (".", "!", "?", "…", ":")
_COMMANDS: Final = ("rl-tui",)
_ARTICLE: Final = "a"


def binding(keys: str, action: str, id: str, tooltip: str) -> Binding:  # noqa: A002
    """Return a hidden binding, with j and k as arrows."""
    for key, letter in (("up", "k"), ("down", "j")):
        keys = ",".join((*keys.split(","), letter)) if key in keys.split(",") else keys
    name = id.partition(".")[2].replace("_", " ").capitalize()
    return Binding(keys, action, name, show=False, id=id, tooltip=tooltip)


class RowList(OptionList):
    """A list in which j and k move the cursor."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("j", "cursor_down", "list.down", "Go to the next row."),
        binding("k", "cursor_up", "list.up", "Go to the previous row."),
    ]


class ListInput(Input):
    """An input that passes movement keys on."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "move('cursor_up')", "typed.up", "Go to the previous row."),
        binding("down", "move('cursor_down')", "typed.down", "Go to the next row."),
        binding("pageup", "move('page_up')", "typed.page_up", "Go a page up."),
        binding("pagedown", "move('page_down')", "typed.page_down", "Go a page down."),
    ]

    def action_move(self, how: str) -> None:
        """Move the list's cursor."""
        getattr(self.screen.query(OptionList).first(), f"action_{how}")()


def key_of_hint(written: str) -> str | None:
    """Return a hint's Textual key, such as ``esc``."""
    return _NAMES.get(written, written if len(written) == 1 else None)


def keys_of(focused: Widget | None) -> frozenset[str]:
    """Return the keys that the focus handles."""
    return frozenset() if focused is None else _keys_of_class(type(focused))


@cache
def _keys_of_class(kind: type[Widget]) -> frozenset[str]:
    declared = (vars(each).get("BINDINGS", ()) for each in kind.__mro__)
    return frozenset(key for bindings in declared for key in BindingsMap(bindings).key_to_bindings)


def as_sentence(text: str) -> str:
    """Add capital and full stop, but leave keys."""
    first, _, _ = text.partition(" ")
    if (first == _ARTICLE or key_of_hint(first) is None) and not first.startswith(_COMMANDS):
        text = f"{text[:1].upper()}{text[1:]}"
    last = text.rpartition(" ")[2]
    return text if text.endswith(_ENDS) or "/" in last or "\\" in last else f"{text}."
