"""Oversized input is refused at once."""

# ruff: noqa: E501

from __future__ import annotations

import resource
import time

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

from rl_tui.common import limits
from rl_tui.common.errors import ScenarioError
from rl_tui.common.limits import LARGEST_FILE, MOST_FAULTS
from rl_tui.worlds.files.scenario import read_scenario

BINS = '[gymnasium]\nid = "CartPole-v1"\nbins = '
LAKE = '[gymnasium]\nid = "FrozenLake-v1"\nkwargs = '
TRANSITION = '{{ state = "s{0}", action = "a{1}", reward = 1, to = "s{2}" }}'
GENEROUS = 20.0  # seconds; a late refusal takes minutes
SPARE = 1_500  # MB; a late refusal takes tens of thousands


def transitions(*places: tuple[int, int, int]) -> str:
    written = ",".join(TRANSITION.format(*place) for place in places)
    return f'[mdp]\nstart = "s0"\ntransition = [{written}]\n'


TOO_LARGE = {
    "10^9 cells": ("[grid]\nrandom = { rows = 100_000, columns = 10_000 }", "grid.random.rows", "10,000"),
    "10^8 cells": ("[grid]\nrandom = { rows = 10_000, columns = 10_000 }", "grid.random", "4,000,000 cells"),
    "a large map": ('[grid]\nmap = """\n' + ("." * 2_001 + "\n") * 2_000 + '"""', "grid.map", "4,000,000 cells"),
    "a long map": ('[grid]\nmap = "S' + "." * 10_000 + '"', "grid.map", "10,000 on a side"),
    "characters": (
        '[grid]\nmap = "' + "".join(map(chr, range(0x4E00, 0x9000))) * 10 + '"',
        "grid.map",
        "at most 200",
    ),
    "outcomes": (
        '[grid]\nmoves = "king+stay"\nwind = [1]\ngusts = true\nrandom = { rows = 2_000, columns = 2_000 }',
        "grid.random",
        "50,000,000 outcomes",
    ),
    "a legend": (
        '[grid]\nmap = "S"\n[grid.legend]\n' + "".join(f'"{chr(0x4E00 + n)}" = {{}}\n' for n in range(201)),
        "grid.legend",
        "at most 200",
    ),
    "wind": ('[grid]\nmap = "S"\nwind = [' + "0," * 20_000 + "]", "grid.wind", "at most 10,000"),
    "10^9 arms": ("[bandit]\narms = 1_000_000_000", "bandit.arms", "10,000"),
    "means": ("[bandit]\nmeans = [" + "1," * 10_001 + "]", "bandit.means", "10,000 numbers"),
    "pulls": ("[bandit]\narms = 2\nbudget = 1_000_000_001", "bandit.budget", "1,000,000,000"),
    "10^9 states": (BINS + "{ count = [1_000_000, 1_000, 1, 1] }", "gymnasium.bins", "1,000,000"),
    "10^24 states": (
        BINS + "{ low = [0, 0, 0, 0], high = [1, 1, 1, 1], count = [" + "1_000_000," * 4 + "] }",
        "gymnasium.bins",
        "1,000,000",
    ),
    "10^9 bins": (BINS + "{ count = [1_000_000_000, 1, 1, 1] }", "gymnasium.bins.count[0]", "1,000,000"),
    "edges": (BINS + "{ edges = [[" + "1," * 10_001 + "]] }", "gymnasium.bins.edges[0]", "10,000 numbers"),
    "dimensions": (BINS + "{ count = [" + "1," * 101 + "] }", "gymnasium.bins.count", "at most 100"),
    "a lake of 250,000 cells": (
        LAKE + "{ desc = [" + '"' + '","'.join(["S" + "F" * 499] * 500) + '"] }',
        "gymnasium.kwargs",
        "10,000 characters",
    ),
    "10^9 steps": (LAKE + "{ max_episode_steps = 1_000_000_000 }", "gymnasium.kwargs.max_episode_steps", "1,000,000"),
    "a time limit": (transitions((0, 0, 0)).replace("start", "time_limit = 10000000\nstart"), "mdp.time_limit", "1,000,000"),
    "actions": (transitions(*((0, n, 0) for n in range(1_001))), "mdp.transition", "1,000"),
    "a start": ('[mdp]\ntransition = []\nstart = { ' + ", ".join(f"s{n} = 0" for n in range(10_001)) + " }", "mdp.start", "10,000"),
    "named tables": ("".join(f"[t{n}]\n" for n in range(1_001)), "", "1,000"),
    "named lists": ("".join(f"[[t{n}]]\n" for n in range(1_001)), "", "1,000"),
    "quoted lists": ("".join(f"[['t{n}']]\n" for n in range(1_001)), "", "1,000"),
    "dotted lists": ("[[a.b.c.d.e]]\n" * 80_001, "", "320,000"),
    "dotted keys": ("".join(f"k{n}.a.b.c.d = 0.5\n" for n in range(80_001)), "", "320,000"),
    "dotted numbers": ("".join(f"{n}.5.1.2e3.d = 1\n" for n in range(80_001)), "", "320,000"),
    "tables in lists": ("[[t]]\n" * 100_000 + "a = [" + "{}," * 220_001 + "]", "", "320,000"),
    "tables within lines": ("[t]\n" + "".join(f"k{n} = {{}}\n" for n in range(320_001)), "", "320,000"),
    "values": ("[bandit]\nx = [" + "1," * 1_000_001 + "]", "", "1,000,000"),
    "tables": ("[bandit]\nx = " + "[" * 2_000_002, "", "1,000,000"),
    "keys": ("[bandit]\n" + "".join(f"k{n} = 1\n" for n in range(1_001)), "bandit", "1,000 keys"),
    "a dotted key": (".".join("a" * 100_000) + " = 1", "", "20 parts"),
    "a dotted header": ("[" + ".".join(['"a"'] * 100_000) + "]", "", "20 parts"),
    "digits": ("[bandit]\narms = " + "1" * 10_001, "", "10,000 characters"),
    "a bare key": ("a" * 10_001 + " = 1", "", "10,000 characters"),
    "bytes": ("#" * (LARGEST_FILE + 1), "", "10 MB"),
}  # fmt: skip


