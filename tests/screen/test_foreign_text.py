"""Texts of files appear literally."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest
from drawn_text import letters_of
from seams import app_at, on_screen, screen_text, tap
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.export.recipe_line import recipe_line
from rl_tui.runs.export.script import script
from rl_tui.runs.export.tables import write_q_csv
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.worlds.files.scenario import Scenario, read_scenario

TITLE = r"[red]T[/] {0} %s $HOME \x1b[31m [@click=app.quit]"
SUMMARY = r"[b]S[/b] {self} ${HOME} __class__ [/]"
NOTES = r"[red]N[/red] [@click=app.quit]q[/] {1} %d [there](http://a.example/%1b[31m)"
HERE, THERE = r"[@click=app.quit]H", r'=1+"""\N[/]'
GO, STAY = r"[red]go[/]", r"{0}%s$env"
FILE = "[bold]x[/]"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / f"{FILE}.toml".replace("/", "-")).write_text('title = "a\\u001b[31m"\n')
    texts = {"TITLE": TITLE, "SUMMARY": SUMMARY, "NOTES": NOTES}
    names = {"HERE": HERE, "THERE": THERE, "GO": GO, "STAY": STAY}
    quoted = {name: json.dumps(text) for name, text in {**texts, **names}.items()}
    (tmp_path / "foreign.toml").write_text(
        "title = {TITLE}\nsummary = {SUMMARY}\nnotes = {NOTES}\norder = 0\n[mdp]\nstart = {HERE}\n"
        "time_limit = 9\n[[mdp.transition]]\nstate = {HERE}\naction = {GO}\nreward = 1.0\n"
        "to = {{ {THERE} = 0.5, {HERE} = 0.5 }}\n[[mdp.transition]]\nstate = {HERE}\naction = {STAY}\n"
        "reward = 0.0\nto = {{ {HERE} = 1.0 }}\n".format(**quoted)
    )
    monkeypatch.setattr("rl_tui.worlds.files.catalogue.user_folder", lambda: tmp_path)
    return tmp_path


@pytest.fixture
def foreign(folder: Path) -> Scenario:
    return read_scenario(folder / "foreign.toml")


def playing(scenario: Scenario) -> RlTuiApp:
    return app_at(recipe_for(scenario))


async def press(pilot: Pilot[UserError], *keys: str) -> str:
    await tap(pilot, *keys)
    return screen_text(pilot.app)


async def test_the_catalogue_shows_them_and_the_name_of_a_session_as_they_are(
    foreign: Scenario, folder: Path, tmp_path: Path
) -> None:
    sessions = tmp_path / "sessions"
    sessions.mkdir()
    record = Record((RunRecord(recipe_for(foreign), (FIRST,)),))
    (sessions / "[bold]a[-].json").write_bytes(encoded(record, title=TITLE, kept=True))
    (sessions / "[red]b.json").write_text("{}")
    app = RlTuiApp(Display(fps=1000.0), picture=True, sessions=sessions)
    async with on_screen(app, (160, 50), notifications=True) as pilot:
        listed = app.screen.query_one("#scenarios")
        listed.highlighted = listed.get_option_index("foreign")  # type: ignore[attr-defined]
        await settle(pilot)
        text = screen_text(pilot.app)
        for each in (TITLE[:30], SUMMARY):
            assert each in text
        assert "! [bold]x[-].toml" in text
        listed.focus()
        text = await press(pilot, "end")
        assert "U+001B" in text  # line breaks depend on the length of the file's name
        assert r'"a\u001b[31m"' in text
        assert "\x1b" not in text
        text = await press(pilot, "tab")
        assert TITLE[:20] in text
        assert "[red]b.json" in text
        assert "/[bold]a[-].json" in letters_of(app.screen.query_one("#facts")), "its file"
        assert TITLE in await press(pilot, "delete"), "in the question"


async def notes_in_help(pilot: Pilot[UserError]) -> str:
    await press(pilot, "question_mark", "3", "end")  # the notes are added only after scrolling
    while not pilot.app.screen.query("MarkdownParagraph"):
        await pilot.pause()
    return await press(pilot, "end")


async def test_the_playground_and_its_dialogs_show_them_as_they_are(foreign: Scenario) -> None:
    app = playing(foreign)
    async with on_screen(app, (160, 50), notifications=True) as pilot:
        text = await press(pilot, *"sssss")
        assert TITLE[:20] in text
        assert "[red]go[/]" in text
        text = await press(pilot, "w", "m")
        assert HERE in text
        assert THERE[:8] in text
        await press(pilot, "escape", "y", "1", "2", "y")
        assert GO in await press(pilot, "m", "b")
        for keys in ("tb", "u", "cs", "d", "ao", "aa", "y", "mx"):
            await press(pilot, "escape")
            await press(pilot, *keys)
        assert app.is_running


async def test_the_help_shows_them_as_they_are_and_opens_no_link(
    foreign: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("webbrowser.open", lambda *_: pytest.fail("a browser was opened"))
    app = playing(foreign)
    async with on_screen(app, (160, 50), notifications=True) as pilot:
        text = await notes_in_help(pilot)
        assert r"[red]N[/red] [@click=app.quit]q[/] {1} %d there" in text
        picture = app.export_screenshot(simplify=True)
        assert "\x1b" not in picture
        ElementTree.fromstring(picture)
        paragraph = app.screen.query("MarkdownParagraph").last()
        await paragraph.run_action("link('http://a.example/%1b[31m')")
        await settle(pilot)
        assert r"http://a.example/\u001b[31m" in screen_text(pilot.app)


def _texts(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_what_is_exported_quotes_them(foreign: Scenario, tmp_path: Path) -> None:
    recipe = recipe_for(foreign)
    source = script(recipe, 10)
    assert {HERE, THERE, GO, STAY} <= set(_texts(source))
    line = recipe_line(recipe, (), 0, (GO, STAY))
    assert line.startswith("rl-tui train foreign ")
    run = Run(recipe, begin(recipe))
    write_q_csv(tmp_path / "q.csv", run.world.space, run.learner.q, run.learner.visits)
    head = (tmp_path / "q.csv").read_text().splitlines()[0]
    assert head.startswith(f"state,{GO},{STAY},")
