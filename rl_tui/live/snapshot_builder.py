"""Makes snapshots of a run: during play, before it begins, and as left."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.agents.learner_counters import Counters
from rl_tui.lessons.file.view import LessonView
from rl_tui.live.pace.stop_condition import until_in_words
from rl_tui.live.pins import Pins
from rl_tui.live.record import Record
from rl_tui.live.snapshot import AgentView, Phase, PlaybackView, Snapshot
from rl_tui.live.state import State
from rl_tui.live.viewport import PartCopier, Viewport
from rl_tui.runs.answers.view import AnswersView
from rl_tui.runs.bandit import bandit_figures
from rl_tui.runs.exact_answers import NO_TABLE, PENDING, Answer
from rl_tui.runs.large_worlds import is_large
from rl_tui.runs.recipe import Recipe, Setting, changed_recipe
from rl_tui.runs.results import RunResults
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import Timeline
from rl_tui.runs.timeline.branching_run import BranchingRun
from rl_tui.runs.timeline.lane_view import RunGroupView
from rl_tui.worlds.mdp.space import IntArray
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.live.playback import Playback
    from rl_tui.live.questions import Questions
    from rl_tui.runs.played_run import PlayedRun
    from rl_tui.runs.timeline.playing import Playing
    from rl_tui.runs.timeline.table_samples import ErrorHistory

PREPARING: Final = "building the world"
REBUILDING: Final = "the world is being rebuilt; learning waits"
_MOST_WITH_ERRORS: Final = 1_000  # pairs: more would take too long in every frame
_MOVING: Final = (Phase.PREPARING, Phase.RUNNING, Phase.SEEKING)


class SnapshotBuilder:
    """Makes snapshots, and caches what a large world needs."""

    def __init__(self) -> None:
        self._copier: PartCopier | None = None

    def before(self, recipe: Recipe, world: World, playback: PlaybackView, *, is_hidden: bool) -> Snapshot:
        """Return a snapshot before the agent exists."""
        hyperparameters, pairs = recipe.hyperparameters, world.space.pairs
        visits: IntArray = np.zeros(pairs, np.int64)
        return Snapshot(
            world=world,
            recipe=recipe,
            agent=AgentView(
                recipe.algorithm, hyperparameters, np.full(pairs, hyperparameters.initial_q), visits
            ),
            counters=Counters(state=0 if world.mdp is None else int(world.mdp.start_state[0])),
            results=RunResults(bandit=bandit_figures(world, visits, winnings=0.0)),
            exact_answer=Answer(None, NO_TABLE) if world.mdp is None else PENDING,
            playback=playback,
            answers=AnswersView(is_hidden=is_hidden and world.mdp is not None),
        )

    def preparing(self, recipe: Recipe, world: World, record: Record, questions: Questions) -> Snapshot:
        """Return a snapshot while runs are built, with the estimates of `record`."""
        playback = PlaybackView(message=PREPARING, speed=record.speed)
        is_hidden = questions.hides_answer(recipe.scenario)
        before = self.before(recipe, world, playback, is_hidden=is_hidden)
        lesson = None if questions.lesson is None else LessonView(questions.lesson)
        return as_left(replace(before, lesson=lesson), record)

    def build(self, playback: Playback, *, has_trail: bool) -> Snapshot:
        """Return a snapshot with all answers, and perhaps the trail."""
        group, questions, playing = playback.group, playback.questions, _view_of(playback)
        current, view, cell = group.current, group.view, questions.cell
        pins = Pins(playing.breakpoints, questions.drawn)
        snapshot = self.of_lane(current, view, view.shown, playing, questions, pins, has_trail=has_trail)
        is_hidden, beside = snapshot.answers.is_hidden, None
        if view.beside is not None and group.beside is not None:
            beside = self.of_lane(
                *(group.beside, view, view.beside, playing, questions, playback.pins_beside),
                has_trail=has_trail,
                led=snapshot.counters,
            )
        history = None if cell is None else current.cell_history(cell)
        snapshot = replace(snapshot, cell=history, beside=beside)
        run = current.run
        if not isinstance(run, Run):  # a program has no lesson, no editor and no checks
            return snapshot
        return replace(
            snapshot,
            study=questions.seed_studies.study_of(group),
            value_errors=_value_errors(current, snapshot),
            lesson=questions.judge(run),
            editor=playback.editor.view(run, snapshot.exact_answer, is_hidden=is_hidden),
            world_check=questions.world_check(run),
        )

    def of_lane(
        self,
        lane: Playing,
        view: RunGroupView,
        number: int,
        playback: PlaybackView,
        questions: Questions,
        pins: Pins,
        *,
        has_trail: bool,
        led: Counters | None = None,
    ) -> Snapshot:
        """Return the snapshot of the run `number` of `view`.

        `pins` have its world's numbers. The surroundings of `led`, the visible agent, are copied too.
        """
        run = lane.run
        counters = run.learner.counters
        if lane.begun_at == run.step and not run.over:
            counters = counters.at_beginning()
        return Snapshot(
            world=run.world,
            recipe=run.recipe,
            agent=self._agent(run, (counters,) if led is None else (counters, led), questions.viewport),
            counters=counters,
            results=view.lanes[number].results if view.lanes else run.results,
            exact_answer=questions.exact.of(run),
            playback=replace(playback, breakpoints=pins.breakpoints),
            answers=questions.answers(run, pins.drawn, is_still=playback.phase not in _MOVING),
            timeline=lane.timeline,
            run_group=view,
            trail=lane.trail if has_trail and not counters.is_at_beginning else (),
            world_changes=run.world_changes,
        )

    def _agent(self, run: PlayedRun, agents: Iterable[Counters], viewport: Viewport | None) -> AgentView:
        learner = run.learner
        part = None
        if viewport is not None and is_large(run.world):
            if self._copier is None or self._copier.world is not run.world:
                self._copier = PartCopier(run.world)
            part = self._copier.copy(viewport, agents, learner.q, learner.visits)
        return AgentView(
            learner.algorithm,
            learner.hyperparameters,
            part.q if part else learner.q.copy(),
            part.visits if part else learner.visits.copy(),
            part=part,
            tables=() if part else learner.remembered("q1", "q2"),
            values=np.empty(0) if part else next(iter(learner.remembered("v")), np.empty(0)),
            policy=np.empty(0) if part else next(iter(learner.remembered("policy")), np.empty(0)),
            sweep=learner.phase,
            planning=learner.planning,
            author=learner.author,
        )


def _view_of(playback: Playback) -> PlaybackView:
    transport, run = playback.transport, playback.group.current.run
    match playback.state:
        case State.SEEKING:
            message = transport.seek_message(waits=playback.waits)
        case State.REBUILDING:
            message = REBUILDING
        case _:
            message = run.message
    return PlaybackView(
        phase=playback.phase,
        message=message,
        speed=transport.speed,
        watching=transport.watching(hides_answer=playback.questions.hides_answer(run.recipe.scenario)),
        steps_per_second=transport.meter.steps_per_second,
        # machine code arrives at any time, which must not show without a clock
        interpreted=playback.automatic and playback.compilation.interpreted,
        stays_interpreted=playback.compilation.why_not,
        until="" if playback.condition is None else until_in_words(playback.condition.until, run.world),
        paused_by=playback.paused_by,
        breakpoints=playback.breakpoints,
        handled=playback.handled,
    )


def as_left(snapshot: Snapshot, record: Record) -> Snapshot:
    """Return `snapshot` with the estimates and step of `record`, before the replay.

    Unknown results are left out. The snapshot stays unchanged for a bandit, or without a table of this world.
    """
    table, space, lane = record.table, snapshot.world.space, record.lanes[record.shown]
    if table is None or snapshot.results.bandit is not None or lane.world_changes:
        return snapshot
    if len(table.q) != space.pairs or table.state >= space.states:
        return snapshot
    journal = lane.branches[lane.branch].journal
    settings = [e.change for e in journal if e.step <= lane.step and isinstance(e.change, Setting)]
    now = changed_recipe(lane.recipe, *settings)
    is_same_gamma = now.hyperparameters.gamma == snapshot.agent.hyperparameters.gamma
    views = [
        replace(
            view,
            algorithm=now.algorithm,
            hyperparameters=now.hyperparameters,
            step=lane.step,
            episodes=table.episodes,
            q=table.q,
            results=RunResults(),
        )
        if number == record.shown
        else view
        for number, view in enumerate(snapshot.run_group.lanes)
    ]
    return replace(
        snapshot,
        agent=AgentView(now.algorithm, now.hyperparameters, table.q, table.visits),
        counters=Counters(state=table.state, step=lane.step, episodes=table.episodes),
        results=RunResults(),
        answers=replace(snapshot.answers, first_update=None),
        exact_answer=snapshot.exact_answer if is_same_gamma or snapshot.world.mdp is None else PENDING,
        timeline=Timeline(lane.branches, lane.branch),
        run_group=replace(snapshot.run_group, lanes=tuple(views)),
        cell=None,
        beside=None,
        trail=(),
    )


def _value_errors(lane: Playing, snapshot: Snapshot) -> ErrorHistory | None:
    space, solution = snapshot.world.space, snapshot.exact_answer.solution
    if solution is None or not isinstance(lane, BranchingRun) or len(space.pair_action) > _MOST_WITH_ERRORS:
        return None
    return None if np.diff(space.first_pair).max() > 1 else lane.value_errors(solution.q)
