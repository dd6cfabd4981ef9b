"""The screen shows one episode number at a time."""

from __future__ import annotations

import re

import pytest
from conftest import MakeApp
from seams import notes, on_screen, playground, press, screen_text, snapshot, switch, tap, train
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.screen.kit.row import MICROSCOPE
from rl_tui.screen.panels.microscope.microscope import ENDED
from rl_tui.worlds.drawing import CellKind, Grid

_NUMBERED = re.compile(r"\b(?:ep|episode|sweep) +([\d,]*\d)(?!\d| +[━●★◆])")  # not the first of the axis


def numbers_of(pilot: Pilot[UserError]) -> set[str]:
    return set(_NUMBERED.findall(screen_text(pilot.app)))


@pytest.mark.parametrize("size", [pytest.param((80, 24), marks=pytest.mark.exhaustive("a size")), (120, 40)])
async def test_every_step_of_an_episode_and_its_end_and_where_one_goes_to_it(
    size: tuple[int, int], make_app: MakeApp
) -> None:
    async with on_screen(make_app("frozenlake"), size, notifications=True) as pilot:
        for expected in ("1", "2", "3"):
            while snapshot(pilot).counters.episodes < int(expected):
                await press(pilot, "s")
                assert numbers_of(pilot) == {expected}
        await train(pilot, 200)
        await press(pilot, "b", "m", "g")
        await tap(pilot, *"e999", "enter")  # an episode beyond the end
        end = snapshot(pilot).timeline.current.end
        assert snapshot(pilot).counters.step == end
        assert [f"step {end}" in note and "space" in note for note in notes(pilot.app)] == [True]
        await press(pilot, "m", "g")
        await tap(pilot, *"e12", "enter")
        assert notes(pilot.app) == []
        assert numbers_of(pilot) == {"12"}
        await press(pilot, "d")
        assert playground(pilot).board.opened == MICROSCOPE
        assert ENDED in screen_text(pilot.app)
        assert numbers_of(pilot) == {"12"}
        await press(pilot, "s")
        assert numbers_of(pilot) == {"12"}


async def test_an_episode_given_up_the_first_reward_and_sweeps_of_a_planner_have_one_number_everywhere(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        await press(pilot, "s", "s", "s")
        await switch(pilot, "value-iteration")
        await switch(pilot, "q-learning")
        assert numbers_of(pilot) == {"1"}
        await press(pilot, "r", "r", "u", "enter")  # until the next reward, which ends the episode
        assert numbers_of(pilot) == {"247"}
        now = snapshot(pilot)
        assert now.counters.episodes == 247
        assert isinstance(now.world.drawing, Grid)
        assert now.world.drawing.kinds[now.counters.state] is CellKind.GOAL
        await press(pilot, "B")
        assert numbers_of(pilot) == {"247"}
        began = snapshot(pilot).counters
        assert (began.state, began.step_from, began.episodes) == (0, 0, 246)
        await press(pilot, "B")
        assert numbers_of(pilot) == {"246"}
        await switch(pilot, "value-iteration")
        seen = set()
        for _ in range(12):  # a sweep is 11 steps
            await press(pilot, "s")
            assert len(numbers_of(pilot)) == 1
            seen.add("end of a sweep" in screen_text(pilot.app))
        assert seen == {True, False}
