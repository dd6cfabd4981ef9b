"""Exported scripts compute what the program computes."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from export_samples import ALLOWED, has_script, imported, q_of, ran, recipe_of, script_of, table_of
from shipped import SHIPPED

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.exact.policy_figures import figures, greedy_policy
from rl_tui.agents.exact.solve import solve
from rl_tui.common.errors import UserError
from rl_tui.runs.export.script import script
from rl_tui.runs.library import episodes_of, recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import read_scenario

ALIKE = "egg"  # its states look equal, which scripts cannot express
WITH_MODEL = [
    name
    for name in SHIPPED
    if name not in ("blackjack", "blackjack-table", "cartpole", "mountain-car", ALIKE)
]
LEARNERS = [each.id for each in BY_ID.values() if not each.planner and has_script(each)]
# These draw only for actions
WITHOUT_DICE = [name for name in LEARNERS if name not in ("double-q-learning", "dyna-q")]
VARIANTS: list[dict[str, object]] = [
    {},
    {"alpha": "sample-average", "ties": "first", "traces": "accumulating", "baseline": "none"},
    {"alpha": 0.1, "alpha_decay": 0.01, "epsilon_decay": 0.01, "epsilon_schedule": "linear"},
]


def all_scripts() -> Iterator[tuple[str, str]]:
    for name in SHIPPED:
        if name == ALIKE:
            continue
        scenario = find(name)
        yield name, script(recipe_for(scenario), episodes_of(scenario))
    algorithms, rules = (filter(has_script, rows.values()) for rows in (BY_ID, POLICY_BY_ID))
    for (i, name), (j, algorithm), (k, rule) in product(
        *map(enumerate, (("frozenlake", "student", "bandit"), algorithms, rules))
    ):
        variant = VARIANTS[(i + j + k) % len(VARIANTS)]  # each with each in the end
        if rule.bandits_only and name != "bandit":
            continue
        if rule.id == "gradient" and variant.get("alpha") == "sample-average":
            continue
        changes = {"algorithm": algorithm.id, "policy": rule.id, **variant}
        yield f"{name}-{algorithm.id}-{rule.id}", script_of(name, **changes)


@pytest.mark.process
def test_every_script_is_python_that_imports_no_more_than_it_says(tmp_path: Path) -> None:
    for name, text in all_scripts():
        compile(text, name, "exec")
        assert imported(text) <= ALLOWED, name
        assert text.startswith('"""')
        assert 55 <= text.count("\n") <= 170, name
        assert "$" not in text, name
        for constant in re.findall(r"^([A-Z]\w*) = ", text, re.MULTILINE):
            assert len(re.findall(rf"\b{constant}\b", text)) > 1, (name, constant)
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    ruff = shutil.which("ruff", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}")
    assert ruff is not None
    checked = subprocess.run(
        [ruff, "check", "--isolated", "--no-cache", "--select", "E,F", "--line-length", "100", tmp_path],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout


@pytest.mark.parametrize("scenario", WITH_MODEL)
def test_the_world_of_a_script_has_the_same_states_outcomes_and_answer(scenario: str) -> None:
    recipe = recipe_of(scenario, algorithm="value-iteration")
    mdp, names = table_of(recipe), ran(script(recipe, 1), "# How good is it?")
    live = [state for state in range(mdp.states) if mdp.pairs_of(state)]
    assert len(names["states"]) == len(live)
    # A sweep that moves no value by more than 1e-9 leaves at most γ / (1 − γ) times that error; at γ = 1 more
    assert np.abs(q_of(names, mdp) - solve(mdp, recipe.hyperparameters.gamma).q).max() < 1e-6


RULES = """
[grid]
map = '''
S.<.J#
.v..+.
^.-#.B
{corner}...>K
'''
rewards = "{rewards}"
moves = "{moves}"
step_reward = -0.1
bump_reward = -0.5
{more}
time_limit = 30
[grid.legend]
J = {{ kind = "floor", reward = 0.3, jump = "K" }}
K = {{ kind = "floor" }}
"+" = {{ kind = "goal", reward = 1.5, exit = true }}
{legend}
"""
# With rewards on leaving, a cell that is never left pays nothing. With a way back only one start is allowed
LEGENDS = {
    "entering": """B = { kind = "cliff", reward = -2.0, back = true }
"-" = { kind = "hole", reward = -1.0 }""",
    "leaving": """B = { kind = "floor", reward = -2.0 }
"-" = { kind = "hole", reward = -1.0, exit = true }""",
}
MORE = {
    "slippery": ("entering", "four", "slippery = true"),
    "noise": ("leaving", "four", "noise = 0.25"),
    "wind": ("entering", "king+stay", "wind = [0, 1, 0, 2, 1, 0]\nwind_rows = [0, 1, -1, 0]"),
    "gusts": (
        "leaving",
        "four",
        "noise = 0.1\nwind = [0, 1, 0, 2, 1, 0]\nwind_rows = [0, 1, 0, 0]\ngusts = true",
    ),
    "gusts-in-columns": ("entering", "king", "wind = [0, 1, 0, -2, 1, 0]\ngusts = true"),
}


@pytest.mark.parametrize("rule", MORE)
def test_every_rule_of_a_grid_is_in_its_script(rule: str, tmp_path: Path) -> None:
    rewards, moves, more = MORE[rule]
    path = tmp_path / "rules.toml"
    corner = "S" if rewards == "leaving" else "."
    text = RULES.format(rewards=rewards, moves=moves, more=more, legend=LEGENDS[rewards], corner=corner)
    path.write_text(text, encoding="utf-8")
    recipe = recipe_for(read_scenario(path), {"algorithm": "value-iteration", "gamma": 0.9})
    mdp, names = table_of(recipe), ran(script(recipe, 1), "# How good is it?")
    assert np.abs(q_of(names, mdp) - solve(mdp, 0.9).q).max() < 1e-6


ODD = r"""
[grid]
map = '''
S.$G
.."\
..é.
'''
[grid.legend]
'$' = { kind = 'wall' }
'"' = { kind = 'hole' }
'\' = { kind = 'wall' }
'é' = { kind = 'hole', reward = -1.0 }
"""


def test_a_map_may_be_drawn_with_any_characters(tmp_path: Path) -> None:
    path = tmp_path / "odd.toml"
    path.write_text(ODD, encoding="utf-8")
    recipe = recipe_for(read_scenario(path), {"algorithm": "value-iteration", "gamma": 0.9})
    text = script(recipe, 1)
    compile(text, "odd", "exec")
    mdp, names = table_of(recipe), ran(text, "# How good is it?")
    assert np.abs(q_of(names, mdp) - solve(mdp, 0.9).q).max() < 1e-6


TABLE = """
[mdp]
start = { "one \\"of\\" us" = 0.25, b = 0.75 }
[[mdp.transition]]
state = 'one "of" us'
action = "go"
reward = 1.0
to = { b = 0.5, end = { p = 0.5, reward = 3.0, std = 0.5 } }
[[mdp.transition]]
state = "b"
action = "back"
reward = 0.0
to = 'one "of" us'
"""


def test_a_table_with_quoted_names_noise_and_several_starts(tmp_path: Path) -> None:
    path = tmp_path / "table.toml"
    path.write_text(TABLE, encoding="utf-8")
    scenario = read_scenario(path)
    recipe = recipe_for(scenario, {"algorithm": "policy-iteration", "gamma": 0.5})
    mdp = table_of(recipe)
    names = ran(script(recipe, 1), "# How good is it?")
    assert np.abs(q_of(names, mdp) - solve(mdp, 0.5).q).max() < 1e-6
    learned = ran(script(recipe_for(scenario, {"gamma": 0.5, "alpha": "sample-average"}), 4000))
    # The mean of about 4,000 targets, with the reward's noise below 2
    assert np.abs(q_of(learned, mdp) - solve(mdp, 0.5).q).max() < 0.2


@pytest.mark.exhaustive(
    "long episodes", but=[*(f"frozenlake-{algorithm}" for algorithm in WITHOUT_DICE), "karpathy-q-learning"]
)
@pytest.mark.parametrize("algorithm", WITHOUT_DICE)
@pytest.mark.parametrize("scenario", ["frozenlake", "karpathy"])
def test_without_chance_a_script_learns_bit_for_bit_the_same_up_to_rounding(
    algorithm: str, scenario: str
) -> None:
    # Optimism explores in place of ε. Both worlds are deterministic, and karpathy truncates its episodes
    changes = {
        "algorithm": algorithm,
        "epsilon": 0.0,
        "ties": "first",
        "initial_q": 1.0,
        "alpha": 0.3,
        "alpha_min": 0.1,
        "alpha_decay": 0.02,
        "traces": "accumulating",
    }
    check_same(scenario, changes, episodes=30 if scenario == "frozenlake" else 8)


@pytest.mark.parametrize("algorithm", WITHOUT_DICE)
def test_so_do_sample_averages_and_linear_schedules(algorithm: str) -> None:
    changes = {"algorithm": algorithm, "epsilon": 0.0, "ties": "first", "initial_q": 1.0}
    check_same("frozenlake", {**changes, "alpha": "sample-average", "lambda": 0.5}, episodes=20)
    linear = {"alpha": 0.5, "alpha_decay": 0.05, "alpha_min": 0.1, "step_size_schedule": "linear"}
    check_same("frozenlake", {**changes, **linear}, episodes=20)


def check_same(scenario: str, changes: dict[str, object], episodes: int) -> None:
    recipe = recipe_for(find(scenario), changes)
    run = Run(recipe, evaluate=False)
    run.advance(episodes=episodes)
    names = ran(script(recipe, episodes))
    assert len(names["returns"]) == episodes
    assert np.mean(names["returns"][-100:]) == pytest.approx(run.history.last_100[0], abs=1e-9)
    np.testing.assert_allclose(q_of(names, table_of(recipe)), run.learner.q, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"policy": "epsilon-greedy", "epsilon": 0.2}, [0.05, 0.45, 0.05, 0.45]),
        ({"policy": "epsilon-greedy", "epsilon": 0.2, "ties": "first"}, [0.05, 0.85, 0.05, 0.05]),
        ({"policy": "softmax", "temperature": 0.5}, [0.0593, 0.4383, 0.0642, 0.4383]),
        ({"policy": "ucb", "confidence": 0.1}, [0.0, 0.5, 0.0, 0.5]),
        ({"policy": "ucb", "confidence": 0.1, "ties": "first"}, [0.0, 1.0, 0.0, 0.0]),
    ],
)
def test_policies_choose_as_often_as_they_should(changes: dict[str, object], expected: list[float]) -> None:
    names = ran(script_of("frozenlake", algorithm="expected-sarsa", **changes), "\nreturns = []")
    values = np.array([0.0, 1.0, 0.04, 1.0])
    names["Q"][0] = values
    if "N" in names:
        names["N"][0] = 5
    draws = 2000
    chosen = np.bincount([names["choose"](0) for _ in range(draws)], minlength=4) / draws
    # Four standard deviations of a share of 2,000 draws
    assert np.abs(chosen - expected).max() < 4 * 0.5 / np.sqrt(draws)
    assert names["expected_value"](0) == pytest.approx(float(values @ expected), abs=2e-4)


