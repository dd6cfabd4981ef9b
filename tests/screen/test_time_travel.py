"""The keys of time travel."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from seams import on_screen, playground, press, snapshot, switch, tap, train
from textual.pilot import Pilot
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.panels.arm_bars import NO_SCALE
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.last_step.last_step import LastStepPanel
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world_views import make_world_view

Moment = tuple[str, ...]
"""The text of the panels, and the bits behind it."""


def text_of(widget: Widget) -> str:
    return "\n".join(widget.render_line(y).text for y in range(widget.size.height))


def moment(pilot: Pilot[UserError]) -> Moment:
    """Return the text of newly made panels, without any old axis or scrolling."""
    board, shown = playground(pilot).board, snapshot(pilot)
    assert board.world is not None
    if shown.world.new_environment is not None:
        shown = replace(shown, trail=())  # a stepped environment has only its recorded trail
    fresh = (
        (board.world, make_world_view(shown.world, board.look)),
        (board.table, QTable(board.look)),
        (board.curve, ReturnCurve(board.look)),
        (board.query_one(LastStepPanel), LastStepPanel(board.look)),
    )
    # the axes of curve and timeline end with the branch, which was shorter then
    shown = replace(
        shown, timeline=Timeline((Branch("branch 1", end=shown.counters.step, here=shown.counters.step),))
    )
    pictures = []
    for shows, panel in fresh:
        panel.show(shown)
        pictures.append("\n".join(row.text for row in panel.picture(shown, *shows.size)))
    return (*pictures, text_of(board.query_one(LastStepPanel)), *bits(shown))


def bits(shown: Snapshot) -> tuple[str, str]:
    counters = shown.counters
    where = counters.state, counters.episodes, counters.episode_step
    learned = (
        shown.agent.q.tobytes(),
        shown.agent.visits.tobytes(),
        counters.rewards.tobytes(),
        shown.results.curve.return_mean.tobytes(),
    )
    return (
        f"{where} {counters.episode_return} {counters.discounted_return} {counters.last_step}",
        f"{[part.hex() for part in learned]}",
    )


async def go(pilot: Pilot[UserError], text: str) -> Snapshot:
    await tap(pilot, "m", "g", *text, "enter")
    return snapshot(pilot)


async def chosen(pilot: Pilot[UserError], planner: bool) -> None:
    if planner:
        await switch(pilot, "value-iteration")


@pytest.mark.exhaustive(
    "the other worlds and agents", but=["frozenlake-False", "bandit-False", "student-True", "cartpole-False"]
)
@pytest.mark.parametrize(
    ("scenario", "planner"),
    [
        ("frozenlake", False),
        ("book", False),
        ("student", False),
        ("bandit", False),
        ("student", True),
        ("cartpole", False),
        ("egg", False),
        ("blackjack", False),
    ],
)
async def test_every_panel_shows_what_it_showed_then(scenario: str, planner: bool, make_app: MakeApp) -> None:
    async with on_screen(make_app(scenario)) as pilot:
        await chosen(pilot, planner)
        then, begins = {0: moment(pilot)}, [0]
        for key in ("s", "s", "s", "s", "s", "e", "s", "s", "e"):
            shown = await press(pilot, key)
            then[shown.counters.step] = moment(pilot)
            if shown.counters.episode_step == 0:
                begins.append(shown.counters.step)
        end = here = snapshot(pilot).counters.step
        for key in "bbBbB":
            shown = await press(pilot, key)
            here = here - 1 if key == "b" else max(step for step in begins if step < here)
            assert (shown.counters.step, shown.playback.phase, shown.timeline.current.end) == (
                here,
                Phase.PAUSED,
                end,
            )
            # at the start of an episode, only the learned values equal those at the end of the one before
            told = slice(-1, None) if key == "B" and here else slice(None)
            assert here not in then or moment(pilot)[told] == then[here][told], (key, here)
        assert "◀ the past" in text_of(playground(pilot).query_one("#status"))
        await go(pilot, "3")
        assert moment(pilot) == then[3]
        for step in (4, 5):
            assert (await press(pilot, "s")).counters.step == step
            assert moment(pilot) == then[step]
        await go(pilot, "end")
        assert moment(pilot) == then[end]
        assert not snapshot(pilot).timeline.in_past
        assert len(snapshot(pilot).timeline.branches) == 1


async def test_a_way_back_keeps_the_axes_and_a_new_start_forgets_them(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit")) as pilot:
        await train(pilot, 60)
        board = playground(pilot).board
        arms = board.world
        assert isinstance(arms, ArmsView)
        scale = arms.scale
        assert scale != NO_SCALE
        await press(pilot, "B")
        assert arms.scale == scale
        axis = board.curve.scale
        for keys in (("m", "g", "0", "enter"), ("s",)):  # the past has nothing on the axis
            await press(pilot, *keys)
            assert board.curve.scale == axis
        await press(pilot, "r", "r")
        assert arms.scale == NO_SCALE
