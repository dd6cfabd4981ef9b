"""What a study is asked for: the runs on screen as data, and how far each seed is to go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import in_kiosk
from rl_tui.common.words import counted
from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.lab.run.library import MOST_EPISODES, episodes_of
from rl_tui.lab.run.recipe import JournalEntry, Recipe, SwitchAlgorithm, TakeAction
from rl_tui.worlds.gym.modules import ALLOWED

if TYPE_CHECKING:
    from rl_tui.lab.timeline.run_group import RunGroup

FIRST_BLOCK: Final = 8
"""Seeds after which there is something to see; then they are doubled. Stepped worlds come to no more."""
MOST_SEEDS: Final = 256


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
    episodes: int
    """Episodes of each seed, unless that takes too many steps."""
    most: int
    """The number of seeds to come to."""
    is_awaited: bool
    """Whether all else waits for it, so that it need not let others go first."""
    modules: frozenset[str]
    """The modules that the id of an environment may import."""
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
            message=self.message,
        )


def studied_runs(group: RunGroup) -> tuple[StudiedRun, ...]:
    """Return the runs of ``group`` with all that was changed on the branch in force, be it ahead of them."""
    return tuple(
        StudiedRun(record.recipe, record.branches[record.branch].journal) for record in group.records
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
    notes = list[str]()
    run, scenario = group.current.run, lanes[group.shown].recipe.scenario
    usual = min(episodes_of(scenario), run.world.budget or MOST_EPISODES)
    finished = run.learner.episodes - run.learner.planned.sweeps
    if finished > usual:
        notes.append(f"each seed has only the {counted(usual, 'episode')} that are usual here")
    if any(isinstance(entry.change, TakeAction) for lane in lanes for entry in lane.journal):
        notes.append("steps taken by a person are left out")
    most = MOST_SEEDS if run.learner.rewindable and not is_awaited else FIRST_BLOCK
    if not run.learner.rewindable:
        notes.append(f"an environment that is stepped for real has {FIRST_BLOCK} seeds")
    return StudyRequest(
        lanes=tuple(map(_settings_only, lanes)),
        shown=group.shown,
        episodes=min(finished, usual) or usual,
        most=most,
        is_awaited=is_awaited,
        modules=frozenset(ALLOWED),
        message="; ".join(notes),
    )


def _settings_only(lane: StudiedRun) -> StudiedRun:
    journal = tuple(entry for entry in lane.journal if not isinstance(entry.change, TakeAction))
    return StudiedRun(lane.recipe, journal)
