"""Which visits of a pair a Monte Carlo program counts, from the boxes of chapter 5 of the book."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import pytest
from corpus import CORRECT
from made_recordings import Learner, Step, recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import ProgramVerdict, Rule
from rl_tui.worlds.mdp.space import FloatArray

NOTES = {
    "first": "Only the first visit to a pair in an episode counts: first-visit Monte Carlo.",
    "every": "Every visit to a pair in an episode counts: every-visit Monte Carlo.",
    "last": (
        "Only the last visit to a pair in an episode counts. First-visit Monte Carlo counts only the first."
    ),
}
ENDS_ONLY = (0.0, 0.0, 0.0, 0.0, 1.0)
MIXED = (-1.0, 0.0, 0.0, 1.0, 2.0)


def monte_carlo(
    visits: str, alpha: float | None, gamma: float, *, order: str = "backwards", without_repeats: bool = False
) -> Learner:
    """Return a learner that updates Q by the averages of returns, or by ``alpha``.

    With ``without_repeats``, it learns only from episodes that visit no pair twice.
    """
    episode: list[Step] = []
    returns: dict[tuple[int, int], list[float]] = defaultdict(list)

    def learn(q: FloatArray, step: Step) -> None:
        episode.append(step)
        if not (step.terminated or step.truncated):
            return
        pairs = [(each.state, each.action) for each in episode]
        g, counted = 0.0, []
        for t in range(len(episode) - 1, -1, -1):
            g = gamma * g + episode[t].reward
            if visits == "first" and pairs[t] in pairs[:t]:
                continue
            if visits == "last" and pairs[t] in pairs[t + 1 :]:
                continue
            counted.append((pairs[t], g))
        before = q.copy()
        for pair, g in counted if order == "backwards" else reversed(counted):
            returns[pair].append(g)
            if alpha is None:
                q[pair] = sum(returns[pair]) / len(returns[pair])
            else:
                q[pair] += alpha * (g - (before if order == "together" else q)[pair])
        if without_repeats and len(set(pairs)) < len(pairs):
            q[:] = before
        episode.clear()

    return learn


def shown(verdict: ProgramVerdict) -> list[str]:
    """Return what the notes say of visits."""
    return [name for name, note in NOTES.items() if note in verdict.notes]


@pytest.mark.exhaustive(
    "watches twenty programs for each",
    but=["first-None-0.9", "first-0.1-1.0", "every-None-1.0", "every-0.1-0.9"],
)
@pytest.mark.parametrize("gamma", [0.9, 1.0])
@pytest.mark.parametrize("alpha", [None, 0.1])
@pytest.mark.parametrize("visits", ["first", "every"])
def test_both_forms_are_told_apart_at_every_seed(visits: str, alpha: float | None, gamma: float) -> None:
    for seed in range(20):
        rewards = MIXED if seed % 2 else ENDS_ONLY
        log = recorded(monte_carlo(visits, alpha, gamma), seed, initial="zeros", rewards=rewards)
        log.numbers["gamma"] = gamma
        verdict = verdict_of(log)
        update = verdict.update
        assert (update.rule, update.alpha, update.gamma) == (Rule.MONTE_CARLO, alpha, gamma)
        assert (shown(verdict), verdict.findings) == ([visits], ()), seed


@pytest.mark.parametrize("order", ["forwards", "together"])
def test_every_visit_is_recognized_in_each_order_of_the_updates(order: str) -> None:
    for seed in range(5):
        log = recorded(monte_carlo("every", 0.1, 0.9, order=order), seed, initial="zeros")
        assert shown(verdict_of(log)) == ["every"]


@pytest.mark.parametrize("alpha", [None, 0.1])
def test_the_last_visit_is_neither(alpha: float | None) -> None:
    for seed in range(5):
        log = recorded(monte_carlo("last", alpha, 0.9), seed, initial="zeros")
        assert shown(verdict_of(log)) == ["last"]


@pytest.mark.exhaustive("all combinations", but=["first-None", "every-0.1"])
@pytest.mark.parametrize("alpha", [None, 0.1])
@pytest.mark.parametrize("visits", ["first", "every"])
def test_nothing_is_said_where_no_pair_is_visited_twice(visits: str, alpha: float | None) -> None:
    for seed in range(5):
        learner = monte_carlo(visits, alpha, 0.9, without_repeats=True)
        verdict = verdict_of(recorded(learner, seed, steps=4_000, initial="zeros"))
        assert shown(verdict) == []
        if alpha is not None:
            assert verdict.update.rule is Rule.MONTE_CARLO


def test_changed_estimates_of_other_rules_say_nothing() -> None:
    def half(q: FloatArray, step: Step) -> None:
        q[step.state, step.action] += 0.5 * (step.reward - q[step.state, step.action])

    assert shown(verdict_of(recorded(half))) == []


@pytest.mark.process
@pytest.mark.parametrize(
    ("script", "visits"), [("first_visit", ["first"]), ("every_visit", []), ("constant", [])]
)
def test_scripts_say_it_where_pairs_return(script: str, visits: list[str], tmp_path: Path) -> None:
    """In blackjack, no pair is visited twice."""
    (program,) = (each for each in CORRECT if each.name == f"monte_carlo_{script}")
    assert shown(verdict_of(program.watched(tmp_path, seed=1))) == visits
