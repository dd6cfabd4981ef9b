"""``import rl_tui``."""

from __future__ import annotations

import doctest
import json
import re
import subprocess
import sys
import threading
import xml.etree.ElementTree as ElementTree
from contextlib import chdir
from dataclasses import replace
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest
from click.testing import CliRunner
from shipped import SHIPPED

import rl_tui
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.commands.main import program
from rl_tui.commands.python.answers import Settings
from rl_tui.commands.python.results import ScenarioInfo

TIMES = ("seconds", "steps_per_second")


def printed(*args: str) -> dict:
    done = CliRunner().invoke(program, [*args, "--json"], catch_exceptions=False)
    assert done.exit_code == 0
    return json.loads(done.stdout)


def without_times(document: dict) -> dict:
    return {name: value for name, value in document.items() if name not in TIMES}


def as_rows(array: np.ndarray, missing: float | None = None) -> list:
    absent = np.isnan(array) if missing is None else array == missing
    return [
        [None if gone else value for value, gone in zip(row, away, strict=True)]
        for row, away in zip(array.tolist(), absent, strict=True)
    ]


def loaded_by(code: str) -> set[str]:
    ending = "\nimport json, sys; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code + ending], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return set(json.loads(done.stdout))


def test_the_package_loads_nothing_before_it_is_needed() -> None:
    bare = loaded_by("pass")
    loaded = loaded_by("import rl_tui; dir(rl_tui)") - bare
    assert loaded - {"__future__"} == {"rl_tui", "rl_tui.common", "rl_tui.common.after_import"}


def test_scenarios_are_listed_without_a_compiler_or_a_screen() -> None:
    loaded = loaded_by("import rl_tui; assert rl_tui.scenarios()")
    assert not loaded & {"numba", "textual", "rich", "click"}


def test_a_short_training_needs_neither_a_screen_nor_a_compiler() -> None:
    loaded = loaded_by("import rl_tui; rl_tui.train('student', steps=10); rl_tui.solve('student')")
    assert not loaded & {"numba", "textual", "rich", "click", "gymnasium"}


@pytest.mark.parametrize("name", ["frozenlake-slippery", "student", "bandit"])
def test_one_training_is_the_one_of_the_command(name: str) -> None:
    run = rl_tui.train(name, algorithm="sarsa", alpha=0.2, episodes=60, seed=3)
    figures = printed("train", name, "--algorithm=sarsa", "--alpha=.2", "--episodes=60", "--seed=3")
    assert without_times(dict(run.figures)) == without_times(figures)
    assert as_rows(run.q) == figures["q"]
    assert as_rows(run.visits, -1) == figures["visits"]
    assert run.expected_return == figures["expected_return"]
    assert run.max_error == figures["max_error"]
    assert run.hyperparameters["alpha"] == 0.2
    assert len(run.returns) == len(run.lengths) == run.episodes == 60
    assert run.returns[-100:].mean() == pytest.approx(figures["return_last_100"])
    assert run.lengths.sum() <= run.steps
    chosen = [[run.actions[action] for action in np.flatnonzero(row)] for row in run.policy]
    assert chosen == figures["policy"]
    assert run.policy.sum(axis=1)[(run.visits >= 0).any(axis=1)] == pytest.approx(1.0)


def test_steps_end_a_training_too() -> None:
    assert rl_tui.train("cliff", steps=123).steps == 123


def test_many_runs_are_those_of_the_command() -> None:
    many = rl_tui.train("frozenlake-slippery", runs=4, episodes=40, seed=7)
    figures = printed("train", "frozenlake-slippery", "--runs=4", "--episodes=40", "--seed=7")
    assert without_times(dict(many.figures)) == without_times(figures)
    assert len(many) == 4
    assert many.seeds.tolist() == [7, 8, 9, 10]
    assert many.expected_return.tolist() == [row["expected_return"] for row in figures["runs"]]
    assert many.summary["expected_return"]["mean"] == pytest.approx(many.expected_return.mean())
    assert many.best_expected_return == rl_tui.solve("frozenlake-slippery").best_expected_return
    one = rl_tui.train("frozenlake-slippery", episodes=40, seed=9)
    assert one.expected_return == many.expected_return[2]
    assert [len(values) for values in many.curve.values()] == [40] * len(many.curve)


