"""The list of scenarios, and the search in it."""

from __future__ import annotations

import subprocess
import sys

import pytest
from shipped import SHIPPED

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.files import catalogue
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.files.shipped import shipped_folder

# The order in which lessons build on one another
LESSONS = [
    *("frozenlake", "student", "frozenlake-slippery", "bandit", "random-walk", "cliff", "windy", "max-bias"),
    *("maze", "book", "karpathy", "bridge", "discount", "taxi", "blackjack", "cartpole", "mountain-car"),
]


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    folder = tmp_path / "scenarios"
    folder.mkdir()
    monkeypatch.setattr(catalogue, "user_folder", lambda: folder)
    return folder


def test_the_shipped_ones_in_teaching_order():
    assert [scenario.id for scenario in catalogue.scenarios()] == SHIPPED
    assert [name for name in SHIPPED if name in LESSONS] == LESSONS
    assert catalogue.read_catalogue().broken == []


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_one_teaches_something(name):
    scenario = catalogue.find(name)
    assert scenario.title != name
    assert scenario.summary
    assert scenario.guess.endswith("?")
    assert scenario.see.endswith(".")
    assert scenario.try_this.endswith((".", "?"))
    assert "**Try this**" in scenario.notes
    assert {"algorithm", "alpha", "gamma", "epsilon", "episodes"} <= scenario.defaults.keys()


def labels(grid: Grid) -> tuple[int, object, object] | None:
    axes = grid.axes
    return None if axes is None else (max(map(len, axes.rows)), axes.titles, axes.names)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_file_tells_how_its_world_will_be_drawn(name):
    scenario = catalogue.find(name)
    drawing, sketch = scenario.build(streams(0).world).drawing, scenario.section.sketch()
    assert type(sketch) is type(drawing)
    match drawing:
        case Grid():
            assert (sketch.rows, sketch.columns, sketch.wind) == (drawing.rows, drawing.columns, drawing.wind)
            assert (bool(sketch.legend), bool(sketch.body)) == (bool(drawing.legend), bool(drawing.body))
            assert labels(sketch) == labels(drawing)
        case _:
            assert sketch == drawing


@pytest.mark.parametrize(
    ("text", "shape"),
    [
        ('id = "FrozenLake-v1"\nkwargs = { map_name = "8x8" }', (8, 8)),
        ('id = "FrozenLake-v1"\nkwargs = { desc = ["SFF", "FHG"] }', (2, 3)),
        ('id = "FrozenLake-v1"\ntable = false', None),
        ('id = "somebody/Else-v0"', None),
        ('id = "Box-v0"\nbins = { edges = [[0.0], [0.0, 1.0]] }', (2, 3)),
        (f'id = "Box-v0"\nbins = {{ count = {[1_000_000] * 60} }}', None),  # it will be refused
    ],
)
def test_of_gymnasium_only_what_is_sure_is_told(own_folder, text, shape):
    path = own_folder / "mine.toml"
    path.write_text(f"[gymnasium]\n{text}\n")
    sketch = read_scenario(path, ask_environment=False).section.sketch()
    assert (sketch and (sketch.rows, sketch.columns)) == shape


@pytest.mark.parametrize(
    ("name", "defaults"),
    [
        ("bandit", {"alpha": "sample-average", "epsilon": 0.1, "gamma": 0.0, "episodes": 1000}),
        ("bandit-bernoulli", {"alpha": "sample-average", "epsilon": 0.1, "gamma": 0.0, "episodes": 1000}),
        ("bandit-drifting", {"alpha": 0.1, "epsilon": 0.1, "gamma": 0.0, "episodes": 10_000}),
        ("student", {"alpha": 0.1, "epsilon": 0.1, "gamma": 0.9, "episodes": 500}),
        ("frozenlake", {"alpha": 0.1, "epsilon": 0.1, "gamma": 0.99, "episodes": 10_000}),
        ("frozenlake-slippery", {"alpha": 0.1, "epsilon": 0.1, "gamma": 0.99, "episodes": 10_000}),
        ("frozenlake-8x8", {"alpha": 0.1, "epsilon": 0.1, "gamma": 0.99, "episodes": 10_000}),
        ("frozenlake-8x8-slippery", {"alpha": 0.1, "epsilon": 0.1, "gamma": 0.99, "episodes": 10_000}),
    ],
)
def test_shipped_defaults(name, defaults):
    assert defaults.items() <= catalogue.find(name).defaults.items()


