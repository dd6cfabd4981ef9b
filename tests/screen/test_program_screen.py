"""A watched script in the playground."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from textwrap import dedent

import pytest
from seams import app_at, choose, notes, on_screen, playground, press, screen_text, snapshot, train
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Phase
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import WatchedProgram
from rl_tui.runs.library import recipe_named
from rl_tui.screen.keys.playground_keys import DECIDES
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import MAY_NEVER_END
from rl_tui.screen.kit.row import CONTROLS, FINDINGS, LAST_STEP, OUTPUT, PROGRAM, TABLE
from rl_tui.screen.panels.curve.text import GREEDY
from rl_tui.screen.panels.discount import DiscountPanel
from rl_tui.screen.panels.q_table.sheet import NO_TABLE
from rl_tui.screen.panels.side_by_side import DIFFERS
from rl_tui.screen.playground.actions.program import FIRST_KEYS

SCRIPT = """\
    import gymnasium as gym
    import numpy as np
    alpha, gamma, epsilon = 0.5, 0.9, 0.2
    rng = np.random.default_rng(0)
    env = gym.make("CliffWalking-v1", max_episode_steps=200)
    env.action_space.seed(0)
    q, other = np.zeros((48, 4)), np.ones((48, 4))
    print("training starts")
    for episode in range(12):
        s, _ = env.reset(seed=episode)
        done = False
        while not done:
            best = np.flatnonzero(q[s] == q[s].max())
            a = int(rng.choice(best)) if rng.random() > epsilon else int(rng.integers(4))
            s2, r, terminated, truncated, _ = env.step(a)
            target = r + gamma * q[s2].max() {end}
            q[s, a] += alpha * (target - q[s, a])
            other[s, a] += 0.25 * (r - other[s, a])
            s, done = s2, terminated or truncated
    """


GRID = """\
def step(state, action):
    after = max(0, state + (1 if action else -1))
    return after, -1.0, after == 3
Q = np.zeros((4, 2))
for episode in range(9):
    state, done = 0, False
    while not done:
        action = random.randrange(2)
        after, reward, done = step(state, action)
        Q[state, action] += 0.1 * (reward + 0.9 * Q[after].max() * (not done) - Q[state, action])
        state = after
