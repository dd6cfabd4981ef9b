from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recipes import bandit, recipe, replay
from snapshots import snapshot_of

from rl_tui.agents.exact.policy_figures import expected_return, greedy_policy
from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE
from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Phase
from rl_tui.runs.recipe import JournalEntry, SetParameter, SwitchAlgorithm, action_called
from rl_tui.runs.run import Run, RunState


def assert_same(one: Run, other: Run) -> None:
    first, second = one.checkpoint(), other.checkpoint()
    assert _bits(first.learner) == _bits(second.learner)
    assert _bits(first.history) == _bits(second.history)
    assert _bits(first.marks) == _bits(second.marks)
    assert first.journal == second.journal


def vars_of(value: Any) -> dict[str, Any]:
    return {name: getattr(value, name) for name in value.__dataclass_fields__}


def _bits(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if isinstance(value, (tuple, list)):
        return [_bits(each) for each in value]
    if hasattr(value, "__dataclass_fields__"):
        return {name: _bits(each) for name, each in vars_of(value).items()}
    return {key: _bits(each) for key, each in value.items()} if isinstance(value, dict) else value


CHANGES = st.one_of(
    st.builds(SetParameter, st.just("alpha"), st.sampled_from([0.05, 0.5, 1.0, SAMPLE_AVERAGE])),
    st.builds(SetParameter, st.just("epsilon"), st.floats(0, 1)),
    st.builds(SetParameter, st.just("gamma"), st.floats(0, 1)),
    st.builds(SetParameter, st.just("ties"), st.sampled_from(["random", "first"])),
    st.builds(SwitchAlgorithm, st.just("q-learning")),
)
DEEDS = st.one_of(
    st.tuples(st.just("steps"), st.integers(0, 200)),
    st.tuples(st.just("episodes"), st.integers(0, 20)),
    st.tuples(st.just("apply"), CHANGES),
    st.just(("keep", None)),
    st.just(("go back", None)),
)


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["student", "bandit"]), st.integers(0, 2**32), st.lists(DEEDS, max_size=12), st.booleans()
)
def test_whatever_was_done_equals_the_straight_replay(
    scenario: str, seed: int, deeds: list[tuple[str, Any]], elsewhere: bool
) -> None:
    run = Run(recipe(scenario, seed))
    kept: RunState = run.checkpoint()
    for deed, what in deeds:
        if deed == "steps":
            run.advance(steps=what)
        elif deed == "episodes":
            run.advance(episodes=what)
        elif deed == "apply":
            run.apply(what)
        elif deed == "keep":
            kept = run.checkpoint()
        else:
            run = Run(recipe(scenario, seed)) if elsewhere else run
            run.restore(kept)
    run.advance(steps=0)
    assert_same(run, replay(run.recipe, run.journal, run.step))


@pytest.mark.parametrize("scenario", ["frozenlake-slippery", "bandit"])
def test_chunks_leave_no_trace(scenario: str) -> None:
    whole, pieces = Run(recipe(scenario)), Run(recipe(scenario))
    whole.advance(steps=20_000)
    while pieces.step < 20_000:
        pieces.advance(steps=min(17, 20_000 - pieces.step))
    assert_same(whole, pieces)


def test_marks_do_not_influence_learning() -> None:
    marked, plain = Run(recipe("student")), Run(recipe("student"), evaluate=False)
    marked.advance(steps=3_000)
    plain.advance(steps=3_000)
    assert marked.learner.q.tobytes() == plain.learner.q.tobytes()
    assert len(marked.results.marks.step) > 0
    assert len(plain.results.marks.step) == 0


def test_a_mark_is_the_exact_return_of_the_greedy_policy_of_its_step() -> None:
    run = Run(recipe("student", seed=4))
    run.advance(steps=200)
    for step, episode, value in zip(*vars_of(run.results.marks).values(), strict=True):
        then = replay(run.recipe, (), int(step))
        policy = greedy_policy(then.world.space, then.learner.q, "random")
        assert value == expected_return(then.world.space, policy)
        assert episode == then.learner.episodes


def test_a_mark_belongs_to_what_was_in_force_before_the_change_of_its_step() -> None:
    changed, unchanged = Run(recipe("student")), Run(recipe("student"))
    changed.apply(SetParameter("ties", "first"))
    changed.advance(steps=1)
    unchanged.advance(steps=1)
    assert changed.results.marks.expected_return[0] == unchanged.results.marks.expected_return[0]
    # Equal estimates: randomly, 50 steps of study or phone. The first action studies and always passes
    assert unchanged.results.marks.expected_return[0] < 7.5