def test_the_users_own_come_after_the_shipped_ones(own_folder):
    (own_folder / "zebra.toml").write_text("order = 1\n[bandit]\narms = 2\n")
    (own_folder / "ape.toml").write_text("[bandit]\narms = 2\n")
    (own_folder / "readme.txt").write_text("no scenario")
    assert [scenario.id for scenario in catalogue.scenarios()] == [*SHIPPED, "zebra", "ape"]
    assert catalogue.find("ape").source == own_folder / "ape.toml"


def test_groups_follow_one_another_and_those_of_the_user_are_the_last(own_folder):
    (own_folder / "mine.toml").write_text("order = 1\n[bandit]\narms = 2\n")
    groups = [catalogue.group_of(scenario) for scenario in catalogue.scenarios()]
    assert list(dict.fromkeys(groups)) == [*(name for _, name in catalogue.GROUPS), catalogue.YOURS]
    assert groups == sorted(groups, key=list(dict.fromkeys(groups)).index)
    assert groups[-1] == catalogue.YOURS
    of_group = {each.id: group for each, group in zip(catalogue.scenarios(), groups, strict=True)}
    assert of_group["frozenlake"] == of_group["student"] == groups[0]
    assert of_group["blackjack"] == of_group["cartpole"] == of_group["mountain-car"] == groups[-2]


def test_a_faulty_file_leaves_only_itself_out(own_folder):
    (own_folder / "bad.toml").write_text("[bandit]\narms = 0\n")
    (own_folder / "good.toml").write_text("[bandit]\narms = 2\n")
    made = catalogue.read_catalogue()
    assert [scenario.id for scenario in made.scenarios] == [*SHIPPED, "good"]
    (error,) = made.broken
    assert error.faults[0].place == "bandit.arms"
    with pytest.raises(ScenarioError, match=r"bad\.toml: bandit\.arms: found 0"):
        catalogue.find("bad")


def test_a_shipped_name_cannot_be_taken(own_folder):
    (own_folder / "bandit.toml").write_text("[bandit]\narms = 2\n")
    made = catalogue.read_catalogue()
    assert [scenario.id for scenario in made.scenarios] == SHIPPED
    assert "choose another file name" in made.broken[0].faults[0].found
    assert catalogue.find("bandit").source.parent == shipped_folder()


def test_no_folder_of_the_users_own_is_needed(own_folder):
    own_folder.rmdir()
    assert len(catalogue.scenarios()) == len(SHIPPED)


def test_finds_a_file_by_its_path(tmp_path, monkeypatch):
    (tmp_path / "mine.toml").write_text("[bandit]\narms = 2\n")
    monkeypatch.chdir(tmp_path)
    for path in ("mine.toml", "./mine.toml", str(tmp_path / "mine.toml")):
        assert catalogue.find(path).id == "mine"
    with pytest.raises(ScenarioError, match=r"^other\.toml: no such file"):
        catalogue.find("other.toml")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("frozenlke", r'there is no scenario "frozenlke": did you mean frozenlake'),
        ("Bandit", "did you mean bandit"),
        ("bad.json", r"expected a name from rl-tui list, FILE\.toml, or gym:ENV_ID$"),
        ("xyz", f"choose from {', '.join(SHIPPED)}$"),
        ("a\x1b[31m", r"there is no scenario \"a\\u001b\[31m\""),
    ],
)
def test_unknown_names_get_near_ones(name, message):
    with pytest.raises(UserError, match=message):
        catalogue.find(name)


@pytest.mark.process
def test_reading_the_catalogue_loads_nothing_slow():
    code = (
        "import sys; from rl_tui.worlds.files.catalogue import scenarios; scenarios(); "
        "print(sorted({'gymnasium', 'numba', 'scipy', 'textual', 'rich', 'click'} & set(sys.modules)))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
