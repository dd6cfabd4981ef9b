"""Environments that fail, hang or are slow."""

from __future__ import annotations

import asyncio
import itertools
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import pytest
from playing import busy

from rl_tui.live.commands import AddLane, Apply, Pause, Play, Restart, Step, StepBack
from rl_tui.live.playback import Playback
from rl_tui.live.player import Player
from rl_tui.live.sessions.autosave import Autosave, untouched
from rl_tui.live.sessions.session import sessions_in
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import JournalEntry, Recipe, SetParameter
from rl_tui.worlds.environment import EnvironmentFailedError


class Willing(gymnasium.Env[int, int]):
    """Walks up and down three states. In step ``fails_at`` of its life it fails, in ``hangs_at`` it waits."""

    observation_space = gymnasium.spaces.Discrete(3)
    action_space = gymnasium.spaces.Discrete(2)
    fails_at: ClassVar = 0
    hangs_at: ClassVar = 0
    can_be_made: ClassVar = True
    hangs: ClassVar = threading.Event()
    goes_on: ClassVar = threading.Event()

    def __init__(self) -> None:
        if not type(self).can_be_made:
            raise OSError("no more of these")
        self.fails_at = type(self).fails_at
        self.at = self.taken = 0

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[int, dict[str, Any]]:
        super().reset(seed=seed)
        self.at = 0
        return self.at, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        self.taken += 1
        if self.taken == self.fails_at:
            raise RuntimeError("out of\x1b[2J breath")
        if self.taken == type(self).hangs_at:
            self.hangs.set()
            self.goes_on.wait(60.0)
        self.at = max(0, self.at + 2 * action - 1)
        return self.at % 3, float(action), self.at == 2, False, {}


@pytest.fixture
def willing() -> Iterator[type[Willing]]:
    """A class of its own for each test."""

    class Own(Willing):
        hangs = threading.Event()
        goes_on = threading.Event()

    gymnasium.register("Willing-v0", Own)
    yield Own
    Own.goes_on.set()
    del gymnasium.registry["Willing-v0"]


def made() -> Recipe:
    return recipe_for(find("gym:Willing-v0"))


def playback_of(recipe: Recipe, speed: float | None = None) -> Playback:
    ticks = itertools.count()
    playback = Playback(
        recipe, speed=speed, automatic=True, clock=lambda: next(ticks) * 1e-4, on_exact=lambda: None
    )
    work_off(playback)
    return playback


def work_off(playback: Playback) -> Snapshot:
    for _ in range(1_000):
        if not busy(playback) and playback.phase is not Phase.RUNNING:
            return playback.snapshot()
        playback.work()
    raise AssertionError("it never stands still")


def do(playback: Playback, *commands: Any) -> Snapshot:
    for command in commands:
        while not playback.takes(command):
            playback.work()
        playback.handle(command)
    return work_off(playback)


def test_a_failure_stops_at_its_step_and_keeps_all_before(willing: type[Willing]) -> None:
    willing.fails_at = 8
    playback = playback_of(made())
    first = do(playback, Step(), Step(), Apply(SetParameter("alpha", 0.5)), Step())
    stopped = do(playback, Play())
    assert (stopped.playback.phase, stopped.counters.step) == (Phase.STOPPED, 7)
    assert (
        stopped.playback.message
        == r"at step 8 Willing-v0 failed in a step: RuntimeError: out of\u001b[2J breath"
    )
    assert stopped.agent.visits.sum() == 7
    assert first.counters.step == 3
    (lane,) = playback.record.lanes
    assert (lane.branches[0].end, lane.branches[0].here) == (7, 7)
    assert lane.branches[0].journal == (JournalEntry(2, SetParameter("alpha", 0.5)),)

    back = do(playback, StepBack(), StepBack())
    assert (back.playback.phase, back.counters.step) == (Phase.PAUSED, 5)
    again = do(playback, Play())
    assert (again.playback.phase, again.counters.step, again.playback.message) == (
        stopped.playback.phase,
        7,
        stopped.playback.message,
    )
    assert again.agent.q.tolist() == stopped.agent.q.tolist()

    anew = do(playback, Restart(playback.record.lanes[0].recipe))
    assert (anew.playback.phase, anew.counters.step, anew.playback.message) == (Phase.PAUSED, 0, "")
    assert do(playback, Play()).counters.step == 7


