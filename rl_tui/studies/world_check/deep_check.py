"""The full check of one world."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.compatibility import incompatibility
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.first_update import Wait, first_wait
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.policy_figures import expected_return, greedy_policy, uniform_policy
from rl_tui.agents.exact.solve import (
    best_expected_return,
    endless_part,
    never_reached,
    shortest_way,
    solve,
    states_without_end,
    staying_states,
)
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.common.words import counted
from rl_tui.runs.answers.first_update_words import wait_in_words
from rl_tui.runs.background.child import bound_processor_time
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.runs.figures import MOST_STATES
from rl_tui.runs.training.compile_or_interpret import Patience
from rl_tui.runs.training.endless import LONG_EPISODE, REMEDY, endless_warning_in
from rl_tui.studies.world_check.report import CheckStage, TrialsMade, WorldReport
from rl_tui.studies.world_check.words import names
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Short trainings: does the learned policy end?


SEEDS: Final = (0, 1, 2)
MOST_EPISODES: Final = 500
MOST_STEPS: Final = 100_000
"""Steps of one training, or a planner's backups."""
_MOST_TRIED_STATES: Final = 1_000
_MOST_TRIED_ACTIONS: Final = 50
"""Limits of a world for trials. In a larger one so few steps teach nothing."""

_CHUNK: Final = 2_000
"""Steps between two checks for a long episode, a constant so that results do not depend on timing."""


class GreedyTrial(NamedTuple):
    """The result of one training.

    The learned greedy policy never ends from the reachable state `endless_at`, or ends with probability 1
    (None, also for a planner that has not converged). `long_episode` had not ended after 50,000 steps. With
    `is_whole`, all episodes were finished, or the planner converged.
    """

    algorithm: str
    seed: int
    endless_at: int | None
    long_episode: int | None
    is_whole: bool

    @property
    def may_never_end(self) -> bool:
        """True if the greedy policy or a training may never end."""
        return self.endless_at is not None or self.long_episode is not None

    @property
    def is_cut_short(self) -> bool:
        """True if the training was incomplete."""
        return not self.is_whole and self.long_episode is None


def may_stay(mdp: TabularMDP) -> bool:
    """Return True if some policy may never end."""
    return bool(staying_states(exact_model(mdp), np.ones(mdp.pairs, dtype=np.bool_)).any())


def is_tried(mdp: TabularMDP) -> bool:
    """Return True if `mdp` is small enough for trials."""
    return mdp.states <= _MOST_TRIED_STATES and len(mdp.action_names) <= _MOST_TRIED_ACTIONS


def suitable(mdp: TabularMDP, hyperparameters: Hyperparameters) -> tuple[str, ...]:
    """Return the algorithms that can learn in `mdp`."""
    return tuple(each for each in BY_ID if not incompatibility(mdp, each, hyperparameters))


def trials(
    mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episodes: int
) -> Iterator[GreedyTrial]:
    """Train for each of `SEEDS` (a planner once), with equal results for equal arguments."""
    seeds, patience = SEEDS[:1] if BY_ID[algorithm].planner else SEEDS, Patience()
    for number, seed in enumerate(seeds):
        learner = Learner(mdp, algorithm, hyperparameters, streams(seed))
        wanted = MOST_STEPS if learner.plans else episodes

        def look(learner: Learner, begun: int = number * wanted, in_all: int = len(seeds) * wanted) -> None:
            patience.look(learner, begun + (learner.step if learner.plans else learner.episodes), in_all)

        yield _trial(mdp, learner, seed, wanted, look)


