"""A person acts for the agent."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Final

from rl_tui.live.commands import Command, Pause, Play, Restart, RunEpisode, RunUntil, Take, WatchLearning
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.draw.names import state_name
from rl_tui.screen.frame.key_line import Hints
from rl_tui.screen.kit.row import WORLD
from rl_tui.screen.kit.snapshot_facts import why_over
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.playground.actions.kept_back import PREDICT_FIRST
from rl_tui.screen.playground.modes import action_keys
from rl_tui.screen.playground.modes.mode import LEAVE, STEPS, KeyMode
from rl_tui.screen.theme.glyphs import Glyphs

MANUAL_TITLE: Final = "You are the agent"
_HAND_BACK: Final = " · y: hand back"


class ManualControl(KeyMode):
    """A person takes the agent's steps."""

    keys: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(STEPS, "Go there"),
        **dict.fromkeys(action_keys.DIGITS, "Take this action"),
        LEAVE: "Hand back",
    }
    way_back = "click or tab here to act · y: hand back", "tab here to act · y: hand back", "y: hand back"
    needs_focus = False
    _has_resumed = False

    def takes(self, key: str) -> bool:
        """Return whether ``key`` acts or hands back."""
        snapshot = self.snapshot
        if key in STEPS:
            return snapshot is not None and action_keys.has_directions(snapshot.world)
        return key in action_keys.DIGITS or key == LEAVE

    def has_on_a_page(self, key: str) -> bool:
        """Return True for digits on a lesson page."""
        return key in action_keys.DIGITS and self.screen.focused is self.board.lesson.panel

    def press(self, key: str) -> None:
        """Take the key's action in view of the world, or hand back."""
        snapshot = self.snapshot
        if not self.board.lesson.is_docked:
            self.board.lesson.reads = False
        if key == LEAVE:
            self.toggle()
        elif snapshot is not None and key in STEPS:
            step = STEPS[key]
            action = action_keys.action_towards(snapshot.world, action_keys.acts_in(snapshot), step)
            self._take(snapshot, action, self.glyphs.direction(step))
        elif snapshot is not None:
            self._take(
                snapshot, action_keys.digit_keys(snapshot.world, action_keys.acts_in(snapshot)).get(key), key
            )

    def why_not(self, deed: str) -> str:
        """Explain why a person cannot act now."""
        return "" if self.is_on or self.snapshot is None else _refused(self.snapshot)

    def toggle(self) -> None:
        """Take over, or hand back."""
        if self.is_on:
            self.leave()
            self.screen.tell("The agent acts again.")
            return
        snapshot = self.snapshot
        if snapshot is None or snapshot.playback.phase is Phase.PREPARING:
            return
        if snapshot.playback.phase is not Phase.PAUSED:
            self.link.send(Pause())
        self.board.bring_into_view(WORLD)
        self.enter()
        self.board.table.action_follow()
        self.show(snapshot)
        if self.board.world is not None:
            self.board.world.action_follow()
        text = f"You act, with {_keys(snapshot)}. y: stop."
        self.screen.tell(text)

    def resume(self, snapshot: Snapshot) -> None:
        """Take over once, if a resumed lesson follows a person's step."""
        if self._has_resumed or snapshot.playback.phase in (Phase.PREPARING, Phase.SEEKING):
            return
        self._has_resumed = True
        last = snapshot.counters.last_step
        if last is not None and last.by_hand and not self.is_on and not _refused(snapshot):
            self.enter()
            self.show(snapshot)

    def enter(self) -> None:
        """Take over."""
        super().enter()
        self._show(is_on=True)

    def leave(self) -> None:
        """Hand back."""
        if self.is_on:
            super().leave()
            self._show(is_on=False)

    def note(self, command: Command) -> None:
        """Hand back if ``command`` makes the agent act or restarts the run."""
        if isinstance(command, Play | WatchLearning | RunEpisode | RunUntil | Restart):
            self.leave()

    def show(self, snapshot: Snapshot) -> None:
        """Show the available actions, or hand back."""
        refused = _refused(snapshot)
        if refused:
            self.leave()
            self.screen.refuse(refused)
            return
        glyphs, record = self.glyphs, self.link.wanted.lesson
        hints: Hints = ((_keys(snapshot), "act"), *_HINTS)
        border = prompts(snapshot, glyphs)
        if record is not None and "run" in record.hidden:
            hints, border = (_HINTS[0], _HINTS[-1]), (f"{PREDICT_FIRST}{_HAND_BACK}", PREDICT_FIRST)
        if record is not None and (offers := self.board.lesson.panel.offers):
            hints = (*offers[-1][:1], *hints)  # first the key that the page asks for
        self._write(title(snapshot, glyphs), border, hints)

    def _take(self, snapshot: Snapshot, action: int | None, key: str) -> None:
        if action is not None:
            self.link.send(Take(action))
            return
        text = f"{key} is not an action here: act with {_keys(snapshot)}"
        self.screen.tell(text, severity="warning")

    def _show(self, *, is_on: bool) -> None:
        if self.board.world is not None:
            self.board.world.is_manual = is_on
            self.board.world.redraw()
        for each in (self.screen.query_one(StatusLine), self.board.lesson.panel):
            each.is_manual = is_on
            each.redraw()


_HINTS: Final = (("y", "hand back"), ("s", "agent's step"), ("space", "run"), ("?", "keys"))


def _refused(snapshot: Snapshot) -> str:
    name = snapshot.agent.row.name
    if snapshot.agent.row.planner:
        return f"{name} takes no actions: it plans. a a: choose an agent"
    return why_over(snapshot)


def title(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return titles of a panel, longest first."""
    state = action_keys.acts_in(snapshot)
    if snapshot.world.is_bandit or state == snapshot.counters.state:
        return (MANUAL_TITLE,)
    start = f"starts at {state_name(snapshot.world, state, glyphs)}"
    return f"{MANUAL_TITLE} · {start}", f"You act · {start}", MANUAL_TITLE


def prompts(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return actions and the way back."""
    keys = _keys(snapshot)
    brief = (f"{keys}: act{_HAND_BACK}", f"{keys}: act", "y: hand back")
    forms = action_keys.actions_in_a_line(snapshot.world, action_keys.acts_in(snapshot), glyphs)
    return (*(f"{form}{_HAND_BACK}" for form in forms[:2]), *forms[:1], *forms[1:], *brief)


def _keys(snapshot: Snapshot) -> str:
    return action_keys.acting_keys(snapshot.world, action_keys.acts_in(snapshot))