def test_what_fails_only_once_can_be_gone_over(willing: type[Willing]) -> None:
    willing.fails_at = 8
    playback = playback_of(made())
    assert do(playback, Play()).counters.step == 7
    willing.fails_at = 16
    assert do(playback, StepBack()).counters.step == 6
    assert do(playback, Play()).counters.step == 15


def test_a_replay_that_fails_sooner_ends_where_it_fails(willing: type[Willing]) -> None:
    willing.fails_at = 8
    playback = playback_of(made())
    assert do(playback, Play()).counters.step == 7
    willing.fails_at = 4
    back = do(playback, StepBack())
    assert (back.playback.phase, back.counters.step) == (Phase.STOPPED, 3)
    assert back.playback.message.startswith("at step 4 Willing-v0 failed")


def test_what_cannot_be_made_again_stays_where_it_is(willing: type[Willing]) -> None:
    willing.fails_at = 8
    playback = playback_of(made())
    stopped = do(playback, Play())
    willing.can_be_made = False
    refused = do(playback, StepBack())
    assert refused.counters.step == stopped.counters.step == 7
    assert refused.agent.q.tolist() == stopped.agent.q.tolist()
    assert "Willing-v0 cannot be created here" in refused.playback.message + refused.playback.paused_by
    assert "OSError: no more of these" in refused.playback.message + refused.playback.paused_by
    assert refused.playback.phase is Phase.STOPPED
    assert playback.table is not None
    (lane,) = playback.record.lanes
    assert lane.step == 7
    changed = do(playback, Apply(SetParameter("alpha", 0.25)))
    assert (changed.agent.hyperparameters.alpha, changed.counters.step) == (0.25, 7)
    with pytest.raises(EnvironmentFailedError, match="no more of these"):
        do(playback, Restart(playback.record.lanes[0].recipe))


def test_beside_others_only_what_failed_stands(willing: type[Willing]) -> None:
    willing.fails_at = 8
    playback = playback_of(made())
    do(playback, Step(), AddLane((SetParameter("alpha", 0.9),)))
    stopped = do(playback, Play())
    assert (stopped.playback.phase, stopped.counters.step) == (Phase.STOPPED, 7)
    assert [lane.step for lane in stopped.run_group.lanes] == [7, 7]


async def test_a_player_stays_open_while_an_environment_does_not_answer(
    willing: type[Willing], tmp_path: Path
) -> None:
    willing.hangs_at = 5
    recipe = made()
    autosave = Autosave(untouched(recipe), tmp_path)
    player = Player(recipe, record_sink=autosave)
    for _ in range(4):
        player.send(Step())
    assert (await player.carried_out()).counters.step == 4
    assert player.unanswered == 0.0
    player.send(Step())
    await asyncio.to_thread(willing.hangs.wait)
    before = player.unanswered
    assert before > 0.0
    player.send(Pause())
    assert player.unanswered > before
    player.close()
    (session,), broken = sessions_in(tmp_path)
    assert (session.step, broken) == (4, [])


async def test_it_goes_on_once_it_is_answered(willing: type[Willing]) -> None:
    willing.hangs_at = 5
    player = Player(made(), speed=None)
    player.send(Play())
    await asyncio.to_thread(willing.hangs.wait)
    player.send(Pause())
    willing.goes_on.set()
    snapshot = await player.carried_out()
    assert (snapshot.playback.phase, snapshot.playback.message) == (Phase.PAUSED, "")
    assert snapshot.counters.step >= 5
    player.close()


def test_a_slow_environment_gives_way_after_each_step(willing: type[Willing]) -> None:
    """It begins with few steps. Later no chunk takes longer than the given patience."""
    playback = playback_of(made())
    playback.handle(Play())
    playback.work()
    assert playback.snapshot().counters.step == 1
