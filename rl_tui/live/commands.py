"""Commands that a screen sends to a player."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rl_tui.runs.recipe import TakeAction

if TYPE_CHECKING:
    from rl_tui.agents.catalogue import SweepPhase
    from rl_tui.lessons.file.view import LessonRecord
    from rl_tui.live.pace.until import Until
    from rl_tui.live.viewport import Viewport
    from rl_tui.runs.answers.policy_kind import PolicyKind
    from rl_tui.runs.recipe import Change, Recipe, Setting
    from rl_tui.runs.timeline.checkpoints import Seek
    from rl_tui.worlds.editing.edit import Edit


class Command:
    """A request to the player."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Play(Command):
    """Run at the chosen speed."""


@dataclass(frozen=True, slots=True)
class WatchLearning(Command):
    """Run at a speed that follows learning."""


@dataclass(frozen=True, slots=True)
class Pause(Command):
    """Pause, and end `RunEpisode` and the like early."""


@dataclass(frozen=True, slots=True)
class Step(Command):
    """Pause if running, and take one step."""


@dataclass(frozen=True, slots=True)
class RunEpisode(Command):
    """Run at full speed to the episode's end, then pause."""


@dataclass(frozen=True, slots=True)
class RunSweep(Command):
    """Run at full speed to the end of a sweep of `phase`, after any other one, then pause."""

    phase: SweepPhase


@dataclass(frozen=True, slots=True)
class Train(Command):
    """Take exactly `steps` steps (fewer if the run ends) first."""

    steps: int


@dataclass(frozen=True, slots=True)
class LetPass(Command):
    """Let `ticks` sixtieths of a second pass for a run without a clock, and take the steps then due first."""

    ticks: int


@dataclass(frozen=True, slots=True)
class SetSpeed(Command):
    """Set the speed in steps per second, None for full speed."""

    speed: float | None


@dataclass(frozen=True, slots=True)
class Apply(Command):
    """Make a change before the next step."""

    change: Change


@dataclass(frozen=True, slots=True)
class Restart(Command):
    """Restart from `recipe`, paused."""

    recipe: Recipe


@dataclass(frozen=True, slots=True)
class LookAt(Command):
    """Copy only `viewport` of a large world."""

    viewport: Viewport


@dataclass(frozen=True, slots=True)
class StepBack(Command):
    """Pause one step earlier."""


@dataclass(frozen=True, slots=True)
class EpisodeBack(Command):
    """Pause at the beginning of the episode or, if just begun, of the previous one."""


@dataclass(frozen=True, slots=True)
class GoTo(Command):
    """Pause at `step`, or at the beginning of `episode` (from 1), within the reached part of the branch."""

    step: int | None = None
    episode: int | None = None


@dataclass(frozen=True, slots=True)
class ChooseBranch(Command):
    """Pause on another branch at this step, or at its end if earlier."""

    branch: int


@dataclass(frozen=True, slots=True)
class RunUntil(Command):
    """Run at full speed until an event, then pause."""

    until: Until


@dataclass(frozen=True, slots=True)
class ToggleBreakpoint(Command):
    """Set or clear a breakpoint."""

    state: int | None = None
    pair: int | None = None


@dataclass(frozen=True, slots=True)
class ClearBreakpoints(Command):
    """Clear all breakpoints."""


@dataclass(frozen=True, slots=True)
class Take(Command):
    """Pause if running, and take one step with this action."""

    action: int


@dataclass(frozen=True, slots=True)
class AddLane(Command):
    """Add a run that differs by `changes`, perhaps with a new seed."""

    changes: tuple[Setting, ...] = ()
    next_seed: bool = False


@dataclass(frozen=True, slots=True)
class AddBranch(Command):
    """Show a branch (from 0) as a second run."""

    branch: int


@dataclass(frozen=True, slots=True)
class ChooseLane(Command):
    """Make another run (from 0) visible, to which later changes apply."""

    lane: int


@dataclass(frozen=True, slots=True)
class DropLane(Command):
    """End a run (from 0), but not the only one."""

    lane: int


@dataclass(frozen=True, slots=True)
class MarkLane(Command):
    """Make a run (from 0) the second visible one."""

    lane: int


