"""Verdicts on tasks."""

from __future__ import annotations

from typing import Any

import pytest
from lessons.task_samples import attempt, condition, lesson_with, recipe_in

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.view import Passed, TaskView
from rl_tui.lessons.judging.conditions import judged_task, program_verdict, verdict
from rl_tui.lessons.judging.seed_panel import PanelsAtOnce, attempted_run, evidence_holds, passes
from rl_tui.lessons.judging.seen_program import SeenProgram
from rl_tui.lessons.judging.verdicts import found_in_words, in_words, is_met
from rl_tui.lessons.lesson import Lesson
from rl_tui.programs.evidence.verdict import CodeFault, CodeFinding, ProgramVerdict, Rule, UpdateFound
from rl_tui.runs.recipe import JournalEntry, SetParameter, TakeAction
from rl_tui.runs.run import Run

pytestmark = pytest.mark.unit

BY_HAND = ["0:take=study", "1:take=study", "2:take=sleep"]
EVENING = {"alpha": 0.5, "gamma": 0.9, "epsilon": 0.0}


def holds(view: TaskView) -> list[bool | None]:
    return [each.holds for each in view.conditions]


@pytest.mark.parametrize(
    ("asked", "value", "expected"),
    [
        ({"equals": 0.3}, 0.1 + 0.2, True),
        ({"equals": 0.3}, 0.3 + 2e-9, False),
        ({"equals": "study"}, "study", True),
        ({"equals": "study"}, "study, check phone", False),
        ({"equals": True}, True, True),
        ({"equals": 1.0}, True, False),
        ({"equals": None, "one_of": [2.0, 4.0]}, 4, True),
        ({"equals": None, "one_of": ["a", "b"]}, "c", False),
        ({"equals": None, "at_least": 2.0, "at_most": 3.0}, 2, True),
        ({"equals": None, "at_least": 2.0, "at_most": 3.0}, 3.1, False),
        ({"equals": None, "at_least": 0.3}, 0.3 - 1e-12, True),
        ({"equals": None, "above": 2.0}, 2, False),
        ({"equals": None, "above": 2.0}, 2.1, True),
        ({"equals": None, "below": 2.0}, 2.0 + 1e-12, False),
        ({"equals": None, "below": 2.0}, 1, True),
        ({"equals": None, "at_least": 0.0}, "sample-average", False),
    ],
)
def test_what_a_condition_asks_for(asked: dict[str, Any], value: Any, expected: bool) -> None:
    assert is_met(condition("steps", **asked), value) is expected


def test_numbers_in_words() -> None:
    assert [in_words(each) for each in (-1.5, 12345, 1 / 3, True, "a")] == [
        "−1.5",
        "12,345",
        "0.3333",
        "yes",
        "a",
    ]


@pytest.mark.parametrize(
    ("asked", "value", "words"),
    [
        ({"equals": None, "at_least": 1.0}, 0.136564, "0.1366"),
        ({"equals": None, "at_least": 1.0}, -35.123456, "−35.12"),
        ({"equals": None, "at_least": 1.0}, 123456.7, "123,457"),
        ({"equals": None, "at_least": 7.5}, 7.499996, "7.499996"),
        ({"equals": None, "below": 7.5}, 7.499996, "7.499996"),
    ],
)
def test_what_was_found_has_four_digits_unless_the_verdict_takes_more(
    asked: dict[str, Any], value: float, words: str
) -> None:
    assert found_in_words(condition("steps", **asked), value) == words


@pytest.mark.parametrize(
    "measure", ["episode_return", "episode_length", "episode_ended", "return_last_100", "return_mean"]
)
def test_where_the_moment_has_not_come_a_condition_is_open(measure: str) -> None:
    asked = "terminated" if measure == "episode_ended" else 1.0
    lesson = lesson_with({"measure": measure, "equals": asked}, **EVENING)
    view = passes(lesson, "only", attempt(changes=BY_HAND[:1], steps=1))
    assert [each.holds for each in view.conditions] == [None]
    assert view.passed is None


def test_an_attempt_that_does_what_is_asked_passes_and_its_evidence_too() -> None:
    asked = [
        {"measure": "q", "state": "Class", "action": "study", "equals": -1.5},
        {"measure": "taken", "equals": 3},
    ]
    lesson = lesson_with(*asked, **EVENING)
    view = passes(lesson, "only", attempt(changes=BY_HAND))
    assert holds(view) == [True, True]
    assert (view.passed.step, len(view.passed.journal), view.passed.claim) == (3, 3, False)
    assert evidence_holds(lesson, view.passed).passed is not None
    less = passes(lesson, "only", attempt(changes=BY_HAND[:2]))
    assert (holds(less), less.passed) == ([True, False], None)


