"""The request for a study of many seeds: the runs to train, and the process that does it.

There is at most one study at a time, in a process of the lowest priority.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import in_kiosk
from rl_tui.common.words import counted
from rl_tui.runs.background.background import Background
from rl_tui.runs.library import MOST_EPISODES, episodes_of
from rl_tui.runs.recipe import JournalEntry, Recipe, SwitchAlgorithm, TakeAction, WorldChange
from rl_tui.studies.many_seeds.figures import SeedStudy, StudyState
from rl_tui.worlds.drawing import Arms

if TYPE_CHECKING:
    from rl_tui.runs.timeline.run_group import RunGroup


# The request


FIRST_BLOCK: Final = 8
"""Seeds after which there is something to see; then they are doubled. Stepped worlds come to no more."""
MOST_SEEDS: Final = 256
MOST_STEPS: Final = 2_000_000
"""Steps of one seed."""
MOST_PAIRS: Final = 1_000_000
"""A world with more states and actions has no study: each lane would take a gigabyte."""


@dataclass(frozen=True, slots=True)
class StudiedRun:
    """A run on screen: where it began, and what was set on the way."""

    recipe: Recipe
    journal: tuple[JournalEntry, ...]

    @property
    def algorithms(self) -> list[str]:
        """The ids of all algorithms at work in it, one after the other."""
        switches = (entry.change for entry in self.journal)
        return [self.recipe.algorithm, *(s.algorithm for s in switches if isinstance(s, SwitchAlgorithm))]

    @property
    def plans(self) -> bool:
        """Whether a planner is among them, whose sweeps have no returns."""
        return any(BY_ID[algorithm].planner for algorithm in self.algorithms)

    @property
    def is_by_luck(self) -> bool:
        """Whether another seed may come to something else."""
        only_plans = all(BY_ID[algorithm].planner for algorithm in self.algorithms)
        return not only_plans or self.recipe.scenario.section.drawn_from_seed


@dataclass(frozen=True, slots=True)
class StudyRequest:
    """What a study is to work out."""

    lanes: tuple[StudiedRun, ...]
    """The runs on screen."""
    shown: int
    """Which of them is shown."""
    episodes: int | None
    """Episodes of each seed, unless that takes too many steps; None where ``steps`` end it."""
    steps: int | None
    """Steps of each seed, where they end it."""
    most: int
    """The number of seeds to come to."""
    is_awaited: bool
    """Whether all else waits for it, so that it need not let others go first."""
    message: str
    """How it is bounded, or what is left out, in words; mostly empty."""

    @property
    def nothing_yet(self) -> SeedStudy:
        """What is known before the first seed."""
        return SeedStudy(
            StudyState.STARTING,
            shown=self.shown,
            most=self.most,
            episodes=self.episodes,
            steps=self.steps,
            message=self.message,
        )


def studied_runs(group: RunGroup) -> tuple[StudiedRun, ...]:
    """Return the runs of ``group`` with all that was changed on the branch in force, be it ahead of them."""
    return tuple(
        StudiedRun(record.recipe, record.branches[record.branch].journal) for record in group.records()
    )


def study_request(group: RunGroup, *, is_awaited: bool) -> StudyRequest:
    """Return what to work out of the runs of ``group``; the first block alone if it ``is_awaited``.

    Steps taken by a person are left out. Raises UserError where there is nothing to be worked out.
    """
    if in_kiosk():
        raise UserError("many seeds are not worked out in a kiosk")
    lanes = studied_runs(group)
    if not any(lane.is_by_luck for lane in lanes):
        raise UserError("a planner knows the world: every seed comes to the same, so there is nothing to see")
    if len({lane.recipe.seed for lane in lanes}) > 1:
        raise UserError("the runs have different seeds; c e ends the one you control")
    run = group.current.run
    if run.world.space.pairs > MOST_PAIRS:
        raise UserError(f"many seeds are not worked out above {MOST_PAIRS:,} pairs of state and action")
    episodes, steps, note = _length(group, lanes)
    notes = [note] if note else []
    if any(isinstance(entry.change, TakeAction) for lane in lanes for entry in lane.journal):
        notes.append("steps taken by a person are left out")
    most = MOST_SEEDS if run.learner.rewindable and not is_awaited else FIRST_BLOCK
    if not run.learner.rewindable:
        notes.append(f"an environment that is stepped for real has {FIRST_BLOCK} seeds")
    return StudyRequest(
        lanes=tuple(map(_settings_only, lanes)),
        shown=group.shown,
        episodes=episodes,
        steps=steps,
        most=most,
        is_awaited=is_awaited,
        message="; ".join(notes),
    )


def _length(group: RunGroup, lanes: tuple[StudiedRun, ...]) -> tuple[int | None, int | None, str]:
    """Return after how many episodes, or else steps, each seed ends, and what is to be said of that.

    A change on the way has its step, which other seeds may not come to in as many episodes, and the sweeps
    of a planner are no episodes: then steps end a seed.
    """
    runs, world = group.runs, group.current.run.world
    step = max(run.step for run in runs)
    plans = any(lane.plans for lane in lanes)
    is_changed = any(0 < entry.step <= step for lane in lanes for entry in _settings_only(lane).journal)
    # the pulls of a bandit are its episodes
    if step and (plans or (is_changed and not isinstance(world.drawing, Arms))):
        why = "a planner's backups are steps, not episodes" if plans else f"{_changed(lanes)} on the way"
        steps = min(step, MOST_STEPS)
        further = ", though this run is further" if step > steps else ""
        return None, steps, f"{why}: each seed ends after {counted(steps, 'step')}{further}"
    usual = min(episodes_of(lanes[group.shown].recipe.scenario), world.budget or MOST_EPISODES)
    finished = min(run.learner.episodes for run in runs)
    if finished > usual:
        return usual, None, f"each seed has only the {counted(usual, 'episode')} that are usual here"
    if not finished:
        who = "the run" if len(runs) == 1 else "a lane"
        return usual, None, f"the usual {counted(usual, 'episode')}: {who} has none yet"
    return finished, None, ""


def _changed(lanes: tuple[StudiedRun, ...]) -> str:
    is_edited = any(isinstance(entry.change, WorldChange) for lane in lanes for entry in lane.journal)
    return "the world was changed" if is_edited else "settings were changed"


def _settings_only(lane: StudiedRun) -> StudiedRun:
    journal = tuple(entry for entry in lane.journal if not isinstance(entry.change, TakeAction))
    return StudiedRun(lane.recipe, journal)


# The process


WORK: Final = "rl_tui.studies.many_seeds.study:work"
"""What runs in its process: it needs much that this one need not load."""


class SeedStudies:
    """Has studies worked out in a process of their own, at the lowest priority.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`begin`
    waits for the end of a study of one block, so that what is known does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[StudyRequest, SeedStudy](WORK, on_news)
        self._refused: SeedStudy | None = None
        self._lanes: tuple[StudiedRun, ...] = ()

    def begin(self, group: RunGroup) -> None:
        """Begin a study of the runs of ``group`` as they are now, in place of any other.

        Where there can be none, the study says why.
        """
        self.end()
        self._lanes = studied_runs(group)
        try:
            request = study_request(group, is_awaited=not self._automatic)
            process = self._background.begin(request, request.nothing_yet)
        except (UserError, OSError) as reason:
            if isinstance(reason, UserError):
                self._refused = SeedStudy(StudyState.REFUSED, message=str(reason))
            else:
                why = f"no process can be started: {reason}"
                self._refused = SeedStudy(StudyState.FAILED, message=why)
            return
        if process is not None and not self._automatic:
            process.wait()

    def end(self) -> None:
        """End the study; nothing of it is known any more."""
        self._background.end()
        self._refused = None

    def close(self) -> None:
        """End the study, from any thread, and begin none any more."""
        self._background.close()

    def study_of(self, group: RunGroup) -> SeedStudy | None:
        """Return what is known by now, with whether it is of the runs of ``group``; None without a study."""
        process = self._background.process
        study = self._refused if process is None else process.known
        if study is None:
            return None
        if process is not None and process.failed and not study.is_over:
            study = replace(study, state=StudyState.FAILED, message=process.failed)
        elif process is not None and not study.is_over:
            study = replace(study, how_long=process.how_long)
        return study if studied_runs(group) == self._lanes else replace(study, is_outdated=True)
