"""Well-known worlds, drawn with keys or mouse."""

from __future__ import annotations

import pytest
from drawing_hands import Hands, Keys, Mouse, app_of_template, map_drawn, plan_of
from seams import on_screen, playground, press, snapshot
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.digest import table_digest

pytestmark = pytest.mark.screen

SCENARIOS = ("karpathy", "book", "bridge", "discount", "maze-188")


def digest(pilot: Pilot[UserError]) -> str:
    mdp = snapshot(pilot).world.mdp
    assert mdp is not None
    return table_digest(mdp)


def digest_of(scenario: str) -> str:
    mdp = find(scenario).build(streams(0).world).mdp
    assert mdp is not None
    return table_digest(mdp)


@pytest.mark.exhaustive("draws whole maps cell by cell")
@pytest.mark.parametrize("hands", [Keys, Mouse])
@pytest.mark.parametrize("scenario", SCENARIOS)
async def test_a_known_map_is_drawn_from_a_blank_one(scenario: str, hands: type[Hands]) -> None:
    async with on_screen(app_of_template("grid"), (120, 40)) as pilot:
        await hands(pilot).draw(plan_of(scenario))
        assert digest(pilot) == digest_of(scenario), map_drawn(pilot).table


async def type_lines(pilot: Pilot[UserError], *texts: str) -> None:
    for text in texts:
        await press(pilot, *("space" if each == " " else each for each in text), "enter")


async def go_to(pilot: Pilot[UserError], state: str) -> None:
    names = snapshot(pilot).world.space.state_names
    view = playground(pilot).board.world
    assert view.cursor is not None
    await press(pilot, *["comma"] * ((names.index(state) - view.cursor) % len(names)))


async def set_action(pilot: Pilot[UserError], state: str, action: str, does: str) -> None:
    await go_to(pilot, state)
    await press(pilot, "enter", "end", "enter")
    await type_lines(pilot, action, does)


@pytest.mark.exhaustive("draws a whole graph key by key")
async def test_the_student_evening_is_drawn_from_a_blank_graph_by_keys() -> None:
    async with on_screen(app_of_template("mdp"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "down", "up")
        for source, name in (("Start", "Class"), ("Class", "Phone"), ("Class", "Pass"), ("Phone", "Sleep")):
            await go_to(pilot, source)
            await press(pilot, "w", "i")
            await type_lines(pilot, name)
        await go_to(pilot, "Class")
        await press(pilot, "S")
        for state in ("Start", "Detour"):  # this removes End too, to which nothing leads then
            await go_to(pilot, state)
            await press(pilot, "w", "d")
        await set_action(pilot, "Class", "study", "Pass 0.8, Class 0.2 pays -2")
        await set_action(pilot, "Class", "check phone", "Phone")
        await set_action(pilot, "Phone", "scroll", "Phone pays -1")
        await set_action(pilot, "Phone", "quit", "Class")
        await set_action(pilot, "Pass", "sleep", "Sleep pays 10")
        # the actions that created the states come first. Initially, one of several outcomes is selected
        await go_to(pilot, "Class")
        await press(pilot, "shift+up", "shift+up", "delete", "delete")
        await go_to(pilot, "Phone")
        await press(pilot, "delete")
        assert digest(pilot) == digest_of("student")
