"""The delay from an edit of a map to the snapshot, to its exact values, and to the screen."""

from __future__ import annotations

import argparse
import asyncio
import time
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from statistics import median
from typing import Final, NamedTuple

import numpy as np
from frame_times import SIZE, painted
from seams import show

from rl_tui.live.commands import DrawWorld, LookAt, OpenEditor
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import Cells, Viewport
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.files.scenario import scenario_of

SCENARIO: Final = """title = "Rooms"
summary = "a map with walls here and there"
notes = "A sample."
[defaults]
algorithm = "q-learning"
alpha = 0.1
gamma = 0.99
epsilon = 0.1
episodes = 100
[grid]
noise = 0.2
map = '''
{map}
'''
"""


class EditTimes(NamedTuple):
    drawn: float
    """Until a snapshot has the drawing."""
    made: float
    """Until a snapshot has the edited world."""
    answered: float
    """Until a snapshot has the exact values of that world, or reports that there are none."""
    frame: float
    """The drawing time of the screen."""
    seen: float
    """Until a frame of the app, at 15 a second, has the exact values."""


def map_with_walls(side: int) -> Recipe:
    cells = np.random.default_rng(0).choice(list("....#"), (side, side))
    cells[0, 0], cells[-1, -1] = "S", "G"
    cells[-1, :-1], cells[1:, 0] = ".", "."
    lines = "\n".join("".join(row) for row in cells)
    return recipe_for(scenario_of(SCENARIO.format(map=lines), Path("rooms.toml")), {}, seed=0)


async def _until(snapshots: AsyncIterator[Snapshot], holds: Callable[[Snapshot], bool]) -> Snapshot:
    async for snapshot in snapshots:
        if holds(snapshot):
            return snapshot
    raise RuntimeError("the player has ended")


async def edit_times(side: int, edits: int = 10) -> EditTimes:
    player = Player(map_with_walls(side))
    snapshots = player.snapshots()
    player.send(OpenEditor(is_open=True))
    player.send(LookAt(Viewport(cells=Cells(20, 40))))
    last = await _until(snapshots, lambda each: each.editor.draft is not None and _is_answered(each))
    times: list[tuple[float, float, float]] = []
    shown = [last]
    for number in range(edits):
        before, start = last.world, time.perf_counter()
        draft = last.editor.draft
        player.send(_edit(side, number))
        last = await _until(snapshots, lambda each, draft=draft: each.editor.draft is not draft)
        drawn = time.perf_counter() - start
        if last.world is before:
            last = await _until(snapshots, lambda each, before=before: each.world is not before)
        made = time.perf_counter() - start
        if not _is_answered(last):
            last = await _until(snapshots, _is_answered)
        times.append((drawn, made, time.perf_counter() - start))
        shown.append(last)
    player.close()
    drawn, made, answered = (median(each) * 1e3 for each in zip(*times, strict=True))
    return EditTimes(drawn, made, answered, await _frame(side, shown[-4:]), await _seen(side, edits))


def _is_answered(snapshot: Snapshot) -> bool:
    return snapshot.exact_answer.solution is not None or bool(snapshot.exact_answer.refused)


async def _frame(side: int, snapshots: list[Snapshot]) -> float:
    app = RlTuiApp(Display(fps=1000.0), map_with_walls(side), picture=True)
    taken = []
    async with app.run_test(size=SIZE) as pilot:
        await pilot.pause()
        screen = app.screen
        assert isinstance(screen, Playground)
        await screen.settled()
        for snapshot in snapshots:
            start = time.perf_counter()
            show(screen, snapshot)
            await painted(screen)
            taken.append(time.perf_counter() - start)
    return median(taken[1:]) * 1e3


def _edit(side: int, number: int) -> DrawWorld:
    row, column = side // 2 + number // 5, side // 4 + number % 5
    return DrawWorld(read_edits(f"world.cell[{row},{column}]={'H' if number % 2 else '#'}"))


async def _seen(side: int, edits: int) -> float:
    app = RlTuiApp(Display(), map_with_walls(side), picture=True)
    taken = []
    async with app.run_test(size=SIZE) as pilot:
        await pilot.pause()
        screen = app.screen
        assert isinstance(screen, Playground)
        screen.send(OpenEditor(is_open=True))
        await screen.settled()
        for number in range(edits):
            before, start = screen.snapshot.world, time.perf_counter()
            screen.send(_edit(side, number))
            while screen.snapshot.world is before or not _is_answered(screen.snapshot):
                await asyncio.sleep(0.001)
            await painted(screen)
            taken.append(time.perf_counter() - start)
            await screen.settled()
    return median(taken) * 1e3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sides", nargs="*", type=int, default=[10, 30, 100, 1_000])
    for side in parser.parse_args().sides:
        times = asyncio.run(edit_times(side, 10 if side < 1_000 else 3))
        print(
            f"{side:,}×{side:,}: drawn {times.drawn:.1f} ms, made {times.made:.1f}, "
            f"answered {times.answered:.1f}, frame {times.frame:.1f}, seen {times.seen:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
