"""A picture on which a person draws."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from textual import events
from textual.geometry import Offset

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.counterparts import state_in
from rl_tui.screen.kit.pointing import PointerStroke, Wheeled
from rl_tui.screen.panels.world.shown_policy import PolicyPicture
from rl_tui.worlds.world import World

_FINE: Final = 0.1  # of a turn of the wheel, with shift
_MIDDLE: Final = 0.2  # of half a place


class DrawnPicture(PolicyPicture):
    """A picture of places that reports pointer strokes."""

    cursor: int | None
    is_drawn_on = False
    """Whether a person draws: the pointer paints, the wheel changes rewards."""
    _picked: frozenset[int] = frozenset()
    _stroke: tuple[int, ...] = ()
    _pointer = Offset()  # last position during a stroke

    @property
    def picked(self) -> frozenset[int]:
        """The places drawn like the cursor."""
        return self._picked.union(self._stroke)

    @picked.setter
    def picked(self, picked: frozenset[int]) -> None:
        if picked != self._picked:
            self._picked = picked
            self.redraw()

    def place_at(self, x: int, y: int) -> int | None:
        """Return the place here, or None."""
        raise NotImplementedError

    def part_at(self, x: int, y: int) -> tuple[int, int] | None:
        """Return the side of the place here."""
        here = self.place_at(x, y)
        columns = [each for each in range(self.size.width) if self.place_at(each, y) == here]
        rows = [each for each in range(self.size.height) if self.place_at(x, each) == here]
        right, down = _off_centre(x, columns), _off_centre(y, rows)
        if max(abs(right), abs(down)) < _MIDDLE:
            return None
        if abs(right) >= abs(down):
            return 0, (1 if right > 0 else -1)
        return (1 if down > 0 else -1), 0

    def carried(self, place: int, before: Snapshot, now: Snapshot) -> int | None:
        """Return where ``place`` is in ``now``."""
        return self.place_in(place, before.world, now.world)

    def place_in(self, place: int, world: World, other: World) -> int | None:
        """Return the matching place in ``other``."""
        return state_in(place, world, other)

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Begin a stroke."""
        place, offset = self._place_under(event), event.get_content_offset(self)
        if self.is_drawn_on and place is not None and offset is not None:
            self.capture_mouse()
            self._stroke, self._pointer = (place,), offset
            self.redraw()

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Continue straight: a fast pointer skips places."""
        offset = event.get_content_offset(self) if self._stroke else None
        if offset is None:
            return
        before, self._pointer = self._pointer, offset
        for x, y in _straight(before, offset):
            place = self.place_at(x, y)
            if place is not None and place != self._stroke[-1]:
                self._stroke = (*self._stroke, place)
                self.redraw()

    def on_mouse_up(self) -> None:
        """Report the stroke."""
        if self._stroke:
            self.release_mouse()
            stroke, self._stroke = self._stroke, ()
            self.redraw()
            self.post_message(PointerStroke(self, stroke))

    def turns(self, event: events.MouseEvent, lines: int) -> bool:
        """Report the wheel, and return whether a person draws."""
        place = self._place_under(event) if self.is_drawn_on else None
        if place is not None:
            amount = -1.0 if lines > 0 else 1.0
            self.post_message(Wheeled(self, place, amount * (_FINE if event.shift else 1.0)))
        return self.is_drawn_on

    def _place_under(self, event: events.MouseEvent) -> int | None:
        offset = event.get_content_offset(self)
        return None if offset is None else self.place_at(offset.x, offset.y)


def _off_centre(at: int, cells: list[int]) -> float:
    return (2 * at - cells[0] - cells[-1]) / len(cells)


def _straight(start: Offset, end: Offset) -> Iterator[tuple[int, int]]:
    across = end - start
    steps = max(abs(across.x), abs(across.y))
    for step in range(1, steps + 1):
        yield start.x + round(across.x * step / steps), start.y + round(across.y * step / steps)
