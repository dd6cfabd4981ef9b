"""The command line of a run."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner
from export_samples import recipe_of

from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.runs.changes import journal_of, read_change, written_change
from rl_tui.runs.export.recipe_line import recipe_line
from rl_tui.runs.figures import training_figures
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import JournalEntry, Recipe, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.run import Run
from rl_tui.worlds.files.scenario import read_scenario, scenario_of

ACTIONS = ("left", "down", "right", "up")
JOURNAL = (
    JournalEntry(0, SetParameter("gamma", 0.9)),
    JournalEntry(50, TakeAction(2)),
    JournalEntry(300, SetParameter("alpha", "sample-average")),
    JournalEntry(300, SetParameter("epsilon", 1e-07)),
    JournalEntry(400, TakeAction(0)),
    JournalEntry(401, SetParameter("gamma", 0.5)),
)


def done_again(line: str) -> dict[str, object]:
    name, *words = shlex.split(line)
    assert name == "rl-tui"
    result = CliRunner().invoke(program, [*words, "--json"])
    assert (result.exit_code, result.stderr) == (0, "")
    document: dict[str, object] = json.loads(result.stdout)
    return document


def test_the_line_of_a_run_does_it_again() -> None:
    recipe = recipe_of("frozenlake", alpha=0.25, epsilon_decay=0.001, ties="first", epsilon=0.4)
    recipe = Recipe(recipe.scenario, recipe.algorithm, recipe.hyperparameters, 7)
    run = Run(recipe, evaluate=False)
    run.follow(JOURNAL, 400)
    line = recipe_line(recipe, JOURNAL, 400, ACTIONS)
    assert line == (
        "rl-tui train frozenlake --alpha 0.25 --epsilon 0.4 --epsilon-decay 0.001 --ties first --seed 7 "
        "--steps 400 --change 0:gamma=0.9 --change 50:take=right --change 300:alpha=sample-average "
        "--change 300:epsilon=1e-07"
    )
    document, figures = done_again(line), training_figures(run, 1.0)
    for name in ("q", "visits", "steps", "episodes", "return_last_100", "seed", "hyperparameters"):
        assert document[name] == figures[name]
    assert document["journal"] == [
        {"step": 0, "name": "gamma", "value": 0.9},
        {"step": 50, "name": "take", "value": "right"},
        {"step": 300, "name": "alpha", "value": "sample-average"},
        {"step": 300, "name": "epsilon", "value": 1e-07},
    ]


def test_a_switch_of_the_algorithm_is_in_the_line() -> None:
    recipe = recipe_of("student")
    journal = (JournalEntry(20, SwitchAlgorithm("sarsa")), JournalEntry(90, SwitchAlgorithm("q-learning")))
    run = Run(recipe, evaluate=False)
    run.follow(journal, 200)
    document = done_again(recipe_line(recipe, journal, 200, ("study",)))
    assert document["q"] == training_figures(run, 1.0)["q"]


def test_at_the_start_it_trains_as_long_as_the_scenario_says() -> None:
    assert recipe_line(recipe_of("student"), JOURNAL[:1], 0, ACTIONS) == (
        "rl-tui train student --seed 0 --change 0:gamma=0.9"
    )


def test_a_file_is_named_by_its_path_and_quoted(tmp_path: Path) -> None:
    path = tmp_path / "my student.toml"
    scenario = recipe_of("student").scenario
    path.write_text(scenario.source.read_text(encoding="utf-8"), encoding="utf-8")
    line = recipe_line(recipe_for(read_scenario(path)), (), 10, ACTIONS)
    assert shlex.split(line) == ["rl-tui", "train", str(path), "--seed", "0", "--steps", "10"]


def test_a_session_that_was_gone_on_with_names_its_scenario_where_it_is_now(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = recipe_of("student").scenario.source.read_text(encoding="utf-8")
    shipped = scenario_of(text, Path("student.toml"))  # the file at its saved place is another one
    assert recipe_line(recipe_for(shipped), (), 5, ACTIONS) == "rl-tui train student --seed 0 --steps 5"
    path.write_text(text, encoding="utf-8")
    mine = recipe_for(read_scenario(path))
    path.write_text(text + "# changed", encoding="utf-8")
    for gone in (mine, recipe_for(scenario_of(text + "\n", Path("student.toml")))):
        with pytest.raises(UserError, match=r".* no longer contains this scenario: save the session"):
            recipe_line(gone, (), 5, ACTIONS)


def test_a_setting_without_effect_is_left_out_unless_it_may_have_one_later() -> None:
    recipe = recipe_of("student", planning_steps=3, temperature=0.5)
    assert recipe_line(recipe, (), 5, ACTIONS) == "rl-tui train student --seed 0 --steps 5"
    for change in (SwitchAlgorithm("dyna-q"), SetParameter("policy", "softmax")):
        line = recipe_line(recipe, [JournalEntry(2, change)], 5, ACTIONS)
        assert " --temperature 0.5 --planning-steps 3 " in line


def test_a_negative_value_and_a_gradient_bandit_come_back_as_they_were() -> None:
    recipe = recipe_of("bandit", policy="gradient", initial_q=-2.5)
    document = done_again(recipe_line(recipe, (), 30, ("0",)))
    assert document["hyperparameters"] == recipe.hyperparameters.as_dict()


def test_values_that_a_slider_only_passes_are_left_out() -> None:
    passing = [JournalEntry(5, SetParameter("alpha", tenth / 10)) for tenth in range(1, 8)]
    policies = [JournalEntry(5, SetParameter("policy", name)) for name in ("softmax", "ucb")]
    line = recipe_line(
        recipe_of("frozenlake"), [*passing, *policies, JournalEntry(6, passing[0].change)], 9, ACTIONS
    )
    assert line.split(" --change ")[1:] == ["5:alpha=0.7", "5:policy=softmax", "5:policy=ucb", "6:alpha=0.1"]


def test_too_many_changes_ask_for_a_session() -> None:
    journal = [JournalEntry(step, TakeAction(0)) for step in range(201)]
    assert recipe_line(recipe_of("frozenlake"), journal, 200, ACTIONS).count("--change") == 200
    with pytest.raises(UserError, match=r"201 changes .* rl-tui replay SESSION.json"):
        recipe_line(recipe_of("frozenlake"), journal, 201, ACTIONS)


@pytest.mark.parametrize("entry", JOURNAL)
def test_a_change_is_read_as_it_is_written(entry: JournalEntry) -> None:
    assert journal_of([read_change(written_change(entry, ACTIONS))], ACTIONS) == (entry,)


def test_names_of_actions_may_have_any_characters() -> None:
    entry = JournalEntry(3, TakeAction(1))
    for names in (("check phone", "a=b: c"), ("left", " left ")):
        assert journal_of([read_change(written_change(entry, names))], names) == (entry,)


def test_changes_are_put_in_the_order_of_their_steps() -> None:
    journal = journal_of(map(read_change, ("9:gamma=0.5", "2:alpha=0.5", "9:epsilon=0")), ACTIONS)
    assert [
        (entry.step, entry.change.name) for entry in journal if isinstance(entry.change, SetParameter)
    ] == [(2, "alpha"), (9, "gamma"), (9, "epsilon")]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("epsilon=0.1", "is not STEP:NAME=VALUE"),
        ("5:epsilon", "is not STEP:NAME=VALUE"),
        ("-5:epsilon=0.1", "not a whole number of steps"),
        ("5:epsilon=1.5", r"expected a number in \[0, 1\]"),
        ("5:epsilon=nan", r"expected a number in \[0, 1\]"),
        ("5:epsilom=1", r'did you mean "epsilon"\?'),
        ("5:algorithm=sarsaa", r'did you mean "sarsa"\?'),
        ("5:initial-q=1", "cannot change during the run"),
        ("5:ties=both", "expected random or first"),
    ],
)
def test_faults_are_one_line_with_what_was_expected(text: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault) as refused:
        read_change(text)
    assert "\n" not in str(refused.value)
