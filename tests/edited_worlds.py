"""A small map, and edits of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from hypothesis import strategies as st

from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import EditWorld, Recipe
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.files.scenario import scenario_of

MAP: Final = """
title = "Small"
summary = "A map to be edited."
notes = "None."

[defaults]
algorithm = "q-learning"
alpha = 0.3
gamma = 0.9
epsilon = 0.2
episodes = 100
initial_q = 0.5
ties = "random"

[grid]
map = '''
S..G
.#.G
S..C
'''
noise = 0.2
time_limit = 30

[grid.legend]
C = { kind = "floor", reward = -5.0 }
"""
GRAPH: Final = """
title = "Small"
summary = "A graph to be edited."
notes = "None."

[defaults]
algorithm = "q-learning"
alpha = 0.3
gamma = 0.9
epsilon = 0.2
episodes = 100
initial_q = 0.5
ties = "random"

[mdp]
start = "Class"
time_limit = 20
transition = [
  { state = "Class", action = "study", to = { Pass = 0.8, Class = 0.2 }, reward = -2.0 },
  { state = "Class", action = "check phone", to = "Phone", reward = 0.0 },
  { state = "Phone", action = "scroll", to = "Phone", reward = -1.0 },
  { state = "Phone", action = "quit", to = "Class", reward = 0.0 },
  { state = "Pass", action = "sleep", to = "Sleep", reward = 10.0 },
]
"""


def small_map(**overrides: Any) -> Recipe:
    return recipe_for(scenario_of(MAP, Path("small.toml")), overrides, seed=3)


def large_map(**overrides: Any) -> Recipe:
    cells = np.random.default_rng(0).choice(list("......#"), (25, 25))
    cells[0, :], cells[:, -1], cells[0, 0], cells[-1, -1] = ".", ".", "S", "G"
    text = "\n".join("".join(row) for row in cells)
    defaults = MAP[: MAP.index("[grid]")]
    section = f"[grid]\nnoise = 0.2\nmap = '''\n{text}\n'''\n"
    return recipe_for(scenario_of(defaults + section, Path("large.toml")), overrides, seed=3)


def small_graph(**overrides: Any) -> Recipe:
    return recipe_for(scenario_of(GRAPH, Path("small.toml")), overrides, seed=3)


def edit(text: str) -> EditWorld:
    """Parse the stroke in ``text``; ``world.`` before each edit is optional."""
    return EditWorld(read_edits(";".join(f"world.{each}" for each in text.split(";"))))


_PLACES = st.builds(lambda row, column: f"[{row},{column}]", st.integers(0, 3), st.integers(0, 4))
_MAP_EDITS = st.one_of(
    st.builds(lambda at, value: f"cell{at}={value}", _PLACES, st.sampled_from("..##HGSC<^?")),
    st.builds(lambda at, value: f"reward{at}={value}", _PLACES, st.sampled_from(["-1", "3", "0.5", "x"])),
    st.builds(
        lambda name, by, at: f"{name}={by}@{at}",
        st.sampled_from(["rows", "columns"]),
        st.sampled_from(["+1", "-1", "+2", "-2"]),
        st.integers(0, 4),
    ),
    st.sampled_from(["noise=0.5", "noise=0", "noise=7", "time_limit=5", "time_limit=0", "wind[1]=1"]),
    # moves the start, removes the only goals, fills the map with walls
    st.sampled_from(["cell[0,0]=.;cell[2,0]=.;cell[0,2]=S", "cell[0:3,0:4]=#", "cell[0:2,0:2]=."]),
)
_GRAPH_EDITS = st.sampled_from(
    [
        'transition["Class","study"]={"to":{"Pass":0.5,"Class":0.5},"reward":-1.0}',
        'transition["Class","study"]=null',
        'transition["Class","cheat"]={"to":{"Pass":0.3,"Jail":0.7},"reward":1.0}',
        'transition["Jail","wait"]={"to":"Class","reward":-3.0}',
        'transition["Phone","quit"]=null',
        'transition["Phone","scroll"]=null',
        'transition["Pass","sleep"]={"to":"Phone","reward":0.5}',
        'transition["Class","check phone"]={"to":{"Phone":0.4},"reward":0.0}',
        'start="Phone"',
        'start="Nowhere"',
        "time_limit=4",
        "time_limit=-1",
    ]
)


def strokes(edits: st.SearchStrategy[str]) -> st.SearchStrategy[EditWorld]:
    return st.builds(lambda texts: edit(";".join(texts)), st.lists(edits, min_size=1, max_size=2))


MAP_STROKES: Final = strokes(_MAP_EDITS)
GRAPH_STROKES: Final = strokes(_GRAPH_EDITS)


def small_lake(**overrides: Any) -> Recipe:
    return recipe_for(find("frozenlake-slippery"), overrides, seed=3)


def small_bandit(**overrides: Any) -> Recipe:
    return recipe_for(find("bandit"), overrides, seed=3)


LAKE_STROKES: Final = strokes(_MAP_EDITS)
_ARM_EDITS = st.one_of(
    st.builds("arm[{}]={}".format, st.integers(0, 10), st.sampled_from(["-1", "0.5", "x"])),
    st.builds("arms={}@{}".format, st.sampled_from(["+1", "-1", "+2", "-2", "-9"]), st.integers(0, 11)),
    st.sampled_from(["std=0.5", "std=-1", "drift=0.1", "drift=0", "budget=5"]),
)
ARM_STROKES: Final = strokes(_ARM_EDITS)
