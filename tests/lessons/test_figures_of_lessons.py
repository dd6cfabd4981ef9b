"""Figures of lessons."""

from __future__ import annotations

import gc
import json
import weakref
from typing import Any, Final

import pytest
from click.testing import CliRunner
from lesson_samples import with_figures

from rl_tui.commands.main import program
from rl_tui.lessons.figures.expression import FigureError
from rl_tui.lessons.figures.figures import FUNCTIONS, LessonFigures
from rl_tui.lessons.figures.step_budget import FIGURE_STEPS, STEPPED, StepBudget
from rl_tui.runs.run import OnEpisodes, Run
from rl_tui.runs.training.seeded_runs import SeededRuns

pytestmark = pytest.mark.unit

TOP_ROW: Final = ", ".join(
    [
        "'else': 'up'",
        *(f"'{cell}': 'right'" for cell in range(11)),
        *(f"'{cell}': 'down'" for cell in (11, 23, 35)),
    ]
)

KNOWN: Final = (
    ("6.3415", "optimal_value('Class')"),
    ("6.3415", "optimal_value()"),
    ("0.25", "flip(1)"),
    ("1", "flips()"),
    ("7.5", "optimal_return()"),
    ("7.5", "best_return()"),
    ("2.25", "policy_steps('optimal')"),
    ("4.0436", "policy_value('Class', 'uniform')"),
    ("2.3993", "policy_value('Phone')"),
    ("10", "policy_value('Pass')"),
    ("80 %", "chance('Class', 'study', 'Pass')"),
    ("−2", "reward('Class', 'study', 'Pass')"),
    ("−1.5", "-alpha * 3"),
    ("q-learning", "algorithm"),
    ("5", "abs(min(-5, max(1, 2)))"),
    ("3", "sqrt(9) + log(1) + log10(1) + exp(0) - round(1.2)"),
    ("71.7", "mean_episodes(scenario='frozenlake', ties='random')"),
    ("50", "median_episodes(scenario='frozenlake', ties='random')"),
    (".013940", "first_update_chance(scenario='frozenlake', ties='random')"),
    ("184,616", "mean_episodes(scenario='frozenlake', ties='first', epsilon=0.1)"),
    ("94.7 %", "(1 - first_update_chance(scenario='frozenlake', ties='first', epsilon=0.1)) ** 10000"),
    ("10,741", "mean_episodes(scenario='frozenlake-slippery', ties='first', epsilon=0.1)"),
    ("0.86284", "optimal_q(14, 'down', scenario='frozenlake-slippery')"),
    ("0.542026", "optimal_value(0, scenario='frozenlake-slippery')"),
    ("0.7402", "optimal_return(scenario='frozenlake-slippery')"),
    ("0.7442", "best_return(scenario='frozenlake-slippery')"),
    ("14/17", "unlimited_return(scenario='frozenlake-slippery')"),
    ("0.4055", "policy_return('optimal', 0.1, scenario='frozenlake-slippery')"),
    ("−50.80", "policy_return('optimal', epsilon=0.1, scenario='cliff')"),
    ("−20.71", "soft_return(0.1, 0.1, scenario='cliff')"),
    ("15", "soft_steps(0.1, 0, scenario='cliff')"),
    ("−28.63", "soft_return(0.2, 0.2, scenario='cliff')"),
    ("−22.27", f"policy_return({{{TOP_ROW}}}, 0.1, scenario='cliff')"),
    ("1", "policy_ends('optimal', scenario='cliff')"),
    (".5133", "optimal_value(scenario='maze')"),
    (".5188", "way_flip(1, scenario='discount')"),
    ("10", "pairs(scenario='bandit')"),
    ("1,000", "budget(scenario='bandit')"),
    ("16", "states(scenario='frozenlake')"),
    ("11", "live_states(scenario='frozenlake')"),
    ("44", "pairs(scenario='frozenlake')"),
    ("4", "actions(scenario='frozenlake')"),
    ("2", "actions('Class')"),
    ("100", "time_limit(scenario='frozenlake')"),
)
HANDS: Final = '["0:take=study", "1:take=study", "2:take=sleep", "3:take=study"]'
RUNS: Final = (
    ("−1", f"run('q', steps=1, changes={HANDS}, state='Class', action='study')"),
    ("−1.5", f"run('q', steps=2, changes={HANDS}, state='Class', action='study')"),
    ("0.5", f"run('q', steps=4, changes={HANDS}, state='Class', action='study')"),
    ("+4.0", f"run('td_error', steps=4, changes={HANDS})"),
    ("check phone", "run('policy_in', episodes=3, state='Class')"),
    ("study", "attempt('do', 'study', 'policy_in', state='Class', setup='evening') "),
    ("−1", "attempt('do', 'study', 'q', state='Class', action='study')"),
    ("100 %", "share('policy_in', equals='study', state='Class', episodes=100, initial_q=5)"),
    ("0", "count('policy_in', equals='study', state='Class', episodes=100, seeds=20)"),
)


