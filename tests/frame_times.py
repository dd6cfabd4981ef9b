"""The time of a frame for maps of any size."""

from __future__ import annotations

import asyncio
import time
from statistics import median
from typing import Final, NamedTuple

from open_grids import open_grid_recipe
from seams import app_at, show

from rl_tui.live.commands import Train
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.playground.playground import Playground

SIZE: Final = (120, 40)
STEPS: Final = 20_000  # between two frames, so that each differs much


class FrameTimes(NamedTuple):
    snapshot: float
    frame: float


async def painted(screen: Playground) -> None:
    done = asyncio.Event()
    screen.call_after_refresh(done.set)
    await done.wait()


async def frame_times(side: int, frames: int = 40) -> FrameTimes:
    app = app_at(open_grid_recipe(side))
    snapshots: list[Snapshot] = []
    copied: list[float] = []
    drawn: list[float] = []
    async with app.run_test(size=SIZE) as pilot:
        await pilot.pause()
        screen = app.screen
        assert isinstance(screen, Playground)
        await screen.settled()
        for _ in range(frames):
            screen.send(Train(STEPS))
            await screen.settled()
            start = time.perf_counter()
            # the player is idle now: nothing else touches its run
            snapshots.append(screen.player._playback.snapshot())
            copied.append(time.perf_counter() - start)
        for snapshot in snapshots:
            start = time.perf_counter()
            show(screen, snapshot)
            await painted(screen)
            drawn.append(time.perf_counter() - start)
    return FrameTimes(median(copied) * 1e3, median(drawn) * 1e3)


def main() -> None:
    for side in (4, 1_000):
        times = asyncio.run(frame_times(side))
        print(f"{side:,}×{side:,}: snapshot {times.snapshot:.2f} ms, frame {times.frame:.2f} ms")


if __name__ == "__main__":
    main()
