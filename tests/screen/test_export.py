"""Exporting from the playground, with real keys."""

from __future__ import annotations

import csv
import shlex
import threading
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import MakeApp
from open_grids import open_grid_recipe
from seams import app_at, notes, on_screen, order, tap, train
from seams import snapshot as shown
from textual.pilot import Pilot
from textual.widgets import Input, OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddLane
from rl_tui.runs.recipe import SetParameter
from rl_tui.screen.dialogs.export import BrokenOffError, CommandLine, Working
from rl_tui.screen.dialogs.form import Choice, Prompt


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


async def press(pilot: Pilot[UserError], *keys: str) -> None:
    for key in keys:
        await tap(pilot, key)
        while isinstance(pilot.app.screen, Working):
            await pilot.pause()


async def choose(pilot: Pilot[UserError], kind: str) -> None:
    await press(pilot, "m", "x")
    options = pilot.app.screen.query_one(OptionList)
    while options.highlighted_option is None or options.highlighted_option.id != kind:
        await press(pilot, "down")
    await press(pilot, "enter")


def said(pilot: Pilot[UserError]) -> list[str]:
    return notes(pilot.app)


async def test_a_script_is_written_under_the_name_offered_and_never_over_what_is_there(
    make_app: MakeApp, folder: Path
) -> None:
    (folder / "mine.py").write_text("mine", encoding="utf-8")
    name = "frozenlake-q-learning.py"
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        await train(pilot, 50)
        await choose(pilot, "script")
        assert pilot.app.screen.query_one(Input).value == name
        await tap(pilot, *"mine.py")
        fault = pilot.app.screen.query_one(".error", Static)
        assert str(fault.render()) == "Mine.py already exists: type another name."
        await press(pilot, "enter")
        assert isinstance(pilot.app.screen, Prompt)
        await press(pilot, "escape")
        assert [path.name for path in folder.iterdir()] == ["mine.py"]
        await choose(pilot, "script")
        await press(pilot, "enter")
        compile((folder / name).read_text(encoding="utf-8"), "script", "exec")
        assert name in "".join(said(pilot)).replace("\n", "")
        await choose(pilot, "script")
        assert pilot.app.screen.query_one(Input).value == "frozenlake-q-learning-2.py"
    assert (folder / "mine.py").read_text(encoding="utf-8") == "mine"


async def test_of_two_lanes_the_one_shown_is_exported_and_named(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "m", "x")
        assert pilot.app.screen.query_one("#box").border_title == "Export"
        await press(pilot, "escape")
        await order(pilot, AddLane((SetParameter("alpha", 0.5),)))
        await press(pilot, "m", "x")
        number = shown(pilot).run_group.shown + 1
        assert pilot.app.screen.query_one("#box").border_title == f"Export · run {number} of 2"
        about = str(pilot.app.screen.query_one("#about", Static).render())
        assert f"Only run {number} of 2 is exported." in " ".join(about.split())


async def test_tables_and_the_picture_are_those_that_are_shown(make_app: MakeApp, folder: Path) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        await press(pilot, "m", "x")
        assert isinstance(pilot.app.screen, Choice)
        option = pilot.app.screen.query_one(OptionList).get_option("returns")
        assert "not here: no episode has finished yet" in str(option.prompt)
        await press(pilot, "5")
        assert isinstance(pilot.app.screen, Choice), "that cannot be chosen"
        await press(pilot, "home", "down")
        assert "true means" not in str(pilot.app.screen.query_one("#about", Static).render())
        await press(pilot, "escape")
        await train(pilot, 300)
        for number, kind in enumerate(("q-csv", "q-npy", "returns", "svg"), start=1):
            await choose(pilot, kind)
            await press(pilot, "enter")
            assert len(list(folder.iterdir())) == number
        snapshot = shown(pilot)
        q = np.load(folder / "student-q-learning-q.npy")
        np.testing.assert_array_equal(np.sort(q[~np.isnan(q)]), np.sort(snapshot.agent.q))
        with (folder / "student-q-learning-q.csv").open(encoding="utf-8") as stream:
            assert [row["state"] for row in csv.DictReader(stream)] == ["Class", "Phone", "Pass"]
        with (folder / "student-q-learning-returns.csv").open(encoding="utf-8") as stream:
            assert len(list(csv.DictReader(stream))) == snapshot.counters.episodes
        assert len(said(pilot)) == 4
        picture = (folder / "student-q-learning.svg").read_text(encoding="utf-8")
    assert picture.startswith("<svg")
    assert "evening" in picture
    assert "esc:" not in picture


async def test_of_a_map_that_is_shown_in_parts_all_of_q_is_written(folder: Path) -> None:
    app = app_at(open_grid_recipe(165))
    async with on_screen(app, notifications=True) as pilot:
        await train(pilot, 2000)
        snapshot = shown(pilot)
        assert snapshot.agent.part is not None
        await choose(pilot, "q-csv")
        await press(pilot, "enter")
        (path,) = folder.iterdir()
        with path.open(encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        assert len(rows) == 165 * 165 - 1
        visits = sum(int(count) for row in rows for name, count in row.items() if name.startswith("visits"))
        assert visits == 2000


async def test_the_command_has_what_was_changed_and_can_be_copied_or_written(
    make_app: MakeApp, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("frozenlake", seed=3)
    async with on_screen(app, notifications=True) as pilot:
        await train(pilot, 40)
        await press(pilot, "a", "t")
        await train(pilot, 10)
        await choose(pilot, "command")
        assert isinstance(app.screen, CommandLine)
        line = str(app.screen.query_one("#command Static", Static).render())
        assert shlex.split(line) == [
            *("rl-tui", "train", "frozenlake", "--seed", "3", "--steps", "50"),
            *("--change", "40:ties=first"),
        ]
        await press(pilot, "c")
        assert app.clipboard == line
        await press(pilot, "w", "enter")
        assert (folder / "frozenlake-q-learning.txt").read_text(encoding="utf-8") == f"{line}\n"


async def test_why_there_is_no_script_is_told_in_a_line(make_app: MakeApp, folder: Path) -> None:
    async with on_screen(make_app("egg"), notifications=True) as pilot:
        await choose(pilot, "script")
        assert "cannot tell some of its states apart" in "".join(said(pilot)).replace("\n", " ")
    assert list(folder.iterdir()) == []


async def test_a_bandit_warns_of_its_true_means_and_what_takes_long_can_be_broken_off(
    make_app: MakeApp,
) -> None:
    met = SimpleNamespace(begun=threading.Event(), ended=threading.Event())

    def endless(on_progress: object) -> None:
        assert callable(on_progress)
        met.begun.set()
        try:
            while True:
                on_progress(1, 3)
        except BrokenOffError:
            met.ended.set()
            raise

    async with on_screen(make_app("bandit")) as pilot:
        await press(pilot, "m", "x", "down")
        assert "true means" in str(pilot.app.screen.query_one("#about", Static).render())
        await press(pilot, "escape")
        answers: list[str | None] = []
        pilot.app.push_screen(Working("Returns", endless), answers.append)
        await pilot.pause()
        assert met.begun.wait(20)
        await tap(pilot, "escape")
        assert met.ended.wait(20)
    assert answers == [None]
