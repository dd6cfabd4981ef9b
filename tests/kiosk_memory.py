"""Print the memory of a kiosk after much abuse: ``python tests/kiosk_memory.py [ROUNDS] | cat``.

The pipe is needed: a kiosk writes to no file.
"""

from __future__ import annotations

import asyncio
import os
import resource
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from textual.pilot import Pilot

    from rl_tui.common.errors import UserError

os.environ["RL_TUI_KIOSK"] = "1"

from seams import on_screen, tap

from rl_tui.commands.line.screen import MOST_DATA, confine, enter_kiosk
from rl_tui.screen.keys.action import MENUS

DIALOGS = (
    *("w m", "m b", "a o", "u", "a a", "a p", "r s", "r i", "m g", "question_mark", "ctrl+p", "c s"),
    *MENUS,
)
_TOLD = 2
LANES = ("c", "a", "down", "enter")


def memory() -> tuple[float, float]:
    fields = dict(
        line.split(":", 1) for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    )
    resident, data = (int(fields[name].split()[0]) / 1024 for name in ("VmRSS", "VmData"))
    return resident, data


async def abuse(rounds: int) -> None:
    from rl_tui.screen.app.app import RlTuiApp
    from rl_tui.screen.app.display import Display

    app = RlTuiApp(Display(), kiosk=True)
    confine()
    async with on_screen(app, (120, 40)) as pilot:
        _tell("the catalogue")
        await tap(pilot, "down", "down", "enter")
        _tell("the playground")
        for number in range(rounds):
            for keys in DIALOGS:
                await pilot.press(*keys.split())
                await _to_playground(pilot)
            await pilot.press("y", *("1", "2") * 20, "y")
            for _ in range(5):
                await pilot.press("s", "s", "b", "1", "right", "escape")
            for _ in range(3):
                await pilot.press(*LANES)
                await _to_playground(pilot)
            await pilot.press("plus", "plus", "plus", "plus", "plus", "plus", "plus", "plus", "space")
            await asyncio.sleep(0.5)
            await pilot.press("a", "a", "down", "enter")
            await _to_playground(pilot)
            await pilot.press("space", "B", "B", "space")
            await _to_playground(pilot)
            if number % 5 == 4:
                await pilot.press("w", "right_square_bracket")
            if number % _TOLD == 0:
                _tell(f"after {number + 1} rounds")
        _tell("at the end")


async def _to_playground(pilot: Pilot[UserError]) -> None:
    from rl_tui.screen.catalogue.catalogue import CatalogueScreen
    from rl_tui.screen.playground.playground import Playground

    while not isinstance(pilot.app.screen, Playground):
        await pilot.press("enter" if isinstance(pilot.app.screen, CatalogueScreen) else "escape")


def _tell(when: str) -> None:
    resident, data = memory()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    seconds = time.process_time()
    print(
        f"{when}: {resident:.0f} MB resident (at most {peak:.0f}), {data:.0f} MB of data of "
        f"{MOST_DATA / 2**20:.0f}, {seconds:.0f} s of work",
        flush=True,
    )


if __name__ == "__main__":
    enter_kiosk(None)
    asyncio.run(abuse(int(sys.argv[1]) if len(sys.argv) > 1 else 50))
