"""Snapshots of a watched program."""

from __future__ import annotations

import math
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.last_step import NOTHING, Author, LastStep
from rl_tui.agents.learner_counters import Counters
from rl_tui.common.errors import UserError
from rl_tui.live.pace.stop_condition import until_in_words
from rl_tui.live.pins import Pins
from rl_tui.live.program_view import ProgramView
from rl_tui.live.programs.progress import ProgramState, steps_between
from rl_tui.live.snapshot import AgentView, Phase, PlaybackView, Snapshot
from rl_tui.live.snapshot_builder import SnapshotBuilder
from rl_tui.live.state import ENDED
from rl_tui.live.viewport import PartCopier
from rl_tui.programs.diagnosis.step_story import update_of_step
from rl_tui.programs.evidence.code_names import declared_discount
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound
from rl_tui.runs.large_worlds import is_large
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import Recipe, changed_parameter
from rl_tui.runs.results import RunResults
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.runs.timeline.lane_view import LaneView, RunGroupView
from rl_tui.runs.timeline.trail import MOST_STEPS, Trail, TrailStep
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rl_tui.live.programs.program_playback import ProgramPlayback
    from rl_tui.programs.watched.program_world import ProgramWorld
    from rl_tui.programs.watched.recording import StepColumns
    from rl_tui.worlds.mdp.space import FloatArray, IntArray


# The last step


_MOST_REWARDS: Final = 256


class KnownUpdate(NamedTuple):
    """The effect of a step on the table, as in `LastStep`. If unexplained, its target is the new estimate."""

    cell: int = NOTHING
    before: float = 0.0
    after: float = 0.0
    others: int = 0
    step_size: float = 1.0
    gathered: float = 0.0
    discount: float = 0.0
    bootstrap: float = 0.0
    bootstrap_state: int = NOTHING
    is_explained: bool = False