def test_where_each_seed_has_a_world_of_its_own_no_optimum_is_common() -> None:
    assert rl_tui.train("bandit", runs=2, episodes=20).best_expected_return is None


@pytest.mark.parametrize("name", ["cliff", "student", "frozenlake-slippery"])
def test_the_exact_answer_is_the_one_of_the_command(name: str) -> None:
    solution, figures = rl_tui.solve(name, gamma=0.9), printed("solve", name, "--gamma=.9")
    assert solution.figures == figures
    assert solution.v.tolist() == figures["v"]
    assert as_rows(solution.q) == figures["q"]
    assert solution.best_expected_return == figures["best_expected_return"]


def test_the_worth_of_a_policy_is_the_one_of_the_command() -> None:
    worth = rl_tui.evaluate("cliff", "optimal", epsilon=0.1)
    figures = printed("evaluate", "cliff", "--policy=optimal", "--epsilon=.1")
    assert worth.figures == figures
    assert worth.v.tolist() == list(figures["V"].values())
    learned = rl_tui.evaluate("student", "greedy", algorithm="sarsa", episodes=30, seed=2)
    assert learned.figures == printed(
        "evaluate", "student", "--policy=greedy", "--algorithm=sarsa", "--episodes=30", "--seed=2"
    )


def test_a_policy_may_be_an_array_or_what_was_trained() -> None:
    solution = rl_tui.solve("frozenlake-slippery")
    by_chances = rl_tui.evaluate("frozenlake-slippery", solution.policy)
    by_actions = rl_tui.evaluate("frozenlake-slippery", solution.policy.argmax(axis=1))
    assert by_chances.expected_return == pytest.approx(solution.expected_return)
    assert by_actions.value_at_start == pytest.approx(solution.value_at_start)
    run = rl_tui.train("student", episodes=50)
    worth = rl_tui.evaluate("student", run)
    assert worth.expected_return == pytest.approx(run.expected_return)
    assert np.nansum(worth.policy, axis=1).tolist() == run.policy.sum(axis=1).tolist()
    uniform = rl_tui.evaluate("student", rl_tui.evaluate("student", "uniform").policy)
    assert uniform.expected_return == rl_tui.evaluate("student", "uniform").expected_return


def test_every_scenario_is_listed() -> None:
    found = {each.id: each for each in rl_tui.scenarios()}
    assert set(SHIPPED) <= set(found)
    assert (found["cliff"].states, found["cliff"].actions, found["cliff"].kind) == (48, 4, "gymnasium")
    assert found["cliff"].defaults["algorithm"]
    listed = rl_tui.scenarios()
    lines = str(listed).splitlines()
    assert (repr(listed), len(lines)) == (str(listed), len(listed) + 2)
    assert [line.split()[0] for line in lines[2:]] == [each.id for each in listed]
    assert listed._repr_html_().count("<tr>") == len(listed) + 1


