"""Noise on the rewards of an [mdp] table."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from rl_tui.common.errors import ScenarioError
from rl_tui.worlds.files.scenario import read_scenario

BIASED = """
[mdp]
start = "A"
[[mdp.transition]]
state = "A"
action = "right"
reward = 0
to = "end"
[[mdp.transition]]
state = "A"
action = "left"
reward = 0
std = 0.5
to = { B = 0.5, end = { p = 0.25, std = 2 }, A = { p = 0.25, std = 0 } }
[[mdp.transition]]
state = "B"
action = "pull"
to = { end = { p = 1, reward = -0.1, std = 1.0 } }
"""


@pytest.fixture
def written(tmp_path):
    def scenario(content: str):
        path = tmp_path / "mine.toml"
        path.write_text(content, encoding="utf-8")
        return read_scenario(path)

    return scenario


def test_noise_is_that_of_the_transition_or_of_the_outcome(written):
    mdp = written(BIASED).build(np.random.default_rng(0)).mdp
    assert mdp.action_names == ("right", "left", "pull")
    assert mdp.reward_std.tolist() == [0.0, 0.5, 2.0, 0.0, 1.0]
    assert mdp.reward.tolist() == [0.0, 0.0, 0.0, 0.0, -0.1]


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("std = 0.5", "std = -1", "mdp.transition[1].std"),
        ("std = 0.5", "std = nan", "mdp.transition[1].std"),
        ("std = 1.0", "std = 2e6", "mdp.transition[2].to.end.std"),
        ("std = 1.0", 'std = "much"', "mdp.transition[2].to.end.std"),
    ],
)
def test_noise_out_of_range_is_a_fault(old, new, place, written):
    with pytest.raises(ScenarioError) as error:
        written(BIASED.replace(old, new))
    (fault,) = error.value.faults
    assert (fault.place, fault.expected) == (place, "a finite number from 0 to 1e+06")


@pytest.mark.parametrize(
    ("content", "drawn"),
    [
        ("[bandit]\narms = 3\n", True),
        ("[bandit]\nmeans = [1, 2]\n", False),
        ("[grid]\nrandom = { rows = 4, columns = 4 }\n", True),
        ('[grid]\nmap = "SG"\n', False),
        (BIASED, False),
        ('[gymnasium]\nid = "FrozenLake-v1"\n', False),
    ],
)
def test_only_what_is_drawn_differs_from_seed_to_seed(content, drawn, written):
    scenario = written(content)
    assert scenario.section.drawn_from_seed == drawn
    stream = np.random.default_rng(5)
    scenario.build(stream)
    assert (stream.random() != np.random.default_rng(5).random()) == drawn


def test_maps_travel_to_other_processes(written):
    scenario = pickle.loads(pickle.dumps(written('[grid]\nmap = "S.#\\n..G"\nslippery = true\n')))
    here = scenario.build(np.random.default_rng(0))
    again = pickle.loads(pickle.dumps(here))
    assert again.drawing == here.drawing
    assert again.mdp.next_state.tolist() == here.mdp.next_state.tolist()
    assert again.mdp.state_names == here.mdp.state_names
