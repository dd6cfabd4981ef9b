"""Pictures of a watched program."""

from __future__ import annotations

from typing import Any

import pytest
from conftest import MakeApp
from program_samples import AFTER_END, KNOWN, TIES, program, watched
from samples import lake
from seams import playground, show
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.screen.app.screenshot import settle


def endless() -> Snapshot:
    verdict = ProgramVerdict(KNOWN, (TIES, AFTER_END), ("Each update comes one step late.",))
    return watched(program(verdict=verdict), lake().counters.step)


@pytest.mark.parametrize(
    ("size", "keys"), [((120, 40), ("a", "f")), ((80, 24), ())], ids=["findings", "small"]
)
def test_program(size: tuple[int, int], keys: tuple[str, ...], snap_compare: Any, make_app: MakeApp) -> None:
    async def watch(pilot: Pilot[UserError]) -> None:
        await settle(pilot)
        show(playground(pilot), endless())
        await pilot.press(*keys)
        await pilot.pause()
        show(playground(pilot), endless())
        await pilot.pause()

    assert snap_compare(make_app("frozenlake-slippery"), terminal_size=size, run_before=watch)
