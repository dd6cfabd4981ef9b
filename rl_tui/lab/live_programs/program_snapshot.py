"""Where snapshots of a program are made."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.last_step import Author
from rl_tui.common.errors import UserError
from rl_tui.lab.detective.source.code_names import declared_discount
from rl_tui.lab.detective.verdict import MovedCell, Rule, UpdateFound
from rl_tui.lab.live.editing.pins import Pins
from rl_tui.lab.live.program_view import ProgramView
from rl_tui.lab.live.snapshot import AgentView, Phase, PlaybackView, Snapshot
from rl_tui.lab.live.snapshot_builder import SnapshotBuilder
from rl_tui.lab.live.state import ENDED
from rl_tui.lab.live.stop_condition import until_in_words
from rl_tui.lab.live.viewport import PartCopier
from rl_tui.lab.live_programs.step_view import StepView
from rl_tui.lab.run.large_worlds import is_large
from rl_tui.lab.run.library import recipe_for
from rl_tui.lab.run.recipe import Recipe, changed_parameter
from rl_tui.lab.run.results import RunResults
from rl_tui.lab.timeline.branches import Branch, Timeline
from rl_tui.lab.timeline.lane_view import LaneView, RunGroupView

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rl_tui.agents.counters import Counters
    from rl_tui.lab.live_programs.program_playback import ProgramPlayback
    from rl_tui.lab.programs.program_world import ProgramWorld
    from rl_tui.worlds.mdp.space import FloatArray

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
    "lists of so many rows",
    "a dictionary of rows, by state",
    "a dictionary of numbers, by (state, action)",
    "in the functions that call step, their globals, and attributes of objects there",
)


class Found(NamedTuple):
    """What is known of how a program learns."""

    algorithm: str
    hyperparameters: Hyperparameters
    gamma_source: str


def found_of(update: UpdateFound, numbers: Mapping[str, float], usual: Hyperparameters) -> Found:
    """Return how a program learns: by the update, else by the ``numbers`` of its code, else as ``usual``."""
    declared = declared_discount(numbers)
    gamma, source = update.gamma, "found"
    if declared is not None and not gamma:  # with γ 0 the next state is left out
        gamma, source = declared[1], "declared"
    elif gamma is None:
        gamma, source = usual.gamma, "usual"
    values = usual
    for name, value in (("gamma", gamma), ("alpha", update.alpha), ("epsilon", update.epsilon)):
        if value is not None and math.isfinite(value):
            with suppress(UserError):  # what a program does need not be within our ranges
                values = changed_parameter(values, name, value)
    is_plain = update.place is MovedCell.TAKEN and update.alpha is not None
    algorithm = _OURS.get(update.rule, OWN_PROGRAM.id) if is_plain else OWN_PROGRAM.id
    return Found(algorithm, values, source)


def usual_recipe(world: ProgramWorld, seed: int) -> Recipe:
    """Return how ours would learn in ``world``."""
    return recipe_for(world.scenario, {}, seed)


class ProgramSnapshots:
    """Makes the snapshots of one playback."""

    def __init__(self) -> None:
        self._builder = SnapshotBuilder()
        self._copier: PartCopier | None = None

    def build(self, playback: ProgramPlayback) -> Snapshot:
        """Return the newest picture of ``playback``."""
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
                    run.step,
                    learner.episodes,
                    np.empty(0) if is_large(beside.world) else learner.q.copy(),
                    run.run.results,
                )
            )
        return RunGroupView((own, *others), 0, 1 + min(beside.marked, len(others) - 1))


def view_of(playback: ProgramPlayback) -> PlaybackView:
    """Return what ``playback`` is doing, and what was asked of it."""
    transport, world = playback.transport, playback.history.shown.world.world
    stop, is_shown_of_past = transport.stop, playback.history.in_past
    return PlaybackView(
        # the end of the program is no part of its past
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
    """Return what is shown of the program beside its steps and its table."""
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