def finding(value: str, by: str) -> str:
    lesson = with_figures(f"tried = {{ value = {json.dumps(value)}, by = {json.dumps(by)} }}")
    found = LessonFigures(lesson).finding("tried")
    return "" if found is None else f"{found.location[-1]}: {found.found}; {found.expected}"


@pytest.mark.parametrize(("value", "by"), [*KNOWN, *(row for row in RUNS if not row[1].endswith(" "))])
def test_known_values(value: str, by: str) -> None:
    assert finding(value, by) == ""


@pytest.mark.parametrize(("value", "by"), KNOWN[:9])
def test_another_value_is_not_so(value: str, by: str) -> None:
    assert finding(f"{value}7" if "." in value else f"{value}1", by).startswith("value: ")


@pytest.mark.parametrize(
    ("value", "by", "told"),
    [
        ("1", "optimal_valu('Class')", 'did you mean "optimal_value"?'),
        ("1", "optimal_value('Clas')", 'did you mean "Class"?'),
        ("1", "optimal_q('Class', 'studdy')", 'did you mean "study"?'),
        ("1", "optimal_q('Pass', 'study')", "choose one of sleep"),
        ("1", "optimal_q('Class')", "optimal_q(state, action)"),
        ("1", "optimal_value('Class', gama=0.5)", 'did you mean "gamma"?'),
        ("1", "optimal_value('Class', gamma=2)", "[0, 1]"),
        ("1", "optimal_value(setup='evenings')", 'did you mean "evening"?'),
        ("1", "optimal_value(scenario='studnet')", "student"),
        ("1", "optimal_value(scenario=['student'])", "a name in quotes"),
        ("1", "optimal_value(algorithm=['sarsa'])", "algorithm is"),
        ("1", "run('gap', steps=1, state='Class', actions=['study'])", "a list of two actions"),
        ("1", "frist + 1", 'did you mean "first"?'),
        ("1", "flip(2)", "a whole number, 1 to 1"),
        ("1", "policy_value('Class', 'best')", "uniform, optimal, soft, first"),
        ("1", "run('q', steps=1)", "q needs state, action; add state"),
        ("1", "run('qq', steps=1)", "the name of a measure"),
        ("1", "run('reward')", "the length of the run"),
        ("1", "run('reward', steps=1, changes=['0:epsilon=7'])", "epsilon"),
        ("1", "run('regret', steps=1)", "not a bandit"),
        ("1", "mean('episodes', seeds=20, steps=9)", "50 to 10,000"),
        ("1", "share('episodes', steps=9)", "one of at_least"),
        ("1", "share('policy_in', steps=9, state='Class', at_least=1)", "cannot be compared with"),
        ("1", "mean('policy_in', steps=9, state='Class')", "a number under every seed"),
        ("1", "mean('first_reward_episode', steps=1)", "a number under every seed"),
        ("1", "ahead('steps', 1, {}, steps=9)", "a table of settings"),
        ("1", "run('steps', steps=9, changes=5)", "a list of changes"),
        ("1", f"mean('steps', steps={FIGURE_STEPS})", f"at most {FIGURE_STEPS:,} steps in a figure"),
        ("1", "attempt('doo', 'study', 'steps')", 'did you mean "do"?'),
        ("1", "attempt('do', 'studi', 'steps')", 'did you mean "study"?'),
        ("1", "sqrt(-1)", "sqrt(x)"),
        ("1", "log('a')", 'log of "a" is not possible'),
        ("1", "tried + 1", "tried → tried is a cycle"),
        ("1", "algorithm", '"q-learning"'),
        ("about one", "1", "a number, such as 1"),
        ("1 ± 0.1", "1", "not a mean over seeds"),
    ],
)
def test_what_is_told_of_a_figure(value: str, by: str, told: str) -> None:
    assert told in finding(value, by)


def test_figures_that_ask_for_each_other() -> None:
    lesson = with_figures(
        'here = { value = "1", by = "there" }', 'there = { value = "1", by = "over_there" }',
        'over-there = { value = "1", by = "here" }',
    )  # fmt: skip
    found = LessonFigures(lesson).finding("here")
    assert found is not None
    assert found.found == "here → there → over-there → here is a cycle; a figure must not depend on itself"


