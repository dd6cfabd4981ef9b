"""A person in place of the agent."""

from __future__ import annotations

from typing import Final

from textual.binding import Binding, BindingType

from rl_tui.agents.catalogue import BY_ID
from rl_tui.lab.live.commands import Command, Pause, Play, Restart, RunEpisode, RunUntil, Take
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.catalogue import WORLD
from rl_tui.tui.panels.status_line import StatusLine
from rl_tui.tui.screens.key_line import KeyLine
from rl_tui.tui.screens.playground.agent_actions import AgentActions
from rl_tui.tui.screens.playground.manual_control import (
    DIGITS,
    acting_keys,
    action_towards,
    digit_keys,
    has_directions,
    prompts,
    title,
)

_STEPS: Final = {"up": (-1, 0), "down": (1, 0), "left": (0, -1), "right": (0, 1)}

# Before whatever is in focus: a slider or a table has uses of its own for these keys
MANUAL_BINDINGS: Final[list[BindingType]] = [
    *(
        Binding(key, f"steer{step}", key, show=False, priority=True, id=f"manual.{key}", tooltip="Go there")
        for key, step in _STEPS.items()
    ),
    *(
        Binding(
            digit,
            f"act('{digit}')",
            digit,
            show=False,
            priority=True,
            id=f"manual.{digit}",
            tooltip="Take this action",
        )
        for digit in DIGITS
    ),
    Binding(
        "escape", "let_go", "hand back", show=False, priority=True, id="manual.back", tooltip="Hand back"
    ),
]


class ManualActions(AgentActions):
    """Taking over, and handing back."""

    is_manual = False

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave arrows and digits to the panels unless a person is the agent."""
        if action == "steer":
            return self.is_manual and self.snapshot is not None and has_directions(self.snapshot)
        if action in ("act", "let_go"):
            return self.is_manual
        return super().check_action(action, parameters)

    def action_take_over(self) -> None:
        """Take over, or hand back."""
        if self.is_manual:
            self.hand_back()
            self.tell("the agent acts again")
            return
        snapshot = self.snapshot
        if snapshot is None or snapshot.playback.phase is Phase.PREPARING:
            return
        refused = _refused(snapshot)
        if refused:
            self.tell(refused)
            return
        if snapshot.playback.phase is not Phase.PAUSED:
            self.send(Pause())
        self.bring_into_view(WORLD)
        self._show_mode(True)
        self.board.table.action_follow()
        self.show_manual_control(snapshot)
        if self.board.world is not None:
            self.board.world.action_follow()
        text = f"you are the agent: act with {acting_keys(snapshot)}; y hands back"
        self.tell(to_ascii(text, self.look.glyphs))

    def action_let_go(self) -> None:
        """Hand back."""
        self.action_take_over()

    def hand_back(self) -> None:
        """Let the agent act again."""
        if self.is_manual:
            self._show_mode(False)

    def note_sent(self, command: Command) -> None:
        """Hand back where the agent is asked to go on by itself, or the run starts again."""
        if isinstance(command, Play | RunEpisode | RunUntil | Restart):
            self.hand_back()

    def show_manual_control(self, snapshot: Snapshot) -> None:
        """Show what can be done in ``snapshot``; hand back where nothing can be done any more."""
        if not self.is_manual:
            return
        refused = _refused(snapshot)
        if refused:
            self.hand_back()
            self.tell(refused)
        elif self.board.world is not None:
            self.board.world.title = title(snapshot, self.look.glyphs)
            self.board.world.prompt = prompts(snapshot, self.look.glyphs)
            self.query_one(KeyLine).hints = ((acting_keys(snapshot), "act"), *_HINTS)

    def action_steer(self, rows: int, columns: int) -> None:
        """Take the action that goes so many rows down and columns to the right."""
        if self.snapshot is not None:
            arrow = self.look.glyphs.direction((rows, columns))
            self._take(action_towards(self.snapshot, (rows, columns)), arrow)

    def action_act(self, digit: str) -> None:
        """Take the action of a digit."""
        if self.snapshot is not None:
            self._take(digit_keys(self.snapshot).get(digit), digit)

    def _take(self, action: int | None, key: str) -> None:
        if self.snapshot is None:
            return
        if action is not None:
            self.send(Take(action))
            return
        text = f"{key} is no action here: act with {acting_keys(self.snapshot)}"
        self.notify(to_ascii(text, self.look.glyphs), severity="warning", markup=False)

    def _show_mode(self, is_manual: bool) -> None:
        self.is_manual = is_manual
        if self.board.world is not None:
            self.board.world.is_manual = is_manual
        status = self.query_one(StatusLine)
        status.is_manual = is_manual
        status.redraw()
        if not is_manual:
            self.query_one(KeyLine).hints = ()


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
