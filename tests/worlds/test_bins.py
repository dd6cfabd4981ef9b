"""Real numbers divided into states."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gymnasium.spaces import Box

from rl_tui.common.errors import ScenarioError
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.gym.bins import BinsSection
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.gym.states import OutsideError
from rl_tui.worlds.sections.schema import WorldRefusedError

PLANE = Box(np.array([-1.0, -np.inf]), np.array([1.0, np.inf]), dtype=np.float64)


def states(space: Box = PLANE, **keys: Any):
    return BinsSection.model_validate(keys).states("Plane", space)


def test_equal_bins_and_what_lies_outside_them():
    made = states(low=[-1.0, 0.0], high=[1.0, 10.0], count=[2, 5])
    for observation, state in {
        (-1.0, 0.0): 0,
        (-1e-9, 1.99): 0,
        (0.0, 2.0): 6,
        (1.0, 9.99): 9,
        (-7.0, -np.inf): 0,
        (7.0, np.inf): 9,
    }.items():
        assert made.state_of(np.array(observation)) == state
    assert made.part_names == [["-0.5", "0.5"], ["1", "3", "5", "7", "9"]]


def test_edges_of_ones_own():
    made = states(edges=[[], [-1.0, 0.5, 2.0]])
    assert [made.state_of(np.array([9.0, y])) for y in (-2.0, -1.0, 0.6, 2.0)] == [0, 1, 2, 3]
    assert made.part_names == [["any"], ["<-1", "-1..0.5", "0.5..2", ">=2"]]


def test_bounds_of_the_box_count_where_none_are_given():
    made = states(count=[4, 1])
    assert made.part_names[0] == ["-0.75", "-0.25", "0.25", "0.75"]
    assert [made.state_of(np.array([x, 1e30])) for x in (-0.6, -0.4, 0.0, 0.6)] == [0, 1, 2, 3]


def test_not_a_number_is_in_no_bin():
    with pytest.raises(OutsideError):
        states(count=[4, 1]).state_of(np.array([np.nan, 0.0]))


@pytest.mark.parametrize(
    ("keys", "location", "found"),
    [
        ({"count": [4]}, ("bins", "count"), "1 entries"),
        ({"edges": [[], [], []]}, ("bins", "edges"), "3 entries"),
        ({"count": [4, 4]}, ("bins", "low"), "dimension 1 has no bound, here or in Plane; .*"),
        (
            {"count": [4, 4], "low": [0, 0]},
            ("bins", "high"),
            "dimension 1 has no bound, here or in .*",
        ),
        ({"count": [4, 1], "low": [2, 0]}, ("bins", "high"), "1"),
    ],
)
def test_what_does_not_fit_the_box_is_refused(keys, location, found):
    with pytest.raises(WorldRefusedError, match=f"^{found}$") as refusal:
        states(**keys)
    assert refusal.value.finding.location == location


CAR = 'id = "MountainCar-v0"\n[gymnasium.bins]\n'


@pytest.mark.parametrize(
    ("text", "place", "found"),
    [
        (CAR, "gymnasium.bins.count", "nothing"),
        (CAR + "count = [2, 0]", "gymnasium.bins.count[1]", "0"),
        (CAR + "count = 2", "gymnasium.bins.count", "2"),
        (CAR + "count = []", "gymnasium.bins.count", "[]"),
        (CAR + "count = [2, 2]\nlow = [0, 0, 0]", "gymnasium.bins.low", "3 numbers"),
        (CAR + "count = [2, 2]\nlow = [0, 0]\nhigh = [1, 0]", "gymnasium.bins.high[1]", "0"),
        (CAR + "count = [2, 2]\nlow = [0, nan]", "gymnasium.bins.low[1]", "nan"),
        (CAR + "edges = [[1.0, 1.0], []]", "gymnasium.bins.edges[0]", "[1.0, 1.0]"),
        (
            CAR + "edges = [[], []]\ncount = [1, 1]",
            "gymnasium.bins.count",
            "count and edges are both set; give edges, or low, high and count",
        ),
        (CAR + "counts = [2, 2]\ncount = [2, 2]", "gymnasium.bins.counts", "unknown key"),
        (CAR + "count = [2, 2, 2]", "gymnasium.bins.count", "3 entries"),
        (CAR + "count = [2000, 2000]", "gymnasium.bins", "4,000,000 states of MountainCar-v0"),
        (
            'id = "Blackjack-v1"\nbins = { count = [2] }',
            "gymnasium.bins",
            "bins divide a Box, but the states of Blackjack-v1 are Tuple; leave out bins",
        ),
        (
            'id = "MountainCar-v0"\ntable = true\nbins = { count = [2, 2] }',
            "gymnasium.table",
            "a world with bins has no transition table; leave out table",
        ),
        ('id = "MountainCar-v0"\nbins = 3', "gymnasium.bins", "3"),
        ('id = "Blackjack-v1"\ntable = "yes"', "gymnasium.table", '"yes"'),
        ('id = "CartPole-v1"\ntable = true', "gymnasium.id", "the states of CartPole-v1 are Box"),
    ],
)
def test_faults_of_a_file(text, place, found, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(f"[gymnasium]\n{text}\n")
    with pytest.raises(ScenarioError) as error:
        read_scenario(path)
    (fault,) = error.value.faults
    assert fault.place == place
    assert fault.found.startswith((f"{found}; ", f"{found}, ")) or fault.found == found


def test_a_world_of_bins():
    section = GymnasiumSection.model_validate(
        {"id": "CartPole-v1", "bins": {"edges": [[], [], [0.0], [0.0]]}}
    )
    world = section.build(np.random.default_rng(0))
    assert list(world.space.state_names) == ["<0, <0", "<0, >=0", ">=0, <0", ">=0, >=0"]
    assert world.space.action_names == ("left", "right")
    assert (world.drawing.rows, world.drawing.columns, world.space.time_limit) == (2, 2, 500)
    environment = world.new_environment()
    assert environment.reset(0) in range(4)
    assert environment.step(1).reward == 1.0


@pytest.mark.parametrize(
    "raw",
    [
        {"low": [0.0], "high": [1e-300], "count": [1000]},
        {"low": [-1e12], "high": [1e12], "count": [1000]},
        {"low": [0.0], "high": [1e-9], "count": [3]},
        {"edges": [[1.0000001, 1.0000002, 1.0000003]]},
        {"edges": [[1e-300, 2e-300, 1.0]]},
    ],
)
def test_bins_however_narrow_have_names_of_their_own(raw):
    (names,) = BinsSection.model_validate(raw).states("a", Box(-1.0, 1.0, (1,))).part_names
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("low", "high", "count"), [(0.0, 5e-324, 10), (1e12 - 1.0, 1e12, 1_000_000), (1.0, 1.0 + 1e-15, 2)]
)
def test_bins_narrower_than_numbers_are_refused(low, high, count):
    section = BinsSection.model_validate({"low": [low], "high": [high], "count": [count]})
    with pytest.raises(WorldRefusedError) as refusal:
        section.states("a", Box(-1.0, 1.0, (1,)))
    assert refusal.value.finding.location == ("bins", "count", 0)
    assert refusal.value.finding.found.endswith("; use fewer bins")
