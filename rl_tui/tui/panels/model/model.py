"""The model of a scenario and, pair by pair, what may follow and what it is worth."""

from __future__ import annotations

from typing import ClassVar, Final

from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.action_order import shown_pairs, shown_place
from rl_tui.tui.draw.pieces import Line, Piece, strips_of
from rl_tui.tui.panels.bindings import binding
from rl_tui.tui.panels.model.text import model_lines, pair_lines
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.scrolling import Scrolled

WAITING: Final = "the world is being built"


class ModelPanel(Panel, can_focus=True):
    """⟨S, A, P, R, γ⟩ above one pair: up and down change its state, left and right its action."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "move_state(-1)", "model.up", "Previous state"),
        binding("down", "move_state(1)", "model.down", "Next state"),
        binding("left", "move_action(-1)", "model.left", "Previous action"),
        binding("right", "move_action(1)", "model.right", "Next action"),
        binding("pageup", "scroll_by(-1)", "model.page_up", "Scroll up"),
        binding("pagedown", "scroll_by(1)", "model.page_down", "Scroll down"),
    ]

    _pair: int | None = None
    _first = 0
    _lines = 0

    @property
    def pair(self) -> int | None:
        """The pair whose outcomes are shown, None before the first snapshot."""
        if self._pair is None and self.snapshot is not None:
            space, mdp = self.snapshot.world.space, self.snapshot.world.mdp
            start = self.snapshot.counters.state if mdp is None else int(mdp.start_state[0])
            pairs = space.pairs_of(start)
            return shown_pairs(self.snapshot.world, pairs)[0] if pairs else space.pairs - 1
        return self._pair

    def show_pair(self, pair: int) -> None:
        """Show the outcomes of ``pair``."""
        self._pair = pair
        self.redraw()
        if self.snapshot is not None and self.is_attached and not self.snapshot.agent.holds(pair):
            self.post_message(Scrolled())

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the part of the model that is in view."""
        pair = self.pair
        if snapshot is None or pair is None:
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        self.heading = f"Model ⟨S, A, P, R, γ⟩ · {snapshot.recipe.scenario.title}"
        model = model_lines(snapshot, self.look, width)
        one_pair = pair_lines(snapshot, pair, self.look, width)
        blank: Line = [Piece("", self.look.palette.text)]
        lines = [*model, blank, *one_pair]
        if len(lines) > height:  # what the arrows change stays in view
            lines = [*one_pair, blank, *model]
        self._lines = len(lines)
        self._first = max(0, min(self._first, len(lines) - height))
        self.footing = self.fitting(_keys(is_scrolled=len(lines) > height), width)
        return strips_of(lines[self._first :], width, height, self.look)

    def action_move_state(self, step: int) -> None:
        """Go to the next state that owns pairs, ``step`` of them on, keeping the action where it is legal."""
        if self.snapshot is None or self.pair is None:
            return
        world, space = self.snapshot.world, self.snapshot.world.space
        place = shown_place(world, int(space.pair_action[self.pair]))
        state = space.state_of(self.pair) + step
        while 0 <= state < space.states and not len(space.pairs_of(state)):
            state += step
        if 0 <= state < space.states:
            pairs = shown_pairs(world, space.pairs_of(state))
            self.show_pair(
                min(pairs, key=lambda pair: abs(shown_place(world, int(space.pair_action[pair])) - place))
            )

    def action_move_action(self, step: int) -> None:
        """Go to another action of the same state."""
        if self.snapshot is None or self.pair is None:
            return
        space = self.snapshot.world.space
        pairs = shown_pairs(self.snapshot.world, space.pairs_of(space.state_of(self.pair)))
        place = pairs.index(self.pair) + step
        if 0 <= place < len(pairs):
            self.show_pair(pairs[place])

    def action_scroll_by(self, pages: int) -> None:
        """Scroll by so many pages."""
        self._scroll(pages * max(1, self.size.height - 2))

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Scroll down by a few lines."""
        event.stop()
        self._scroll(3)

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Scroll up by a few lines."""
        event.stop()
        self._scroll(-3)

    def _scroll(self, lines: int) -> None:
        self._first = max(0, min(self._first + lines, self._lines - self.size.height))
        self.redraw()


def _keys(*, is_scrolled: bool) -> list[str]:
    """Return the keys of the panel, longest form first."""
    pair, scroll, close = "↑ ↓: state   ← →: action", "pgup pgdn: scroll", "m: close"
    forms = [(pair, close), (close,)]
    if is_scrolled:
        forms = [(pair, scroll, close), (scroll, close), (close,)]
    return ["   ".join(form) for form in forms]