class StepView:
    """The last step before `progress`.

    Args:
        progress: Moment of the program.
        update: What is known about the update rule.
        gamma: Discount for the rewards of the episode.
    """

    def __init__(self, progress: ProgramState, update: UpdateFound, gamma: float) -> None:
        self._progress = progress
        self._update = update
        self._gamma = gamma
        self._world = progress.world
        here = progress.step
        self._last = steps_between(progress.recording, here - 1, here) if here else None
        if self._last is not None and not len(self._last.state):
            self._last = None
        self._episode = None if self._last is None else self._steps_of_episode(self._last)

    @property
    def counters(self) -> Counters:
        """Steps, episodes and last step of the program."""
        progress, steps = self._progress, self._episode
        if steps is None or self._last is None:
            start = self._start()
            return Counters(state=start, step_from=start, step=progress.step, episodes=progress.episodes)
        place = len(steps.state) - 1
        state = self._landing(steps, place)
        ended = bool(steps.terminated[place] or steps.truncated[place])
        length = int(steps.episode_step[place]) + 1
        rewards, (errors, pairs) = steps.reward, self._td_errors()
        return Counters(
            state=state,
            step_from=self._start() if ended else state,
            step=progress.step,
            episodes=progress.episodes,
            episode_step=0 if ended else length,
            episode_return=0.0 if ended else float(sum(rewards.tolist())),
            rewards=rewards[-_MOST_REWARDS:].copy(),
            discounted_return=float(sum(rewards * self._gamma ** np.arange(len(rewards)))),
            td_errors=errors,
            updated_pairs=pairs,
            last_step=self._last_step(steps, place, ended=ended),
        )

    @property
    def trail(self) -> Trail:
        """Last steps of the episode, oldest first."""
        steps = self._episode
        if steps is None:
            return ()
        count, found = len(steps.state), []
        for place in range(max(0, count - MOST_STEPS), count):
            action = int(steps.action[place])
            number = self._progress.step - (count - 1 - place)
            found.append(
                TrailStep(
                    number,
                    self._world.state(int(steps.state[place]), int(steps.episode_step[place])),
                    action,
                    UNKNOWN_ACTION,
                    self._landing(steps, place),
                )
            )
        return tuple(found)

    def _steps_of_episode(self, last: StepColumns) -> StepColumns:
        """Return the recorded steps of the last step's episode, including that step."""
        here, length = self._progress.step, int(last.episode_step[0]) + 1
        steps = steps_between(self._progress.recording, here - length, here)
        same = steps.episode == last.episode[0]
        if not same.all():  # steps of two environments alternate
            first = max(self._progress.recording.first, 0)
            steps = steps_between(self._progress.recording, max(first, here - 4 * length), here)
            same = steps.episode == last.episode[0]
        return type(steps)._make(column[same] for column in steps)

    def _landing(self, steps: StepColumns, place: int) -> int:
        return self._world.landing(
            int(steps.next_state[place]),
            float(steps.reward[place]),
            terminated=bool(steps.terminated[place]),
        )

    def _start(self) -> int:
        mdp = self._world.world.mdp
        return 0 if mdp is None else int(mdp.start_state[0])

    def _last_step(self, steps: StepColumns, place: int, *, ended: bool) -> LastStep | None:
        observation, action = int(steps.state[place]), int(steps.action[place])
        count = int(steps.episode_step[place])
        pair = self._world.pair(observation, action, count)
        if pair == NOTHING:
            return None  # screens take a step without a pair for a planner's
        next_state, update = self._landing(steps, place), self.last_update
        own_cell = observation * self._progress.recording.actions + action
        moved = self._pair_of(update.cell, own_cell, pair)
        return LastStep(
            step=self._progress.step,
            episode=self._progress.episodes + (not ended),
            state=self._world.state(observation, count),
            pair=pair,
            explored=False,
            epsilon=0.0,
            outcome=self._outcome(pair, next_state, float(steps.reward[place])),
            reward=float(steps.reward[place]),
            next_state=next_state,
            terminated=bool(steps.terminated[place]),
            truncated=bool(steps.truncated[place]),
            updated_pair=moved,
            others=update.others if moved != NOTHING else 0,
            table=0,
            before=update.before,
            step_size=update.step_size,
            gamma=self._gamma,
            gathered=update.gathered,
            discount=update.discount,
            bootstrap=update.bootstrap,
            after=update.after,
            episode_step=count + 1,
            bootstrap_state=NOTHING if update.bootstrap_state == NOTHING else next_state,
        )

    @cached_property
    def last_update(self) -> KnownUpdate:
        """The effect of the last step on the table, part by part as far as known."""
        progress = self._progress
        if self._last is None or progress.table is None or progress.step <= progress.recording.found_at:
            return KnownUpdate()
        changes, step = progress.recording.changes, progress.step - 1
        begin, end = np.searchsorted(changes.step, (step, step + 1))
        table = progress.table.copy()
        table[changes.cell[begin:end][::-1]] = changes.before[begin:end][::-1]
        story = update_of_step(progress.recording, self._update, step, table)
        if story.step_size is not None and story.gathered is not None:
            return KnownUpdate(
                story.cell,
                story.before,
                story.after,
                0,
                story.step_size,
                story.gathered,
                story.discount or 0.0,
                story.bootstrap or 0.0,
                story.bootstrap_state,
                is_explained=True,
            )
        if not story.moved:
            return KnownUpdate()
        own = int(self._last.state[0]) * progress.recording.actions + int(self._last.action[0])
        first = next((each for each in story.moved if each.cell == own), story.moved[0])
        others = len({each.cell for each in story.moved}) - 1
        return KnownUpdate(first.cell, first.before, first.after, others, gathered=first.after)

    def _pair_of(self, cell: int, own_cell: int, own_pair: int) -> int:
        """Return our pair for `cell`. If several pairs share it, the pair that was taken."""
        if cell in (NOTHING, own_cell):
            return own_pair if cell == own_cell else NOTHING
        return int(self._world.pair_of_cell[cell])

    def _td_errors(self) -> tuple[FloatArray, IntArray]:
        update, changes = self._update, self._progress.recording.changes
        if not update.alpha:
            return np.empty(0), np.empty(0, np.int64)
        end = int(np.searchsorted(changes.step, self._progress.step))
        last = slice(max(0, end - _MOST_REWARDS), end)
        pairs = self._world.pair_of_cell[changes.cell[last]]
        errors = (changes.after[last] - np.nan_to_num(changes.before[last])) / update.alpha
        return errors[pairs >= 0], pairs[pairs >= 0]

    def _outcome(self, pair: int, next_state: int, reward: float) -> int:
        """Return the matching outcome in the transition table, or −1 if several or none match."""
        mdp = self._world.world.mdp
        if mdp is None:
            return UNKNOWN_ACTION
        first, last = int(mdp.first_outcome[pair]), int(mdp.first_outcome[pair + 1])
        fits = (mdp.next_state[first:last] == next_state) & (mdp.reward[first:last] == reward)
        return first + int(np.argmax(fits)) if np.count_nonzero(fits) == 1 else UNKNOWN_ACTION


