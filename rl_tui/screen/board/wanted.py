"""What a person asks the player for, and what was asked until a snapshot has caught up with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.commands import (
    LOOKING,
    Apply,
    Command,
    HideAnswer,
    KeepLesson,
    Restart,
    SetSpeed,
    StudyPolicy,
)
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.recipe import Recipe, Setting, changed_recipe
from rl_tui.runs.timeline.lane_view import LaneView


class Wanted:
    """What commands ask for, beside the newest snapshot, which reconciles them with what is in force.

    ``recipe`` is what a restart starts from: with every change made, be it in force already or not. ``speed``
    is in steps a second, None for as fast as it goes. ``is_hidden`` says that the answer is,
    ``was_hidden_by_person`` that a person has hidden it. ``studied`` is the policy that is, None where none
    is. ``lesson`` is how far the learner has come, None where there is no lesson. ``step`` is where the
    handle of the timeline was put, None once the run has come to it. ``sent`` counts the commands,
    ``last_deed`` tells how many had been sent with the last one that does more than look.
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

    def note(self, command: Command) -> None:
        """Take over what ``command``, which is being sent, asks for."""
        self.sent += 1
        if not isinstance(command, LOOKING):
            self.last_deed = self.sent
        match command:
            case SetSpeed(speed):
                self.speed = speed
            case HideAnswer(is_hidden):
                self.is_hidden = self.was_hidden_by_person = is_hidden
            case StudyPolicy(kind):
                self.studied = kind
            case KeepLesson(lesson):
                self.lesson = lesson
            case Restart(recipe):
                self.recipe = recipe
            case Apply(change) if isinstance(change, Setting):
                self.recipe = changed_recipe(self.recipe, change)

    def take_over(self, lane: LaneView) -> None:
        """Let whatever is changed from here on start from what is in force in ``lane``."""
        seed = self.recipe.seed if lane.past is None else lane.past.begun.seed
        self.recipe = replace(
            self.recipe, algorithm=lane.algorithm, hyperparameters=lane.hyperparameters, seed=seed
        )

    def reconcile(self, snapshot: Snapshot) -> None:
        """Let what is in force count again, once the player has taken in all that was sent."""
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
        """Return whether there is something to lose; what was asked for last may not be there yet."""
        if snapshot is None:
            return False
        is_drawn = bool(snapshot.answers.drawn.choices or snapshot.world_changes)
        return snapshot.timeline.current.end > 0 or is_drawn or snapshot.playback.handled < self.last_deed

    def is_taken_in(self, snapshot: Snapshot) -> bool:
        """Return True if ``snapshot`` comes after all that was sent."""
        return snapshot.playback.handled == self.sent


def in_force(snapshot: Snapshot) -> Recipe:
    """Return the recipe of the run shown with the settings in force at this moment."""
    return replace(
        snapshot.recipe, algorithm=snapshot.agent.algorithm, hyperparameters=snapshot.agent.hyperparameters
    )


# The way to the player and back


class PlayerLink:
    """Sends commands and holds the newest snapshot, None before the first; ``on_sent`` hears each command."""

    def __init__(self, player: Player, wanted: Wanted, on_sent: Callable[[Command], None]) -> None:
        self.player = player
        self.wanted = wanted
        self.snapshot: Snapshot | None = None
        self.settled: Snapshot | None = None
        """The newest snapshot, None while something is under way that was asked for after it."""
        self.sent = 0
        """How many commands were sent, also such as were sent because of what was drawn."""
        self._on_sent = on_sent

    def send(self, command: Command) -> None:
        """Ask the player for something."""
        self.sent += 1
        self.settled = None
        self.wanted.note(command)
        self._on_sent(command)
        self.player.send(command)

    def receive(self, snapshot: Snapshot) -> None:
        """Take ``snapshot`` for the newest."""
        self.snapshot = snapshot
        self.wanted.reconcile(snapshot)
        self.settled = snapshot if self.wanted.is_taken_in(snapshot) else None
