"""What a screen may ask of a player."""

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
    """What a screen asks of the player."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Play(Command):
    """Run on at the wanted speed."""


@dataclass(frozen=True, slots=True)
class WatchLearning(Command):
    """Run on at a speed that goes by what is learned, until another speed is set."""


@dataclass(frozen=True, slots=True)
class Pause(Command):
    """Stand still; also breaks off an episode under way."""


@dataclass(frozen=True, slots=True)
class Step(Command):
    """Pause if running, and take one step."""


@dataclass(frozen=True, slots=True)
class RunEpisode(Command):
    """Run to the end of the episode under way, as fast as it goes, and pause there."""


@dataclass(frozen=True, slots=True)
class RunSweep(Command):
    """Run to the end of a sweep of ``phase``, as fast as it goes, and pause there.

    That is the sweep under way if it is one; else it is finished, and the next one is ordered.
    """

    phase: SweepPhase


@dataclass(frozen=True, slots=True)
class Train(Command):
    """Take exactly ``steps`` steps (fewer only where the run ends) before any other command counts."""

    steps: int


@dataclass(frozen=True, slots=True)
class SetSpeed(Command):
    """Steps a second to aim at from now on; None for as fast as it goes."""

    speed: float | None


@dataclass(frozen=True, slots=True)
class Apply(Command):
    """Change a hyper-parameter or the algorithm before the next step."""

    change: Change


@dataclass(frozen=True, slots=True)
class Restart(Command):
    """Start again from ``recipe``, paused."""

    recipe: Recipe


@dataclass(frozen=True, slots=True)
class LookAt(Command):
    """Copy no more than ``viewport`` shows of a world that is too large to be copied whole."""

    viewport: Viewport


@dataclass(frozen=True, slots=True)
class StepBack(Command):
    """Pause, one step earlier."""


@dataclass(frozen=True, slots=True)
class EpisodeBack(Command):
    """Pause where the episode under way began, or the one before it if it has only begun."""


@dataclass(frozen=True, slots=True)
class GoTo(Command):
    """Pause at ``step``, or where ``episode`` (from 1) begins; at most as far as the branch has come."""

    step: int | None = None
    episode: int | None = None


@dataclass(frozen=True, slots=True)
class ChooseBranch(Command):
    """Go to another branch and pause there: at this step, or as far as it has come if that is less."""

    branch: int


@dataclass(frozen=True, slots=True)
class RunUntil(Command):
    """Run as fast as it goes until something happens, and pause there."""

    until: Until


@dataclass(frozen=True, slots=True)
class ToggleBreakpoint(Command):
    """Set a breakpoint on a state or on a state–action pair, or take it away."""

    state: int | None = None
    pair: int | None = None


@dataclass(frozen=True, slots=True)
class ClearBreakpoints(Command):
    """Take all breakpoints away."""


@dataclass(frozen=True, slots=True)
class Take(Command):
    """Pause if running, and take one step with this action (its number) in place of the agent."""

    action: int


@dataclass(frozen=True, slots=True)
class AddLane(Command):
    """Begin another run beside the one shown, the same but for ``changes``, and let it catch up.

    With ``next_seed`` it has a seed that no run beside it has, else that of the run shown.
    """

    changes: tuple[Setting, ...] = ()
    next_seed: bool = False


@dataclass(frozen=True, slots=True)
class AddBranch(Command):
    """Let a branch of the run shown, counted from 0, stand beside it as a run of its own."""

    branch: int


@dataclass(frozen=True, slots=True)
class ChooseLane(Command):
    """Show another lane, counted from 0: what is changed from now on is changed there."""

    lane: int


@dataclass(frozen=True, slots=True)
class DropLane(Command):
    """End a lane, counted from 0, unless it is the only one."""

    lane: int


@dataclass(frozen=True, slots=True)
class MarkLane(Command):
    """Let a lane, counted from 0, stand beside the one shown."""

    lane: int


@dataclass(frozen=True, slots=True)
class StudySeeds(Command):
    """Work out, beside all else, what many seeds say of the runs as they are now; a study under way ends."""


@dataclass(frozen=True, slots=True)
class EndStudy(Command):
    """Work out no more, and show nothing of it."""


@dataclass(frozen=True, slots=True)
class FollowCell(Command):
    """Tell in every snapshot how Q of ``pair`` went; None: of no pair."""

    pair: int | None


@dataclass(frozen=True, slots=True)
class AskFlips(Command):
    """Tell in every snapshot at which γ the optimal actions of the world shown change, once that is known."""


@dataclass(frozen=True, slots=True)
class AskCheck(Command):
    """Tell in every snapshot what an author wants to know of the world, as it comes, or tell it no more."""

    is_asked: bool


@dataclass(frozen=True, slots=True)
class StudyPolicy(Command):
    """Tell in every snapshot what policies are worth, with all values of this one; None: of none."""

    kind: PolicyKind | None


@dataclass(frozen=True, slots=True)
class DrawAction(Command):
    """Choose an action (its number) in a state for the drawn policy; None: none."""

    state: int
    action: int | None


@dataclass(frozen=True, slots=True)
class ClearDrawing(Command):
    """Forget the drawn policy."""


@dataclass(frozen=True, slots=True)
class HideAnswer(Command):
    """Hide whatever would give the answer away, or show it."""

    is_hidden: bool


@dataclass(frozen=True, slots=True)
class OpenEditor(Command):
    """Let snapshots tell what is being drawn of the world of the run shown, or tell it no more."""

    is_open: bool


@dataclass(frozen=True, slots=True)
class DrawWorld(Command):
    """Make these edits in the world of the run shown, as one stroke.

    Where they come to no valid MDP, they wait, with those that wait already, for what makes it one.
    """

    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class UndoStroke(Command):
    """Undo the last stroke, be it one that waits or one that was made."""


@dataclass(frozen=True, slots=True)
class RedoStroke(Command):
    """Make the stroke again that was undone last."""


@dataclass(frozen=True, slots=True)
class AskWhy(Command):
    """Tell in every snapshot how long nothing is learned, and why, or only where that takes many episodes."""

    is_asked: bool


@dataclass(frozen=True, slots=True)
class ChooseTable(Command):
    """Start the program that is watched again, with the table of this name taken for the one that learns."""

    name: str


@dataclass(frozen=True, slots=True)
class KeepLesson(Command):
    """Keep with the runs how far the learner has come in a lesson, and judge the task of its open page.

    With a prediction open, the run shown stands still.
    """

    lesson: LessonRecord


@dataclass(frozen=True, slots=True)
class WatchProgram(Command):
    """Watch the program in this file, in a process of its own, for the task of the lesson's open page."""

    path: Path