def test_every_hyper_parameter_can_be_given() -> None:
    assert {name.removesuffix("_") for name in get_type_hints(Settings)} == set(PARAMETERS)
    run = rl_tui.train("student", algorithm="sarsa-lambda", lambda_=0.5, n=np.int64(2), steps=np.int64(5))
    assert run.hyperparameters["lambda"] == 0.5
    assert run.without_effect == ("n",)
    assert "n" in str(run).splitlines()[-1]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rl_tui.train("clif"), "did you mean cliff"),
        (lambda: rl_tui.train("cliff", alpa=0.1), 'did you mean "alpha"'),
        (lambda: rl_tui.train("cliff", alpha=3), "alpha is 3; expected"),
        (lambda: rl_tui.train("cliff", algorithm="sarse"), 'did you mean "sarsa"'),
        (lambda: rl_tui.train("cliff", runs=0), "runs is 0; expected"),
        (lambda: rl_tui.train("cliff", runs=2.5), "runs is 2.5; expected"),
        (lambda: rl_tui.train("cliff", seed=-1), "seed is -1; expected"),
        (lambda: rl_tui.train("cliff", steps=1, episodes=1), "give episodes or steps, not both"),
        (lambda: rl_tui.solve("cartpole"), "no transition table"),
        (lambda: rl_tui.solve("cliff", gamma=2), "gamma is 2; expected"),
        (lambda: rl_tui.evaluate("cliff", "optimla"), 'did you mean "optimal"'),
        (lambda: rl_tui.evaluate("cliff", "optimal", alpha=0.1), 'alpha works only with the policy "greedy"'),
        (lambda: rl_tui.evaluate("cliff", "optimal", epsilon=2), "epsilon is 2; expected"),
        (lambda: rl_tui.evaluate("cliff", np.zeros(3)), "the policy is an array"),
        (lambda: rl_tui.evaluate("cliff", [[1], [1, 0]]), "the policy is not an array"),
        (lambda: rl_tui.evaluate("cliff", None), "the policy is an array"),
        (lambda: rl_tui.evaluate("student", [4, 0, 4, 0]), "the policy in state 0"),
        (lambda: rl_tui.evaluate("cliff", np.full((48, 4), 0.3)), "that sum to 1"),
        (lambda: rl_tui.evaluate("cliff", "missing.json"), "no such file"),
        (
            lambda: rl_tui.train("student", episodes=9).plot("length"),
            "measure is .length.; expected return_mean",
        ),
        (lambda: rl_tui.solve("student").plot().save("values.pdf"), "does not end in .svg or .png"),
    ],
)
def test_what_can_be_mended_is_one_error_in_one_line(call, message: str) -> None:
    with pytest.raises(rl_tui.Error, match=message) as raised:
        call()
    assert "\n" not in str(raised.value)


def test_a_result_prints_as_a_table_and_as_html() -> None:
    results = [
        rl_tui.train("student", episodes=20),
        rl_tui.train("student", episodes=20, runs=2),
        rl_tui.solve("student"),
        rl_tui.evaluate("student", "uniform"),
        rl_tui.scenarios()[0],
    ]
    for result in results:
        lines = str(result).splitlines()
        assert repr(result) == str(result)
        assert 4 <= len(lines) <= 15
        html = result._repr_html_()
        assert html.startswith("<table>")
        assert html.count("<tr>") == len(lines) - 1


def test_the_help_of_train_names_every_setting_and_its_example_runs(tmp_path: Path) -> None:
    text = rl_tui.train.__doc__
    assert text
    arguments = {name + "_" * (name == "lambda") for name in PARAMETERS}
    assert arguments <= set(re.findall(r"^        (\w+): ", text, re.MULTILINE))
    example = doctest.DocTestParser().get_doctest(text, {"rl_tui": rl_tui}, "train", None, 0)
    assert len(example.examples) == 4
    with chdir(tmp_path):
        assert doctest.DocTestRunner(verbose=False).run(example).failed == 0
    assert ElementTree.parse(tmp_path / "frozenlake.svg").getroot().tag.endswith("svg")


def test_a_result_has_a_picture_of_the_same_curve_as_the_plot_command(tmp_path: Path) -> None:
    many = rl_tui.train("student", runs=3, episodes=40)
    named = replace(many, figures={}, seconds=0.0)
    assert (
        many._repr_svg_() == many.plot().svg == named.plot("return_mean").svg != many.plot("length_mean").svg
    )
    results, drawn = tmp_path / "results.json", tmp_path / "drawn.svg"
    results.write_text(json.dumps(dict(many.figures)), encoding="utf-8")
    CliRunner().invoke(program, ["plot", str(results), "--out", str(drawn)], catch_exceptions=False)
    lines = [re.findall("<polyline.*", text) for text in (drawn.read_text(encoding="utf-8"), many.plot().svg)]
    assert lines[0] == lines[1] != []
    many.plot().save(tmp_path / "saved.svg")
    assert (tmp_path / "saved.svg").read_text(encoding="utf-8") == many.plot().svg