# The whole snapshot


SHOWN_OUTPUT: Final = 200
"""Lines of output in a snapshot."""
_OURS: Final[Mapping[Rule, str]] = {
    Rule.Q_LEARNING: "q-learning",
    Rule.SARSA: "sarsa",
    Rule.EXPECTED_SARSA: "expected-sarsa",
}
_NAME: Final = "your program"
_LOOKED_FOR: Final = (
    "an array of states × actions",
    "lists with one row per state",
    "a dictionary of rows, by state",
    "a dictionary of numbers, by (state, action)",
    "in the functions that call step, their globals, and attributes of objects there",
)


class Found(NamedTuple):
    """What is known about the learning of a program."""

    algorithm: str
    hyperparameters: Hyperparameters
    gamma_source: str


def found_of(update: UpdateFound, numbers: Mapping[str, float], usual: Hyperparameters) -> Found:
    """Combine the update with the `numbers` in the code and the defaults `usual`, in this order of
    preference.
    """
    declared = declared_discount(numbers)
    gamma, source = update.gamma, "found"
    if declared is not None and not gamma:  # with γ = 0 the target has no next state
        gamma, source = declared[1], "declared"
    elif gamma is None:
        gamma, source = usual.gamma, "usual"
    values = usual
    for name, value in (("gamma", gamma), ("alpha", update.alpha), ("epsilon", update.epsilon)):
        if value is not None and math.isfinite(value):
            with suppress(UserError):  # the program's value may be outside our ranges
                values = changed_parameter(values, name, value)
    is_plain = update.place is MovedCell.TAKEN and update.alpha is not None
    algorithm = _OURS.get(update.rule, OWN_PROGRAM.id) if is_plain else OWN_PROGRAM.id
    return Found(algorithm, values, source)


def usual_recipe(world: ProgramWorld, seed: int) -> Recipe:
    """Return the default recipe for `world`."""
    return recipe_for(world.scenario, {}, seed)


