from __future__ import annotations

import asyncio
import gc
import sys
import threading
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from recipes import bandit, recipe, replay

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Apply, Pause, Play, Restart, RunEpisode, SetSpeed, Step, Train
from rl_tui.live.pace.interpreter import SWITCH_INTERVAL, USUAL_SWITCH_INTERVAL
from rl_tui.live.playback import Playback
from rl_tui.live.player import Player, PlayerClosedError
from rl_tui.live.record import Record
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import SetParameter
from rl_tui.runs.timeline.branches import Branch, RunRecord


async def until(player: Player, phase: Phase) -> Snapshot:
    async for snapshot in player.snapshots():
        if snapshot.playback.phase is phase:
            return snapshot
    raise AssertionError("the player was closed")


async def test_the_first_snapshot_shows_the_world_and_then_the_run_stands_ready() -> None:
    player = Player(recipe("student"))
    phases = []
    async for snapshot in player.snapshots():
        phases.append(snapshot.playback.phase)
        if snapshot.playback.phase is Phase.PAUSED:
            player.close()
    assert phases == [Phase.PREPARING, Phase.PAUSED]


async def test_commands_are_carried_out_in_order() -> None:
    player = Player(recipe("student"), automatic=False)
    for command in (Train(1000), Apply(SetParameter("alpha", 0.5)), Step(), Step(), RunEpisode()):
        player.send(command)
    snapshot = await player.carried_out()
    player.close()
    assert snapshot.agent.hyperparameters.alpha == 0.5
    assert snapshot.playback.phase is Phase.PAUSED
    assert snapshot.counters.episode_step == 0
    assert snapshot.counters.last_step.terminated or snapshot.counters.last_step.truncated
    assert snapshot.playback.steps_per_second is None


async def test_what_is_known_already_is_not_made_again() -> None:
    player = Player(recipe("student"), automatic=False)
    player.send(Step())
    first = await player.carried_out()
    assert await player.carried_out() is first
    snapshots = player.snapshots()
    assert (await anext(snapshots)).counters.step == 1
    player.send(Step())
    assert (await player.carried_out()).counters.step == 2
    player.close()


async def test_what_happens_on_screen_is_what_a_replay_gives() -> None:
    player = Player(recipe("frozenlake-slippery"), speed=None)
    player.send(Play())
    seen = 0
    async for snapshot in player.snapshots():
        assert snapshot.counters.step >= seen
        seen = snapshot.counters.step
        if seen > 300_000:
            break
    player.send(Pause())
    snapshot = await player.carried_out()
    player.close()
    straight = replay(snapshot.recipe, (), snapshot.counters.step)
    assert snapshot.agent.q.tobytes() == straight.learner.q.tobytes()
    assert snapshot.results.curve.return_mean.tobytes() == straight.history.curve().return_mean.tobytes()
    assert (
        snapshot.results.marks.expected_return.tobytes() == straight.results.marks.expected_return.tobytes()
    )


class Kept:
    def __init__(self) -> None:
        self.steps: list[int] = []
        self.left_at: list[int] = []

    def offer(self, record: Record, table: Any = None) -> None:
        self.steps.append(record.lanes[0].step)

    def begin_anew(self, record: Record) -> None:
        assert record.lanes[0].step == 0
        self.left_at.append(self.steps[-1])

    def close(self) -> None:
        pass


async def test_the_last_steps_before_a_restart_are_kept() -> None:
    sink = Kept()
    player = Player(recipe("student"), speed=None, clock=lambda: 0.0, record_sink=sink)
    player.send(Play())
    seen = 0
    async for snapshot in player.snapshots():
        seen = snapshot.counters.step
        if seen > 1_000:
            break
    player.send(Restart(recipe("student")))
    await player.carried_out()
    player.close()
    assert sink.left_at[0] >= seen


