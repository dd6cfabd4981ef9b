"""The key of a cell."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import pytest
from plans import cell_of, plan_of

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.studies.sweeps import cell as cell_module
from rl_tui.studies.sweeps.cell import Cell, used_parameters
from rl_tui.studies.sweeps.runs import run_rows
from rl_tui.worlds.files.shipped import shipped_folder

MAZE = (shipped_folder() / "maze.toml").read_text(encoding="utf-8")


def key(scenario: str, *vary: str, **settings: object) -> str:
    return cell_of(scenario, *vary, **settings).key


def test_what_a_file_and_its_texts_are_called_does_not_matter(tmp_path: Path) -> None:
    other = tmp_path / "another-name.toml"
    title, _, rest = MAZE.partition("\n")
    assert title.startswith("title")
    other.write_text(f'title = "Another title"\n{rest}', encoding="utf-8")
    assert key(str(other), "alpha=0.1") == key("maze", "alpha=0.1")


def test_neither_the_order_nor_the_number_of_settings_runs_and_cells_matters() -> None:
    expected = key("maze", "alpha=0.1", "epsilon=0.2")
    assert key("maze", "epsilon=0.2", "alpha=0.1") == expected
    assert key("maze", "epsilon=0.2,0.3", "alpha=0.1,0.5", runs=7, first_seed=9) == expected
    assert key("maze", "epsilon=0.2", overrides={"alpha": 0.1}) == expected
    assert key("maze", "alpha=1e-1", "epsilon=0.20") == expected


def test_another_content_is_another_key(tmp_path: Path) -> None:
    changed = tmp_path / "maze.toml"
    changed.write_text(MAZE.replace("[grid]\n", "[grid]\nbump_reward = -0.25\n"), encoding="utf-8")
    assert key(str(changed), "alpha=0.1") != key("maze", "alpha=0.1")
    assert key("maze", "world.bump_reward=-0.25") == key(str(changed), "n=4")


@pytest.mark.parametrize(
    "vary",
    [
        ("alpha=0.25",),
        ("gamma=0.5",),
        ("algorithm=sarsa",),
        ("policy=softmax",),
        ("ties=first",),
        ("initial_q=3",),
        ("world.noise=0.3",),
        ("world.time_limit=9",),
        ("scenario=cliff",),
    ],
    ids=str,
)
def test_what_makes_a_difference_is_in_the_key(vary: tuple[str, ...]) -> None:
    assert key("maze", *vary) != key("maze", "algorithm=q-learning")


def test_the_number_of_episodes_is_in_the_key() -> None:
    assert key("maze", "alpha=0.1", episodes=21) != key("maze", "alpha=0.1")


@pytest.mark.parametrize("name", ["KEY_FORMAT", "KERNELS", "FIGURES"])
def test_versions_are_in_the_key(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = key("maze", "alpha=0.1")
    monkeypatch.setattr(cell_module, name, getattr(cell_module, name) + 1)
    assert key("maze", "alpha=0.1") != before


@pytest.mark.parametrize(
    ("one", "other"),
    [
        # not used by the algorithm or policy
        (("lambda=0.1",), ("lambda=0.9",)),
        pytest.param(
            *(("policy=softmax", "epsilon=0.1"), ("policy=softmax", "epsilon=0.9")),
            marks=pytest.mark.exhaustive("takes many steps interpreted"),
        ),
        (("algorithm=value-iteration", "alpha=0.1"), ("algorithm=value-iteration", "alpha=0.2")),
        (("algorithm=value-iteration", "policy=softmax"), ("algorithm=value-iteration", "policy=ucb")),
        # without effect in the current settings
        (("epsilon_min=0.1",), ("epsilon_min=0.2",)),
        (
            ("algorithm=sarsa-lambda", "lambda=0", "traces=replacing"),
            ("algorithm=sarsa-lambda", "lambda=0", "traces=accumulating"),
        ),
        # two spellings of the same value
        (("alpha=sample-average",), ("step_size_schedule=sample-average",)),
        (("alpha=sample-average", "alpha_decay=1"), ("alpha=sample-average", "alpha_decay=2")),
        (("initial_q=0",), ("initial_q=-0.0",)),
    ],
    ids=str,
)
def test_the_same_runs_have_the_same_key(one: tuple[str, ...], other: tuple[str, ...]) -> None:
    first, second = cell_of("maze", *one), cell_of("maze", *other)
    assert first.key == second.key
    figures = [[row.figures for row in run_rows(each, (0, 1))] for each in (first, second)]
    assert figures[0] == figures[1]


def test_of_a_bandit_nothing_that_looks_ahead_is_in_the_key() -> None:
    assert key("bandit", "gamma=0.5") == key("bandit", "gamma=0.9")
    assert key("bandit", "world.std=2") != key("bandit", "gamma=0.9")


def test_what_each_seed_draws_is_known_by_what_it_is_drawn_from() -> None:
    first = plan_of("bandit", "alpha=0.1", first_seed=0).cell(0)
    later = plan_of("bandit", "alpha=0.1", first_seed=5).cell(0)
    assert isinstance(first, Cell)
    assert isinstance(later, Cell)
    assert first.key == later.key


def test_an_environment_that_is_stepped_is_known_by_its_version(monkeypatch: pytest.MonkeyPatch) -> None:
    import gymnasium

    before = key("gym:Blackjack-v1", "world.table=false")
    assert key("gym:Blackjack-v1", "world.table=false") == before
    monkeypatch.setattr(gymnasium, "__version__", "0.0.0")
    assert key("gym:Blackjack-v1", "world.table=false") != before


def test_every_shipped_scenario_has_a_key_of_its_own() -> None:
    scenarios = [path.stem for path in shipped_folder().glob("*.toml")]
    assert len({key(each, "gamma=0.5") for each in scenarios}) == len(scenarios)


def test_what_the_agent_sees_of_a_table_is_swept_as_well() -> None:
    rows = list(run_rows(cell_of("egg", "alpha=0.5", episodes=20), (0, 1)))
    assert [row.figures["episodes"] for row in rows] == [20, 20]


def test_identity_is_plain_json() -> None:
    cell = cell_of("maze", "alpha=0.1")
    assert json.loads(json.dumps(cell.identity)) == cell.identity
    assert len(cell.key) == 64


def test_each_algorithm_and_policy_names_the_parameters_that_it_uses() -> None:
    for algorithm, policy in ((algorithm, policy) for algorithm in BY_ID for policy in POLICY_BY_ID):
        used = used_parameters(algorithm, replace(Hyperparameters(), policy=policy), is_bandit=False)
        assert "ties" in used
        assert "policy" not in used
        assert set(used) <= set(PARAMETERS)


def test_cells_of_a_grid_have_keys_of_their_own() -> None:
    plan = plan_of("maze", "alpha=0.1:1:4", "epsilon=0:0.4:3", "algorithm=q-learning,sarsa")
    cells = [plan.cell(index) for index in range(plan.count)]
    keys = [cell.key for cell in cells if isinstance(cell, Cell)]
    assert len(set(keys)) == len(keys) == 24
    assert not any(one == other for one, other in combinations(keys, 2))