@pytest.mark.parametrize("policy", [each.id for each in POLICY_BY_ID.values() if has_script(each)])
@pytest.mark.parametrize("scenario", ["bandit", "bandit-bernoulli"])
def test_a_bandit_finds_an_arm_that_pays(scenario: str, policy: str) -> None:
    recipe = recipe_of(scenario, policy=policy)
    names = ran(script(recipe, 2000))
    means = np.array(names["MEANS"])
    np.testing.assert_allclose(means, solve(table_of(recipe), 0.0).q, atol=1e-12)
    # Far above the mean of all arms, the result of chance
    assert np.mean(names["returns"][-500:]) > (means.mean() + means.max()) / 2


DIES_IF_IT_MEETS_US = "\nimport sys\nassert not any(name.startswith('rl_tui') for name in sys.modules)\n"
TELLS_Q = "\nimport json\nprint(json.dumps([list(map(float, row)) for row in Q]))\n"


@pytest.mark.process
@pytest.mark.exhaustive("learns in other worlds", but=["student-changes1-1500-1.0"])
@pytest.mark.parametrize(
    ("scenario", "changes", "episodes", "share"),
    [
        ("frozenlake", {}, 2000, 1.0),
        ("student", {"algorithm": "double-q-learning"}, 1500, 1.0),
        ("maze", {"algorithm": "dyna-q"}, 50, 0.95**2),  # a path with two extra steps counts too
    ],
)
def test_it_runs_by_itself_and_learns_the_best_policy(
    scenario: str, changes: dict[str, object], episodes: int, share: float, tmp_path: Path
) -> None:
    recipe = recipe_of(scenario, **changes)
    (tmp_path / "script.py").write_text(
        script(recipe, episodes) + DIES_IF_IT_MEETS_US + TELLS_Q, encoding="utf-8"
    )
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    done = subprocess.run(
        [sys.executable, "-I", "-W", "error::SyntaxWarning", "script.py"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=True,
    )
    assert "mean return of the last" in done.stdout
    *_, last = done.stdout.splitlines()
    mdp, gamma = table_of(recipe), recipe.hyperparameters.gamma
    q = q_of({"Q": json.loads(last), "STATES": list(mdp.state_names)}, mdp)
    learned = figures(mdp, greedy_policy(mdp, q, "random"), gamma)
    optimum = solve(mdp, gamma).value_at_start
    assert share * optimum - 1e-9 <= learned.value_at_start <= optimum + 1e-9


def test_bins_are_those_of_the_scenario() -> None:
    for scenario in ("mountain-car", "cartpole"):
        recipe = recipe_of(scenario)
        world = begin(recipe).world
        names = ran(script(recipe, 1), "\nenv.reset(seed=SEED)")
        counts = [len(edges) + 1 for edges in names["EDGES"]]
        assert int(np.prod(counts)) == world.space.states
        state, _ = names["env"].reset(seed=7)
        assert world.new_environment is not None
        number = 0
        for place, count in zip(state, counts, strict=True):
            number = number * count + place
        assert world.new_environment().reset(seed=7) == number


def test_what_is_too_large_to_read_is_refused_in_a_line(tmp_path: Path) -> None:
    path = tmp_path / "large.toml"
    path.write_text("[grid]\nrandom = { rows = 61, columns = 10 }\n", encoding="utf-8")
    with pytest.raises(UserError, match=r"61 × 10 cells, too many for a readable script"):
        script(recipe_for(read_scenario(path)), 1)
    rows = "\n".join(
        f'[[mdp.transition]]\nstate = "{state}"\naction = "go"\nreward = 0.0\nto = "{state + 1}"'
        for state in range(2001)
    )
    path.write_text(f'[mdp]\nstart = "0"\n{rows}\n', encoding="utf-8")
    with pytest.raises(UserError, match=r"2,001 outcomes, too many for a readable script"):
        script(recipe_for(read_scenario(path)), 1)


def test_states_that_look_alike_have_no_script() -> None:
    with pytest.raises(UserError, match="cannot tell some of its states apart"):
        script_of(ALIKE)


def test_a_planner_without_a_table_of_the_environment_is_refused() -> None:
    with pytest.raises(UserError, match="a planner needs a transition table"):
        script_of("blackjack-table", algorithm="value-iteration")


def test_a_script_says_that_its_run_had_other_settings_at_first() -> None:
    text = script(recipe_of("frozenlake"), 10, changed=True)
    assert "had other settings or another world at first" in text
    assert "other settings" not in script_of("frozenlake")


def test_a_script_says_how_many_episodes_its_run_had() -> None:
    (line,) = (
        each
        for each in script(recipe_of("frozenlake"), 500, episodes_of_run=3481).splitlines()
        if each.startswith("EPISODES")
    )
    assert " ".join(line.split()) == "EPISODES = 500 # how many episodes to train (the run had 3,481)"
    for same in (0, 500):
        assert "the run had" not in script(recipe_of("frozenlake"), 500, episodes_of_run=same)


def test_a_script_says_of_which_lane_it_is() -> None:
    text = script(recipe_of("frozenlake"), 10, lane="1 of 2")
    assert "It contains only run 1 of 2." in " ".join(text.split())
    assert "It contains" not in script(recipe_of("frozenlake"), 10)


def test_a_policy_with_many_equally_good_moves_stays_in_its_columns(
    capsys: pytest.CaptureFixture[str],
) -> None:
    exec(compile(script_of("windy-king", episodes=3), "script", "exec"), {"__name__": "script"})
    rows = capsys.readouterr().out.splitlines()[-7:]
    assert len({len(row) for row in rows}) == 1
    assert all(len(row.split()) == 10 for row in rows)
    assert "/" in "".join(rows), "moves of two characters are told apart"