async def test_a_reader_that_sleeps_gets_the_newest_and_not_the_backlog() -> None:
    player = Player(recipe("student"), automatic=False)
    reader = player.snapshots()
    await anext(reader)
    player.send(Train(10))
    player.send(Train(10))
    last = await player.carried_out()
    steps = []
    async for snapshot in reader:
        steps.append(snapshot.counters.step)
        if snapshot.counters.step == last.counters.step == 20:
            break
    player.close()
    assert len(steps) <= 2


async def test_where_nothing_depends_on_the_time_a_resumed_run_is_shown_where_it_stood_only() -> None:
    branch = Branch("branch 1", (), end=2_000, here=2_000)
    lanes = tuple(RunRecord(recipe("cliff", epsilon=epsilon), (branch,)) for epsilon in (0.1, 0.5))
    clock = count(0.0, 0.004)  # time passes with every look, so that no seek finishes at once
    player = Player(lanes[0].recipe, automatic=False, clock=lambda: next(clock), record=Record(lanes))
    steps = []
    async for snapshot in player.snapshots():
        steps += [snapshot.counters.step, *(lane.step for lane in snapshot.run_group.lanes)]
        if snapshot.playback.phase is Phase.PAUSED:
            break
    player.close()
    assert set(steps) <= {0, 2_000}


async def test_a_spent_budget_is_published() -> None:
    player = Player(bandit(5000), speed=None)
    player.send(Play())
    snapshot = await until(player, Phase.SPENT)
    player.close()
    assert snapshot.results.bandit.pulls == 5000


async def test_a_world_that_cannot_be_built_reaches_the_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = recipe("student")

    def build(self: object, generator: object) -> None:
        raise UserError("no such world")

    monkeypatch.setattr(type(broken.scenario), "build", build)
    player = Player(broken)
    with pytest.raises(UserError, match="no such world"):
        await anext(player.snapshots())
    with pytest.raises(UserError, match="no such world"):
        await player.carried_out()
    with pytest.raises(UserError, match="no such world"):
        await anext(player.snapshots())
    player.close()


async def test_an_unexpected_error_in_the_thread_is_not_lost() -> None:
    player = Player(replace(recipe("student"), algorithm="no such algorithm"))
    with pytest.raises(ValueError, match="no algorithm no such algorithm"):
        await player.carried_out()
    with pytest.raises(ValueError, match="no algorithm no such algorithm"):
        await until(player, Phase.PAUSED)
    player.close()


async def test_whoever_asks_for_the_end_of_an_episode_does_not_blind_the_reader(tmp_path: Path) -> None:
    endless = tmp_path / "endless.toml"
    endless.write_text(
        '[mdp]\nstart = "A"\n[[mdp.transition]]\nstate = "A"\naction = "on"\nreward = 0\nto = "A"\n'
    )
    player = Player(recipe(str(endless)), speed=None)
    player.send(RunEpisode())
    waiting = asyncio.create_task(player.carried_out())
    await asyncio.sleep(0)
    async for snapshot in player.snapshots():
        if snapshot.counters.step > 0:
            player.close()
    with pytest.raises(PlayerClosedError):
        await waiting


async def test_whoever_sends_without_end_does_not_blind_the_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    player = Player(recipe("student"))
    await player.carried_out()
    work, gammas = Playback.work, iter(range(1_000_000))

    def work_and_be_sent_more(playback: Playback) -> float | None:
        wait = work(playback)
        player.send(Apply(SetParameter("gamma", next(gammas) / 1_000_000)))
        return wait

    monkeypatch.setattr(Playback, "work", work_and_be_sent_more)
    player.send(SetSpeed(None))
    pictures = 0
    async for snapshot in player.snapshots():
        pictures += snapshot.agent.hyperparameters.gamma < 0.9
        if pictures == 3:
            player.close()
    assert pictures == 3


async def test_closing_in_the_middle_of_full_speed_ends_the_thread_and_the_reader() -> None:
    player = Player(recipe("frozenlake-slippery"), speed=None)
    player.send(Play())
    async for snapshot in player.snapshots():
        if snapshot.counters.step > 0:
            player.close()
    assert not any(thread.name == "player" for thread in threading.enumerate())
    with pytest.raises(PlayerClosedError):
        await player.carried_out()


