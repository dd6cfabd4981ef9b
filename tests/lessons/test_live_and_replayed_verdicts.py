"""Measures of a live run equal those of its replay."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lessons.task_samples import condition, recipe_in

from rl_tui.common.errors import UserError
from rl_tui.lessons.judging.journal_reader import entries_before, run_digest
from rl_tui.lessons.judging.measures import MEASURES, MissingError
from rl_tui.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.lessons.judging.seed_panel import replayed
from rl_tui.runs.recipe import OrderSweep, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.run import Run

pytestmark = pytest.mark.unit

ARGUMENTS: dict[str, dict[str, Any]] = {
    "student": {"state": "Class", "action": "study", "actions": ["study", "check phone"]},
    "frozenlake": {"state": "14", "action": "right", "actions": ["left", "down"]},
}
OPERATIONS = st.one_of(
    st.tuples(st.just("step"), st.integers(1, 40)),
    st.tuples(st.just("episode"), st.integers(1, 3)),
    st.tuples(st.just("take"), st.integers(0, 3)),
    st.tuples(st.just("set"), st.sampled_from([("gamma", 0.5), ("gamma", 1.0), ("epsilon", 0.9)])),
    st.tuples(st.just("set"), st.sampled_from([("ties", "first"), ("ties", "random"), ("alpha", 0.3)])),
    st.tuples(
        st.just("switch"),
        st.sampled_from(["q-learning", "double-q-learning", "value-iteration", "policy-iteration"]),
    ),
    st.tuples(st.just("sweep"), st.sampled_from(["improvement", "evaluation"])),
    st.tuples(st.just("rest"), st.sampled_from(["value-iteration", "policy-iteration"])),
    st.tuples(st.just("keep"), st.none()),
    st.tuples(st.just("back"), st.integers(0, 3)),
)


def all_measured(run: Run, scenario: str, kept: Kept) -> dict[str, Any]:
    moment = JudgedMoment(run, recipe_in(scenario), kept)
    values = dict[str, Any]()
    for name, measure in MEASURES.items():
        known = {**ARGUMENTS[scenario], "first": 1, "last": 2}
        asked = condition(name, **{each: known[each] for each in measure.needs})
        try:
            values[name] = measure.of(moment, asked)
        except MissingError as reason:
            values[name] = str(reason)
    values["digest"] = moment.journal.digest
    return values


def carry_out(run: Run, what: str, value: Any, kept: list[Any]) -> None:
    if what == "step":
        run.advance(value)
    elif what == "episode":
        run.advance(2_000, episodes=value)
    elif what == "set":
        run.apply(SetParameter(*value))
    elif what == "switch":
        run.apply(SwitchAlgorithm(value))
    elif what == "rest":
        run.apply(SwitchAlgorithm(value))
        run.advance(5_000)
    elif what == "sweep":
        run.apply(OrderSweep(value))
    elif what == "take":
        run.apply(TakeAction(value))
    elif what == "keep":
        kept.append(run.checkpoint())
    elif kept:
        run.restore(kept[value % len(kept)])


@pytest.mark.parametrize("scenario", list(ARGUMENTS))
@given(operations=st.lists(OPERATIONS, min_size=1, max_size=12), seed=st.integers(0, 50))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_every_measure_is_that_of_the_replay(scenario: str, operations: list[Any], seed: int) -> None:
    made_from = recipe_in(scenario, seed, alpha=0.5)
    run, checkpoints, kept = Run(made_from), list[Any](), Kept()
    for what, value in operations:
        try:
            carry_out(run, what, value, checkpoints)
        except UserError:
            continue
        before = entries_before(run.journal, run.step)
        again = replayed(made_from, before, run.step)
        live = all_measured(run, scenario, kept)
        assert live == all_measured(again, scenario, Kept())
        names = run.world.space.action_names
        assert live["digest"] == run_digest(made_from, run.journal, run.step, names)


def test_what_was_done_on_another_branch_does_not_count() -> None:
    run, kept = Run(recipe_in("student", alpha=0.5)), Kept()
    run.apply(SetParameter("epsilon", 0.4))
    run.advance(2)
    here = run.checkpoint()
    for epsilon, gamma in ((0.5, 0.5), (0.6, 0.6)):
        run.restore(here)
        run.apply(SetParameter("epsilon", epsilon))
        run.apply(TakeAction(0 if run.learner.state == 0 else 2))
        run.advance(1)
        run.apply(SetParameter("gamma", gamma))
        run.advance(1)
        live = all_measured(run, "student", kept)
        assert live == all_measured(run, "student", Kept())
