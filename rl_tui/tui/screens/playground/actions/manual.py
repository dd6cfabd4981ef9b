"""A person in place of the agent."""

from __future__ import annotations

from typing import Final

from textual.binding import Binding, BindingType

from rl_tui.agents.catalogue import BY_ID
from rl_tui.lab.live.commands import (
    Command,
    Pause,
    Play,
    Restart,
    RunEpisode,
    RunUntil,
    Take,
    WatchLearning,
)
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.tui.panels.catalogue import WORLD
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.status_line import StatusLine
from rl_tui.tui.screens.key_line import KeyLine
from rl_tui.tui.screens.playground.actions.manual_keys import (
    DIGITS,
    acting_keys,
    action_towards,
    digit_keys,
    has_directions,
    prompts,
    title,
)
from rl_tui.tui.screens.playground.actions.subject import Subject

_STEPS: Final = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}
_BACK: Final = "escape"


def _binding(key: str, tooltip: str) -> Binding:
    # Before whatever is in focus: a slider or a table has uses of its own for these keys
    return Binding(
        key, f"manual_key('{key}')", key, show=False, priority=True, id=f"manual.{key}", tooltip=tooltip
    )


MANUAL_BINDINGS: Final[list[BindingType]] = [
    *(_binding(key, "Go there") for key in _STEPS),
    *(_binding(digit, "Take this action") for digit in DIGITS),
    _binding(_BACK, "Hand back"),
]


class ManualControl(Subject):
    """Taking over, acting, and handing back; ``is_on`` while a person is the agent."""

    is_on = False

    def takes(self, key: str) -> bool:
        """Return whether ``key`` acts: else arrows and digits are left to the panels, or to what is typed."""
        snapshot, focused = self.snapshot, self.screen.focused
        if isinstance(focused, Slider) and focused.is_typing:
            return False
        return self.is_on and (key not in _STEPS or (snapshot is not None and has_directions(snapshot)))

    def press(self, key: str) -> None:
        """Take the action of ``key``; escape hands back."""
        if key == _BACK:
            self.toggle()
        elif self.snapshot is not None and key in _STEPS:
            step = _STEPS[key]
            self._take(self.snapshot, action_towards(self.snapshot, step), self.glyphs.direction(step))
        elif self.snapshot is not None:
            self._take(self.snapshot, digit_keys(self.snapshot).get(key), key)

    def toggle(self) -> None:
        """Take over, or hand back."""
        if self.is_on:
            self.hand_back()
            self.screen.tell("the agent acts again")
            return
        snapshot = self.snapshot
        if snapshot is None or snapshot.playback.phase is Phase.PREPARING:
            return
        refused = _refused(snapshot)
        if refused:
            self.screen.tell(refused)
            return
        if snapshot.playback.phase is not Phase.PAUSED:
            self.link.send(Pause())
        self.board.bring_into_view(WORLD)
        self._show_mode(True)
        self.board.table.action_follow()
        self.show(snapshot)
        if self.board.world is not None:
            self.board.world.action_follow()
        text = f"you are the agent: act with {acting_keys(snapshot)}; y hands back"
        self.screen.tell(text)

    def hand_back(self) -> None:
        """Let the agent act again."""
        if self.is_on:
            self._show_mode(False)

    def note(self, command: Command) -> None:
        """Hand back where the agent is asked to go on by itself, or the run starts again."""
        if isinstance(command, Play | WatchLearning | RunEpisode | RunUntil | Restart):
            self.hand_back()

    def show(self, snapshot: Snapshot) -> None:
        """Show what can be done in ``snapshot``; hand back where nothing can be done any more."""
        if not self.is_on:
            return
        refused = _refused(snapshot)
        if refused:
            self.hand_back()
            self.screen.tell(refused)
        elif self.board.world is not None:
            glyphs = self.glyphs
            self.board.world.title = title(snapshot, glyphs)
            self.board.world.prompt = prompts(snapshot, glyphs)
            self.screen.query_one(KeyLine).hints = ((acting_keys(snapshot), "act"), *_HINTS)

    def _take(self, snapshot: Snapshot, action: int | None, key: str) -> None:
        if action is not None:
            self.link.send(Take(action))
            return
        text = f"{key} is no action here: act with {acting_keys(snapshot)}"
        self.screen.tell(text, severity="warning")

    def _show_mode(self, is_on: bool) -> None:
        self.is_on = is_on
        if self.board.world is not None:
            self.board.world.is_manual = is_on
        status = self.screen.query_one(StatusLine)
        status.is_manual = is_on
        status.redraw()
        if not is_on:
            self.screen.query_one(KeyLine).hints = ()


_HINTS: Final = (
    ("y", "hand back"),
    ("s", "agent's step"),
    ("space", "run"),
    ("?", "help"),
)


def _refused(snapshot: Snapshot) -> str:
    """Return why a person cannot act in place of the agent, empty if that is possible."""
    name = BY_ID[snapshot.agent.algorithm].name
    if BY_ID[snapshot.agent.algorithm].planner:
        return f"{name} takes no actions: it plans with the model; a chooses an agent"
    if snapshot.playback.phase is Phase.SPENT:
        return "the budget is spent; r starts again"
    return "the run has stopped; r starts again" if snapshot.playback.phase is Phase.STOPPED else ""
