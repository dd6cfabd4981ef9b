"""Values of policies in a run."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from playing import busy
from recipes import bandit, recipe

from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.policies.chances import action_chances
from rl_tui.live.commands import AddLane, Apply, DrawAction, Pause, Play, Restart, Step, StudyPolicy, Train
from rl_tui.live.playback import Playback
from rl_tui.runs import evaluation
from rl_tui.runs.answers import policy_values
from rl_tui.runs.answers.policy_kind import PLANS, PolicyKind
from rl_tui.runs.answers.policy_values import NO_CHANCES, TOO_MANY, WHILE_RUNNING, PolicyAnswer
from rl_tui.runs.recipe import Recipe, SetParameter
from rl_tui.runs.run import Run
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

UNIFORM, OPTIMAL, GREEDY, BEHAVIOUR, DRAWN = (
    PolicyKind.UNIFORM,
    PolicyKind.OPTIMAL,
    PolicyKind.GREEDY,
    PolicyKind.BEHAVIOUR,
    PolicyKind.DRAWN,
)
SOLVED = ("frozenlake-slippery", "student", "cliff")


def ready(made_from: Recipe, *, automatic: bool = False) -> Playback:
    clock = itertools.count(0.0, 0.001).__next__
    playback = Playback(made_from, speed=None, automatic=automatic, clock=clock, on_exact=lambda: None)
    while busy(playback):
        playback.work()
    return playback


def after(made_from: Recipe, steps: int, kind: PolicyKind = UNIFORM) -> Playback:
    playback = ready(made_from)
    playback.handle(StudyPolicy(kind))
    playback.handle(Train(steps))
    while playback.on_the_way:
        playback.work()
    return playback


def answer(playback: Playback, kind: PolicyKind) -> PolicyAnswer:
    return playback.snapshot().answers.policies[kind]


def plain_values(mdp: TabularMDP, policy: np.ndarray[Any, Any], gamma: float) -> np.ndarray[Any, Any]:
    matrix, right = np.eye(mdp.states), np.zeros(mdp.states)
    for pair in range(mdp.pairs):
        state = int(mdp.pair_state[pair])
        for outcome in mdp.outcomes_of(pair):
            chance = policy[pair] * mdp.probability[outcome]
            right[state] += chance * mdp.reward[outcome]
            if not mdp.terminated[outcome]:
                matrix[state, int(mdp.next_state[outcome])] -= gamma * chance
    return np.linalg.solve(matrix, right)


@pytest.mark.parametrize("scenario", SOLVED)
@pytest.mark.parametrize("kind", PolicyKind)
def test_values_solve_the_equations_of_the_policy(scenario: str, kind: PolicyKind) -> None:
    gamma = 0.9
    playback = after(recipe(scenario, gamma=gamma), 300)
    playback.handle(DrawAction(0, 1))
    mdp, found = playback.group.current.run.world.mdp, answer(playback, kind)
    assert mdp is not None
    assert found.policy is not None
    assert found.v is not None
    assert found.q is not None
    v = plain_values(mdp, found.policy, gamma)
    assert found.v == pytest.approx(v, abs=1e-9)
    assert found.value_at_start == pytest.approx(mdp.average_at_start(v), abs=1e-9)
    mixed = np.zeros(mdp.states)
    np.add.at(mixed, mdp.pair_state, found.policy * found.q)
    live = np.diff(mdp.first_pair) > 0
    assert mixed[live] == pytest.approx(v[live], abs=1e-9)  # V(s) = Σ π(a|s) Q(s, a)


def test_the_known_values_of_random_acting() -> None:
    student = after(recipe("student"), 0)
    v = answer(student, UNIFORM).v
    assert v is not None
    names = student.group.current.run.world.space.state_names
    assert dict(zip(names, np.round(v, 4), strict=True)).items() >= {"Class": 4.0436, "Phone": 2.3993}.items()
    lake = answer(after(recipe("frozenlake-slippery"), 0), UNIFORM)
    assert lake.expected_return == pytest.approx(0.013939795959171436, abs=1e-15)
    assert lake.ends == pytest.approx(1.0, abs=1e-7)


def test_what_was_drawn_is_done_and_all_else_is_random() -> None:
    playback = after(recipe("student"), 0, DRAWN)
    assert answer(playback, DRAWN).expected_return == answer(playback, UNIFORM).expected_return
    playback.handle(DrawAction(0, 0))
    found = answer(playback, DRAWN)
    assert found.policy[:2].tolist() == [1.0, 0.0]


@pytest.mark.parametrize("ties", ["random", "first"])
@pytest.mark.parametrize("schedule", ["constant", "linear"])
def test_the_agent_as_it_acts_is_its_own_chances_state_by_state(ties: str, schedule: str) -> None:
    more = {} if schedule == "constant" else {"epsilon_schedule": schedule, "epsilon_decay": 0.01}
    playback = after(recipe("frozenlake-slippery", epsilon=0.3, ties=ties, **more), 400)
    run, found = playback.group.current.run, answer(playback, BEHAVIOUR)
    assert found.policy is not None
    values, learner = run.learner.hyperparameters, run.learner
    epsilon = values.epsilon_at(learner.episodes)
    assert (epsilon == 0.3) is (schedule == "constant")
    for state in range(run.world.space.states):
        own = run.world.space.pairs_of(state)
        if own:
            part = slice(own.start, own.stop)
            by_state = action_chances(values, epsilon, learner.q[part], learner.visits[part])
            assert found.policy[part] == pytest.approx(by_state, abs=1e-15)


@pytest.mark.parametrize("policy", ["softmax", "ucb"])
def test_other_policies_are_asked_state_by_state(policy: str) -> None:
    playback = after(recipe("student", policy=policy), 200)
    run, found = playback.group.current.run, answer(playback, BEHAVIOUR)
    assert found.policy is not None
    learner = run.learner
    for state in range(3):
        own = run.world.space.pairs_of(state)
        part = slice(own.start, own.stop)
        by_state = action_chances(learner.hyperparameters, 0.0, learner.q[part], learner.visits[part])
        assert found.policy[part] == pytest.approx(by_state, abs=1e-15)


@pytest.mark.interpreted
def test_a_gradient_bandit_acts_by_what_it_prefers() -> None:
    playback = after(bandit(1_000, policy="gradient"), 50)
    run, found = playback.group.current.run, answer(playback, BEHAVIOUR)
    assert found.policy.tolist() == run.learner.rule.probability.tolist()
    assert found.expected_return == pytest.approx(float(found.policy @ run.world.mdp.expected_reward))


@pytest.mark.interpreted
def test_what_cannot_be_told_says_why() -> None:
    assert answer(after(bandit(1_000, policy="thompson"), 5), BEHAVIOUR).refused == NO_CHANCES
    assert answer(after(recipe("student", algorithm="value-iteration"), 5), BEHAVIOUR).refused == PLANS
    assert answer(after(recipe("student", algorithm="value-iteration"), 5), GREEDY).is_known


def test_a_large_world_is_left_to_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(policy_values, "LIVE_STATES", 3)
    playback = after(recipe("student"), 0)
    assert {each.refused for each in playback.snapshot().answers.policies.values()} == {TOO_MANY}


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    found: list[float] = []
    plain = policy_values.worth_of

    def counted(mdp: TabularMDP, policy: Any, gamma: float) -> PolicyAnswer:
        found.append(gamma)
        return plain(mdp, policy, gamma)

    monkeypatch.setattr(policy_values, "worth_of", counted)
    return found


def test_nothing_is_worked_out_before_somebody_asks(asked: list[float]) -> None:
    playback = ready(recipe("student"))
    playback.handle(Step())
    assert not playback.snapshot().answers.policies
    assert not asked
    playback.handle(StudyPolicy(GREEDY))
    assert set(playback.snapshot().answers.policies) == set(PolicyKind)
    assert len(asked) == 5
    playback.handle(StudyPolicy(None))
    assert not playback.snapshot().answers.policies


def test_it_is_worked_out_again_only_where_something_is_another(asked: list[float]) -> None:
    playback = after(recipe("student"), 500)
    first = playback.snapshot().answers.policies
    assert len(asked) == 5
    playback.handle(Step())
    again = playback.snapshot().answers.policies
    assert len(asked) == 5  # the same greedy actions
    assert all(again[kind] is first[kind] for kind in PolicyKind)
    playback.handle(Apply(SetParameter("epsilon", 0.5)))
    playback.snapshot()
    assert len(asked) == 6  # the agent's own policy
    playback.handle(Apply(SetParameter("gamma", 0.5)))
    playback.snapshot()
    assert asked[6:] == [0.5] * 5


def test_lanes_have_answers_of_their_own(asked: list[float]) -> None:
    playback = after(recipe("student"), 100, BEHAVIOUR)
    playback.handle(AddLane((SetParameter("epsilon", 0.6),)))
    while playback.on_the_way:
        playback.work()
    left = playback.snapshot()
    assert left.beside is not None
    both = [each.answers.policies[BEHAVIOUR].expected_return for each in (left, left.beside)]
    assert both[0] != both[1]
    asked.clear()
    playback.snapshot()
    assert not asked


@pytest.fixture
def dear(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(policy_values, "is_quick", lambda _: False)


@pytest.mark.usefixtures("dear")
def test_what_is_dear_waits_for_a_pause(asked: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    playback = ready(recipe("student"), automatic=True)
    playback.handle(StudyPolicy(UNIFORM))
    playback.handle(Play())
    playback.work()
    with monkeypatch.context() as patched:
        patched.delattr("rl_tui.runs.answers.policy_values.DrawnPolicy.chances")  # none is started
        patched.delattr("rl_tui.agents.policies.chances.all_chances")
        shown = playback.snapshot().answers.policies
    assert {each.refused for each in shown.values()} == {WHILE_RUNNING}
    assert not asked
    playback.handle(Pause())
    assert not any(each.refused or each.is_known for each in playback.snapshot().answers.policies.values())
    count = 0
    while playback.work() is not None:
        count += len(asked) > count
        assert len(asked) == count  # one between two looks into the mailbox
    assert count == 5
    assert all(each.is_known for each in playback.snapshot().answers.policies.values())
    playback.handle(Play())
    playback.work()
    running = playback.snapshot().answers.policies
    assert running[UNIFORM].is_known  # nothing in it has changed


@pytest.mark.usefixtures("dear")
def test_without_time_even_what_is_dear_is_there_at_once() -> None:
    playback = after(recipe("student"), 10)
    assert all(each.is_known for each in playback.snapshot().answers.policies.values())


def test_another_world_has_other_answers() -> None:
    playback = after(bandit(1_000), 10)
    before = answer(playback, UNIFORM).expected_return
    playback.handle(Restart(bandit(1_000, seed=1)))
    while busy(playback) or playback.on_the_way:
        playback.work()
    assert answer(playback, UNIFORM).expected_return != before


def results(made_from: Recipe, steps: int) -> Any:
    run = Run(made_from)
    run.advance(steps=steps)
    return run.results


def test_what_exploring_earns_is_always_there_beside_greedy() -> None:
    for scenario in ("frozenlake-slippery", "cliff"):
        playback = after(recipe(scenario), 4_000)
        shown = playback.snapshot()
        known, always = shown.answers.policies[BEHAVIOUR].expected_return, shown.results.behaviour_return
        assert always == pytest.approx(known, rel=1e-9)
    assert (
        results(recipe("student", epsilon=0.0), 500).behaviour_return
        == results(recipe("student", epsilon=0.0), 500).greedy_return
    )
    assert results(recipe("student", policy="softmax"), 100).behaviour_return is None
    assert results(recipe("student", algorithm="value-iteration"), 30).behaviour_return is None


def test_where_a_second_evaluation_is_dear_it_waits_to_be_asked_for() -> None:
    shown = results(recipe("taxi"), 100)
    assert shown.greedy_return is not None
    assert shown.behaviour_return is None


def test_neither_is_evaluated_again_while_policy_and_epsilon_are_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    evaluated: list[object] = []

    def counted(mdp: TabularMDP, policy: FloatArray) -> float | None:
        evaluated.append(policy)
        return expected_return(mdp, policy)

    monkeypatch.setattr(evaluation, "expected_return", counted)
    run = Run(recipe("student"), evaluate=False)
    run.advance(steps=500)
    assert run.results.behaviour_return != run.results.greedy_return
    assert len(evaluated) == 2
    run.apply(SetParameter("epsilon", 0.5))
    assert run.results.behaviour_return == run.results.behaviour_return
    assert len(evaluated) == 3
