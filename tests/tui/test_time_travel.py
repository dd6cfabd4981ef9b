"""The five keys of time travel on all kinds of scenarios: every panel shows what it showed then."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from seams import notes, playground, press, snapshot, switch, train
from textual.pilot import Pilot
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.curve.curve import ReturnCurve
from rl_tui.tui.panels.last_step.last_step import LastStepPanel
from rl_tui.tui.panels.q_table.q_table import QTable
from rl_tui.tui.panels.timeline.picture import timeline_form
from rl_tui.tui.panels.world.arms.arms import ArmsView
from rl_tui.tui.panels.world.arms.scale import NO_SCALE
from rl_tui.tui.panels.world.make_view import make_world_view

Moment = tuple[str, ...]
"""What the panels say, and the bits behind it."""


def text_of(widget: Widget) -> str:
    return "\n".join(widget.render_line(y).text for y in range(widget.size.height))


def moment(pilot: Pilot[UserError]) -> Moment:
    """Return what the panels say if they are made anew, so that no axis and no scrolling is left over."""
    board, shown = playground(pilot).board, snapshot(pilot)
    assert board.world is not None
    if shown.world.new_environment is not None:
        shown = replace(shown, trail=())  # of an environment that is stepped it is what was recorded
    fresh = (
        (board.world, make_world_view(shown.world, board.look)),
        (board.table, QTable(board.look)),
        (board.curve, ReturnCurve(board.look)),
        (board.query_one(LastStepPanel), LastStepPanel(board.look)),
    )
    pictures = []
    for shows, panel in fresh:
        panel.show(shown)
        pictures.append("\n".join(row.text for row in panel.picture(shown, *shows.size)))
    return (*pictures, text_of(board.query_one(LastStepPanel)), *bits(shown))


def bits(shown: Snapshot) -> tuple[str, str]:
    """Return where the agent stands, and what was learned."""
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
    """Press g, type ``text``, and wait until that moment is on screen."""
    await pilot.press("g", *text, "enter")
    await settle(pilot)
    return snapshot(pilot)


async def chosen(pilot: Pilot[UserError], planner: bool) -> None:
    """Let a planner take over, if that is wanted."""
    if planner:
        await switch(pilot, "value-iteration")


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
    async with make_app(scenario).run_test(size=(80, 24)) as pilot:
        await settle(pilot)
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
            # where an episode begins only what was learned is as it was at the end of the one before
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


@pytest.mark.parametrize("scenario", ["frozenlake", "bandit", "cartpole"])
async def test_fast_presses_all_count(scenario: str, make_app: MakeApp) -> None:
    async with make_app(scenario).run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await pilot.press(*"ssssssss")
        await settle(pilot)
        now = snapshot(pilot)
        assert now.counters.step == 8
        await pilot.press(*"bbbbb")
        await settle(pilot)
        assert snapshot(pilot).counters.step == 3
        await pilot.press(*"sssss")
        await settle(pilot)
        assert bits(snapshot(pilot)) == bits(now)


async def test_a_change_in_the_past_forks_and_j_goes_back(make_app: MakeApp) -> None:
    app = make_app("student")
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await settle(pilot)
        await train(pilot, 300)
        first = moment(pilot)
        await go(pilot, "200")
        app.screen.query_one("#alpha", Slider).focus()
        await press(pilot, "right")
        forked = await train(pilot, 100)
        assert forked.timeline.branch == 1
        assert forked.timeline.current.fork == 200
        assert notes(app) == ["branch 2 begins here; j goes back to branch 1"]
        assert "branch 2  step 300" in text_of(playground(pilot).board.timeline)
        second, changed = moment(pilot), forked.agent.hyperparameters.alpha
        assert second != first
        await press(pilot, "j", "up", "enter")
        await go(pilot, "end")
        assert moment(pilot) == first
        assert app.screen.query_one("#alpha", Slider).value == 0.1
        assert playground(pilot).recipe.hyperparameters.alpha == 0.1
        await press(pilot, "j", "down", "enter")
        assert moment(pilot) == second
        assert app.screen.query_one("#alpha", Slider).value == changed
        assert playground(pilot).recipe.hyperparameters.alpha == changed
        await press(pilot, "j", "tab", "enter")
        assert snapshot(pilot).counters.step == 200
        assert notes(app) == []


async def test_settings_of_then_are_in_force_then(make_app: MakeApp) -> None:
    app = make_app("student")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await train(pilot, 50)
        await press(pilot, "t")
        await train(pilot, 50)
        await switch(pilot, "sarsa")
        await train(pilot, 50)
        for step, ties, algorithm in (
            (40, "random", "q-learning"),
            (60, "first", "q-learning"),
            (120, "first", "sarsa"),
            (10, "random", "q-learning"),
        ):
            shown = await go(pilot, str(step))
            assert (shown.agent.hyperparameters.ties, shown.agent.algorithm) == (ties, algorithm)
            recipe = playground(pilot).recipe
            assert (recipe.hyperparameters.ties, recipe.algorithm) == (ties, algorithm)
        again = await press(pilot, "r")
        assert (again.counters.step, again.agent.hyperparameters.ties, again.agent.algorithm) == (
            0,
            "random",
            "q-learning",
        )


async def test_the_timeline_is_dragged_through_time(make_app: MakeApp) -> None:
    async with make_app("student").run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        now = await train(pilot, 1_000)
        bar = playground(pilot).board.timeline
        track = timeline_form(now.timeline, bar.size.width).track
        await pilot.mouse_down(bar, offset=(track.start + 20, 0))
        await pilot.hover(bar, offset=(track.start + 5, 0))
        await pilot.mouse_up(bar, offset=(track.start + 5, 0))
        await settle(pilot)
        shown = snapshot(pilot)
        assert shown.counters.step == track.step_at(5)
        assert bar.at == shown.counters.step
        await pilot.press("end")
        await settle(pilot)
        assert bits(snapshot(pilot)) == bits(now)
        assert bar.at == 1_000


async def test_a_way_back_keeps_the_axes_and_a_new_start_forgets_them(make_app: MakeApp) -> None:
    async with make_app("bandit").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await train(pilot, 50)
        arms = playground(pilot).board.world
        assert isinstance(arms, ArmsView)
        scale = arms.scale
        assert scale != NO_SCALE
        await press(pilot, "B")
        assert arms.scale == scale
        await press(pilot, "r")
        assert arms.scale == NO_SCALE


async def test_the_axis_stays_where_the_past_has_nothing_on_it(make_app: MakeApp) -> None:
    async with make_app("bandit").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await train(pilot, 60)
        curve = playground(pilot).board.curve
        before = curve.scale
        for keys in (("g", "0", "enter"), ("s",)):
            await press(pilot, *keys)
            assert curve.scale == before
