"""What new scenarios begin as: files without a fault, and mazes and lakes that can be solved."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.agents.exact.solve import solve
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.lab.run.library import checked
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
    assert found is not None
    assert found.title == "mine"
    if template in (*BLANK, *SIZES):
        assert not refusal(found, 0)


@settings(max_examples=20)
@given(
    template=st.sampled_from([LAKE, MAZE]),
    seed=st.integers(0, 10_000),
    rows=st.integers(1, 8).map(lambda half: 2 * half + 1),
    columns=st.integers(1, 8).map(lambda half: 2 * half + 1),
)
def test_what_is_drawn_can_be_solved_and_is_the_same_for_the_same_seed(
    template: str, seed: int, rows: int, columns: int
) -> None:
    text = template_text(template, seed, rows, columns)
    assert text == template_text(template, seed, rows, columns)
    lines = tomllib.loads(text)["grid"]["map"].strip().split("\n")
    assert {len(line) for line in lines} == {columns}
    assert len(lines) == rows
    mdp = scenario(text).build(streams(0).world).mdp
    assert mdp is not None
    assert solve(mdp, 0.95).value_at_start > 0.0


@pytest.mark.parametrize(
    ("template", "size", "fault"),
    [
        (MAZE, (8, 9), "--rows 7 or 9"),
        (LAKE, (1, 9), "expected 2 to"),
        ("grid", (3, 3), "a size of its own"),
        ("labyrinth", (None, None), "there is no template"),
    ],
)
def test_what_cannot_be_made_says_what_can(
    template: str, size: tuple[int | None, int | None], fault: str
) -> None:
    with pytest.raises(UserError, match=fault):
        template_text(template, 0, *size)