"""
WALK = """\
    import gymnasium as gym
    env = gym.make("CliffWalking-v1", max_episode_steps=200)
    env.action_space.seed(0)
    for episode in range(12):
        env.reset(seed=episode)
        done = False
        while not done:
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
            done = terminated or truncated
    """


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "cliff.py"
    path.write_text(dedent(SCRIPT).format(end="* (not terminated)"), encoding="utf-8")
    return path


@asynccontextmanager
async def watching(path: Path, size: tuple[int, int] = (120, 40)) -> AsyncIterator[Pilot[UserError]]:
    program = WatchedProgram(ProgramRequest(path))
    try:
        program.wait_for_environment()
        async with on_screen(app_at(program), size, notifications=True) as pilot:
            yield pilot
    finally:
        program.end()


async def test_it_stands_at_its_beginning_says_how_to_go_on_and_has_keys_of_its_own(script: Path) -> None:
    async with watching(script, (80, 24)) as pilot:
        assert snapshot(pilot).counters.step == 0
        assert notes(pilot.app) == [FIRST_KEYS]
        board = playground(pilot).board
        assert board.shows(PROGRAM)
        assert not board.shows(CONTROLS)
        assert "cliff.py" in screen_text(pilot.app)
        await train(pilot, 3)
        assert notes(pilot.app) == []
        assert (await press(pilot, "s")).counters.step == 4
        await pilot.resize_terminal(160, 40)
        await press(pilot, "s")
        line = screen_text(pilot.app).splitlines()[-1]
        for there in ("space run", "b back", "a agent", "t tools"):
            assert there in line
        assert "you act" not in line
        await press(pilot, "a")
        menu = screen_text(pilot.app).splitlines()[-4:]
        for there in ("Your program", "findings", "output", "table…"):
            assert any(there in row for row in menu), there
        for gone in ("algorithm", "policy", "evaluate"):
            assert not any(gone in row for row in menu), gone
        await press(pilot, "w")
        assert board.shows(OUTPUT)
        assert not board.shows(TABLE)
        assert "│ training starts" in screen_text(pilot.app)
        await press(pilot, "a", "w")
        assert board.shows(TABLE)
        await press(pilot, "question_mark", "3")
        assert "Your script under rl-tui watch" in " ".join(screen_text(pilot.app).split())


DECIDED = DECIDES.format(file="cliff.py")
REFUSED = {
    **dict.fromkeys(("1", "4", "r i", "t s", "c s"), DECIDED),
    "y": "takes its own steps",
    **dict.fromkeys(("r n", "r s"), "--seed"),
    "m x": "cliff.py",
    "m s": "cliff.py",
    "t m": "rl-tui grade cliff.py",
    "w d": "scenarios can be edited",
    "w c": "rl-tui check --deep",
    "m w": "+ and −",
    "t y": "c a: compare",
    "m b": "b and B",
    "c l": "c o: one run",
    "w left_square_bracket": "esc: go there",
    "w right_square_bracket": "esc: go there",
}
"""The refused actions by their keys, and their refusals."""


async def test_what_cannot_be_done_says_what_to_do_instead_and_what_can_is_done(script: Path) -> None:
    async with watching(script) as pilot:
        screen, before = pilot.app.screen, playground(pilot).wanted.sent
        for keys, instead in REFUSED.items():
            await press(pilot, *keys.split())
            if " " in keys:
                said = [line for line in screen_text(pilot.app).splitlines() if "Not here: " in line]
                await press(pilot, "escape")
            else:
                said = notes(pilot.app)
            assert len(said) == 1, keys
            assert instead.lower() in said[0].lower(), keys
        assert pilot.app.screen is screen
        assert playground(pilot).wanted.sent == before
        await train(pilot, 50)
        program = snapshot(pilot).program
        assert program.table.others
        assert program.table.other_forms == ("array",)
        await press(pilot, "a", "b")
        assert "array 48×4, float64" in screen_text(pilot.app)
        await choose(pilot, "1")
        assert snapshot(pilot).counters.step == 0
        await train(pilot, 50)
        assert snapshot(pilot).program.table.name == program.table.others[0]


async def test_without_a_table_nothing_is_called_an_estimate_and_a_flip_sets_no_gamma(tmp_path: Path) -> None:
    path = tmp_path / "lake.py"
    path.write_text(dedent(WALK).replace("CliffWalking-v1", "FrozenLake-v1"), encoding="utf-8")
    async with watching(path) as pilot:
        await train(pilot, 20)
        assert snapshot(pilot).program.table is None  # type: ignore[union-attr]
        assert snapshot(pilot).agent.visits.any()
        text, table = screen_text(pilot.app), playground(pilot).board.table
        for told in ("searched for: an array", "no table was found, so no change is known", f"Q  {NO_TABLE}"):
            assert told in text
        assert "– no table" in text
        assert table.layer_choices == (Layer.Q, Layer.OPTIMAL, Layer.VISITS)
        playground(pilot).board.show_layer(Layer.VISITS)
        shown = "".join(table.render_line(y).text for y in range(1, 12))
        assert any(str(count) in shown for count in range(1, 9))
        playground(pilot).board.show_layer(Layer.Q)
        await train(pilot, 180)
        text = screen_text(pilot.app)
        for claim in (MAY_NEVER_END, "0.00", f"{GREEDY} ", "not tried"):
            assert claim not in text
        await press(pilot, "t", "g", "up")
        assert "enter" not in playground(pilot).board.query_one(DiscountPanel).footing
        gamma = snapshot(pilot).agent.hyperparameters.gamma
        await press(pilot, "enter")
        (said,) = notes(pilot.app)
        assert said.rstrip(".").lower() == DECIDES.format(file="lake.py").lower()
        assert snapshot(pilot).agent.hyperparameters.gamma == gamma
        await press(pilot, "escape", "c", "a")
        await choose(pilot, "sarsa")
        assert playground(pilot).board.is_paired
        assert DIFFERS not in screen_text(pilot.app)  # it is not compared with ours
        await press(pilot, "c", "e")
        assert "Not here: your program is in control" in screen_text(pilot.app)
        await press(pilot, "escape")


async def test_a_finding_leads_to_the_first_step_that_shows_it(tmp_path: Path) -> None:
    path = tmp_path / "endless.py"
    path.write_text(
        dedent(SCRIPT).format(end="").replace("np.zeros((48", "5 + np.zeros((48"), encoding="utf-8"
    )
    async with watching(path) as pilot:
        while not snapshot(pilot).program.ended:  # type: ignore[union-attr]
            await train(pilot, 4_000)
        program = snapshot(pilot).program
        (finding,) = program.verdict.findings
        await press(pilot, "a", "f")
        assert playground(pilot).board.shows(FINDINGS)
        assert "bug: bootstraps after the end" in screen_text(pilot.app)
        assert "target = " in screen_text(pilot.app)
        now = await press(pilot, "enter")
        assert now.counters.step == finding.step + 1
        assert now.counters.last_step.terminated


async def test_no_run_is_offered_beside_a_world_of_the_program_alone(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text("import random, numpy as np\n" + GRID)
    async with watching(path) as pilot:
        await press(pilot, "c", "a")
        assert "Not here: only your program can create this environment" in screen_text(pilot.app)


async def test_the_step_back_is_told_as_it_was_and_an_agent_of_ours_stands_beside_it(script: Path) -> None:
    async with watching(script) as pilot:
        await train(pilot, 30)
        story = playground(pilot).board.panel(LAST_STEP)
        then = [story.render_line(y).text for y in range(story.size.height)]
        await press(pilot, "s", "b")
        assert snapshot(pilot).counters.step == 30
        assert "past, only shown" in screen_text(pilot.app)
        assert any(line.strip() for line in then)
        assert [story.render_line(y).text for y in range(story.size.height)] == then
        await press(pilot, "s")
        await train(pilot, 29)
        await press(pilot, "c", "a")
        await choose(pilot, "sarsa")
        beside = snapshot(pilot).beside
        assert beside.agent.algorithm == "sarsa"
        assert beside.counters.step == 60
        assert playground(pilot).board.is_paired
        assert "cliff.py" in screen_text(pilot.app)
        await press(pilot, "c", "c")
        assert "One seed proves nothing: rl-tui grade runs your program" in screen_text(pilot.app)


async def test_it_starts_again_and_it_ends(script: Path) -> None:
    async with watching(script) as pilot:
        await train(pilot, 40)
        assert (await press(pilot, "r", "r")).counters.step == 0
        while not snapshot(pilot).program.ended:  # type: ignore[union-attr]
            await train(pilot, 4_000)
        assert "your program has ended" in screen_text(pilot.app)
        keys = screen_text(pilot.app).splitlines()[-1]
        assert "r again" in keys
        assert "s step" not in keys
        for key in ("space", "s", "e"):
            await press(pilot, key)
            (said,) = notes(pilot.app)
            assert "r r: start it again" in said
        assert "s step" in (await _keys_after(pilot, "b"))  # forward again through the recording
        assert (await press(pilot, "s")).playback.phase is Phase.SPENT
        await press(pilot, "escape")
        assert "your program then ends" in notes(pilot.app)[0]


async def _keys_after(pilot: Pilot[UserError], key: str) -> str:
    await press(pilot, key)
    return screen_text(pilot.app).splitlines()[-1]


async def test_without_a_program_the_menu_does_not_list_what_is_for_one() -> None:
    async with on_screen(app_at(recipe_named("student"))) as pilot:
        await press(pilot, "a")
        text = screen_text(pilot.app)
        assert "algorithm" in text
        for of_program in ("findings", "output", "table…"):
            assert of_program not in text
        await press(pilot, "f", "w", "b", "escape")
        assert playground(pilot).board.shows(TABLE)
        assert snapshot(pilot).counters.step == 0
