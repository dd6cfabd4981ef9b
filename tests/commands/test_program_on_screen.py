"""Your code in the playground."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rl_tui.commands.line.screen import started
from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import VARIABLE
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.playground.playground import Playground

SCRIPT = """
import gymnasium
import numpy as np
env = gymnasium.make("FrozenLake-v1", is_slippery=False)
q = np.zeros((16, 4))
rng = np.random.default_rng(3)
for _ in range(500):
    s, _ = env.reset(); ended = False
    while not ended:
        a = int(rng.integers(4))
        s2, r, terminated, truncated, _ = env.step(a)
        q[s, a] += 0.1 * (r + 0.9 * (0 if terminated else q[s2].max()) - q[s, a])
        s, ended = s2, terminated or truncated
"""
AGENT = """
import numpy as np
class Agent:
    def __init__(self, nA, nS):
        self.Q = np.zeros((nS, nA))
    def select_action(self, state):
        return np.random.randint(4)
    def step(self, state, action, reward, next_state, done):
        target = reward + (0 if done else 0.9 * self.Q[next_state].max())
        self.Q[state, action] += 0.1 * (target - self.Q[state, action])
"""
pytestmark = pytest.mark.process


def written(folder: Path, text: str) -> str:
    path = folder / "student.py"
    path.write_text(text)
    return str(path)


def picture(*args: str) -> Result:
    return CliRunner().invoke(program, ["screenshot", *args, "--size", "100x32", "--out", "-"])


def test_a_picture_of_a_watched_script_has_the_same_bytes_each_time(tmp_path: Path) -> None:
    call = ("--watch", written(tmp_path, SCRIPT), "--keys", "s,wait:800,e")
    first, second = picture(*call), picture(*call)
    assert first.exit_code == 0, first.output
    assert "student.py" in first.stdout
    assert first.stdout == second.stdout


def test_a_picture_of_an_agent_of_ones_own(tmp_path: Path) -> None:
    result = picture("frozenlake", "--agent", written(tmp_path, AGENT), "--keys", "wait:300")
    assert result.exit_code == 0, result.output
    assert "student.py" in result.stdout


def test_what_cannot_be_shown_is_said_in_one_line(tmp_path: Path) -> None:
    result = picture("--watch", written(tmp_path, "print('nothing to see')"))
    assert result.exit_code == 1
    assert len(str(result.exception or result.stderr).strip().splitlines()) == 1
    assert "<svg" not in result.stdout


def test_a_script_brings_its_own_settings(tmp_path: Path) -> None:
    assert picture("frozenlake", "--watch", written(tmp_path, SCRIPT)).exit_code == 2
    assert picture("--agent", written(tmp_path, AGENT)).exit_code == 2


def test_escape_leaves_it_for_the_catalogue_and_ends_its_process(tmp_path: Path) -> None:
    async def leave() -> int | None:
        with started(ProgramRequest(Path(written(tmp_path, SCRIPT)))) as watched:
            app = RlTuiApp(start=watched, picture=True)
            async with app.run_test(size=(100, 32)) as pilot:
                await pilot.pause()
                assert isinstance(app.screen, Playground)
                await app.screen.settled()
                await pilot.press("escape")
                await pilot.pause()
                while not isinstance(app.screen, CatalogueScreen):
                    await pilot.pause()
                return watched.exit_status

    assert asyncio.run(leave()) is not None


def test_in_a_kiosk_no_code_of_others_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "1")
    request = ProgramRequest(Path(written(tmp_path, SCRIPT)))
    with pytest.raises(UserError, match="kiosk"), started(request):
        pass


def test_a_program_that_makes_no_environment_for_long_is_told_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("rl_tui.commands.line.screen.WORTH_TELLING", 1.0)
    text = "import gymnasium, time\ngymnasium.make('Pendulum-v1')\ntime.sleep(2)\n"
    request = ProgramRequest(Path(written(tmp_path, text)))
    why = "Pendulum-v1 is not watched: it has Box observations"
    with pytest.raises(UserError, match=why), started(request):
        pass
    said = capsys.readouterr().err
    assert "is not ready for its first step yet (1 s" in said
    assert why in said