@pytest.mark.parametrize(
    "call",
    [
        lambda: rl_tui.train("bandit", episodes=30),
        lambda: rl_tui.solve("student"),
        lambda: rl_tui.evaluate("cliff", "uniform"),
    ],
)
def test_every_result_has_a_picture(call) -> None:
    result = call()
    text = result._repr_svg_()
    assert text == result.plot()._repr_svg_()
    caption = str(result).splitlines()[0]
    assert caption in {each.text for each in ElementTree.fromstring(text).iter()}
    assert caption in repr(result.plot())


def test_without_an_episode_there_is_no_picture() -> None:
    planned = rl_tui.train("student", algorithm="value-iteration", steps=3)
    assert planned._repr_svg_() is None
    with pytest.raises(rl_tui.Error, match="no episode was finished"):
        planned.plot()


def test_every_result_is_a_table_of_pandas() -> None:
    pytest.importorskip("pandas")
    run, many = rl_tui.train("student", episodes=20), rl_tui.train("student", episodes=20, runs=3)
    assert run.to_pandas()["return"].tolist() == run.returns.tolist()
    assert run.to_pandas().index.tolist() == list(range(1, 21))
    assert many.to_pandas()["expected_return"].tolist() == many.expected_return.tolist()
    assert many.to_pandas().index.tolist() == many.seeds.tolist()
    solution, worth = rl_tui.solve("student"), rl_tui.evaluate("student", "uniform")
    for result, of_actions in ((solution, solution.q), (worth, worth.policy)):
        frame = result.to_pandas()
        assert frame["value"].tolist() == result.v.tolist()
        assert np.array_equal(frame[list(result.actions)].to_numpy(), of_actions, equal_nan=True)
        assert frame.index.tolist() == list(result.states)
    assert rl_tui.scenarios().to_pandas().loc["cliff", "states"] == 48


def test_without_pandas_there_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(rl_tui.Error, match="pip install pandas"):
        rl_tui.solve("student").to_pandas()


def test_an_error_in_a_notebook_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    interactive = pytest.importorskip("IPython.core.interactiveshell", exc_type=ImportError)
    shell = interactive.InteractiveShell()
    shell.run_cell("import rl_tui; rl_tui.train('cliff', alpha=3)")
    shown = capsys.readouterr().out
    assert shown == "rl_tui.Error: alpha is 3; expected a number in (0, 1] or sample-average\n"


def test_what_stands_in_html_is_text() -> None:
    defaults = {"algorithm": "<i>", "episodes": 1}
    info = ScenarioInfo("x", "<script>", "grid", 1, 1, 1, 0, defaults)
    assert "&lt;script&gt;" in info._repr_html_()
    assert "<script>" not in info._repr_html_()
    assert "&lt;i&gt;" in info._repr_html_()


def test_it_is_quiet_works_from_a_thread_and_a_second_time(capfd) -> None:
    found = []

    def work() -> None:
        found.append(rl_tui.train("cliff", episodes=20).q)
        found.append(rl_tui.train("cliff", runs=3, episodes=20).expected_return)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    work()
    assert np.array_equal(found[0], found[2], equal_nan=True)
    assert np.array_equal(found[1], found[3], equal_nan=True)
    assert capfd.readouterr() == ("", "")


def test_a_scenario_may_be_a_file(tmp_path) -> None:
    path = tmp_path / "line.toml"
    path.write_text('title = "Line"\n[grid]\nmap = """\nS.G\n"""\n', encoding="utf-8")
    assert rl_tui.solve(path, gamma=0.5).v.tolist() == [0.5, 1.0, 0.0]
    assert rl_tui.train(path, episodes=30).expected_return == 1.0


def test_a_name_that_is_not_offered_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'trian'"):
        rl_tui.trian  # noqa: B018
