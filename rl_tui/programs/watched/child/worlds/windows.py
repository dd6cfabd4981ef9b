"""A tkinter without a screen. Some worlds read their state from a canvas, so that keeps places."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from typing import Any, Final

from rl_tui.common.made_modules import MadeModules
from rl_tui.programs.watched.child.stand_ins import Note, Nothing

_SIZE: Final = 400
_TKINTER: Final = ("tkinter", "Tkinter")
_NO_WINDOWS: Final = "tkinter opens no window: rl-tui shows the world"
_WIDGETS: Final = (
    *("Frame", "Label", "Button", "Entry", "Toplevel", "Scale", "Text", "Menu", "Scrollbar", "Radiobutton"),
    *("Checkbutton", "StringVar", "IntVar", "DoubleVar", "BooleanVar", "PhotoImage", "LabelFrame", "Spinbox"),
    *("Listbox", "OptionMenu"),
)
_CONSTANTS: Final = (
    *("LEFT", "RIGHT", "TOP", "BOTTOM", "BOTH", "X", "Y", "N", "S", "E", "W", "NW", "NE", "SW", "SE", "END"),
    *("CENTER", "HORIZONTAL", "VERTICAL", "NORMAL", "DISABLED", "FLAT", "RAISED", "SUNKEN", "ALL", "YES"),
    "NO",
)


class Widget(Nothing):
    """A part of a window, which does nothing."""

    def winfo_screenwidth(self) -> int:
        """Return a width."""
        return _SIZE

    winfo_screenheight = winfo_width = winfo_height = winfo_screenwidth


class Tk(Widget):
    """A window, which calls the functions that wait for it."""

    def __init__(self, *_: Any, **__: Any) -> None:
        self._waiting: list[tuple[Callable[..., Any], tuple[Any, ...]]] = []

    def after(self, _: int, function: Callable[..., Any] | None = None, *arguments: Any) -> str:
        """Leave `function` to `mainloop`."""
        if function is not None:
            self._waiting.append((function, arguments))
        return "after#0"

    def after_idle(self, function: Callable[..., Any], *arguments: Any) -> str:
        """Leave `function` to `mainloop`."""
        return self.after(0, function, *arguments)

    def mainloop(self, *_: Any) -> None:
        """Call all waiting functions, and those that they add."""
        while self._waiting:
            function, arguments = self._waiting.pop(0)
            function(*arguments)

    def destroy(self) -> None:
        """Forget the waiting functions."""
        self._waiting.clear()


class _PlacingCanvas(Tk):
    """A canvas that knows where its items are."""

    def __init__(self, *_: Any, **__: Any) -> None:
        super().__init__()
        self._items: dict[int, list[float]] = {}
        self._made = 0

    def create_item(self, *numbers: Any, **_: Any) -> int:
        self._made += 1
        self._items[self._made] = list(_flat(numbers))
        return self._made

    create_line = create_rectangle = create_oval = create_text = create_image = create_item
    create_polygon = create_arc = create_window = create_item

    def coords(self, item: int, *numbers: Any) -> list[float]:
        if numbers:
            self._items[item] = list(_flat(numbers))
        return list(self._items.get(item, []))

    def bbox(self, item: int) -> list[float]:
        return self.coords(item)

    def move(self, item: int, right: float, down: float) -> None:
        place = self._items.get(item, [])
        self._items[item] = [each + float(down if odd % 2 else right) for odd, each in enumerate(place)]

    def delete(self, *items: Any) -> None:
        for each in items:
            if each == "all":
                self._items.clear()
            else:
                self._items.pop(each, None)

    def find_all(self) -> tuple[int, ...]:
        return tuple(self._items)


def _flat(numbers: Any) -> Iterator[float]:
    for each in numbers:
        if isinstance(each, list | tuple):
            yield from _flat(each)
        else:
            yield float(each)


def _content() -> dict[str, Any]:
    names: dict[str, Any] = {"Tk": Tk, "Canvas": _PlacingCanvas, "Widget": Widget, "Misc": Widget}
    names |= {"TclError": RuntimeError, "TkVersion": 8.6}
    names |= {name: type(name, (Widget,), {}) for name in _WIDGETS}
    names |= {name: name.lower() for name in _CONSTANTS}
    return {**names, "__all__": [*names]}


def offer_windows(note: Note) -> None:
    """Answer imports of tkinter, and `note` the first."""

    def content(_: str) -> dict[str, Any]:
        note(_NO_WINDOWS)
        return _content()

    sys.meta_path.insert(0, MadeModules(lambda name: name.partition(".")[0] in _TKINTER, content))
