"""What policies are worth: each in a row, and what exploring costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final

from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.screen.draw.canvas import Line, Piece, strips_of, wrapped
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.panels.policies.names import POLICY_NAMES
from rl_tui.screen.panels.policies.table import head_line, notes, row_lines, table_form
from rl_tui.worlds.drawing import Arms

TITLE: Final = "Policies"
WAITING: Final = "they are being worked out"
_NOT_KNOWN: Final = f"what they are worth cannot be told: {NO_TABLE}"
_CHOOSE: Final = "screen.do('policies.choose({})')"


_KEYS: Final = (
    "↑ ↓: which · enter: keep it in view · P: back to V",
    "↑ ↓: which · enter: keep · P: back",
    "↑ ↓ · enter: keep · P: back",
    "enter: keep · P: back",
    "P: back",
)

# Arms show their bars all the time: there is no V to go back to
_KEYS_OF_ARMS: Final = ("↑ ↓: which · enter: keep it in view · P: close", *_KEYS[1:])

_KEYS_ELSEWHERE: Final = (
    "click or tab here to choose · P: close",
    "tab here to choose · P: close",
    "P: close",
)


@dataclass
class PolicyChosen(Message):
    """A person chose the policy ``kind`` with the mouse."""

    kind: PolicyKind


class Policies(Panel, can_focus=True):
    """A row a policy; the one under the cursor is studied: the world shows its values and actions."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", _CHOOSE.format(-1), "policies.up", "The policy above"),
        binding("down", _CHOOSE.format(1), "policies.down", "The policy below"),
        binding("home", _CHOOSE.format(-9), "policies.first", "The first policy"),
        binding("end", _CHOOSE.format(9), "policies.last", "The last policy"),
        binding("enter", "screen.do('policies.keep')", "policies.keep", "Keep it on screen"),
    ]
    _places: Sequence[int] = ()  # the row of the picture in which each policy stands

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the table and the notes, of which the last ones are left out where there is no room."""
        self.heading = self.fitting(self._headings(snapshot), width)
        is_bandit = snapshot is not None and isinstance(snapshot.world.drawing, Arms)
        keys = _KEYS_OF_ARMS if is_bandit else _KEYS
        self.footing = self.fitting(keys if self.has_focus else _KEYS_ELSEWHERE, width)
        self._places = ()
        if snapshot is None or snapshot.answers.studied is None:
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        if snapshot.world.mdp is None:
            # rows and explanations of figures would be about nothing
            self.footing = self.fitting(_KEYS[-1:], width)
            why = wrapped(_NOT_KNOWN, width, self.look.palette.dim, self.look, " ", " ")
            self.free_rows = height - len(why)
            return strips_of(why, width, height, self.look)
        table = self._table(snapshot, width, height)
        lines = list(table)
        room = height - len(lines)
        for note, is_plain in notes(snapshot, self.look):
            style = self.look.palette.text if is_plain else self.look.palette.dim
            wrapped_note = wrapped(note, width, style, self.look, " ", "   ")
            gap = int(len(lines) == len(table) and room > len(wrapped_note))
            if gap + len(wrapped_note) <= room:
                lines += [*([[]] if gap else []), *wrapped_note]
                room -= gap + len(wrapped_note)
        if height <= len(table):
            self.heading = self.fitting(self._headings_with_cost(snapshot), width) or self.heading
        self.free_rows = room
        return strips_of(lines, width, height, self.look)

    def _headings(self, snapshot: Snapshot | None) -> tuple[str, ...]:
        """Return the headings, the longest first; of runs side by side they say whose policies these are."""
        plain = (*self.captioned(TITLE), TITLE)
        if snapshot is None or not snapshot.run_group.lanes:
            return plain
        lane = self._lane(snapshot)
        named = f"{lane} {snapshot.run_group.lanes[snapshot.run_group.shown].name}"
        return (*(f"{named} · {each}" for each in plain), f"{lane} · {TITLE}", lane)

    def _headings_with_cost(self, snapshot: Snapshot) -> tuple[str, ...]:
        """Return headings with what exploring costs, for a panel without a row for that; none if unknown."""
        said = next((note for note, is_figure in notes(snapshot, self.look) if is_figure), "")
        said = said.removesuffix(" an episode")
        lane = f"{self._lane(snapshot)} · " if snapshot.run_group.lanes else ""
        return (f"{lane}{TITLE} · {said}", f"{lane}{said}") if said else ()

    def _lane(self, snapshot: Snapshot) -> str:
        return f"{self.look.glyphs.cursor}{snapshot.run_group.shown + 1}"

    def watch_has_focus(self, has_focus: bool) -> None:
        """Tell the keys that choose only where they do."""
        super().watch_has_focus(has_focus)
        self.redraw()

    def _table(self, snapshot: Snapshot, width: int, height: int) -> list[Line]:
        """Return the rows that fit, those around the cursor first, below a heading if there is room."""
        form = table_form(snapshot, width, self.look)
        rows = row_lines(snapshot, form, self.look)
        has_head = height > len(rows)
        studied = snapshot.answers.studied
        cursor = list(POLICY_NAMES).index(studied) if studied is not None else 0
        first = max(0, min(cursor - height // 2, len(rows) - height))
        self._places = [has_head + place - first for place in range(len(rows))]
        head = [head_line(form, self.look)] if has_head else []
        return [*head, *rows[first : first + height]]

    def on_click(self, event: events.Click) -> None:
        """Choose the policy under the pointer."""
        offset = event.get_content_offset(self)
        if offset is not None and offset.y in self._places:
            kind = list(POLICY_NAMES)[list(self._places).index(offset.y)]
            self.post_message(PolicyChosen(kind))
