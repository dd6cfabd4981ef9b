"""The request for a study of many seeds, and its process."""

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

if TYPE_CHECKING:
    from rl_tui.runs.timeline.run_group import RunGroup


# The request


FIRST_BLOCK: Final = 8
"""Seeds of the first report, after which their number doubles. Simulated environments have only these."""
MOST_SEEDS: Final = 256
MOST_STEPS: Final = 2_000_000
"""Largest number of steps of one seed."""
MOST_PAIRS: Final = 1_000_000
"""Most pairs of a world. Larger ones would take a gigabyte for each run."""


@dataclass(frozen=True, slots=True)
class StudiedRun:
    """A visible run: its start and its changes."""

    recipe: Recipe
    journal: tuple[JournalEntry, ...]

    @property
    def algorithms(self) -> list[str]:
        """Ids of all its algorithms, in order."""
        switches = (entry.change for entry in self.journal)
        return [self.recipe.algorithm, *(s.algorithm for s in switches if isinstance(s, SwitchAlgorithm))]

    @property
    def plans(self) -> bool:
        """True if one of them is a planner."""
        return any(BY_ID[algorithm].planner for algorithm in self.algorithms)

    @property
    def is_by_luck(self) -> bool:
        """True if another seed may give another result."""
        only_plans = all(BY_ID[algorithm].planner for algorithm in self.algorithms)
        return not only_plans or self.recipe.scenario.section.drawn_from_seed


@dataclass(frozen=True, slots=True)
class StudyRequest:
    """The request for a study."""

    lanes: tuple[StudiedRun, ...]
    shown: int
    """Index of the visible run."""
    episodes: int | None
    """Episodes of each seed (unless they take too many steps), or None if `steps` end it."""
    steps: int | None
    """Steps of each seed, or None."""
    most: int
    """Number of seeds to reach."""
    is_awaited: bool
    """True if the caller waits, so that the work keeps a normal priority."""
    message: str
    """Limits and omissions in words, usually empty."""

    @property
    def nothing_yet(self) -> SeedStudy:
        """The study before the first seed."""
        return SeedStudy(
            StudyState.STARTING,
            shown=self.shown,
            most=self.most,
            episodes=self.episodes,
            steps=self.steps,
            message=self.message,
        )


def studied_runs(group: RunGroup) -> tuple[StudiedRun, ...]:
    """Return the runs of `group` with all changes on the branch, even later ones."""
    return tuple(
        StudiedRun(record.recipe, record.branches[record.branch].journal) for record in group.records()
    )


def study_request(group: RunGroup, *, is_awaited: bool) -> StudyRequest:
    """Return the request for the runs of `group`, without actions of the user. Raises UserError."""
    if in_kiosk():
        raise UserError("many seeds are not available in a kiosk")
    lanes = studied_runs(group)
    if not any(lane.is_by_luck for lane in lanes):
        raise UserError("a planner has the same result for every seed; choose an algorithm that learns")
    if len({lane.recipe.seed for lane in lanes}) > 1:
        raise UserError("the runs have different seeds; c e ends the one you control")
    run = group.built_in.run
    if run.world.space.pairs > MOST_PAIRS:
        raise UserError(f"many seeds are not available above {MOST_PAIRS:,} state–action pairs")
    episodes, steps, note = _length(group, lanes)
    notes = [note] if note else []
    if any(isinstance(entry.change, TakeAction) for lane in lanes for entry in lane.journal):
        notes.append("steps that you took yourself are left out")
    most = MOST_SEEDS if run.learner.rewindable and not is_awaited else FIRST_BLOCK
    if not run.learner.rewindable:
        notes.append(f"a simulated environment gets only {FIRST_BLOCK} seeds")
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
    """Return the episodes (or steps, for planners and after later changes) of each seed, and a note."""
    runs, world = group.runs, group.current.run.world
    step = max(run.step for run in runs)
    plans = any(lane.plans for lane in lanes)
    is_changed = any(0 < entry.step <= step for lane in lanes for entry in _settings_only(lane).journal)
    # each pull of a bandit is an episode
    if step and (plans or (is_changed and not world.is_bandit)):
        why = "a planner's backups are steps, not episodes" if plans else f"{_changed(lanes)} during the run"
        steps = min(step, MOST_STEPS)
        further = ", although this run has more" if step > steps else ""
        return None, steps, f"{why}: each seed ends after {counted(steps, 'step')}{further}"
    usual = min(episodes_of(lanes[group.shown].recipe.scenario), world.budget or MOST_EPISODES)
    finished = min(run.learner.episodes for run in runs)
    if finished > usual:
        return usual, None, f"each seed has only {counted(usual, 'episode')}, although this run has more"
    if not finished:
        who = "the run on screen" if len(runs) == 1 else "one of the runs"
        return usual, None, f"{who} had finished no episode: each seed gets {counted(usual, 'episode')}"
    return finished, None, ""


def _changed(lanes: tuple[StudiedRun, ...]) -> str:
    is_edited = any(isinstance(entry.change, WorldChange) for lane in lanes for entry in lane.journal)
    return "the world was changed" if is_edited else "settings were changed"


def _settings_only(lane: StudiedRun) -> StudiedRun:
    journal = tuple(entry for entry in lane.journal if not isinstance(entry.change, TakeAction))
    return StudiedRun(lane.recipe, journal)


# The process


WORK: Final = "rl_tui.studies.many_seeds.study:work"
"""Runs in a process of its own, with imports that this process does not need."""


class SeedStudies:
    """Computes one study at a time in a background process.

    `on_news` is called from any thread. Without `automatic`, `begin` waits for one block.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[StudyRequest, SeedStudy](WORK, on_news)
        self._refused: SeedStudy | None = None
        self._lanes: tuple[StudiedRun, ...] = ()

    def begin(self, group: RunGroup) -> None:
        """Begin a study of the current runs, replacing any other."""
        self.end()
        self._lanes = studied_runs(group)
        try:
            request = study_request(group, is_awaited=not self._automatic)
            process = self._background.begin(request, request.nothing_yet)
        except (UserError, OSError) as reason:
            if isinstance(reason, UserError):
                self._refused = SeedStudy(StudyState.REFUSED, message=str(reason))
            else:
                why = f"cannot start a process: {reason}"
                self._refused = SeedStudy(StudyState.FAILED, message=why)
            return
        if process is not None and not self._automatic:
            process.wait()

    def end(self) -> None:
        """End and forget the study."""
        self._background.end()
        self._refused = None

    def close(self) -> None:
        """End the study, and begin no other. Safe from any thread."""
        self._background.close()

    def study_of(self, group: RunGroup) -> SeedStudy | None:
        """Return the study so far, or None."""
        process = self._background.process
        study = self._refused if process is None else process.known
        if study is None:
            return None
        if process is not None and process.failed and not study.is_over:
            study = replace(study, state=StudyState.FAILED, message=process.failed)
        elif process is not None and not study.is_over:
            study = replace(study, how_long=process.how_long)
        return study if studied_runs(group) == self._lanes else replace(study, is_outdated=True)
