"""Run commands and play the app where POSIX is hidden. Print JSON."""

from __future__ import annotations

import asyncio
import json
import sys
from pathlib import Path

from click.testing import CliRunner

from rl_tui.commands.main import program
from rl_tui.live.sessions.session import sessions_in
from rl_tui.runs.library import recipe_named
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.opening import Start
from rl_tui.screen.app.screenshot import settle

SESSIONS = Path("sessions")
LONGEST = 120.0  # seconds


async def play(start: Start, *keys: str, until_gone: str = "") -> str:
    app = RlTuiApp(Display(), start, sessions=SESSIONS)
    async with app.run_test(size=(120, 40)) as pilot, asyncio.timeout(LONGEST):
        await settle(pilot)
        for key in keys:
            await pilot.press(key)
            await settle(pilot)
        while until_gone and until_gone in app.export_screenshot(simplify=True):
            await pilot.pause(0.1)
        return app.export_screenshot(simplify=True)


def run(*args: str) -> tuple[int, str, str]:
    done = CliRunner().invoke(program, args)
    return done.exit_code, done.stdout, done.stderr


def main() -> None:
    shown: dict[str, object] = {"platform": sys.platform}
    sweep = ("sweep", "student", "--vary", "alpha=0.1,0.5", "--episodes", "5", "--store", "runs.db", "--json")
    shown["swept"] = run(*sweep, "--runs", "3"), run(*sweep, "--runs", "4")
    shown["trained"] = run("train", "student", "--episodes", "20", "--runs", "3", "--json")
    shown["solved"] = run("solve", "student", "--json")
    shown["watched"], shown["graded"] = (
        run("watch", "own.py"),
        run("grade", "own.py", "--scenario", "student"),
    )
    shown["new"] = run("new", "a & b")
    asyncio.run(play(recipe_named("student", {}, 0), "s", "s", "e"))
    (session,), _ = sessions_in(SESSIONS)
    shown["replayed"] = run("replay", str(session.path), "--json")
    seeds = play(session, "s", "t", "m", until_gone="first numbers come")
    shown["many seeds"] = "256 seeds" in asyncio.run(seeds).replace("&#160;", " ")
    (session,), _ = sessions_in(SESSIONS)
    shown["continued"] = run("replay", str(session.path), "--json")
    print(json.dumps(shown))


main()