class ProgramSnapshots:
    """Makes the snapshots of one playback."""

    def __init__(self) -> None:
        self._builder = SnapshotBuilder()
        self._copier: PartCopier | None = None

    def build(self, playback: ProgramPlayback) -> Snapshot:
        """Return the newest snapshot of `playback`."""
        shown, found = playback.history.shown, playback.found
        view = StepView(shown, playback.verdicts.newest.update, found.hyperparameters.gamma)
        counters, results, world = view.counters, shown.results, shown.world
        if playback.history.begun_at == shown.step:
            counters = counters.at_beginning()
        playing = view_of(playback)
        recipe = Recipe(world.scenario, found.algorithm, found.hyperparameters, playback.program.request.seed)
        q = shown.q
        group = self._group(playback, counters, results, q)
        beside = playback.beside.beside
        asked = playback.questions
        cell = asked.beside.cell
        other = None
        if beside is not None and group.beside is not None:
            pins = Pins(playing.breakpoints, asked.beside.drawn)
            other = self._builder.of_lane(
                beside, group, group.beside, playing, asked.beside, pins, has_trail=True, led=counters
            )
        gamma = found.hyperparameters.gamma
        return Snapshot(
            world=world.world,
            recipe=recipe,
            agent=self._agent(playback, counters, q, is_explained=view.last_update.is_explained),
            counters=counters,
            results=results,
            exact_answer=asked.exact(shown, gamma),
            playback=playing,
            answers=asked.answers(shown, world.scenario, gamma, is_still=playback.transport.is_still),
            timeline=_timeline(playback),
            run_group=group,
            cell=None if cell is None else playback.history.cell(cell),
            beside=other,
            trail=view.trail if playback.shows_trail and not counters.is_at_beginning else (),
            program=program_view(playback),
        )

    def _agent(
        self, playback: ProgramPlayback, counters: Counters, q: FloatArray, *, is_explained: bool
    ) -> AgentView:
        shown, found, viewport = playback.history.shown, playback.found, playback.questions.beside.viewport
        part, world = None, shown.world.world
        if viewport is not None and is_large(world):
            if self._copier is None or self._copier.world is not world:
                self._copier = PartCopier(world)
            part = self._copier.copy(viewport, (counters,), q, shown.visits)
        return AgentView(
            found.algorithm,
            found.hyperparameters,
            part.q if part else q,
            part.visits if part else shown.visits.copy(),
            part=part,
            author=None if is_explained else Author(OWN_PROGRAM.id, found.hyperparameters),
        )

    def _group(
        self, playback: ProgramPlayback, counters: Counters, results: RunResults, q: FloatArray
    ) -> RunGroupView:
        beside, found = playback.beside, playback.found
        if not beside.runs:
            return RunGroupView()
        own_q = np.empty(0) if is_large(beside.world) else q
        own = LaneView(
            _NAME, found.algorithm, found.hyperparameters, counters.step, counters.episodes, own_q, results
        )
        others = []
        for run, name in zip(beside.runs, beside.names, strict=True):
            learner = run.run.learner
            others.append(
                LaneView(
                    name,
                    learner.algorithm,
                    learner.hyperparameters,
                    learner.step,
                    learner.episodes,
                    np.empty(0) if is_large(beside.world) else learner.q.copy(),
                    run.run.results,
                )
            )
        return RunGroupView((own, *others), 0, 1 + min(beside.marked, len(others) - 1))


def view_of(playback: ProgramPlayback) -> PlaybackView:
    """Return the state of `playback`."""
    transport, world = playback.transport, playback.history.shown.world.world
    stop, is_shown_of_past = transport.stop, playback.history.in_past
    return PlaybackView(
        # the end of the program is not in its past
        phase=Phase.PAUSED if is_shown_of_past and transport.state in ENDED else transport.phase,
        message=transport.message,
        speed=transport.speed,
        steps_per_second=transport.meter.steps_per_second,
        until="" if stop is None else until_in_words(stop.until, world),
        paused_by=transport.paused_by,
        breakpoints=transport.breakpoints,
        handled=playback.handled,
    )


def program_view(playback: ProgramPlayback) -> ProgramView:
    """Return what is shown of the program besides its steps and its table."""
    program, log, found = playback.program, playback.program.log, playback.found
    request = program.request
    name = f"{request.path.name}:{request.agent}" if request.agent else request.path.name
    return ProgramView(
        title=name,
        environment=log.environments[0].id,
        table=log.table,
        looked_for=_LOOKED_FOR if log.table is None else (),
        verdict=playback.verdicts.newest,
        output=tuple(log.output)[-SHOWN_OUTPUT:],
        notes=tuple(log.notes),
        error=log.error,
        ended=program.is_over,
        stands_at=None if log.stands_at is None else log.stands_at[1],
        refused=log.refused,
        reloaded=playback.restarts.words,
        source=playback.restarts.file.source,
        path=str(request.path),
        first_step=playback.history.first_step,
        gamma=found.hyperparameters.gamma,
        gamma_source=found.gamma_source,
        is_agent=request.agent is not None,
    )


def _timeline(playback: ProgramPlayback) -> Timeline:
    history = playback.history
    return Timeline((Branch(_NAME, end=history.newest.step, here=history.shown.step),), 0)
