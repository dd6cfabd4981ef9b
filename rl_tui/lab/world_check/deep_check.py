"""The whole check of one world: exact figures, and what short trainings of each algorithm come to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.first_update import first_wait
from rl_tui.agents.exact.policies import uniform_policy
from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.exact.solution import NoExactAnswer
from rl_tui.agents.exact.solve import best_expected_return, solve
from rl_tui.agents.exact.ways_out import endless_states, never_reached, shortest_way
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.lab.experiments.endless import endless_warning_in
from rl_tui.lab.run.exact_answers import NO_TABLE
from rl_tui.lab.run.figures import MOST_STATES
from rl_tui.lab.world_check.greedy_trials import (
    MOST_EPISODES,
    MOST_STEPS,
    SEEDS,
    OnAlgorithm,
    Trial,
    is_tried,
    may_stay,
    trials,
)
from rl_tui.lab.world_check.report import TrialsMade, WorldReport
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.agents.exact.first_update import Wait
    from rl_tui.agents.exact.flips.flips import Flip

TOO_LARGE: Final = f"not worked out above {MOST_STATES:,} states"


class Question(NamedTuple):
    """The world to check, and the agent with whose settings; ``episodes`` are those of a whole training."""

    mdp: TabularMDP
    algorithm: str
    hyperparameters: Hyperparameters
    episodes: int


def ignore(algorithm: str) -> None:
    """Ignore which algorithm is tried."""


def without_table() -> WorldReport:
    """Return the report on a world that is stepped: nothing is known of it."""
    return WorldReport((f"nothing can be told: {NO_TABLE}",))


def deep_check(asked: Question, on_algorithm: OnAlgorithm = ignore) -> WorldReport:
    """Return the report on the world of ``asked``; ``on_algorithm`` as for :func:`trials`.

    All is exact but for ``endless``, which rests on trainings of limited length: see :class:`TrialsMade`.
    Equal questions have equal answers, however long they take.
    """
    mdp, warnings = asked.mdp, list[str]()
    warning = endless_warning_in(mdp, asked.hyperparameters, asked.episodes)
    if warning:
        warnings.append(warning)
    random_return, best_return = _returns(mdp, warnings)
    first, found_flips = _first_wait(asked, warnings), _flips(mdp, warnings)
    endless, tried = _endless(asked, on_algorithm, warnings)
    return WorldReport(
        random_return=random_return,
        best_return=best_return,
        shortest_way=_shortest_way(mdp, asked.hyperparameters.gamma, warnings),
        first_update=first,
        flips=found_flips,
        never_reached=tuple(never_reached(mdp).tolist()),
        endless_states=tuple(np.flatnonzero(endless_states(mdp)).tolist()),
        endless=endless,
        tried=tried,
        warnings=tuple(warnings),
    )


def _returns(mdp: TabularMDP, warnings: list[str]) -> tuple[float | None, float | None]:
    """Return what the random and the best policy earn; say which of them is not known."""
    if mdp.states > MOST_STATES:
        warnings.append(f"returns of the random and the best policy: {TOO_LARGE}")
        return None, None
    by_chance, best = expected_return(mdp, uniform_policy(mdp)), best_expected_return(mdp)
    if by_chance is None:
        warnings.append("return of the random policy: it has none, for it may go on being paid for ever")
    if best is None:
        warnings.append("return of the best policy: at γ = 1 there is none; rl-tui solve --gamma 1 says why")
    return by_chance, best


def _shortest_way(mdp: TabularMDP, gamma: float, warnings: list[str]) -> int | None:
    if mdp.states > MOST_STATES:
        warnings.append(f"length of the best way: {TOO_LARGE}")
        return None
    try:
        steps = shortest_way(mdp, solve(mdp, gamma).greedy)
    except NoExactAnswer as reason:
        warnings.append(f"length of the best way: {reason}")
        return None
    if steps is None:
        warnings.append("length of the best way: the best policy never comes to an end")
    elif mdp.time_limit and steps > mdp.time_limit:
        limit = counted(mdp.time_limit, "step")
        warnings.append(f"length of the best way: its end is {steps:,} steps away, an episode has {limit}")
        return None
    return steps


def _first_wait(asked: Question, warnings: list[str]) -> Wait | None:
    if asked.mdp.states > MOST_STATES:
        warnings.append(f"first update: {TOO_LARGE}")
        return None
    try:
        return first_wait(asked.mdp, asked.algorithm, asked.hyperparameters)
    except NoExactAnswer as reason:
        warnings.append(f"first update: {reason}")
        return None


def _flips(mdp: TabularMDP, warnings: list[str]) -> tuple[Flip, ...] | None:
    from rl_tui.agents.exact.flips.flips import flips

    try:
        return () if mdp.terminated.all() else flips(mdp)
    except NoExactAnswer as reason:
        warnings.append(f"flips: {reason}")
        return None


def _endless(
    asked: Question, on_algorithm: OnAlgorithm, warnings: list[str]
) -> tuple[tuple[str, ...] | None, TrialsMade | None]:
    """Return the algorithms that may learn never to end, and how they were tried."""
    mdp, episodes = asked.mdp, min(MOST_EPISODES, asked.episodes)
    if not is_tried(mdp):
        warnings.append("endless policies: the world is too large for short trainings to tell anything")
        return None, None
    if not may_stay(mdp):
        return (), TrialsMade((), 0, 0)
    try:
        made = list(trials(mdp, asked.hyperparameters, episodes, on_algorithm))
    except UserError as reason:
        warnings.append(f"endless policies: {reason}")
        return None, None
    warnings += _said_of(made, mdp, episodes)
    found = dict.fromkeys(trial.algorithm for trial in made if trial.may_never_end)
    return tuple(found), TrialsMade(SEEDS, episodes, MOST_STEPS)


def _said_of(made: Sequence[Trial], mdp: TabularMDP, episodes: int) -> list[str]:
    """Return what ``made`` gives cause to warn of: traps, and trainings that were broken off."""
    said = []
    greedy = [trial for trial in made if trial.endless_at is not None]
    if greedy:
        place = mdp.state_names[greedy[0].endless_at or 0]
        limit = f"the {counted(mdp.time_limit, 'step')} of an episode alone end it"
        remedy = limit if mdp.time_limit else "there is no time limit, which would end it"
        said.append(
            f"a greedy policy of {_names(greedy)} may never end, as at {place} "
            f"(up to {counted(episodes, 'episode')}, seeds {SEEDS[0]}–{SEEDS[-1]}): {remedy}"
        )
    long = [trial for trial in made if trial.long_episode is not None]
    if long:
        said.append(f"while {_names(long)} learns, an episode may take very long, or never end")
    short = [trial for trial in made if not trial.is_whole and trial.long_episode is None]
    if short:
        said.append(
            f"{_names(short)}: tried in part, up to {MOST_STEPS:,} steps or until it broke down; "
            "what is learned later is not known"
        )
    return said


def _names(made: Sequence[Trial]) -> str:
    return ", ".join(BY_ID[algorithm].name for algorithm in dict.fromkeys(trial.algorithm for trial in made))