def _trial(
    mdp: TabularMDP, learner: Learner, seed: int, wanted: int, look: Callable[[Learner], None]
) -> GreedyTrial:
    is_long, stop = False, Stop.DONE
    while learner.step < MOST_STEPS and learner.episodes < wanted and not is_long:
        stop = learner.advance(min(_CHUNK, MOST_STEPS - learner.step), wanted - learner.episodes)
        learner.drain_episodes()
        if stop not in (Stop.DONE, Stop.EPISODES_FULL):
            break
        is_long = not learner.plans and learner.episode_step >= LONG_EPISODE
        look(learner)
    is_whole = learner.converged if learner.plans else learner.episodes >= wanted
    # an interrupted planner has no policy yet
    greedy = (
        greedy_policy(mdp, learner.q, learner.hyperparameters.ties) if is_whole or not learner.plans else None
    )
    return GreedyTrial(
        learner.algorithm,
        seed,
        None if greedy is None else endless_part(mdp, greedy),
        learner.episodes + 1 if is_long else None,
        is_whole,
    )


MOST_SECONDS: Final = 300
"""CPU-time limit in seconds. The slowest shipped world takes a minute without compiled code."""
_MOST_NAMED: Final = 3
TOO_LARGE: Final = f"not computed above {MOST_STATES:,} states"


class Question(NamedTuple):
    """A world to check, with settings and episodes of a full training."""

    mdp: TabularMDP
    algorithm: str
    hyperparameters: Hyperparameters
    episodes: int


def work(asked: Question, tell: Callable[[WorldReport, float], None]) -> None:
    """Send the report as it grows, from a background process."""
    bound_processor_time(MOST_SECONDS)
    for report in reports(asked):
        tell(report, list(BY_ID).index(report.trying) / len(BY_ID) if report.trying else 0.0)


def without_table() -> WorldReport:
    """Return the report on a simulated world."""
    return WorldReport(warnings=(f"no exact checks: {NO_TABLE}",))


def deep_check(asked: Question) -> WorldReport:
    """Return the full report, equal for equal questions.

    Everything is exact except `endless`, which depends on limited trainings (see `TrialsMade`).
    """
    *_, report = reports(asked)
    return report


def reports(asked: Question) -> Iterator[WorldReport]:
    """Yield the report as it grows."""
    report = _figures(asked)
    yield report
    report = _with_flips(report, asked.mdp)
    yield report
    yield from _with_trials(report, asked)


def _figures(asked: Question) -> WorldReport:
    mdp, unknown = asked.mdp, dict[str, str]()
    random_return, best_return = _returns(mdp, unknown)
    first = _first_wait(asked, unknown)
    return WorldReport(
        CheckStage.FLIPS,
        warnings=_wait_warnings(first, asked.episodes),
        random_return=random_return,
        best_return=best_return,
        shortest_way=_shortest_way(mdp, asked.hyperparameters.gamma, unknown),
        first_update=first,
        never_reached=tuple(never_reached(mdp).tolist()),
        endless_states=tuple(np.flatnonzero(states_without_end(mdp)).tolist()),
        unknown=unknown,
    )


def _returns(mdp: TabularMDP, unknown: dict[str, str]) -> tuple[float | None, float | None]:
    if mdp.states > MOST_STATES:
        unknown |= {"random_return": TOO_LARGE, "best_return": TOO_LARGE}
        return None, None
    by_chance, best = expected_return(mdp, uniform_policy(mdp)), best_expected_return(mdp)
    if by_chance is None:
        unknown["random_return"] = "none: rewards may go on forever"
    if best is None:
        unknown["best_return"] = "none at γ 1: see rl-tui solve --gamma 1"
    return by_chance, best


def _shortest_way(mdp: TabularMDP, gamma: float, unknown: dict[str, str]) -> int | None:
    name = "shortest_way"
    if mdp.states > MOST_STATES:
        unknown[name] = TOO_LARGE
        return None
    try:
        steps = shortest_way(mdp, solve(mdp, gamma).greedy)
    except NoExactAnswer as reason:
        unknown[name] = str(reason)
        return None
    if steps is None:
        unknown[name] = "an episode of the best policy never ends"
    elif mdp.time_limit and steps > mdp.time_limit:
        limit = counted(mdp.time_limit, "step")
        unknown[name] = f"the goal is {steps:,} steps away, but an episode stops after {limit}"
        return None
    return steps