@pytest.mark.parametrize("how", [{"steps": 10**9}, {"changes": ["900000000:gamma=0.5"]}])
def test_an_attempt_that_goes_on_for_too_long_is_refused_at_once(how: dict[str, Any]) -> None:
    lesson = lesson_with({"measure": "steps", "at_least": 3}, **EVENING)
    with pytest.raises(UserError, match="it takes more than 20,000,000 steps"):
        passes(lesson, "only", attempt(**how))


def test_evidence_is_judged_by_its_replay_not_by_its_word() -> None:
    lesson = lesson_with({"measure": "steps", "at_least": 3}, **EVENING)
    recipe = judged_task(lesson, "only").setup
    assert evidence_holds(lesson, Passed("only", recipe, (), 3)).passed is not None
    assert evidence_holds(lesson, Passed("only", recipe, (), 2)).passed is None


def test_nothing_done_passes_nothing_of_settings() -> None:
    lesson = lesson_with(
        {"measure": "epsilon", "equals": 0.0}, {"measure": "algorithm", "equals": "q-learning"}, **EVENING
    )
    assert passes(lesson, "only", attempt()).passed is None
    assert passes(lesson, "only", attempt(steps=1)).passed is not None


def test_what_is_set_and_takes_no_step_does_not_count() -> None:
    lesson = lesson_with({"measure": "gamma", "equals": 0.25}, **EVENING)
    assert passes(lesson, "only", attempt(changes=["5:gamma=0.25"], steps=5)).passed is None
    assert passes(lesson, "only", attempt(changes=["5:gamma=0.25"], steps=6)).passed is not None


def test_settings_of_an_attempt_are_those_of_the_start() -> None:
    lesson = lesson_with(
        {"measure": "changed_settings", "equals": 1}, {"measure": "episodes", "equals": 4}, **EVENING
    )
    view = passes(lesson, "only", attempt(settings={"epsilon": 0.5}, episodes=4))
    assert holds(view) == [True, True]
    assert holds(passes(lesson, "only", attempt(episodes=4))) == [False, True]


def test_a_run_in_another_world_or_under_another_seed_passes_nothing() -> None:
    lesson = lesson_with({"measure": "steps", "at_least": 1}, **EVENING)
    judged = judged_task(lesson, "only")
    for recipe, expected in (
        (recipe_in("student"), True),
        (recipe_in("frozenlake"), False),
        (recipe_in("student", seed=1), False),
    ):
        run = Run(recipe)
        run.advance(2)
        view = verdict(judged, run, PanelsAtOnce())
        assert (view.passed is not None) is expected
    assert passes(lesson, "only", attempt(steps=2), seed=7).passed is not None


IMPOSSIBLE = (
    'proof = { condition = 0, best = "best" }\n[figures]\nbest = { value = "8", by = "best_return()" }\n'
)


def impossible() -> Lesson:
    return lesson_with({"measure": "expected_return", "at_least": 9}, more=IMPOSSIBLE, **EVENING)


def test_that_a_task_is_impossible_passes_where_it_is() -> None:
    view = passes(impossible(), "only", attempt(claim=True))
    assert view.passed.claim
    assert evidence_holds(impossible(), view.passed).passed is not None


def test_that_a_task_is_impossible_is_wrong_where_it_is_not() -> None:
    lesson = lesson_with({"measure": "steps", "at_least": 1}, **EVENING)
    assert passes(lesson, "only", attempt(claim=True)).passed is None
    assert passes(lesson, "only", attempt(claim=True, steps=5)).passed is None
    evidence = Passed("only", judged_task(lesson, "only").setup, step=5, claim=True)
    assert evidence_holds(lesson, evidence).passed is None


def test_an_impossible_task_is_not_passed_by_doing() -> None:
    assert passes(impossible(), "only", attempt(episodes=50)).passed is None


SEEDS = {"seeds": 20, "hold": 18, "episodes": 10}


def maze(*, changes: Any = (), **settings: Any) -> TaskView:
    asked = {"measure": "steps_of_episodes", "first": 2, "last": 10, "at_most": 300, **SEEDS}
    lesson = lesson_with({"measure": "episodes", "at_least": 1}, asked, scenario="maze", algorithm="dyna-q")
    return passes(lesson, "only", attempt(settings=settings, changes=list(changes), episodes=1))


@pytest.mark.parametrize(("planning", "expected"), [(0, False), (5, False), (50, True)])
def test_many_seeds_decide_where_one_would_by_luck(planning: int, expected: bool) -> None:
    view = maze(planning_steps=planning)
    assert holds(view) == [True, expected]
    assert (view.passed is not None) is expected