def test_figures_that_ask_for_very_many_others() -> None:
    chain = (f'f{n} = {{ value = "1", by = "f{n + 1} * 1" }}' for n in range(280))
    lesson = with_figures(*chain, 'f280 = { value = "1", by = "1" }')
    found = LessonFigures(lesson).finding("f0")
    assert found is None or "too deep" in found.found
    assert not LessonFigures(lesson).needs_seeds("f0")


def test_a_figure_may_not_be_mistaken_for_a_setting() -> None:
    lesson = with_figures(
        'epsilon = { value = "0.5", by = "alpha" }', 'gamma = { value = "0.9", by = "gamma" }'
    )
    assert LessonFigures(lesson).finding("epsilon") is not None
    assert LessonFigures(lesson).finding("gamma") is None


def test_a_mean_over_seeds_is_written_with_its_error() -> None:
    by = "mean('first_reward_episode', seeds=50, episodes=400, scenario='frozenlake')"
    figures = LessonFigures(with_figures(f'tried = {{ value = "1", by = "{by}" }}'))
    wanted = figures.value("tried")
    assert wanted == pytest.approx(71.7, abs=4 * wanted.error)
    assert finding(f"{wanted:.1f} ± {wanted.error:.1f}", by) == ""
    assert finding(f"{wanted:.1f}", by) == ""
    assert finding(f"{wanted:.1f} ± {wanted.error + 1:.1f}", by).startswith("value: ")
    assert finding(f"{wanted + 1:.1f} ± {wanted.error:.1f}", by).startswith("value: ")
    assert finding(f"{10 * wanted:.0f} ± {10 * wanted.error:.0f}", f"10 * {by}") == ""
    assert finding(f"−{wanted / 2:.1f} ± {wanted.error / 2:.1f}", f"-{by} / 2") == ""
    assert finding(f"{1 - wanted:.1f} ± {wanted.error:.1f}", f"1 - {by}") == ""
    assert finding(f"1 ± {wanted.error:.1f}", f"{by} / {by}").startswith("value: ")
    assert finding(f"{wanted.error:.2f}", by.replace("mean", "error_of_mean")) == ""


def test_runs_over_seeds_are_those_of_the_command() -> None:
    runs = document("train", "student", "--runs", "50", "--episodes", "20", "--alpha", "0.3", "--seed", "0")[
        "runs"
    ]
    returns = [row["return_mean"] for row in runs]
    over = "'return_mean', seeds=50, episodes=20, scenario='student', alpha=0.3"
    for name, exact in (("least", min(returns)), ("greatest", max(returns)), ("mean", sum(returns) / 50)):
        figures = LessonFigures(with_figures(f'tried = {{ value = "1", by = "{name}({over})" }}'))
        assert figures.value("tried") == pytest.approx(exact, rel=1e-12)
    share = sum(value >= 5 for value in returns) / 50
    assert finding(f"{share:.0%}", f"share({over}, at_least=5)") == ""
    by = "ahead('return_mean', {'alpha': 0.3}, {'alpha': 0.3}, seeds=50, episodes=20)"
    assert finding("0", by) == ""


def test_exact_figures_are_those_of_the_commands() -> None:
    solved = document("solve", "student", "--gamma", "0.5", "--flips")
    asked = LessonFigures(
        with_figures(
            *(
                f'{name} = {{ value = "1", by = "{by}" }}'
                for name, by in (
                    ("v", "optimal_value('Class', gamma=0.5)"),
                    ("q", "optimal_q('Class', 'study', gamma=0.5)"),
                    ("fixed", "flip(1)"),
                    ("value", "policy_value(policy='uniform', epsilon=0.2, scenario='cliff')"),
                    ("long", "policy_steps('uniform', 0.2, scenario='cliff')"),
                    ("wait", "mean_episodes(scenario='frozenlake', ties='first')"),
                )
            )
        )
    )
    place = solved["states"].index("Class")
    assert asked.value("v") == solved["v"][place]
    assert asked.value("q") == solved["q"][place][solved["actions"].index("study")]
    assert asked.value("fixed") == solved["flips"][0]["gamma"]
    evaluated = document("evaluate", "cliff", "--policy", "uniform", "--epsilon", "0.2")
    assert (asked.value("value"), asked.value("long")) == (evaluated["value_at_start"], evaluated["steps"])
    why = document("why", "frozenlake", "--ties", "first")
    assert asked.value("wait") == why["first_update"]["mean_episodes"]


