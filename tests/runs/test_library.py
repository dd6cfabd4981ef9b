from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from recipes import recipe

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE
from rl_tui.common.errors import Fault, ScenarioError, UserError
from rl_tui.runs.library import checked, episodes_of, find, listing, recipe_for

WORLD = "[bandit]\nmeans = [0.0, 1.0]\n"


def faults_of(path: str | Path) -> list[Fault]:
    return checked(path)[1]


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text)
    return path


def test_defaults_come_from_the_file() -> None:
    arms = recipe("bandit")
    assert arms.algorithm == "q-learning"
    assert arms.hyperparameters.alpha == SAMPLE_AVERAGE
    assert arms.hyperparameters.gamma == 0.0
    assert arms.seed == 0
    assert episodes_of(arms.scenario) == 1000
    assert episodes_of(find("frozenlake")) == 10_000


def test_what_the_user_asks_for_goes_before_the_defaults() -> None:
    lake = recipe_for(find("student"), {"alpha": 0.3, "ties": "first", "gamma": 1}, seed=5)
    assert lake.hyperparameters.alpha == 0.3
    assert lake.hyperparameters.ties == "first"
    assert lake.hyperparameters.gamma == 1.0
    assert lake.hyperparameters.epsilon == 0.1
    assert lake.seed == 5


@pytest.mark.parametrize(
    ("name", "value", "complaint"),
    [
        ("alpha", 0, r"alpha is 0; expected a number in \(0, 1\] or sample-average"),
        ("gamma", 1.01, r"gamma is 1.01; expected a number in \[0, 1\]"),
        ("epsilon", -0.1, r"epsilon is -0.1; expected a number in \[0, 1\]"),
        ("epsilon", float("nan"), r"expected a number in \[0, 1\]"),
        ("ties", "last", "ties is last; expected random or first"),
        ("algorithm", "qlearning", 'algorithm is "qlearning".*did you mean "q-learning"'),
        ("alhpa", 0.1, 'no setting "alhpa".*did you mean "alpha"'),
    ],
)
def test_overrides_out_of_range_are_refused_with_the_range(name: str, value: object, complaint: str) -> None:
    with pytest.raises(UserError, match=complaint) as refused:
        recipe_for(find("student"), {name: value})
    assert "\n" not in str(refused.value)


def test_a_seed_below_zero_is_refused() -> None:
    with pytest.raises(UserError, match="seed is -1; expected a whole number, 0 or more"):
        recipe_for(find("student"), seed=-1)


def test_faulty_defaults_are_all_reported_with_their_place(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        "[defaults]\nalpha = 0\nepisodes = -5\nalgorithm = 'sarsar'\nepsillon = 1\nties = 3\n" + WORLD,
    )
    faults = faults_of(path)
    assert [fault.place for fault in faults] == [
        "defaults.alpha",
        "defaults.episodes",
        "defaults.algorithm",
        "defaults.epsillon",
        "defaults.ties",
    ]
    assert faults[0].found == "0"
    assert faults[0].expected == "a number in (0, 1] or sample-average"
    assert faults[1].expected == "a whole number, 1 or more"
    assert 'did you mean "epsilon"' in str(faults[3])
    for attempt in (lambda: find(str(path)),):
        with pytest.raises(ScenarioError) as refused:
            attempt()
        assert list(refused.value.faults) == faults


def test_faults_of_world_and_defaults_come_together_in_the_order_of_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "[bandit]\narms = 0\n[defaults]\ngamma = 2\n")
    assert [fault.place for fault in faults_of(path)] == ["bandit.arms", "defaults.gamma"]
    path = written(tmp_path, "titel = 'x'\n[defaults]\ngamma = 2\n[bandit]\narms = 0\n")
    assert [fault.place for fault in faults_of(path)] == ["titel", "defaults.gamma", "bandit.arms"]


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("[defaults]\ngamma = 2\n[bandit]\narms = 0\n", ["defaults.gamma", "bandit.arms"]),
        ("[defaults]\ngamma = 2\n[gymnasium]\nid = 'Lake'\n", ["defaults.gamma", "gymnasium.id"]),
        ("titel = 'x'\n[gymnasium]\nid = 'Lake'\n", ["titel", "gymnasium.id"]),
        ("[bandit]\narms = 0\n", ["bandit.arms"]),
    ],
)
def test_whoever_uses_a_faulty_file_hears_of_all_its_faults(
    text: str, places: list[str], tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError) as refused:
        find(str(written(tmp_path, text)))
    assert [fault.place for fault in refused.value.faults] == places


def test_a_default_beyond_all_floats_is_out_of_range(tmp_path: Path) -> None:
    (fault,) = faults_of(written(tmp_path, f"[defaults]\nalpha = {10**400}\n" + WORLD))
    assert fault.place == "defaults.alpha"
    assert fault.expected == "a number in (0, 1] or sample-average"


def test_a_sound_file_has_no_faults(tmp_path: Path) -> None:
    assert faults_of(written(tmp_path, WORLD)) == []
    assert faults_of(find("student").source) == []


def test_an_unreadable_file_has_its_one_fault(tmp_path: Path) -> None:
    assert len(faults_of(tmp_path / "nowhere.toml")) == 1
    assert len(faults_of(written(tmp_path, "[defaults\n"))) == 1


def test_a_listing_has_sizes_and_complete_defaults() -> None:
    row = listing(find("student"))
    assert {key: row[key] for key in ("id", "kind", "states", "actions", "pairs", "time_limit")} == {
        "id": "student",
        "kind": "mdp",
        "states": 4,
        "actions": 5,
        "pairs": 5,
        "time_limit": 100,
    }
    assert row["defaults"]["episodes"] == 500
    assert row["defaults"]["gamma"] == 0.9
    assert row["defaults"]["epsilon_decay"] == 0.0
    json.dumps(row)


@pytest.mark.process
def test_what_the_screen_imports_first_loads_neither_numba_nor_gymnasium() -> None:
    program = (
        "import sys, rl_tui.live.player, rl_tui.live.commands, rl_tui.live.snapshot\n"
        "import rl_tui.runs.library\n"
        "print([name for name in ('numba', 'gymnasium', 'scipy', 'textual') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_gradient_bandit_takes_a_step_size_where_the_file_averages() -> None:
    bandit = find("bandit")
    assert recipe_for(bandit, {"policy": "gradient"}).hyperparameters.alpha == 0.1
    assert recipe_for(bandit, {"policy": "gradient", "alpha": 0.4}).hyperparameters.alpha == 0.4
    assert recipe_for(
        bandit, {"policy": "gradient", "alpha": "sample-average"}
    ).hyperparameters.sample_average
    assert recipe_for(bandit, {"policy": "ucb"}).hyperparameters.sample_average
