"""Requests that the newest snapshot may not show yet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live import commands
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.recipe import Recipe, Setting, changed_recipe
from rl_tui.runs.timeline.lane_view import LaneView


class Wanted:
    """The requests of commands, which snapshots may not show yet.

    ``recipe`` includes every change made. ``step``: target of the timeline, None once reached. ``sent``: the
    number of commands, with those that drawing causes. ``last_deed``: the same at the last one that changes
    something.
    """

    def __init__(self, recipe: Recipe, speed: float | None, lesson: LessonRecord | None = None) -> None:
        self.recipe = recipe
        self.speed = speed
        self.is_hidden = recipe.scenario.hides_answer
        self.was_hidden_by_person = False
        self.studied: PolicyKind | None = None
        self.lesson = lesson
        self.step: int | None = None
        self.sent = 0
        self.last_deed = 0

    def note(self, command: commands.Command) -> None:
        """Take over a command's request."""
        self.sent += 1
        if not isinstance(command, commands.LOOKING):
            self.last_deed = self.sent
        match command:
            case commands.SetSpeed(speed):
                self.speed = speed
            case commands.HideAnswer(is_hidden):
                self.is_hidden = self.was_hidden_by_person = is_hidden
            case commands.StudyPolicy(kind):
                self.studied = kind
            case commands.KeepLesson(lesson):
                self.lesson = lesson
            case commands.Restart(recipe):
                self.recipe = recipe
            case commands.Apply(change) if isinstance(change, Setting):
                self.recipe = changed_recipe(self.recipe, change)

    def take_over(self, lane: LaneView) -> None:
        """Start later changes from a run's settings."""
        seed = self.recipe.seed if lane.past is None else lane.past.begun.seed
        self.recipe = replace(
            self.recipe, algorithm=lane.algorithm, hyperparameters=lane.hyperparameters, seed=seed
        )

    def reconcile(self, snapshot: Snapshot) -> None:
        """Take over current values after all commands."""
        if self.is_taken_in(snapshot):
            self.recipe = in_force(snapshot)
            self.speed = snapshot.playback.speed
            self.is_hidden = snapshot.answers.is_hidden
            self.studied = snapshot.answers.studied
            self.lesson = None if snapshot.lesson is None else snapshot.lesson.record
        is_there = snapshot.timeline.current.here == self.step
        if snapshot.playback.phase is not Phase.SEEKING and (is_there or self.is_taken_in(snapshot)):
            self.step = None

    def was_used(self, snapshot: Snapshot | None) -> bool:
        """Return whether there is something to lose."""
        if snapshot is None:
            return False
        is_drawn = bool(snapshot.answers.drawn.choices or snapshot.world_changes)
        return snapshot.timeline.current.end > 0 or is_drawn or snapshot.playback.handled < self.last_deed

    def is_taken_in(self, snapshot: Snapshot) -> bool:
        """Return whether ``snapshot`` comes after all commands."""
        return snapshot.playback.handled == self.sent


def in_force(snapshot: Snapshot) -> Recipe:
    """Return the shown run's recipe, with current settings."""
    return replace(
        snapshot.recipe, algorithm=snapshot.agent.algorithm, hyperparameters=snapshot.agent.hyperparameters
    )


class PlayerLink:
    """Sends commands, and holds the newest snapshot."""

    def __init__(self, player: Player, wanted: Wanted, on_sent: Callable[[commands.Command], None]) -> None:
        self.player = player
        self.wanted = wanted
        self.snapshot: Snapshot | None = None
        self.settled: Snapshot | None = None
        """The newest snapshot, None while a later request is under way."""
        self._on_sent = on_sent

    def send(self, command: commands.Command) -> None:
        """Send ``command`` to the player."""
        self.settled = None
        self.wanted.note(command)
        self._on_sent(command)
        self.player.send(command)

    def receive(self, snapshot: Snapshot) -> None:
        """Make ``snapshot`` the newest."""
        self.snapshot = snapshot
        self.wanted.reconcile(snapshot)
        self.settled = snapshot if self.wanted.is_taken_in(snapshot) else None