def counted(by: str, budget: StepBudget) -> str:
    lesson = with_figures(f"tried = {{ value = '1', by = {json.dumps(by)} }}")
    try:
        LessonFigures(lesson, budget).value("tried")
    except FigureError as fault:
        return f"{fault.found}; {fault.expected}"
    return ""


@pytest.mark.parametrize(
    ("by", "steps"),
    [
        ("run('steps', steps=40)", 40),
        ("run('steps', steps=40) + run('episodes', steps=60)", 100),
        ("run('steps', steps=40) + run('episodes', steps=40)", 40),
        ("mean('steps', seeds=50, steps=3)", 150),
        ("mean('steps', steps=3) + share('episodes', steps=3, at_least=1)", 300),
        ("ahead('steps', {'epsilon': 0.1}, {'epsilon': 1}, steps=3)", 300),
        ("attempt('do', 'study', 'steps')", 1),
        ("run('steps', steps=4, algorithm='dyna-q', planning_steps=5)", 24),
        ("run('steps', steps=4, algorithm='dyna-q', planning_steps=2, changes=['1:planning_steps=5'])", 24),
        ("run('steps', steps=4, changes=['1:planning_steps=5', '2:algorithm=dyna-q'])", 44),
        ("run('steps', steps=4, planning_steps=5)", 4),
        ("run('steps', steps=4, scenario='cartpole')", 4 * STEPPED),
    ],
)
def test_steps_are_counted_one_by_one(by: str, steps: int) -> None:
    exactly = StepBudget(figure=steps)
    assert counted(by, exactly) == ""
    assert (exactly.taken, exactly.of_figures["tried"]) == (steps, steps)
    assert f"at most {steps - 1:,} steps in a figure" in counted(by, StepBudget(figure=steps - 1))


@pytest.mark.parametrize("by", ["run('steps', episodes=9)", "mean('steps', episodes=9)"])
def test_runs_of_any_length_are_counted_by_what_they_took(by: str) -> None:
    free = StepBudget()
    assert counted(by, free) == ""
    assert counted(by, StepBudget(figure=free.taken)) == ""
    little = StepBudget(figure=free.taken - 1)
    assert counted(by, little).startswith(f"more than {free.taken - 1:,} steps of figure tried; ")
    assert little.taken == free.taken - 1  # all of its budget, whatever its threads did


def test_a_run_that_breaks_down_counts_as_what_it_took() -> None:
    budget = StepBudget()
    assert counted("run('steps', episodes=9, scenario='maze', alpha=1, gamma=1, initial_q=1e308)", budget)
    assert 0 <= budget.taken < 10_000


def test_figures_of_a_file_share_its_budget() -> None:
    lesson = with_figures(
        """sixty = { value = "60", by = "run('steps', steps=60)" }""",
        """large = { value = "41", by = "run('steps', steps=41)" }""",
        """both = { value = "101", by = "sixty + large" }""",
        """small = { value = "40", by = "run('steps', steps=40)" }""",
    )
    figures = LessonFigures(lesson, StepBudget(figure=60, file=100))
    found = {name: figures.finding(name) for name in ("sixty", "large", "both", "small")}
    assert (found["sixty"], found["small"]) == (None, None)
    assert found["large"] is not None
    assert found["large"].found == "41 steps of figure large"
    assert found["large"].expected == "at most 100 steps in a file, of which 40 are left"
    assert found["both"] is not None
    assert found["both"].found == found["large"].found


def test_of_runs_over_seeds_only_measures_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    made, new_run = list[weakref.ref[Run]](), SeededRuns.new_run

    def watched(seeded: SeededRuns, seed: int, *on_episodes: OnEpisodes | None) -> Run:
        run = new_run(seeded, seed, *on_episodes)
        made.append(weakref.ref(run))
        return run

    monkeypatch.setattr(SeededRuns, "new_run", watched)
    figures = LessonFigures(with_figures("tried = { value = '1', by = \"mean('steps', steps=9)\" }"))
    assert figures.value("tried") == 9
    gc.collect()
    assert len(made) == 50
    assert not any(each() for each in made)


def test_every_function_has_its_line() -> None:
    for name, row in FUNCTIONS.items():
        assert name == row.name
        assert row.meaning[:1].isupper()
        assert row.meaning.endswith((".", "…"))


def document(*args: str) -> Any:
    result = CliRunner().invoke(program, [*args, "--json"])
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout)
