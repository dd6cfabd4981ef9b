"""Which functions of the project run on the player's thread when a key asks for one step."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator
from pathlib import Path
from types import FrameType
from typing import Final

import rl_tui
from rl_tui.lab.live.commands import Command, Step, StepBack
from rl_tui.lab.live.player import Player
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.run.library import find, recipe_for

SCENARIO: Final = "frozenlake"
STEPS_BEFORE: Final = 20
PRESSES: Final = 3
REST: Final = 0.1  # seconds after which the thread sleeps again
PACKAGE: Final = str(Path(rl_tui.__file__).parent)


class Calls:
    """The distinct functions of the package that a thread enters.

    Lambdas, comprehensions and the methods that dataclasses generate do not count.
    """

    def __init__(self) -> None:
        self.counts = False
        """Whether calls are noted now."""
        self.found: set[tuple[str, str]] = set()
        """The functions, by file and qualified name."""

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if not self.counts or event != "call" or not code.co_filename.startswith(PACKAGE):
            return
        if not code.co_name.startswith("<"):
            self.found.add((code.co_filename, code.co_qualname))


async def _calls_of(command: Command) -> set[tuple[str, str]]:
    calls = Calls()
    threading.setprofile(calls)
    player = Player(recipe_for(find(SCENARIO)))
    snapshots = player.snapshots()
    try:
        sent = 0
        await _answer(snapshots, sent)
        for _ in range(STEPS_BEFORE):
            player.send(Step())
            sent += 1
            await _answer(snapshots, sent)
        for _ in range(PRESSES):
            asked = asyncio.ensure_future(anext(snapshots))
            await asyncio.sleep(REST)
            calls.found.clear()
            calls.counts = True
            player.send(command)
            snapshot = await asked
            sent += 1
            assert snapshot.playback.handled == sent
            await asyncio.sleep(REST)
            calls.counts = False
    finally:
        threading.setprofile(None)
        player.close()
    return calls.found


async def _answer(snapshots: AsyncIterator[Snapshot], handled: int) -> None:
    async for snapshot in snapshots:
        if snapshot.playback.handled == handled and snapshot.playback.phase is not Phase.PREPARING:
            return


def player_calls() -> dict[str, set[tuple[str, str]]]:
    """Return for the keys s and b which functions the third press of it runs, as (file, name)."""
    kinds: dict[str, Command] = {"s": Step(), "b": StepBack()}
    for command in kinds.values():
        asyncio.run(_calls_of(command))  # whatever is compiled, or read from the cache, is not counted
    return {key: asyncio.run(_calls_of(command)) for key, command in kinds.items()}