@dataclass(frozen=True, slots=True)
class StudySeeds(Command):
    """Train under many seeds in the background, replacing an earlier study."""


@dataclass(frozen=True, slots=True)
class EndStudy(Command):
    """End and hide the study of many seeds."""


@dataclass(frozen=True, slots=True)
class FollowCell(Command):
    """Report the history of Q of `pair`, None to stop."""

    pair: int | None


@dataclass(frozen=True, slots=True)
class AskFlips(Command):
    """Report at which γ the optimal actions change."""


@dataclass(frozen=True, slots=True)
class AskCheck(Command):
    """Report the world check as it arrives, or stop."""

    is_asked: bool


@dataclass(frozen=True, slots=True)
class StudyPolicy(Command):
    """Report values of this policy, None to stop."""

    kind: PolicyKind | None


@dataclass(frozen=True, slots=True)
class DrawAction(Command):
    """Set or remove a state's action in the drawn policy."""

    state: int
    action: int | None


@dataclass(frozen=True, slots=True)
class ClearDrawing(Command):
    """Clear the drawn policy."""


@dataclass(frozen=True, slots=True)
class HideAnswer(Command):
    """Hide or show exact answers."""

    is_hidden: bool


@dataclass(frozen=True, slots=True)
class OpenEditor(Command):
    """Report the draft of the visible world, or stop."""

    is_open: bool


@dataclass(frozen=True, slots=True)
class DrawWorld(Command):
    """Edit the visible world in one stroke, pending until later ones make it valid."""

    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class UndoStroke(Command):
    """Undo the last stroke, pending or applied."""


@dataclass(frozen=True, slots=True)
class RedoStroke(Command):
    """Redo the last undone stroke."""


@dataclass(frozen=True, slots=True)
class AskWhy(Command):
    """Report why nothing is learned yet, or only slowly."""

    is_asked: bool


@dataclass(frozen=True, slots=True)
class ChooseTable(Command):
    """Restart the watched program with another table as its Q."""

    name: str


@dataclass(frozen=True, slots=True)
class KeepLesson(Command):
    """Save progress in a lesson, and judge its open task. An open prediction pauses the run."""

    lesson: LessonRecord


@dataclass(frozen=True, slots=True)
class WatchProgram(Command):
    """Watch a program file for the open task."""

    path: Path


_AT_ANY_TIME: Final = (
    *(LetPass, LookAt, FollowCell, MarkLane, EndStudy, SetSpeed),
    *(StudyPolicy, AskFlips, AskCheck, AskWhy, OpenEditor),
)
LOOKING: Final = (*_AT_ANY_TIME, StudySeeds)
"""Commands that change nothing worth saving."""

MOVES: Final = (Play, WatchLearning, Pause, Step, RunEpisode, RunUntil, Take, Train)
"""Commands without effect once a run has ended."""

_TAKES_STEPS: Final = (Play, WatchLearning, Step, RunEpisode, RunSweep, RunUntil, Take, Train)

_BESIDE: Final = (Pause, DrawAction, ClearDrawing, HideAnswer, KeepLesson, WatchProgram, *_AT_ANY_TIME)

_WHILE_SEEKING: Final = (StepBack, GoTo, DropLane, *_BESIDE)
"""Commands that replace a seek, or do not affect it."""

WHILE_REBUILDING: Final = (Play, Restart, DrawWorld, UndoStroke, RedoStroke, *_BESIDE)
"""Commands that need not wait for a world that is being rebuilt."""

_FROM_HERE: Final = (StepBack, EpisodeBack, ChooseBranch)
"""Commands that need the target of the visible run only."""


def takes_steps(command: Command) -> bool:
    """Return True if `command` makes runs advance."""
    is_action = isinstance(command, Apply) and isinstance(command.change, TakeAction)
    return is_action or isinstance(command, _TAKES_STEPS)


def is_taken_while_seeking(command: Command, seek: Seek | None) -> bool:
    """Return True if `command` need not wait. `seek` is None if only other runs seek."""
    kind = type(command)
    if seek is None and kind in _FROM_HERE:
        return True
    knows_where = seek is not None and seek.target.step is not None
    return kind in _WHILE_SEEKING and (knows_where or kind is not StepBack)
