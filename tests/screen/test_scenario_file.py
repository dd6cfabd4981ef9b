"""The scenario's file changes during play."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from seams import app_at, notes, on_screen, playground, screen_text, snapshot, tap
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import VARIABLE
from rl_tui.live.sessions.session import read_session, sessions_in
from rl_tui.runs.library import recipe_named, recipe_with, reread
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.dialogs.form import Choice
from rl_tui.screen.kit.snapshot_facts import is_secret
from rl_tui.screen.playground.playground import Playground

TEXT = '[defaults]\ngamma = {gamma}\nalpha = 0.1\n[grid]\nmap = """\n{map}\n"""\n'
FAULTY = TEXT.format(gamma="0,5", map="S.G")


def text(map_: str = "S..G", gamma: float = 0.9) -> str:
    return TEXT.format(map=map_, gamma=gamma)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(text(), encoding="utf-8")
    return path


MakeApp = Callable[..., RlTuiApp]


@pytest.fixture
def app_of(tmp_path: Path) -> MakeApp:
    def make(start: object) -> RlTuiApp:
        folder = tmp_path / "sessions"
        return app_at(start, sessions=folder)

    return make


def cells(pilot: Pilot[UserError]) -> int:
    return snapshot(pilot).world.space.states


async def test_the_new_content_is_offered_and_taken(file: Path, app_of: MakeApp, tmp_path: Path) -> None:
    app = app_of(recipe_named(str(file), {"alpha": 0.5}, 3))
    async with on_screen(app) as pilot:
        await tap(pilot, "s", "s", "plus", "plus")
        speed = snapshot(pilot).playback.speed
        file.write_text(text("S....G", 0.5), encoding="utf-8")
        await pilot.press("r", "r")
        assert isinstance(app.screen, Choice)
        await tap(pilot, "escape")
        assert (cells(pilot), snapshot(pilot).counters.step) == (4, 2), "nothing is done"
        await tap(pilot, "r", "r", "enter")
        assert (cells(pilot), snapshot(pilot).counters.step) == (6, 0)
        recipe = snapshot(pilot).recipe
        assert (recipe.hyperparameters.alpha, recipe.hyperparameters.gamma, recipe.seed) == (0.5, 0.5, 3)
        assert snapshot(pilot).playback.speed == playground(pilot).wanted.speed == speed
        await tap(pilot, "s")
    (newer, older), _ = sessions_in(tmp_path / "sessions")
    assert newer.document.scenario.text == text("S....G", 0.5)
    assert (older.document.scenario.text, older.step) == (text(), 2)


async def test_the_old_content_may_be_kept_and_a_hidden_answer_stays_hidden_in_the_new(
    file: Path, app_of: MakeApp
) -> None:
    app = app_of(recipe_named(str(file)))
    async with on_screen(app) as pilot:
        await tap(pilot, "s")
        file.write_text(text("S....G"), encoding="utf-8")
        await tap(pilot, "r", "r", "down", "enter")
        assert (cells(pilot), snapshot(pilot).counters.step) == (4, 0)
        await tap(pilot, "s", "r", "r")
        assert (cells(pilot), snapshot(pilot).counters.step) == (4, 0), "it is not asked again"
        file.write_text(text("S.....G"), encoding="utf-8")
        await tap(pilot, "w", "h", "r", "r")
        assert isinstance(app.screen, Choice), "but of what is newer still"
        assert "mine.toml has changed" in screen_text(app)
        await tap(pilot, "enter")
        assert (cells(pilot), is_secret(snapshot(pilot))) == (7, True)


async def test_faults_of_the_new_content_are_told_and_the_old_one_stays(file: Path, app_of: MakeApp) -> None:
    app = app_of(recipe_named(str(file)))
    async with on_screen(app) as pilot:
        await tap(pilot, "s", "r", "r")  # if unchanged, it restarts at once
        assert isinstance(app.screen, Playground)
        assert snapshot(pilot).counters.step == 0
        await tap(pilot, "s")
        file.write_text(FAULTY, encoding="utf-8")
        await tap(pilot, "r", "r")
        assert (cells(pilot), snapshot(pilot).counters.step) == (4, 0)
        assert any("mine.toml: line 2" in each and "0,5" in each for each in notes(app))
        assert any("Started again" in each for each in notes(app))
        file.unlink()
        await tap(pilot, "s")
        assert notes(app) == []
        await tap(pilot, "r", "r")
        assert (cells(pilot), snapshot(pilot).counters.step) == (4, 0)


async def test_a_session_brings_its_own_world(
    file: Path, app_of: MakeApp, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = app_of(recipe_named(str(file)))
    async with on_screen(app) as pilot:
        await tap(pilot, "s")
    file.write_text(text("S....G"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    ((session,), _) = sessions_in(tmp_path / "sessions")
    app = app_of(read_session(session.path))
    async with on_screen(app) as pilot:
        await tap(pilot, "r", "r")
        assert (cells(pilot), snapshot(pilot).counters.step) == (4, 0)


async def test_a_kiosk_reads_no_files(file: Path, app_of: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    app = app_of(recipe_named(str(file)))
    file.write_text(text("S....G"), encoding="utf-8")
    async with on_screen(app) as pilot:
        monkeypatch.setenv(VARIABLE, "1")
        assert isinstance(app.screen, Playground)
        app.screen.place |= type(app.screen.place).KIOSK
        await tap(pilot, "r", "r")
        assert cells(pilot) == 4


def test_what_a_person_has_set_stays_and_what_the_file_suggests_follows_it(file: Path) -> None:
    recipe = recipe_named(str(file), {"algorithm": "sarsa", "epsilon": 0.3}, 5)
    assert reread(recipe.scenario) is None
    file.write_text(text("S....G", 0.5), encoding="utf-8")
    scenario = reread(recipe.scenario)
    assert scenario is not None
    now = recipe_with(scenario, recipe)
    assert (now.algorithm, now.hyperparameters.epsilon, now.seed) == ("sarsa", 0.3, 5)
    assert now.hyperparameters.gamma == 0.5
    assert now.scenario is scenario


def test_a_file_that_cannot_be_looked_for_is_none_that_has_changed(file: Path) -> None:
    scenario = recipe_named(str(file)).scenario
    assert reread(replace(scenario, source=file.with_name("x" * 5_000))) is None
