"""Changes of the view."""

from __future__ import annotations

from rl_tui.live.commands import AskCheck, AskFlips, HideAnswer, LookAt
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.flip_answer import FlipState
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.frame.key_line import Hints
from rl_tui.screen.kit.layers import ACTION_LAYERS, Layer
from rl_tui.screen.kit.row import DISCOUNT, WORLD, WORLD_CHECK
from rl_tui.screen.kit.snapshot_facts import is_secret
from rl_tui.screen.panels.controls.controls import GAMMA
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.world import World

_AROUND = 2  # columns and rows around a full-screen map


class ViewActions(Subject):
    """Layers, full screen and exact values."""

    _flips_asked: World | None = None
    _asks_check: bool = False

    def why_not(self, deed: str) -> str:
        """Explain why exact values or cells cannot change."""
        snapshot = self.snapshot
        if snapshot is None:
            return ""
        drawing = snapshot.world.drawing
        if deed == "hide_answer" and snapshot.world.mdp is None:
            return "this world has no exact values to hide"
        if deed == "hide_answer" and snapshot.playback.phase is Phase.SPENT:
            return "the budget is spent, so nothing is hidden. r r: start again"
        if deed == "turn_actions" and not isinstance(drawing, Grid):
            return f"{'each bar' if snapshot.world.is_bandit else 'the table'} shows Q of every action here"
        if deed == "numbers" and not isinstance(drawing, Grid):
            return "only maps have cells that can show the numbers of states"
        return ""

    def value(self, deed: str) -> str:
        """Return the value for a menu."""
        legends = self.board.legends
        values = {
            "hide_answer": "hidden" if self.link.wanted.is_hidden else "shown",
            "turn_actions": "Q" if legends.shows_actions else "V",
            "numbers": "on" if legends.numbers_states else "off",
            "turn_legends": "on" if legends.is_on else "off",
        }
        return "" if self.why_not(deed) else values.get(deed, "")

    def look_at(self) -> None:
        """Ask for the visible parts of a large world."""
        self.link.send(LookAt(self.board.viewport))

    def follow_panel(self) -> None:
        """Check the world while its panel is open."""
        is_open = self.board.opened == WORLD_CHECK
        if is_open != self._asks_check:
            self._asks_check = is_open
            self.link.send(AskCheck(is_open))

    def follow_flips(self) -> None:
        """Ask once for the flip points, if wanted."""
        snapshot = self.snapshot
        if snapshot is None or snapshot.world is self._flips_asked:
            return
        is_unknown = snapshot.answers.flips.state is FlipState.NOT_ASKED
        is_there = snapshot.playback.phase not in (Phase.PREPARING, Phase.SEEKING)
        if is_unknown and is_there and self._wants_flips(snapshot):
            self._flips_asked = snapshot.world
            self.link.send(AskFlips())

    def _wants_flips(self, snapshot: Snapshot) -> bool:
        if self.board.opened == DISCOUNT or is_secret(snapshot):
            return self.board.opened == DISCOUNT
        focused = self.screen.focused
        if isinstance(focused, Slider) and focused.id == GAMMA:
            return True
        rests = snapshot.playback.phase is not Phase.RUNNING
        return self.link.player.is_automatic and rests and self.board.controls.has_slider(GAMMA)

    def next_layer(self) -> None:
        """Go to the next layer, or only the table's."""
        board, order = self.board, list(Layer)
        choices = [layer for layer in board.table.layer_choices if self._is_seen(layer)]
        if len(choices) < 2 and board.zoomed is None:
            board.zoom(board.table.id)
            board.table.focus()
            return
        if not choices:
            return
        now = board.wanted_layer if board.wanted_layer in choices else Layer.Q
        later = [layer for layer in choices if order.index(layer) > order.index(now)]
        board.show_layer((later or choices)[0])

    def _is_seen(self, layer: Layer) -> bool:
        board, world = self.board, self.board.world
        if layer is not Layer.LANDSCAPE and board.shows(board.table.id or ""):
            return True
        return world is not None and board.shows(world.id or "") and world.has_layer(layer)

    def turn_actions(self) -> None:
        """Switch a map's cells between all Q and V."""
        view = self.board.world
        if view is None:
            return
        legends = self.board.legends
        legends.shows_actions = not legends.shows_actions
        if legends.shows_actions and self.board.wanted_layer not in ACTION_LAYERS:
            self.board.wanted_layer = Layer.Q
        self.board.apply_switches()
        if view.lacks_room:
            width, height = self.board.size
            alone = self.board.zoomed != view.id and view.has_room_in(width - _AROUND, height - _AROUND)
            room = "f: full screen." if alone else "A larger terminal has room."
            self.screen.tell(f"Cells are too small for Q of every action. {room}")

    def enter_world(self) -> None:
        """Focus the world."""
        if self.board.world is not None:
            self.board.bring_into_view(WORLD)
            self.board.world.focus()

    def with_way_back(self, offered: tuple[Hints, ...]) -> tuple[Hints, ...]:
        """Add the key that ends full screen."""
        if not self.board.zoomed:
            return offered
        way_back: Hints = (("f", "all panels"),)
        return (*((*form, *way_back) for form in offered), *(offered or (way_back,)))

    def zoom(self) -> None:
        """Switch full screen."""
        self.board.zoom(None if self.board.zoomed else self.board.panel_of(self.screen.focused))

    def hide_answer(self) -> None:
        """Hide or show the exact values."""
        if self.snapshot is not None:
            self.link.send(HideAnswer(not self.link.wanted.is_hidden))

    def turn_legends(self) -> None:
        """Hide or show captions and legends."""
        legends = self.board.legends
        legends.turn()
        self.screen.tell(
            f"Captions and legends are {'shown' if legends.is_on else 'hidden. m l: show them'}."
        )
        self.board.apply_switches()
        if self.snapshot is not None:
            self.board.show(self.snapshot)

    def numbers(self) -> None:
        """Hide or show a map's state numbers."""
        legends = self.board.legends
        legends.numbers_states = not legends.numbers_states
        self.board.apply_switches()