def refusal(text: str, folder) -> ScenarioError:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    begin, memory = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
    with pytest.raises(ScenarioError) as error:
        read_scenario(path)
    assert time.process_time() - begin < GENEROUS
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10) - memory < SPARE
    assert max(map(len, str(error.value).splitlines())) < 600
    return error.value


@pytest.mark.parametrize("name", TOO_LARGE)
def test_is_refused_with_its_limit(name, tmp_path):
    text, place, limit = TOO_LARGE[name]
    faults = refusal(text, tmp_path).faults
    assert any(fault.place == place and limit in str(fault) for fault in faults), str(faults)


def test_of_very_many_faults_the_first_are_told(tmp_path):
    """Names are not compared with all others, which would take hours."""
    text = transitions(*((n // 10, n % 10, 100_000 + n) for n in range(5_000)))
    error = refusal(text.replace("[mdp]", "[mdp]\nplace = { s0 = [0, 0] }"), tmp_path)
    assert len(error.faults) == MOST_FAULTS + 1
    assert error.faults[0].found.startswith('unknown state "s100000"; ')
    assert error.faults[-1].found == "more than 100 errors; fix these first"


def test_very_many_unknown_keys_are_put_in_order_quickly(tmp_path):
    faults = refusal("".join(f"k{n} = 1\n" for n in range(20_000)), tmp_path).faults
    assert [fault.place for fault in faults[:3]] == ["", "k0", "k1"], "that there is no world comes first"


@pytest.mark.parametrize(
    "text",
    ["[bandit]\n" + "\\\"" * 2_000_000, 'title = "' + '\\"' * 400_000, "title = " + "'''\"\"\"" * 200_000, "[" * 100_000],
    ids=["escapes", "an open text", "quotes", "brackets"],
)  # fmt: skip
def test_a_text_without_an_end_is_looked_through_once(text, tmp_path):
    assert refusal(text, tmp_path).faults


def test_large_maps_and_tables_pass(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('[grid]\nmap = """\nS.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.S.G\n"""\n')
    assert read_scenario(path).kind == "grid", "the points of a map are no dotted key"
    path.write_text(
        "\n".join(["[bandit]", "arms = 2", "# " + ".".join("a" * 1_000), "[defaults]", "alpha = 0.5"])
    )
    assert read_scenario(path).kind == "bandit"


class Vast(gymnasium.Env):
    def __init__(self, space: str) -> None:
        self.observation_space, self.action_space = SPACES[space]


TWO = spaces.Discrete(2)
SPACES = {
    "states": (spaces.Discrete(10**9), TWO),
    "actions": (TWO, spaces.Discrete(10**9)),
    "product": (spaces.MultiDiscrete([1_000_000_000, 1_000_000_000]), TWO),
    "powers": (spaces.MultiDiscrete(np.full(10_000, 2)), TWO),
    "bits": (spaces.MultiBinary(10**6), TWO),
    "tuple": (spaces.Tuple([spaces.Discrete(10**6)] * 50), TWO),
}


@pytest.mark.parametrize("space", SPACES)
def test_environments_of_vast_spaces_are_refused(space, tmp_path, monkeypatch):
    monkeypatch.setitem(
        gymnasium.registry, "Vast-v0", gymnasium.envs.registration.EnvSpec("Vast-v0", entry_point=Vast)
    )
    text = f'[gymnasium]\nid = "Vast-v0"\nkwargs = {{ space = "{space}" }}\n'
    (fault,) = refusal(text, tmp_path).faults
    assert "of Vast-v0" in fault.found
    assert fault.expected in ("at most 1,000,000", "at most 10,000")


def test_every_limit_is_a_number_that_is_explained():
    names = [name for name in vars(limits) if name.isupper()]
    assert len(names) >= 25
    assert np.all(np.hstack([getattr(limits, name) for name in names]) > 0)
