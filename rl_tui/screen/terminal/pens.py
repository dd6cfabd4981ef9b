"""Pens for the styles of cells."""

from __future__ import annotations

from typing import Final
from weakref import WeakValueDictionary

from rich.color import ColorSystem
from rich.style import Style

# By the bit of rich.style.Style: bold, dim, italic, underline, blink, fast blink, reverse, conceal, strike,
# double underline, frame, encircle, overline
_ON: Final = ("1", "2", "3", "4", "5", "6", "7", "8", "9", "21", "51", "52", "53")
_OFF: Final = ("22", "22", "23", "24", "25", "25", "27", "28", "29", "24", "54", "54", "55")
_UNSEEN_ON_BLANKS: Final = 0b111  # bold, dim, italic; the others also show on blanks
MOST_KEPT: Final = 20_000  # styles, and changes from one pen to another
RESET: Final = "\x1b[m"


class Pen:
    """Attributes, foreground and background in the terminal's codes, one object per pen.

    ``blank`` is the pen with which a space looks the same.
    """

    __slots__ = ("__weakref__", "attributes", "background", "blank", "foreground")

    def __init__(self, attributes: int, foreground: str, background: str) -> None:
        self.attributes = attributes
        self.foreground = foreground
        self.background = background
        self.blank = self

    @property
    def order(self) -> tuple[str, str, int]:
        """A sort key that keeps changes between neighbours short."""
        return self.background, self.foreground, self.attributes


class Pens:
    """The pens of a terminal."""

    def __init__(self, system: ColorSystem) -> None:
        self._system = system
        self._of_style: dict[Style | None, Pen] = {}
        # Weak, so that unused pens disappear; a pen in use must not be made twice, because pens are compared
        # by identity
        self._known: WeakValueDictionary[tuple[int, str, str], Pen] = WeakValueDictionary()
        self._changes: dict[tuple[Pen, Pen], str] = {}
        self.plain = self._pen(0, "", "")

    def of(self, style: Style | None) -> Pen:
        """Return a style's pen, without its link."""
        pen = self._of_style.get(style)
        if pen is None:
            if len(self._of_style) > MOST_KEPT:  # fading colours make ever new styles
                self._of_style.clear()
            pen = self._of_style[style] = self._made(style)
        return pen

    def change(self, before: Pen, after: Pen) -> str:
        """Return the shortest change of pens."""
        if before is after:
            return ""
        change = self._changes.get((before, after))
        if change is None:
            if len(self._changes) > MOST_KEPT:
                self._changes.clear()
            change = self._changes[before, after] = _change(before, after)
        return change

    def _made(self, style: Style | None) -> Pen:
        if style is None:
            return self.plain
        foreground, background = style.color, style.bgcolor
        return self._pen(
            style._attributes & style._set_attributes,
            "" if foreground is None else ";".join(foreground.downgrade(self._system).get_ansi_codes()),
            "" if background is None else ";".join(background.downgrade(self._system).get_ansi_codes(False)),
        )

    def _pen(self, attributes: int, foreground: str, background: str) -> Pen:
        foreground = "" if foreground == "39" else foreground
        background = "" if background == "49" else background
        pen = self._known.get((attributes, foreground, background))
        if pen is None:
            pen = self._known[attributes, foreground, background] = Pen(attributes, foreground, background)
            if not attributes & ~_UNSEEN_ON_BLANKS and (attributes or foreground):
                pen.blank = self._pen(0, "", background)
        return pen


def _change(before: Pen, after: Pen) -> str:
    if not (after.attributes or after.foreground or after.background):
        return RESET
    # 22 ends both bold and dim, 24 and 25 also end two each: those that stay are set again
    ends = {_OFF[bit] for bit in _bits(before.attributes & ~after.attributes)}
    kept = [bit for bit in _bits(after.attributes & before.attributes) if _OFF[bit] in ends]
    begun = _bits(after.attributes & ~before.attributes)
    steps = [*sorted(ends), *(_ON[bit] for bit in (*kept, *begun))]
    if before.foreground != after.foreground:
        steps.append(after.foreground or "39")
    if before.background != after.background:
        steps.append(after.background or "49")
    afresh = ["0", *(_ON[bit] for bit in _bits(after.attributes)), after.foreground, after.background]
    return min((f"\x1b[{';'.join(filter(None, way))}m" for way in (steps, afresh)), key=len)


def _bits(attributes: int) -> list[int]:
    return [bit for bit in range(len(_ON)) if attributes >> bit & 1]
