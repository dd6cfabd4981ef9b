"""A stepped environment teaches exactly what its table would."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from typing import Any

import pytest

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import LONGEST_EPISODE, Stop
from rl_tui.agents.learner import EPISODES_LOGGED, UNLIMITED, Learner
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.environment import EnvironmentFailedError, StepResult
from rl_tui.worlds.gym.toy_text import world_of
from rl_tui.worlds.mdp.space import FiniteSpace, all_pairs
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

LEARNERS = [each.id for each in BY_ID.values() if not each.planner and importlib.util.find_spec(each.module)]


def lake() -> TabularMDP:
    """A slippery lake with several starts and at most 20 steps needs all kinds of draws."""
    mdp = world_of("FrozenLake-v1", {"desc": ["SFFS", "FHFH", "FFFF", "HFFG"]}).mdp
    assert mdp is not None
    return replace(mdp, time_limit=20)


class Table:
    """A table used as an environment, with draws from ``seed``'s world stream like the compiled loop."""

    def __init__(self, mdp: TabularMDP, seed: int) -> None:
        self._mdp, self._generator = mdp, streams(seed).world
        self._state = self._taken = 0
        self.seeds: list[int | None] = []

    def reset(self, seed: int | None = None) -> int:
        self.seeds.append(seed)
        self._taken, index = 0, 0
        if len(self._mdp.start_state) > 1:
            draw = self._generator.random()
            while draw >= self._mdp.start_cumulative[index]:
                index += 1
        self._state = int(self._mdp.start_state[index])
        return self._state

    def step(self, action: int) -> StepResult:
        mdp = self._mdp
        pair = next(p for p in mdp.pairs_of(self._state) if mdp.pair_action[p] == action)
        outcomes = mdp.outcomes_of(pair)
        outcome = outcomes[0]
        if len(outcomes) > 1:
            draw = self._generator.random()
            outcome += sum(draw >= mdp.cumulative[each] for each in outcomes[:-1])
        self._state = int(mdp.next_state[outcome])
        self._taken += 1
        over = bool(mdp.terminated[outcome])
        truncated = self._taken == mdp.time_limit and not over
        return StepResult(self._state, float(mdp.reward[outcome]), over, truncated)


def untabled(mdp: TabularMDP) -> FiniteSpace:
    return FiniteSpace(mdp.state_names, mdp.action_names, mdp.first_pair, mdp.pair_action, mdp.time_limit)


def facts(learner: Learner) -> list[Any]:
    assert learner.last_step is not None
    return [
        learner.q.tolist(),
        learner.visits.tolist(),
        learner.step,
        learner.episodes,
        learner.state,
        learner.episode_step,
        learner.counters.episode_return,
        learner.first_reward_episode,
        replace(learner.last_step, outcome=-1),
        learner.streams.learner.bit_generator.state,
    ]


def go(learner: Learner, steps: int) -> list[list[float]]:
    done, ended = learner.step + steps, [[0.0, 0.0]]
    while learner.step < done:
        learner.advance(done - learner.step)
        returns, lengths, _ = learner.drain_episodes()
        ended += [list(each) for each in zip(returns.tolist(), lengths.tolist(), strict=True)]
    return ended


HYPERPARAMETERS = Hyperparameters(alpha=0.3, epsilon=0.8, epsilon_min=0.1, epsilon_decay=0.05, initial_q=0.5)


@pytest.mark.compiled
def test_a_stepped_table_gives_the_bits_of_the_compiled_loop() -> None:
    mdp = lake()
    by_table = Learner(mdp, "q-learning", HYPERPARAMETERS, streams(7))
    stepped = Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(7), Table(mdp, 7))
    assert go(stepped, 3_000) == go(by_table, 3_000)
    assert facts(stepped) == facts(by_table)


@pytest.mark.parametrize("algorithm", LEARNERS)
def test_every_algorithm_learns_alike_interpreted(algorithm: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Learner, "is_compiled", False)
    mdp = lake()
    by_table = Learner(mdp, algorithm, HYPERPARAMETERS, streams(3))
    stepped = Learner(untabled(mdp), algorithm, HYPERPARAMETERS, streams(3), Table(mdp, 3))
    assert go(stepped, 300) == go(by_table, 300)
    assert facts(stepped) == facts(by_table)


def test_how_the_steps_are_cut_does_not_matter() -> None:
    mdp = lake()
    whole, pieces = (
        Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(1), Table(mdp, 1)) for _ in range(2)
    )
    ended = go(whole, 600)
    in_pieces = [[0.0, 0.0]]
    for steps in [1] * 100 + [7] * 50 + [150]:
        in_pieces += go(pieces, steps)[1:]
    assert in_pieces == ended
    assert facts(pieces) == facts(whole)


def test_out_of_patience_it_comes_back_after_a_step() -> None:
    mdp = lake()
    learner = Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(1), Table(mdp, 1))
    learner.set_time_budget(0.0)
    for step in range(1, 601):
        assert learner.advance(1_000) is Stop.DONE
        assert learner.step == step
    whole = Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(1), Table(mdp, 1))
    go(whole, 600)
    assert facts(learner) == facts(whole)


