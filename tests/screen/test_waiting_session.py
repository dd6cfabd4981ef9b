"""A session on screen while its replay waits."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from seams import screen_text, snapshot
from textual.pilot import Pilot

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.loops import compile_here
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS
from rl_tui.common.errors import UserError
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.sessions.session import StoredSession, digest_of, encoded, read_session
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.worlds.files.catalogue import find

pytestmark = pytest.mark.interpreted
STEPS = 200_000


@pytest.fixture(autouse=True)
def _compiler_never_finishes(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(BACKGROUND, "want", lambda loops: None)
    before = set(COMPILED_LOOPS)
    yield
    COMPILED_LOOPS.update(before)


def left_at(folder: Path, steps: int) -> StoredSession:
    """A session of the cliff. Nothing is compiled afterwards."""
    run = Run(recipe_for(find("cliff")))
    compile_here(run.learner.loop)
    run.advance(steps)
    learner = run.learner
    table = LearnedTable(learner.q, learner.visits, learner.episodes, learner.state)
    lane = RunRecord(run.recipe, (replace(FIRST, end=steps, here=steps),))
    path = folder / "a.json"
    path.write_bytes(encoded(Record((lane,), table=table), digest=digest_of(learner.q)))
    COMPILED_LOOPS.clear()
    return read_session(path)


async def says(pilot: Pilot[UserError], pattern: str) -> bool:
    for _ in range(3_000):
        if re.search(pattern, screen_text(pilot.app)):
            return True
        await pilot.pause(0.01)
    return False


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_what_was_learned_is_drawn_while_it_waits(size: tuple[int, int], tmp_path: Path) -> None:
    app = RlTuiApp(Display(fps=1000.0), left_at(tmp_path, STEPS), picture=True)
    async with app.run_test(size=size) as pilot:
        assert await says(pilot, "200,000 steps to replay: waiting for the compiler")
        assert await says(pilot, "the last step appears once it is replayed")
        assert "−113" in screen_text(app)  # the values learned on the cliff
        waiting = snapshot(pilot).agent.q
        compile_here(Run(recipe_for(find("cliff"))).learner.loop)
        assert await says(pilot, "paused .*step +200,000")
        assert snapshot(pilot).agent.q.tobytes() == waiting.tobytes()
