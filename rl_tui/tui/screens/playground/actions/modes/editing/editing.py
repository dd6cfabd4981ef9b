"""The mode in which a person draws the world, while the agent goes on learning in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Final

from rl_tui.lab.live.commands import DrawWorld, HideAnswer, OpenEditor, RedoStroke, UndoStroke
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.tui.panels.pointing import Stroke, Wheeled
from rl_tui.tui.panels.row import WORLD
from rl_tui.tui.panels.snapshot_facts import is_secret
from rl_tui.tui.panels.world.view import WorldView
from rl_tui.tui.screens.playground.actions.modes.editing.arms_tools import ArmsTools
from rl_tui.tui.screens.playground.actions.modes.editing.graph_tools import GraphTools
from rl_tui.tui.screens.playground.actions.modes.editing.map_tools import MapTools
from rl_tui.tui.screens.playground.actions.modes.editing.saving import ScenarioSaving
from rl_tui.tui.screens.playground.actions.modes.editing.texts import hints, prompts, title
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Hand, Tool, Toolbox
from rl_tui.tui.screens.playground.actions.modes.mode import LEAVE, STEPS, WITH_SHIFT, KeyMode
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.editing.edit import Edit

_TOOLBOXES: Final[Mapping[type, Callable[[], Toolbox]]] = {
    Grid: MapTools,
    Graph: GraphTools,
    Arms: ArmsTools,
}
_ALONG: Final = {f"{WITH_SHIFT}{key}": step for key, step in STEPS.items()}
UNDO, REDO, SAVE = "z", "Z", "w"
_IN_LESSON: Final = "a lesson's world stays as it is: draw in a scenario of the catalogue"


class WorldEditing(KeyMode):
    """Drawing the world with the tools of its kind; the world in view has the focus, and the run goes on."""

    way_back = "click or tab here to draw on", "tab here to draw on"
    toolbox: Toolbox | None = None

    @cached_property
    def saving(self) -> ScenarioSaving:
        """What knows the file of the world."""
        return ScenarioSaving(self.screen, self.board, self.link)

    def takes(self, key: str) -> bool:
        """Return whether ``key`` draws, undoes, saves or leaves."""
        if self.toolbox is None or self._view is None:
            return False
        return key in (*_ALONG, UNDO, REDO, SAVE, LEAVE) or self.toolbox.tool(key) is not None

    def press(self, key: str) -> None:
        """Do what ``key`` means."""
        view, box = self._view, self.toolbox
        hand = None if view is None else self._hand(view)
        if box is None or hand is None:
            return
        tool = box.tool(key)
        if key == LEAVE:
            if not (isinstance(box, MapTools) and box.cancel()):
                self._end()
        elif key == UNDO:
            self.link.send(UndoStroke())
        elif key == REDO:
            self.link.send(RedoStroke())
        elif key == SAVE:
            self.saving.save()
        elif key in _ALONG:
            self._paint_along(hand, _ALONG[key])
        elif tool is not None:
            tool.use(box, hand)
        self._show_picked(hand)

    def draw(self, event: Stroke | Wheeled) -> None:
        """Paint where the pointer was drawn over the world, or change what is paid under it."""
        hand = self._hand(event.view) if isinstance(event.view, WorldView) else None
        if hand is None or self.toolbox is None:
            return
        if isinstance(event, Stroke):
            self.toolbox.paint(hand, event.places)
        else:
            self.toolbox.turn(hand, event.place, event.amount)

    def toggle(self) -> None:
        """Begin to draw, or end it."""
        snapshot = self.snapshot
        if self.is_on:
            self._end()
        elif snapshot is not None and snapshot.playback.phase is not Phase.PREPARING:
            self._begin(snapshot)

    def _begin(self, snapshot: Snapshot) -> None:
        from rl_tui.worlds.editing.drafts import refusal

        refused = (
            _IN_LESSON
            if snapshot.lesson is not None
            else refusal(snapshot.recipe.scenario, snapshot.recipe.seed)
        )
        if refused:
            self.screen.tell(refused)
            return
        if isinstance(snapshot.world.drawing, Arms) and is_secret(snapshot):
            self.link.send(HideAnswer(is_hidden=False))
            self.screen.tell("what the arms truly pay is shown now: h hides it again")
        self.toolbox = _TOOLBOXES[type(snapshot.world.drawing)]()
        self.board.bring_into_view(WORLD)
        self.link.send(OpenEditor(is_open=True))
        self.enter()
        view = self.board.world
        if view is not None:
            view.is_drawn_on = True
            if view.cursor_place is not None:
                view.put_cursor(view.cursor_place)  # it stays there while the agent goes on
        self.show(snapshot)

    def leave(self) -> None:
        """Give the keys back; what was drawn stays."""
        if self.is_on:
            super().leave()
            self.toolbox = None
            self.link.send(OpenEditor(is_open=False))
            for view in (self.board.world,):
                if view is not None:
                    view.is_drawn_on = False
                    view.picked = frozenset()
                    view.action_follow()

    def _end(self) -> None:
        self.leave()
        self.screen.tell("the world stays as you drew it; C goes on drawing")

    def show(self, snapshot: Snapshot) -> None:
        """Show what is drawn, what is unfinished in it, and which keys draw."""
        view, box = self.board.world, self.toolbox
        if view is None or box is None:
            return
        hand = self._hand(view)
        about = () if hand is None else box.about(hand)
        own: tuple[Tool, ...] = box.tools
        self._write(title(snapshot), prompts(snapshot, about), hints(box.hints(), own))

    @property
    def _view(self) -> WorldView | None:
        """The world in focus."""
        focused = self.screen.focused
        return focused if isinstance(focused, WorldView) else None

    def _hand(self, view: WorldView) -> Hand | None:
        """Return what tools work with; None while there is no draft yet."""
        snapshot = self.snapshot
        if snapshot is None or snapshot.editor.draft is None:
            return None
        return Hand(view, snapshot, self.glyphs, self.link.send, self._draw, self.screen.tell, self.ask)

    def _draw(self, edits: Sequence[Edit]) -> None:
        if edits:
            self.link.send(DrawWorld(tuple(edits)))

    def _paint_along(self, hand: Hand, step: tuple[int, int]) -> None:
        """Paint under the cursor and where it moves."""
        assert self.toolbox is not None
        before = hand.view.cursor_place
        if before is not None and isinstance(self.toolbox, MapTools):
            self.toolbox.paint(hand, (before, hand.view.moved(before, *step)))

    def _show_picked(self, hand: Hand) -> None:
        if self.toolbox is not None:
            hand.view.picked = self.toolbox.picked(hand)
        if self.snapshot is not None:
            self.show(self.snapshot)
