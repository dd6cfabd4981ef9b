"""What a study of many seeds costs the live run.

The live run plays at full speed, with and without a study beside it in turns. A reader takes snapshots as
often as a screen draws them.
"""

from __future__ import annotations

import asyncio
import time
from typing import Final

from rl_tui.lab.live.commands import EndStudy, Play, StudySeeds
from rl_tui.lab.live.player import Player
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.many_seeds.figures import StudyState
from rl_tui.lab.run.library import recipe_named

SCENARIO: Final = "taxi"
SECONDS: Final = 3.0
FRAME: Final = 1 / 30


class _Watched:
    """A player at full speed whose snapshots are read as a screen reads them."""

    def __init__(self) -> None:
        self._player = Player(recipe_named(SCENARIO), speed=None)
        self._newest: Snapshot | None = None

    async def read(self) -> None:
        async for snapshot in self._player.snapshots():
            self._newest = snapshot
            await asyncio.sleep(FRAME)

    async def is_at_full_speed(self) -> None:
        self._player.send(Play())
        while self._newest is None or self._newest.playback.interpreted or not self._newest.counters.step:
            await asyncio.sleep(FRAME)

    async def speed(self, *, with_study: bool) -> tuple[float, float]:
        """Return its steps by seconds, and by seconds of processor."""
        self._player.send(StudySeeds() if with_study else EndStudy())
        while with_study and self._study_state in ("", StudyState.STARTING):
            await asyncio.sleep(FRAME)
        await asyncio.sleep(0.5)
        before, start, used = self._steps, time.perf_counter(), time.process_time()
        await asyncio.sleep(SECONDS)
        steps = self._steps - before
        return steps / (time.perf_counter() - start), steps / (time.process_time() - used)

    def close(self) -> None:
        self._player.close()

    @property
    def _steps(self) -> int:
        return 0 if self._newest is None else self._newest.counters.step

    @property
    def _study_state(self) -> str:
        study = None if self._newest is None else self._newest.study
        return "" if study is None else study.state


async def seed_study_cost(rounds: int) -> list[tuple[float, float]]:
    """Return what is left beside a study, each round: of the speed, and of the steps a second of processor.

    The second leaves out what others took away, and shows what is lost in the caches.
    """
    watched = _Watched()
    reading = asyncio.create_task(watched.read())
    await watched.is_at_full_speed()
    ratios = []
    for _ in range(rounds):
        alone, thrift_alone = await watched.speed(with_study=False)
        beside, thrift_beside = await watched.speed(with_study=True)
        ratios.append((beside / alone, thrift_beside / thrift_alone))
    watched.close()
    await reading
    return ratios