def test_many_seeds_decide_nothing_where_anything_was_done_on_the_way() -> None:
    assert holds(maze(planning_steps=50, changes=["0:take=up"])) == [True, False]
    assert holds(maze(planning_steps=5, changes=["1:planning_steps=50"])) == [True, False]
    assert holds(maze(planning_steps=5, changes=["0:planning_steps=50"])) == [True, True]


def test_many_seeds_are_asked_only_once_all_else_holds() -> None:
    asked = {"measure": "return_mean", "at_least": -1e9, **SEEDS}
    lesson = lesson_with({"measure": "episodes", "at_least": 5}, asked)
    assert holds(passes(lesson, "only", attempt(episodes=4))) == [False, None]
    assert holds(passes(lesson, "only", attempt(episodes=5))) == [True, True]


def test_a_mean_over_seeds() -> None:
    asked = {"measure": "regret", "seeds": 20, "mean": True, "episodes": 200}
    lesson = lesson_with({**asked, "at_most": 60.0}, {**asked, "above": 60.0}, scenario="bandit")
    before = passes(lesson, "only", attempt(episodes=1))
    assert sorted(map(bool, holds(before))) == [False, True]


def test_a_seed_without_a_value_does_not_hold() -> None:
    asked = {
        "measure": "steps_of_episodes",
        "first": 1,
        "last": 20,
        "at_least": 0,
        "seeds": 4,
        "episodes": 10,
    }
    lesson = lesson_with({**asked, "hold": 1}, {**asked, "mean": True})
    assert holds(passes(lesson, "only", attempt(steps=1))) == [False, False]


def test_an_attempt_ends_where_its_last_change_has_had_its_effect() -> None:
    lesson = lesson_with({"measure": "steps", "at_least": 1}, **EVENING)
    assert attempted_run(lesson, "only", attempt()).step == 0
    assert attempted_run(lesson, "only", attempt(changes=BY_HAND)).step == 3
    assert attempted_run(lesson, "only", attempt(changes=["4:epsilon=0.5"])).step == 4


def test_a_journal_entry_that_waits_is_no_evidence() -> None:
    lesson = lesson_with({"measure": "steps", "equals": 2}, **EVENING)
    judged = judged_task(lesson, "only")
    run = Run(judged.setup)
    run.apply(TakeAction(0))
    run.advance(1)
    run.apply(SetParameter("gamma", 0.1))
    passed = verdict(judged, run, PanelsAtOnce()).passed
    assert passed.journal == (JournalEntry(0, TakeAction(0)),)


FINDING = CodeFinding(CodeFault.GAMMA_TWICE, "proven", 3, 5, 0, "t", "c")
RISK = CodeFinding(CodeFault.NEVER_EXPLORES, "declared", 3, 5, 0, "t", "c")


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (ProgramVerdict(UpdateFound(Rule.Q_LEARNING, 0.5, gamma=0.9)), [True] * 5),
        (ProgramVerdict(UpdateFound(Rule.Q_LEARNING, 0.5, gamma=0.9), (RISK,)), [True] * 5),
        (
            ProgramVerdict(UpdateFound(Rule.Q_LEARNING, 0.5, gamma=0.9), (FINDING,)),
            [True, True, False, True, True],
        ),
        (ProgramVerdict(UpdateFound(Rule.SARSA, None, departs_at=0)), [False, False, True, False, False]),
        (ProgramVerdict(), [False, False, True, False, False]),
    ],
)
def test_a_program_is_judged_by_what_watching_it_found(found: ProgramVerdict, expected: list[bool]) -> None:
    asked = [
        {"measure": "program_rule", "equals": "q-learning"},
        {"measure": "program_departs", "equals": 0},
        {"measure": "program_faults", "equals": 0},
        {"measure": "program_alpha", "equals": 0.5},
        {"measure": "program_gamma", "equals": 0.9},
    ]
    lesson = lesson_with(*asked, more='program = { file = "mine.py", skeleton = "" }\n')
    view = program_verdict(judged_task(lesson, "only"), "code", SeenProgram(found))
    assert holds(view) == expected
    assert (view.passed is not None) is all(expected)
    assert view.passed is None or view.passed.program == "code"


def test_what_only_a_step_can_tell_is_open_before_the_first_one() -> None:
    lesson = lesson_with(
        {"measure": "gamma", "equals": 0.9},
        {"measure": "reward", "equals": -2},
        {"measure": "steps", "at_least": 1},
        {"measure": "q", "state": "Class", "action": "study", "below": 0, "seeds": 2, "hold": 2, "steps": 3},
    )
    judged = judged_task(lesson, "only")
    run = Run(judged.setup)
    view = verdict(judged, run, PanelsAtOnce())
    assert [each.holds for each in view.conditions] == [None, None, False, None]
    assert view.passed is None
    run.advance(1)
    assert verdict(judged, run, PanelsAtOnce()).conditions[0].holds is True