def test_a_journal_entry_counts_from_the_next_step_on() -> None:
    run = Run(recipe("student", alpha=0.1))
    run.advance(steps=5)
    run.apply(SetParameter("alpha", 0.5))
    assert run.learner.last_step.step_size == 0.1
    run.advance(steps=1)
    assert run.learner.last_step.step_size == 0.5
    assert run.journal == (JournalEntry(5, SetParameter("alpha", 0.5)),)


def test_a_value_out_of_range_is_refused_with_the_range_and_not_journalled() -> None:
    run = Run(recipe("student"))
    with pytest.raises(UserError, match=r"alpha is 2; expected a number in \(0, 1\] or sample-average"):
        run.apply(SetParameter("alpha", 2))
    assert run.journal == ()


def test_every_episode_is_reported_once_and_in_order() -> None:
    episodes: list[tuple[float, bool]] = []
    run = Run(
        recipe("bandit"),
        on_episodes=lambda returns, lengths, optimal: episodes.extend(
            zip(returns.tolist(), optimal.tolist(), strict=True)
        ),
    )
    run.advance(episodes=20_000)  # more than the learner logs at once
    assert run.learner.episodes == run.step == len(episodes) == 20_000
    assert sum(total for total, _ in episodes) == pytest.approx(run.history.total_return)
    best = int(run.world.space.reward.argmax())
    assert sum(optimal for _, optimal in episodes) == run.learner.visits[best]


def test_a_run_ends_with_its_budget() -> None:
    run = Run(bandit(50), episode_limit=50)
    run.advance(steps=1000)
    assert run.step == 50
    assert run.over
    assert run.spent
    assert not run.stop_reason


def test_a_bandit_settles_its_accounts() -> None:
    run = Run(recipe("bandit", seed=3), episode_limit=1000)
    run.advance(steps=1000)
    snapshot = snapshot_of(run, Phase.SPENT)
    means = run.world.space.reward
    visits = run.learner.visits
    figures = snapshot.results.bandit
    assert figures.pulls == figures.budget == 1000
    assert figures.regret == pytest.approx(sum(visits * (means.max() - means)))
    assert figures.best_arm_rate == visits[means.argmax()] / 1000
    assert figures.best_possible == pytest.approx(1000 * means.max())
    assert figures.winnings == run.history.total_return
    assert snapshot_of(Run(recipe("student"))).results.bandit is None


def test_a_runaway_stops_the_run_and_names_the_step(tmp_path: Any) -> None:
    file = tmp_path / "loop.toml"
    file.write_text(
        '[defaults]\nalpha = 1.0\ngamma = 1.0\n[mdp]\nstart = "A"\n'
        '[[mdp.transition]]\nstate = "A"\naction = "loop"\nreward = 1e12\nto = "A"\n'
    )
    run = Run(recipe(str(file)))
    run.advance(steps=1000)
    assert run.over
    assert run.step == 2
    assert "at step 2" in run.stop_reason
    run.advance(steps=1000)
    assert run.step == 2
    assert snapshot_of(run, Phase.STOPPED, message=run.stop_reason).results.greedy_return is None
    assert_same(run, replay(run.recipe, (), 2))


def test_the_agent_is_seen_where_an_episode_ended_until_the_next_begins() -> None:
    run = Run(recipe("student"))
    run.advance(episodes=1)
    ended = snapshot_of(run)
    assert ended.counters.state == ended.counters.last_step.next_state != run.learner.state
    run.advance(steps=1)
    begun = snapshot_of(run)
    assert begun.counters.last_step.state == int(run.world.space.start_state[0])


def test_the_last_step_is_told_by_whoever_took_it() -> None:
    run = Run(recipe("frozenlake"))
    run.advance(steps=5)
    run.apply(SwitchAlgorithm("value-iteration"))
    run.apply(SetParameter("policy", "softmax"))
    shown = snapshot_of(run)
    assert shown.agent.algorithm == "value-iteration"
    algorithm, hyperparameters = shown.agent.learned_by
    assert (algorithm, hyperparameters.policy) == ("q-learning", "epsilon-greedy")
    kept = run.checkpoint()
    run.advance(steps=1)
    assert snapshot_of(run).agent.learned_by[0] == "value-iteration"
    run.restore(kept)
    assert snapshot_of(run).agent.learned_by[0] == "q-learning"


def test_spaces_of_an_action_matter_only_if_names_differ_by_them() -> None:
    names = ("south", "pick up", "a b", "ab", " left")
    wanted = ("pick up", "pickup", " south", "a b", "ab", "left", "up", "a  b")
    assert [action_called(each, names) for each in wanted] == [1, 1, 0, 2, 3, 4, None, None]
