"""A session with too many steps to replay."""

from __future__ import annotations

import asyncio
import threading
from pathlib import Path

from recipes import recipe
from session_samples import after, fresh

from rl_tui.live.commands import Pause, Step
from rl_tui.live.player import Player
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.live.snapshot import Phase, Snapshot

FAR = 10**15


def opened(folder: Path) -> tuple[Player, Path]:
    path = folder / "far.json"
    path.write_bytes(encoded(after(fresh(recipe("student")), FAR)))
    session = read_session(path)
    record = session.record()
    return Player(record.lanes[0].recipe, record=record, record_sink=Autosave(record, folder, session)), path


async def under_way(player: Player) -> Snapshot:
    async for snapshot in player.snapshots():
        if snapshot.playback.phase is Phase.SEEKING and "left" in snapshot.playback.message:
            return snapshot
    raise AssertionError("it was closed")


async def test_it_says_how_far_it_is_and_can_be_left_at_once(tmp_path: Path) -> None:
    player, path = opened(tmp_path)
    snapshot = await under_way(player)
    assert "of 1,000,000,000,000,000 steps, about" in snapshot.playback.message
    assert snapshot.playback.message.endswith(" years left") or snapshot.playback.message.endswith(
        " days left"
    )
    (thread,) = (each for each in threading.enumerate() if each.name == "player")
    player.close()
    await asyncio.to_thread(thread.join, 60.0)
    assert not thread.is_alive()
    assert read_session(path).step == FAR, "what was only looked at is as it was"


async def test_one_can_stay_where_it_is(tmp_path: Path) -> None:
    player, path = opened(tmp_path)
    await under_way(player)
    player.send(Pause())
    player.send(Step())
    snapshot = await player.carried_out()
    assert snapshot.playback.phase is Phase.PAUSED
    assert 0 < snapshot.counters.step < FAR
    player.close()
    assert read_session(path).step == snapshot.counters.step
