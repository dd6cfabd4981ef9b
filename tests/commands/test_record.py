"""Recordings."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest
from called import called
from called import printed as run
from emulator import Emulator
from recipes import recipe
from rich.segment import Segment
from seams import screen_text
from session_samples import after, fresh

from rl_tui.common.errors import UserError
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.recipe import SetParameter
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import Cast, ScriptedApp, length_of, performed, record, script_of
from rl_tui.screen.terminal.screen_buffer import ScreenBuffer

RECORDINGS = sorted((Path(__file__).parents[2] / "docs" / "recordings").glob("*.cast"))
MOST = 100_000  # bytes of thirty seconds
SIZE = (80, 24)


def played(cast: str) -> list[tuple[float, str]]:
    head, *events = map(json.loads, cast.splitlines())
    assert head["version"] == 2
    terminal, frames = Emulator(head["width"], head["height"]), []
    for time, kind, data in events:
        assert kind == "o"
        terminal.feed(data.encode())
        frames.append((time, terminal.text))
    assert [time for time, _ in frames] == sorted(time for time, _ in frames)
    return frames


async def last_screen(keys: list[str]) -> str:
    app = ScriptedApp(Display(), recipe("frozenlake"))
    async with performed(app, SIZE, script_of(keys)):
        return "\n".join(row.rstrip() for row in screen_text(app).splitlines())


@pytest.mark.screen
async def test_a_recording_ends_at_the_screen_of_the_same_keys() -> None:
    keys = ["wait:3000", "space", "2s", "space", "v", "question_mark", "esc", "s", "d"]
    frames = played(await record(recipe("frozenlake"), SIZE, script_of(keys)))
    assert frames[-1][1] == await last_screen(keys)
    assert frames[-1][0] == pytest.approx(0.8 + 0.8 + 2 + 6 * 0.8) == length_of(script_of(keys)) / 60
    running = [text for time, text in frames if 1.6 < time < 3.6]
    assert len(set(running)) >= 12  # steps, and the estimates that travel


@pytest.mark.screen
def test_two_processes_write_the_same_bytes(tmp_path: Path) -> None:
    out = tmp_path / "a.cast"
    call = ("record", "cliff", "--size", "80x24", "--keys", "s,space,1s", "--out")
    command = [sys.executable, "-m", "rl_tui", *call, str(out)]
    subprocess.run(command, check=True, env=os.environ | {"TERM": "dumb", "NO_COLOR": "1"})
    assert out.read_text(encoding="utf-8") == run(*call, "-")


@pytest.mark.screen
def test_a_script_of_your_own_is_recorded_to_its_step(tmp_path: Path) -> None:
    lake = Path(__file__).parents[2] / "docs" / "lake.py"
    call = ("record", "--watch", str(lake), "--size", "80x24", "--out", "-")
    frames = played(run(*call, "--keys", "s,space,1s,space"))
    assert " 11" in frames[-1][1]  # one step, and a second of ten


@pytest.mark.screen
def test_a_session_is_replayed_from_its_first_to_its_last_step(tmp_path: Path) -> None:
    session, out = tmp_path / "a.json", tmp_path / "a.cast"
    lived = after(fresh(recipe("student")), 5, (2, SetParameter("alpha", 0.5)))
    session.write_bytes(encoded(lived))
    assert "at step 5" in run("replay", str(session), "--out", str(out), "--size", "80x24")
    frames = played(out.read_text(encoding="utf-8"))
    lines = [text.splitlines()[0].split() for _, text in frames[1:]]
    assert (lines[0][-2:], lines[-1][-2:]) == (["step", "0"], ["step", "5"])
    assert frames[-1][0] == pytest.approx(1 + 5 + 3, abs=0.01)  # at one step per second
    refused = called("replay", session, "--out", session)
    assert (refused.exit_code, refused.stderr.count("--out names the session file")) == (2, 1)


class Flicker:
    passed = 0

    def __init__(self) -> None:
        self.rows = [""] * SIZE[1]

    def put_on(self, buffer: ScreenBuffer) -> None:
        chance = random.Random(self.passed)
        self.rows = ["".join(chance.choices("abc", k=SIZE[0])) for _ in self.rows]
        for y, row in enumerate(self.rows):
            buffer.put(0, y, [Segment(row)])


@pytest.mark.unit
def test_thirty_seconds_take_a_hundred_kilobytes_whatever_moves_and_end_with_the_last_screen() -> None:
    app = Flicker()
    cast = Cast(app, SIZE, 30.0)
    for _ in range(450):
        app.passed += 4
        cast.show(moves=True)
    text = cast.text()
    assert len(text.encode()) < MOST + 5_000  # the first of the screen, and the last
    frames = played(text)
    assert len(frames) > 30
    assert frames[-1] == (30.0, "\n".join(app.rows))


@pytest.mark.unit
@pytest.mark.parametrize("path", RECORDINGS, ids=lambda path: path.stem)
def test_the_recordings_of_the_docs_are_small_and_play(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.encode()) < MOST
    assert len(played(text)) > 50


@pytest.mark.unit
@pytest.mark.parametrize("key", ["s2", "2ss", "-1s", "601s", "1e3s"])
def test_a_time_that_is_none_is_refused(key: str) -> None:
    with pytest.raises(UserError):
        script_of([key])