def _first_wait(asked: Question, unknown: dict[str, str]) -> Wait | None:
    if asked.mdp.states > MOST_STATES:
        unknown["first_update"] = TOO_LARGE
        return None
    try:
        return first_wait(asked.mdp, asked.algorithm, asked.hyperparameters)
    except NoExactAnswer as reason:
        unknown["first_update"] = str(reason)
        return None


def _wait_warnings(wait: Wait | None, episodes: int) -> tuple[str, ...]:
    if wait is not None and wait.chance == 0.0:
        return ("the agent can never learn: no outcome that it can reach changes an estimate",)
    if wait is None or wait.median_episodes is None or wait.median_episodes <= episodes:
        return ()
    training = f"but training has only {counted(episodes, 'episode')}"
    return (f"{wait_in_words(wait)}, {training}: rl-tui why shows a remedy",)


def _with_flips(report: WorldReport, mdp: TabularMDP) -> WorldReport:
    from rl_tui.agents.exact.flips import flips

    try:
        return replace(report, stage=CheckStage.TRIALS, flips=flips(mdp))
    except NoExactAnswer as reason:
        return replace(report, stage=CheckStage.TRIALS, unknown={**report.unknown, "flips": str(reason)})


def _with_trials(report: WorldReport, asked: Question) -> Iterator[WorldReport]:
    mdp, settings, episodes = asked.mdp, asked.hyperparameters, min(MOST_EPISODES, asked.episodes)
    warning = endless_warning_in(mdp, settings, asked.episodes)
    known = (*report.warnings, *([warning] if warning else []))
    report = replace(report, warnings=known)
    if not is_tried(mdp):
        unknown = {**report.unknown, "endless": "the world is too large for short trial runs"}
        yield replace(report, stage=CheckStage.DONE, unknown=unknown)
        return
    if not may_stay(mdp):
        yield replace(report, stage=CheckStage.DONE, endless=(), tried=TrialsMade((), 0, 0))
        return
    made: list[GreedyTrial] = []
    try:
        for algorithm in suitable(mdp, settings):
            yield replace(report, trying=algorithm, endless=_may_never_end(made))
            made += trials(mdp, algorithm, settings, episodes)
    except UserError as reason:
        yield replace(report, stage=CheckStage.DONE, unknown={**report.unknown, "endless": str(reason)})
        return
    is_said = mdp.time_limit or report.endless_states
    in_part = dict.fromkeys(trial.algorithm for trial in made if trial.is_cut_short)
    yield replace(
        report,
        stage=CheckStage.DONE,
        endless=_may_never_end(made),
        tried=TrialsMade(SEEDS, episodes, MOST_STEPS, tuple(in_part)),
        warnings=(*known, *([] if is_said else _warnings(made, mdp, episodes))),
    )


def _may_never_end(made: Sequence[GreedyTrial]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(trial.algorithm for trial in made if trial.may_never_end))


def _warnings(made: Sequence[GreedyTrial], mdp: TabularMDP, episodes: int) -> list[str]:
    """Return warnings for the trials, none with a time limit or endless states."""
    said = []
    greedy = [trial for trial in made if trial.endless_at is not None]
    if greedy:
        place = mdp.state_names[greedy[0].endless_at or 0]
        said.append(
            f"a greedy policy of {_names(greedy)} may never end, for example from {place} "
            f"(up to {counted(episodes, 'episode')}, seeds {SEEDS[0]}–{SEEDS[-1]}): {REMEDY}"
        )
    long = [trial for trial in made if trial.long_episode is not None]
    if long:
        said.append(f"with {_names(long)}, a training episode may take very long or never end: {REMEDY}")
    return said


def _names(made: Sequence[GreedyTrial]) -> str:
    found = tuple(dict.fromkeys(trial.algorithm for trial in made))
    is_short = len(found) <= _MOST_NAMED or len(found) == len(BY_ID)
    return names(found) if is_short else f"{len(found)} of {len(BY_ID)} algorithms"
