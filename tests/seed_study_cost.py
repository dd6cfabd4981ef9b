"""The cost of a study of many seeds for the live run.

The study is stopped and continued in short turns, to expose both to the same load from other work.
"""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import time
from typing import Any, Final

from rl_tui.live.commands import Play, StudySeeds
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.background import background
from rl_tui.runs.library import recipe_named
from rl_tui.studies.many_seeds.figures import StudyState

SCENARIO: Final = "taxi"
SECONDS: Final = 0.5
FRAME: Final = 1 / 30


class _LiveRun:
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

    async def is_studied(self) -> None:
        self._player.send(StudySeeds())
        while self._newest is None or self._newest.study is None or not self._newest.study.seeds:
            await asyncio.sleep(FRAME)

    async def speed(self) -> tuple[float, float]:
        before, start, used = self._steps, time.perf_counter(), time.process_time()
        await asyncio.sleep(SECONDS)
        steps = self._steps - before
        return steps / (time.perf_counter() - start), steps / (time.process_time() - used)

    @property
    def is_beside_a_study(self) -> bool:
        study = None if self._newest is None else self._newest.study
        return study is not None and study.state is StudyState.RUNNING

    def close(self) -> None:
        self._player.close()

    @property
    def _steps(self) -> int:
        return 0 if self._newest is None else self._newest.counters.step


async def seed_study_cost(rounds: int) -> list[tuple[float, float]]:
    """Return, per round, the fractions left during a study: of the speed, and of the steps per CPU second."""
    processes: list[subprocess.Popen[bytes]] = []
    start_process = background.python_process

    def noted(*args: Any) -> subprocess.Popen[bytes]:
        processes.append(start_process(*args))
        return processes[-1]

    background.python_process = noted
    live, ratios = _LiveRun(), list[tuple[float, float]]()
    reading = asyncio.create_task(live.read())
    await live.is_at_full_speed()
    while len(ratios) < rounds:
        if not live.is_beside_a_study:
            await live.is_studied()
        turns = []
        for wanted in (signal.SIGSTOP, signal.SIGCONT, signal.SIGSTOP):
            os.kill(processes[-1].pid, wanted)
            turns.append(await live.speed())
        os.kill(processes[-1].pid, signal.SIGCONT)
        before, beside, after = turns
        if live.is_beside_a_study:
            speed, thrift = (2 * beside[kind] / (before[kind] + after[kind]) for kind in (0, 1))
            ratios.append((speed, thrift))
    live.close()
    await reading
    return ratios
