"""Tables of maps against a plain model."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest
from grid_model import GridModel
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rl_tui.worlds.grid.section import GridSection

LETTERS = "....S#HG<>^vAXCT"


@st.composite
def random_grids(draw):
    rows, columns = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    cells = [[draw(st.sampled_from(LETTERS)) for _ in range(columns)] for _ in range(rows)]
    places = draw(st.permutations([(row, column) for row in range(rows) for column in range(columns)]))
    cells = [[letter.replace("S", ".") for letter in line] for line in cells]
    several = draw(st.integers(1, 2))
    for row, column in places[:several]:
        cells[row][column] = "S"
    assume(any("S" in line for line in cells))
    flat = [letter for line in cells for letter in line]
    jumps = len(places) > several
    if jumps:
        row, column = places[several]
        cells[row][column] = "B"
    raw = {"map": "\n".join("".join(line) for line in cells)}
    leaving = draw(st.booleans())
    raw["legend"] = {
        "A": {"kind": "floor", "reward": 10.0} | ({"jump": "B"} if jumps else {}),
        "B": {"kind": "floor", "reward": draw(st.sampled_from([0.0, -3.0]))},
        "X": {"kind": "goal", "exit": True, "reward": draw(st.floats(-9, 9))},
        "C": {"kind": "cliff", "reward": 0.0 if leaving else -100.0}
        | ({"back": True} if flat.count("S") == 1 else {}),
        "T": {"kind": "floor", "terminal": True, "reward": 0.0 if leaving else 7.0},
        "G": {"kind": "goal", "reward": 0.0 if leaving else 1.0},
    }
    raw["rewards"] = "leaving" if leaving else "entering"
    raw["step_reward"] = draw(st.sampled_from([0.0, -1.0]))
    raw["bump_reward"] = draw(st.sampled_from([0.0, -0.25]))
    raw["moves"] = draw(st.sampled_from(["four", "king", "king+stay"]))
    if raw["moves"] == "four":
        slip = draw(st.sampled_from(["none", "noise", "slippery"]))
        raw |= {"noise": {"noise": draw(st.sampled_from([0.2, 1.0]))}, "slippery": {"slippery": True}}.get(
            slip, {}
        )
    strength = st.integers(-2, 3)
    if draw(st.booleans()):
        raw["wind"] = draw(st.lists(strength, min_size=columns, max_size=columns))
    if draw(st.booleans()):
        raw["wind_rows"] = draw(st.lists(strength, min_size=rows, max_size=rows))
    raw["gusts"] = draw(st.booleans()) and any(raw.get("wind", []) + raw.get("wind_rows", []))
    return raw


def seen_from_outside(mdp, pair):
    """(happened, next number, reward, terminated) → probability, from the model."""
    chances = defaultdict(float)
    for o in mdp.outcomes_of(pair):
        key = (
            mdp.action_names[mdp.outcome_action[o]],
            int(mdp.state_names[mdp.next_state[o]]),
            round(float(mdp.reward[o]), 9),
            bool(mdp.terminated[o]),
        )
        chances[key] += float(mdp.probability[o])
    return chances


@settings(deadline=None, max_examples=300)
@given(random_grids())
@pytest.mark.slow
def test_random_maps_agree_with_the_model_cell_by_cell(raw):
    assert list(GridSection.connection_findings(raw)) == []
    world = GridSection.model_validate(raw).build(np.random.default_rng(0))
    mdp = world.mdp
    rules = {key: value for key, value in raw.items() if key not in ("map", "legend")}
    model = GridModel(raw["map"].split("\n"), raw["legend"], **rules)
    assert list(mdp.action_names) == model.actions
    open_cells = [cell for cell in model.cells() if model.is_open(cell)]
    assert list(mdp.state_names) == [str(model.number(cell)) for cell in open_cells]
    assert world.drawing.cell_of_state == tuple(model.number(cell) for cell in open_cells)
    assert [open_cells[state] for state in mdp.start_state] == model.starts
    assert mdp.start_probability == pytest.approx(np.full(len(model.starts), 1 / len(model.starts)))
    reached = model.reached()
    for state, cell in enumerate(open_cells):
        expected = [
            (action, outcomes)
            for action in model.actions
            if cell in reached and (outcomes := model.outcomes(cell, action))
        ]
        pairs = mdp.pairs_of(state)
        assert [mdp.action_names[mdp.pair_action[pair]] for pair in pairs] == [name for name, _ in expected]
        for pair, (_, outcomes) in zip(pairs, expected, strict=True):
            said = defaultdict(float)
            for (happened, number, reward, terminated), chance in outcomes.items():
                said[happened, number, round(reward, 9), terminated] += chance
            assert seen_from_outside(mdp, pair) == pytest.approx(said)
