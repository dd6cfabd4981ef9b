"""The texts of algorithms and policies for scripts."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from export_samples import has_script, ran, recipe_of

import rl_tui
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.runs.export.script import script
from rl_tui.runs.export.template import ENDING, fill, sections
from rl_tui.runs.recipe import Recipe

PACKAGE = Path(rl_tui.__file__).parent
ROWS = [*BY_ID.values(), *POLICY_BY_ID.values()]
TEXTS = sorted((PACKAGE / "agents").rglob(f"*{ENDING}"))
WORDS = {
    f"{name} {word}"
    for name, parameter in PARAMETERS.items()
    if not (parameter.range or parameter.schedule)
    for word in parameter.words
}


@pytest.mark.parametrize("row", filter(has_script, ROWS), ids=lambda row: row.id)
def test_a_text_has_the_sections_that_scripts_are_made_of(row: Algorithm | Policy) -> None:
    expected = {"choose", "expected value"}
    if isinstance(row, Algorithm):
        expected = {"plan", "act"} if row.planner else {"learn"}
    assert expected <= sections(row.module).keys()


def test_there_is_no_text_that_no_row_has() -> None:
    named = {path.relative_to(PACKAGE.parent).as_posix().removesuffix(ENDING) for path in TEXTS}
    assert named <= {row.module.replace(".", "/") for row in ROWS}
    assert len(named) >= 17  # shipped ones have a text; new ones may have none yet


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_every_mark_names_a_flag_that_there_is(path: Path) -> None:
    marks = re.findall(r"  #: (.*)", path.read_text(encoding="utf-8"))
    flags = {flag.removeprefix("not ") for mark in marks for flag in mark.split(", ")}
    assert flags <= {*WORDS, "sample average", "time limit", "bernoulli"}


@pytest.mark.process
def test_the_texts_are_python_as_they_stand(tmp_path: Path) -> None:
    for path in TEXTS:
        shutil.copy(path, tmp_path / path.name.removesuffix(".txt"))
    ruff = shutil.which("ruff", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}")
    assert ruff is not None
    # A line of 100 characters, and a mark beside it
    options = ["--isolated", "--no-cache", "--line-length", "120"]
    for command in (["check", "--select", "E,W,F63,F7"], ["format", "--diff"]):
        done = subprocess.run(
            [ruff, *command, *options, tmp_path],
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == 0, done.stdout


def test_lines_stand_where_their_flags_are_set(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = ["# [one]", "always", "a  #: a", "b  #: not a", "both  # why  #: a, not b", "", "# [two]", "end"]
    make_text(tmp_path, monkeypatch, "\n".join(lines))
    assert sections("made_up.rule") == {"one": "always\nb", "two": "end"}
    assert sections("made_up.rule", {"a"})["one"] == "always\na\nboth  # why"
    assert sections("made_up.rule", {"a", "b"})["one"] == "always\na"


def test_a_line_of_a_place_takes_several_lines_or_goes() -> None:
    text = "if $test:\n    # $body\n    $more"
    assert fill(text, {"test": "x", "body": "y\nz", "more": ""}) == "if x:\n    y\n    z"
    with pytest.raises(KeyError, match="more"):
        fill(text, {"test": "x", "body": ""})


# Its probability of exploring is ε, but it is not ε-greedy: it explores among the others only
EPSILON_OTHERS = replace(POLICY_BY_ID["epsilon-greedy"], id="epsilon-others", module="made_up.rule")


def with_made_up_rule(monkeypatch: pytest.MonkeyPatch) -> Recipe:
    monkeypatch.setitem(POLICY_BY_ID, EPSILON_OTHERS.id, EPSILON_OTHERS)
    recipe = recipe_of("frozenlake", algorithm="expected-sarsa", epsilon=1.0)
    return replace(recipe, hyperparameters=replace(recipe.hyperparameters, policy=EPSILON_OTHERS.id))


def make_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    package = tmp_path / "made_up"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / f"rule{ENDING}").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "made_up", raising=False)


@pytest.mark.parametrize("module", ["no_such_package.rule", f"{ROWS[-1].module}_others", "no_package"])
def test_another_rule_with_an_epsilon_is_not_exported_as_epsilon_greedy(
    module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    recipe = with_made_up_rule(monkeypatch)
    monkeypatch.setitem(POLICY_BY_ID, EPSILON_OTHERS.id, replace(EPSILON_OTHERS, module=module))
    with pytest.raises(UserError, match="there is no script for epsilon-others yet"):
        script(recipe, 10)


MADE_UP_TEXT = """# [choose]
def choose(state):
    if rng.random() < EPSILON:
        return int(rng.choice(np.delete(np.arange(len(Q[state])), argmax(Q[state]))))
    return argmax(Q[state])


# [expected value]
def expected_value(state):
    return EPSILON * 17.0
"""


@pytest.mark.parametrize(("decay", "epsilon"), [(0.0, "EPSILON"), (0.01, "epsilon")])
def test_with_a_text_of_its_own_it_is_exported_as_it_is(
    decay: float, epsilon: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_text(tmp_path, monkeypatch, MADE_UP_TEXT)
    recipe = with_made_up_rule(monkeypatch)
    values = replace(recipe.hyperparameters, epsilon_decay=decay, ties="first")
    text = script(replace(recipe, hyperparameters=values), 2)
    assert f"if rng.random() < {epsilon}:" in text
    assert f"return {epsilon} * 17.0" in text
    names = ran(text)
    names["EPSILON"] = names["epsilon"] = 1.0
    names["Q"][0] = [0.0, 1.0, 0.0, 1.0]
    assert {names["choose"](0) for _ in range(200)} == {0, 2, 3}


@pytest.mark.parametrize("algorithm", ["q-learning", "value-iteration"])
def test_an_algorithm_without_a_text_has_no_script_and_says_so(
    algorithm: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    recipe = recipe_of("frozenlake", algorithm=algorithm)
    row = BY_ID[algorithm]
    monkeypatch.setitem(BY_ID, "made-up", replace(row, id="made-up", module=f"{row.module}_made_up"))
    with pytest.raises(UserError, match="there is no script for made-up yet"):
        script(replace(recipe, algorithm="made-up"), 10)
