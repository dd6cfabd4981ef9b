"""Templates of new scenarios."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rl_tui.agents.exact.solve import best_expected_return, shortest_way
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.runs.library import checked
from rl_tui.worlds.editing.drafts import refusal
from rl_tui.worlds.editing.templates import BLANK, LAKE, MAZE, SIZES, named, template_text
from rl_tui.worlds.files.scenario import Scenario, scenario_of
from rl_tui.worlds.files.shipped import shipped_names

pytestmark = pytest.mark.unit


def scenario(text: str) -> Scenario:
    return scenario_of(text, Path("mine.toml"))


@pytest.mark.parametrize("template", [*BLANK, *SIZES, *shipped_names()])
def test_every_template_is_a_scenario_without_a_fault(template: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(named(template_text(template), "mine"), encoding="utf-8")
    found, faults = checked(path)
    assert not faults
    assert found.title == "mine"
    if template in (*BLANK, *SIZES):
        assert not refusal(found, 0)


@settings(max_examples=20, deadline=None)
@given(
    template=st.sampled_from([LAKE, MAZE]),
    seed=st.integers(0, 10_000),
    rows=st.integers(1, 60),
    columns=st.integers(1, 60),
)
@example(template=LAKE, seed=0, rows=1, columns=2)
@example(template=LAKE, seed=0, rows=60, columns=1)
@example(template=LAKE, seed=1, rows=60, columns=60)
@example(template=MAZE, seed=0, rows=1, columns=3)
def test_what_is_drawn_can_be_solved_and_is_the_same_for_the_same_seed(
    template: str, seed: int, rows: int, columns: int
) -> None:
    if rows * columns < 2:
        columns = 2
    if template == MAZE:
        rows, columns = rows + (rows + 1) % 2, columns + (columns + 1) % 2
    text = template_text(template, seed, rows, columns)
    assert text == template_text(template, seed, rows, columns)
    lines = tomllib.loads(text)["grid"]["map"].strip().split("\n")
    assert {len(line) for line in lines} == {columns}
    assert len(lines) == rows
    found = scenario(text)
    assert not refusal(found, 0)
    mdp = found.build(streams(0).world).mdp
    way = shortest_way(mdp, np.ones(mdp.pairs, dtype=np.bool_))
    assert way is not None
    assert way <= mdp.time_limit
    assert mdp.reward[mdp.terminated].max() == 1.0, "it is the goal, not a hole alone"
    assert best_expected_return(mdp) == 1.0


@pytest.mark.parametrize(
    ("template", "size", "fault"),
    [
        (MAZE, (8, 9), "--rows 7 or 9"),
        (MAZE, (200, 9), "--rows 199, not 200"),
        (LAKE, (1, 1), "expected 2 cells"),
        (LAKE, (201, 9), "at most 200 rows"),
        ("grid", (3, 3), "has a fixed size"),
        ("labyrinth", (None, None), "there is no template"),
    ],
)
def test_what_cannot_be_made_says_what_can(
    template: str, size: tuple[int | None, int | None], fault: str
) -> None:
    with pytest.raises(UserError, match=fault):
        template_text(template, 0, *size)