async def test_closing_wakes_a_reader_that_waits() -> None:
    player = Player(recipe("student"))
    await player.carried_out()

    async def read() -> list[Phase]:
        return [snapshot.playback.phase async for snapshot in player.snapshots()]

    reading = asyncio.create_task(read())
    await player.carried_out()
    player.close()
    assert set(await reading) <= {Phase.PREPARING, Phase.PAUSED}


async def test_closing_does_not_wait_for_a_world_that_is_being_built(monkeypatch: pytest.MonkeyPatch) -> None:
    slow = recipe("student")
    building, finish = threading.Event(), threading.Event()
    build = type(slow.scenario).build

    def slowly(self: Any, generator: Any) -> Any:
        building.set()
        finish.wait()
        return build(self, generator)

    monkeypatch.setattr(type(slow.scenario), "build", slowly)
    player = Player(slow)
    reading = asyncio.ensure_future(anext(player.snapshots(), None))
    await asyncio.to_thread(building.wait)
    player.close()
    assert await reading is None
    finish.set()


async def test_an_exact_answer_that_comes_later_is_published(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.runs.exact_answers.AT_ONCE_STATES", 0)
    player = Player(recipe("student"))
    async for snapshot in player.snapshots():
        if snapshot.exact_answer.solution is not None:
            break
    player.close()
    assert snapshot.exact_answer.solution.v[0] == pytest.approx(5.2 / 0.82)


async def test_an_exact_answer_that_comes_while_a_snapshot_is_made_is_in_the_next(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("rl_tui.runs.exact_answers.AT_ONCE_STATES", 0)
    make = Playback.snapshot

    def make_slowly(self: Playback) -> Snapshot:
        snapshot = make(self)
        for thread in threading.enumerate():
            if thread.name == "exact answers":
                thread.join()
        return snapshot

    monkeypatch.setattr(Playback, "snapshot", make_slowly)
    player = Player(recipe("student"))
    async with asyncio.timeout(60):
        async for snapshot in player.snapshots():
            if snapshot.exact_answer.solution is not None:
                break
    player.close()
    assert snapshot.exact_answer.solution is not None


async def test_speed_is_measured_while_it_runs() -> None:
    player = Player(recipe("student"), speed=1.0)
    player.send(SetSpeed(None))
    player.send(Play())
    async for snapshot in player.snapshots():
        if snapshot.playback.steps_per_second is not None:
            break
    player.close()
    assert snapshot.playback.steps_per_second > 0
    assert snapshot.playback.speed is None


@pytest.mark.usefixtures("real_collections")
async def test_while_it_plays_the_collector_is_spared_what_is_loaded() -> None:
    gc.unfreeze()
    player = Player(recipe("student"))
    await until(player, Phase.PAUSED)
    assert gc.get_freeze_count() > 10_000
    assert sys.getswitchinterval() == pytest.approx(SWITCH_INTERVAL)
    player.close()
    assert gc.get_freeze_count() < 10_000
    assert sys.getswitchinterval() == pytest.approx(USUAL_SWITCH_INTERVAL)


async def test_where_no_thread_can_be_started_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    player = Player(recipe("student"))
    monkeypatch.setattr(threading.Thread, "start", refuse)
    with pytest.raises(UserError, match="cannot start its thread: can't start new thread"):
        await anext(player.snapshots())
    player.close()


@pytest.mark.usefixtures("real_collections")
async def test_a_player_that_closes_after_the_next_has_begun_takes_nothing_from_it() -> None:
    first, second = Player(recipe("student")), Player(recipe("student"))
    for player in (first, second):
        await until(player, Phase.PAUSED)
    first.close()
    assert gc.get_freeze_count() > 10_000
    assert sys.getswitchinterval() == pytest.approx(SWITCH_INTERVAL)
    second.close()
    first.close()
    assert gc.get_freeze_count() < 10_000
    assert sys.getswitchinterval() == pytest.approx(USUAL_SWITCH_INTERVAL)