def test_it_stops_after_so_many_episodes() -> None:
    mdp = lake()
    learner = Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(0), Table(mdp, 0))
    assert learner.advance(UNLIMITED, 5) is Stop.DONE
    assert (learner.episodes, learner.episode_step) == (5, 0)


def test_the_seed_is_drawn_once_from_the_stream_of_the_world() -> None:
    mdp = lake()
    seeds = []
    for seed in (0, 0, 1):
        table = Table(mdp, 0)
        Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(seed), table).advance(UNLIMITED, 3)
        assert table.seeds[1:] == [None] * 3
        seeds.append(table.seeds[0])
    assert seeds[0] == seeds[1] == int(streams(0).world.integers(2**31))
    assert seeds[2] != seeds[0]


class Line:
    """One state, one action. It gives ``answers`` in order, then repeats the last; None fails."""

    def __init__(self, *answers: StepResult | None, starts: int = 10**9) -> None:
        self._answers = list(answers)
        self._starts = starts

    def reset(self, seed: int | None = None) -> int:
        self._starts -= 1
        if self._starts < 0:
            raise EnvironmentFailedError("the wheel is lost")
        return 0

    def step(self, action: int) -> StepResult:
        answer = self._answers.pop(0) if len(self._answers) > 1 else self._answers[0]
        if answer is None:
            raise EnvironmentFailedError("the wheel is lost")
        return answer


ON, OVER = StepResult(0, 1.0, False, False), StepResult(0, 1.0, True, False)


def on(environment: Line, **hyperparameters: float) -> Learner:
    return Learner(
        all_pairs(["here"], ["on"], 0),
        "q-learning",
        Hyperparameters(**hyperparameters),
        streams(0),
        environment,
    )


def test_a_failure_keeps_what_was_learned_until_then() -> None:
    learner = on(Line(ON, OVER, ON, None), alpha=1.0, gamma=0.5)
    assert learner.advance(100) is Stop.WORLD_FAILED
    assert learner.advance(100) is Stop.WORLD_FAILED
    assert learner.stop_reason == "at step 4 the wheel is lost"
    last = learner.last_step
    assert (learner.step, last.step, learner.visits[0], learner.episodes, learner.episode_step) == (
        3,
        3,
        3,
        1,
        1,
    )
    assert learner.q[0] == last.after == 1.5


def test_a_failure_to_start_again_keeps_the_episode_before_it() -> None:
    learner = on(Line(ON, OVER, starts=1), alpha=1.0)
    assert learner.advance(100) is Stop.WORLD_FAILED
    assert (learner.step, learner.episodes, learner.episode_step) == (2, 1, 0)
    assert learner.drain_episodes().returns.tolist() == [2.0]
    assert learner.stop_reason == "after step 2 the wheel is lost"
    assert learner.last_step.terminated


def test_an_environment_that_cannot_start_is_an_error_at_once() -> None:
    with pytest.raises(EnvironmentFailedError, match="the wheel is lost"):
        on(Line(ON, starts=0))


def test_a_truncated_step_still_bootstraps_and_a_terminated_one_does_not() -> None:
    cut, over = on(Line(StepResult(0, 1.0, False, True)), initial_q=2.0), on(Line(OVER), initial_q=2.0)
    for learner in (cut, over):
        learner.advance(1)
        assert learner.episodes == 1
    assert (cut.last_step.bootstrap, over.last_step.bootstrap) == (2.0, 0.0)


def test_a_runaway_stops_for_good() -> None:
    learner = on(Line(StepResult(0, 1e13, False, False)), alpha=1.0)
    assert learner.advance(10) is Stop.DIVERGED
    assert learner.step == 1
    assert "left ±1e12 at step 1" in learner.stop_reason


def test_an_endless_episode_stops_for_good() -> None:
    learner = on(Line(ON))
    learner._position.episode_step[0] = LONGEST_EPISODE - 2
    assert learner.advance(10) is Stop.ENDLESS_EPISODE
    assert learner.step == 2


def test_a_full_log_waits_to_be_drained() -> None:
    learner = on(Line(OVER))
    assert learner.advance(EPISODES_LOGGED + 5) is Stop.EPISODES_FULL
    assert len(learner.drain_episodes().returns) == EPISODES_LOGGED
    assert learner.advance(5) is Stop.DONE


def test_it_cannot_be_wound_back_and_says_so() -> None:
    learner = on(Line(ON))
    assert not learner.rewindable
    assert Learner(lake(), "q-learning", HYPERPARAMETERS, streams(0)).rewindable
    with pytest.raises(UserError, match="cannot go back"):
        learner.checkpoint()


def test_hyperparameters_change_between_steps() -> None:
    learner = on(Line(ON), alpha=0.5, gamma=0.0)
    learner.advance(1)
    learner.configure(Hyperparameters(alpha=1.0, gamma=0.0))
    learner.advance(1)
    assert learner.q[0] == 1.0
    learner.configure(Hyperparameters(alpha="sample-average", gamma=0.0))
    learner.advance(1)
    assert learner.last_step.step_size == pytest.approx(1 / 3)
