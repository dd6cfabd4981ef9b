"""Motion on a map after a step."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import pytest
from drawn_grids import style_at
from program_samples import unknown, watched
from rich.color import Color
from rich.style import Style
from samples import lake, learned_from, look
from seams import on_screen, order, playground, press, show, snapshot, train
from snapshots import changed
from textual.pilot import Pilot
from textual.strip import Strip

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddLane, Step, StepBack
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import SetParameter
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.map import GridMap
from rl_tui.screen.panels.grid.motion import Motion, Mover, motion_between
from rl_tui.screen.theme.roles import readable
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.files.catalogue import find

LEFT, DOWN, RIGHT, UP = range(4)
WIDTH, HEIGHT = 14, 3  # of a cell
CHANGES, LAST = 3, 9  # the ticks of the value's change, and of the end of all motion


# The picture at each tick


def pair_at(moment: Snapshot, state: int, action: int) -> int:
    return moment.world.space.pairs_of(state).start + action


def learned(**q: float) -> Snapshot:
    """A learned lake. ``s9=.4`` is the estimate of going down in state 9, ``.1`` of its other actions."""
    moment = changed(lake(), phase=Phase.PAUSED)
    values = moment.agent.q.copy()
    for name, value in q.items():
        own = moment.world.space.pairs_of(int(name[1:]))
        values[own.start : own.stop] = 0.1
        values[own.start + DOWN] = value
    return changed(moment, q=values)


def after(before: Snapshot, state: int, action: int, next_state: int, **terms: Any) -> Snapshot:
    last, pair = before.counters.last_step, pair_at(before, state, action)
    assert last is not None
    usual = {"state": state, "pair": pair, "updated_pair": pair, "next_state": next_state, "reward": 0.0}
    usual |= {"gathered": 0.0, "bootstrap": 0.5, "terminated": False, "step_size": 0.5, "others": 0}
    usual |= {"before": float(before.agent.q[pair])}
    last = learned_from(replace(last, step=last.step + 1), **(usual | terms))
    q = before.agent.q.copy()
    if last.learned:
        q[last.updated_pair] = last.after
    return changed(before, step=before.counters.step + 1, state=next_state, q=q, last_step=last)


def between(before: Snapshot, now: Snapshot, pace: float = 0.0) -> Motion | None:
    grid = before.world.drawing
    assert isinstance(grid, Grid)
    return motion_between(before, now, GridMap(before.world.space, grid), pace)


def moved(before: Snapshot, now: Snapshot, pace: float = 0.0) -> Motion:
    motion = between(before, now, pace)
    assert motion is not None
    return motion


def drawn(now: Snapshot, motion: Motion | None, tick: int = 0, depth: str = "truecolor") -> list[Strip]:
    view = GridView(now.world, look(depth=depth))
    view.mover.motion = motion and motion._replace(tick=tick)
    return view.picture(now, 4 * WIDTH, 4 * HEIGHT)


def style_of(rows: list[Strip], y: int, x: int) -> Style:
    style = style_at(rows[y], x)
    assert style is not None
    return style


def number(rows: list[Strip], cell: int) -> str:
    row, column = divmod(cell, 4)
    return rows[row * HEIGHT + HEIGHT - 1].text[column * WIDTH :][:WIDTH].strip("▌▐▕ ")


def frame(rows: list[Strip], cell: int) -> Color | None:
    row, column = divmod(cell, 4)
    y, x = row * HEIGHT + 1, column * WIDTH
    return style_of(rows, y, x).color if rows[y].text[x] == "▌" else None


def arrow(rows: list[Strip], cell: int) -> Color | None:
    row, column = divmod(cell, 4)
    return style_of(rows, row * HEIGHT + 1, column * WIDTH + 6).color


def chip(rows: list[Strip], text: str) -> tuple[int, int] | None:
    found = [(y, each.text.index(text)) for y, each in enumerate(rows) if text in each.text]
    assert len(found) < 2
    return found[0] if found else None


@pytest.mark.parametrize(
    ("state", "action", "next_state", "text", "ways"),
    [
        (9, RIGHT, 10, "◀.57", [(7, 32), (7, 25), (7, 18)]),
        (9, LEFT, 8, ".57▶", [(7, 4), (7, 11), (7, 18)]),
        (9, DOWN, 13, "▲.57", [(10, 18), (9, 18), (7, 18)]),
        (4, UP, 0, "▼.57", [(1, 4), (3, 4), (4, 4)]),
    ],
)
def test_the_estimate_of_a_neighbour_travels_over_the_seam_into_the_updated_cell(
    state: int, action: int, next_state: int, text: str, ways: list[tuple[int, int]]
) -> None:
    before = learned()
    now = after(before, state, action, next_state, bootstrap=0.57)
    motion = moved(before, now)
    pictures = [drawn(now, motion, tick) for tick in range(LAST + 1)]
    assert [chip(rows, text) for rows in pictures] == [*ways, *[None] * (LAST + 1 - CHANGES)]
    assert style_of(pictures[1], *ways[1]).bgcolor == look().palette.source.bgcolor
    assert {strip.cell_length for rows in pictures for strip in rows} == {4 * WIDTH}


def test_until_it_has_arrived_the_cell_has_its_value_and_its_arrow_and_no_frame() -> None:
    before = learned(s9=0.4)
    now = after(before, 9, DOWN, 13, bootstrap=1.0, discount=1.0)
    motion, still = moved(before, now), drawn(before, None)
    for tick in range(CHANGES):
        rows = drawn(now, motion, tick)
        assert (number(rows, 9), frame(rows, 9), arrow(rows, 9)) == (".40", None, arrow(still, 9))
    rows = drawn(now, motion, CHANGES)
    assert (number(rows, 9), frame(rows, 9) is None) == (".70", False)


@pytest.mark.parametrize(("bootstrap", "role"), [(0.9, "good"), (0.0, "bad")])
def test_the_frame_fades_in_three_steps_and_stays_pale(bootstrap: float, role: str) -> None:
    before = learned(s9=0.4)
    now = after(before, 9, DOWN, 13, bootstrap=bootstrap)
    motion = moved(before, now)
    colours = [frame(drawn(now, motion, tick), 9) for tick in range(CHANGES, LAST + 3)]
    value = style_of(drawn(now, None), 3 * HEIGHT - 1, WIDTH + 6)
    assert colours[0] == readable(getattr(look().palette, role), value).color
    assert len(set(colours)) == 4
    assert colours[LAST - CHANGES :] == [colours[-1]] * 3
    assert None not in colours
    assert [motion._replace(tick=tick).is_over for tick in (LAST - 1, LAST)] == [False, True]
    assert motion.at_rest.tick == LAST


def test_an_arrow_that_turned_is_yours_for_four_ticks() -> None:
    before = learned(s9=0.4)
    turns = after(before, 9, RIGHT, 10, bootstrap=2.0)
    motion, ink = moved(before, turns), look().palette.you.color
    seen = [arrow(drawn(turns, motion, tick), 9) == ink for tick in range(LAST + 1)]
    assert seen == [False] * 3 + [True] * 4 + [False] * 3
    stays = after(before, 9, DOWN, 13, bootstrap=2.0)
    motion = moved(before, stays)
    assert not any(arrow(drawn(stays, motion, tick), 9) == ink for tick in range(LAST + 1))


@pytest.mark.parametrize(("reward", "text", "role"), [(1.0, "◀+1", "goal"), (0.0, "◀0", "source")])
def test_at_the_end_of_an_episode_the_reward_travels(reward: float, text: str, role: str) -> None:
    before = learned()
    now = after(before, 14, RIGHT, 15, terminated=True, reward=reward, gathered=reward, bootstrap=0.0)
    rows = drawn(now, moved(before, now), 1)
    found = chip(rows, text)
    assert found is not None
    assert style_of(rows, *found).bgcolor == getattr(look().palette, role).bgcolor


@pytest.mark.parametrize(("next_state", "text"), [(9, "◀.57"), (1, "▼.57"), (3, "↙.57")])
def test_what_comes_from_no_neighbour_appears_in_the_cell_at_once(next_state: int, text: str) -> None:
    before = learned()
    now = after(before, 9, LEFT, next_state, bootstrap=0.57)
    motion = moved(before, now)
    assert [chip(drawn(now, motion, tick), text) for tick in range(CHANGES + 1)] == [(7, 18)] * 3 + [None]


@pytest.mark.parametrize(
    "terms", [{"others": 3}, {"updated_pair": 2}, {"pair": -1}, {"bootstrap": float("nan"), "step_size": 0.0}]
)
def test_updates_of_another_kind_only_flash(terms: dict[str, Any]) -> None:
    before = learned()
    now = after(before, 9, RIGHT, 10, **terms)
    motion = moved(before, now)
    assert (motion.chip, motion.path) == (None, ())
    several = replace(before, agent=replace(before.agent, algorithm="n-step-sarsa"))
    now = after(several, 9, RIGHT, 10)
    assert moved(several, now).chip is None


@pytest.mark.parametrize(("pace", "ticks"), [(6.0, 3), (7.0, 1), (15.0, 1), (16.0, 0), (30.0, 0)])
def test_the_faster_steps_come_the_less_travels(pace: float, ticks: int) -> None:
    before = learned()
    now = after(before, 9, RIGHT, 10, bootstrap=0.57)
    motion = moved(before, now, pace)
    pictures = [drawn(now, motion, tick) for tick in range(LAST)]
    assert [chip(rows, "◀.57") is not None for rows in pictures] == [True] * ticks + [False] * (LAST - ticks)
    waits = [frame(rows, 9) is None for rows in pictures]
    assert waits == [ticks == 3] * 3 + [False] * (LAST - 3)


def test_a_step_of_a_program_moves_like_one_of_ours_if_its_update_is_known() -> None:
    before = watched()
    assert moved(before, after(before, 9, RIGHT, 10)).chip is not None
    before = unknown()
    assert moved(before, after(before, 9, RIGHT, 10)).chip is None


def test_nothing_moves_but_by_the_next_step_of_the_same_run_that_can_be_followed() -> None:
    before = learned()
    now = after(before, 9, RIGHT, 10)
    later = changed(now, step=now.counters.step + 1)
    fast = changed(now, phase=Phase.RUNNING, speed=None)
    unlearned = after(before, 9, RIGHT, 10, updated_pair=-1)
    other_run = replace(now, recipe=replace(now.recipe, seed=1))
    other_lane = changed(now, shown=1)
    for moment in (later, fast, unlearned, other_run, other_lane, before):
        assert between(before, moment) is None
    assert between(now, before) is None


def test_without_shades_the_frame_stays_as_it_is() -> None:
    before = learned(s9=0.4)
    now = after(before, 9, DOWN, 13, bootstrap=0.9)
    motion = moved(before, now)
    colours = {frame(drawn(now, motion, tick, depth="16"), 9) for tick in (CHANGES, LAST)}
    assert colours == {look(depth="16").palette.good.color}


# On the screen


def app_of(scenario: str = "cliff", *, ticks: float | None = 0.001, **display: Any) -> RlTuiApp:
    """An app with motion at the ticks that a test requests. A timer would take minutes."""
    options = Display(**{"fps": 1000.0, **display})
    app = RlTuiApp(
        options, recipe_for(find(scenario), {}, 0), make_player=partial(Player, automatic=False), picture=True
    )
    app.ticks = app.ticks if ticks is None else ticks
    return app


def mover(pilot: Pilot[UserError], panel: str = "world") -> Mover:
    return pilot.app.screen.query_one(f"#{panel}", GridView).mover


def rows_of(pilot: Pilot[UserError]) -> list[str]:
    view = pilot.app.screen.query_one("#world", GridView)
    return [repr(view.render_line(y)) for y in range(view.size.height)]


async def test_a_step_moves_the_map_until_the_timer_stops() -> None:
    async with on_screen(app_of(), (120, 40)) as pilot:
        await train(pilot, 300)
        assert not mover(pilot).is_running
        await press(pilot, "s")
        moving, pictures = mover(pilot), [rows_of(pilot)]
        for _ in range(LAST):
            assert moving.is_running
            moving.tick()
            pictures.append(rows_of(pilot))
        assert not moving.is_running
        assert moving.motion is not None
        assert moving.motion.is_over
        assert len({tuple(rows) for rows in pictures}) == CHANGES + 4
        await press(pilot, "s")
        assert moving.motion.tick == 0
        await press(pilot, "b")
        assert rows_of(pilot) == pictures[-1], "a moment at rest has one picture however it is reached"


async def test_the_faster_a_run_is_and_the_faster_keys_follow_one_another_the_less_travels() -> None:
    app = app_of()
    async with on_screen(app, (120, 40)) as pilot:
        await train(pilot, 300)

        def way() -> int:
            motion = mover(pilot).motion
            assert motion is not None
            return len(motion.path)

        for speed, ticks in ((5.0, 3), (10.0, 1), (20.0, 0)):
            await press(pilot, "s")
            following = snapshot(pilot)
            await order(pilot, StepBack())
            show(playground(pilot), changed(following, phase=Phase.RUNNING, speed=speed))
            assert way() == ticks, speed
            await settle(pilot)
        for since, ticks in ((0, 0), (1, 1), (2, 1), (3, 3), (LAST, 3)):
            app.ticks = 0.001
            await press(pilot, "s")
            for _ in range(since):
                mover(pilot).tick()
            app.ticks = 15.0
            await press(pilot, "s")
            assert way() == ticks, since
            for _ in range(2):
                await order(pilot, StepBack())


async def test_a_picture_drawn_again_goes_on_a_step_back_does_not_move_and_a_slow_terminal_ends_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with on_screen(app_of(), (120, 40)) as pilot:
        await train(pilot, 300)
        await press(pilot, "s")
        moving = mover(pilot)
        moving.tick()
        playground(pilot).redraw()
        assert moving.motion is not None
        assert moving.motion.tick == 1
        await order(pilot, StepBack())
        assert not moving.is_running
        assert moving.motion.is_over
        moving.tick()
        await press(pilot, "s")
        assert moving.is_running
        monkeypatch.setattr(RlTuiApp, "keeps_up", False)
        moving.tick()
        assert moving.motion is not None
        assert (moving.motion.is_over, moving.is_running) == (True, False)
        await press(pilot, "s")
        assert moving.motion is None


@pytest.mark.parametrize(
    ("options", "views"),
    [
        ({"ascii": True}, ("",)),
        ({"colors": "none"}, ("",)),
        ({"ticks": None}, ("",)),
        ({}, ("w d", "escape w a", "w a v")),
        ({"scenario": "taxi"}, ("",)),
    ],
)
async def test_nothing_moves(options: dict[str, Any], views: tuple[str, ...]) -> None:
    async with on_screen(app_of(**options), (80, 24)) as pilot:
        await train(pilot, 300)
        for keys in views:
            await press(pilot, *keys.split())
            before = snapshot(pilot).counters.step
            await order(pilot, Step())
            assert snapshot(pilot).counters.step == before + 1
            assert (mover(pilot).motion, mover(pilot).is_running) == (None, False), keys


@pytest.mark.parametrize(
    ("display", "ticks"),
    [
        ({}, 15.0),
        ({"fps": 12.0}, 12.0),
        ({"fps": 60.0}, 15.0),
        ({"fps": 5.0}, 0.0),
        ({"reduced_motion": True}, 0.0),
    ],
)
def test_options_say_whether_pictures_move(display: dict[str, Any], ticks: float) -> None:
    assert RlTuiApp(Display(**display)).ticks == ticks
    assert RlTuiApp(Display(**display), picture=True).ticks == 0.0


async def test_each_of_two_lanes_moves_for_itself() -> None:
    async with on_screen(app_of(), (160, 50)) as pilot:
        await train(pilot, 300)
        await order(pilot, AddLane((SetParameter("alpha", 0.5),)))
        await press(pilot, "s")
        left, right = mover(pilot), mover(pilot, "world-beside")
        assert left.motion is not None
        assert right.motion is not None
        left.tick()
        assert (left.motion.tick, right.motion.tick) == (1, 0)