_AT_ANY_TIME: Final = (
    *(LookAt, FollowCell, MarkLane, EndStudy, SetSpeed, StudyPolicy, AskFlips, AskCheck, AskWhy, OpenEditor),
)
LOOKING: Final = (*_AT_ANY_TIME, StudySeeds)
"""Commands that leave nothing behind that is worth keeping."""

MOVES: Final = (Play, WatchLearning, Pause, Step, RunEpisode, RunUntil, Take, Train)
"""Commands that mean nothing where a run takes no further step."""

_TAKES_STEPS: Final = (Play, WatchLearning, Step, RunEpisode, RunSweep, RunUntil, Take, Train)

_BESIDE: Final = (Pause, DrawAction, ClearDrawing, HideAnswer, KeepLesson, WatchProgram, *_AT_ANY_TIME)

_WHILE_SEEKING: Final = (StepBack, GoTo, DropLane, *_BESIDE)
"""Commands that replace a seek under way, or leave it alone."""

WHILE_REBUILDING: Final = (Play, Restart, DrawWorld, UndoStroke, RedoStroke, *_BESIDE)
"""Commands that need not wait for a world that is being rebuilt."""

_FROM_HERE: Final = (StepBack, EpisodeBack, ChooseBranch)
"""Commands that need to know where the run shown is to stand, but not where the others are."""


def takes_steps(command: Command) -> bool:
    """Return True if runs go further by ``command``."""
    is_action = isinstance(command, Apply) and isinstance(command.change, TakeAction)
    return is_action or isinstance(command, _TAKES_STEPS)


def is_taken_while_seeking(command: Command, seek: Seek | None) -> bool:
    """Return True if ``command`` need not wait until runs are where they have to be.

    ``seek`` is the way of the run shown; None where that is there already, and others have to catch up.
    """
    kind = type(command)
    if seek is None and kind in _FROM_HERE:
        return True
    knows_where = seek is not None and seek.target.step is not None
    return kind in _WHILE_SEEKING and (knows_where or kind is not StepBack)
