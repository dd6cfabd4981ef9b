"""The requests of the keys of time travel."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from seams import notes, on_screen, playground, show, snapshot
from snapshots import changed
from textual.pilot import Pilot
from textual.widgets import Input

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Apply, ChooseBranch, Command, EpisodeBack, GoTo, LookAt, Restart, StepBack
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import JournalEntry, SetParameter
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.dialogs.form import Form
from rl_tui.screen.panels.controls.slider import Slider

JOURNAL = (JournalEntry(40, SetParameter("alpha", 0.5)),)


def recorded(pilot: Pilot[UserError], monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    sent: list[Command] = []

    def send(command: Command) -> None:
        if not isinstance(command, LookAt):
            sent.append(command)

    monkeypatch.setattr(playground(pilot).player, "send", send)
    return sent


def shows(pilot: Pilot[UserError], timeline: Timeline, **changes: object) -> Snapshot:
    made = changed(snapshot(pilot), timeline=timeline, step=timeline.current.here, **changes)
    screen = playground(pilot)
    show(screen, changed(made, handled=screen.wanted.sent))
    return made


def one(here: int, end: int) -> Timeline:
    return Timeline((Branch("branch 1", JOURNAL, end=end, here=here),))


def two(branch: int, here: int = 80) -> Timeline:
    return Timeline(
        (Branch("branch 1", JOURNAL, end=200, here=200), Branch("branch 2", (), 0, 20, end=here, here=here)),
        branch,
    )


async def test_b_goes_back_a_step_and_B_an_episode_as_often_as_they_are_pressed(  # noqa: N802
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        shows(pilot, one(100, 100))
        sent = recorded(pilot, monkeypatch)
        await pilot.press("b", "b", "b", "B", "b")
        assert sent == [StepBack(), StepBack(), StepBack(), EpisodeBack(), StepBack()]
        shows(pilot, one(0, 100))
        sent.clear()
        await pilot.press("b")
        assert sent == []
        assert notes(pilot.app) == ["This is step 0, the start of the run."]


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_timeline_is_scrubbed_with_keys_that_stand_above_it_and_with_the_mouse(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("student"), size) as pilot:
        shows(pilot, one(200, 200))
        sent, board = recorded(pilot, monkeypatch), playground(pilot).board
        assert "move" not in board.curve.heading
        await pilot.press("tab", "tab", "tab", "tab")
        assert board.timeline.has_focus
        assert "← →: move" in board.curve.heading
        await pilot.press("pagedown", "pagedown", "shift+left", "home")
        assert sent == [GoTo(180), GoTo(160), GoTo(159), GoTo(0)]
        sent.clear()
        await pilot.click("#timeline", offset=(size[0] // 4, 0))
        assert len(sent) == 1
        assert isinstance(sent[0], GoTo)
        assert 60 < (sent[0].step or 0) < 140
        await pilot.press("tab")
        assert "move" not in board.curve.heading


async def test_it_is_asked_where_to_and_it_goes_there(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student")) as pilot:
        shows(pilot, one(200, 200), episodes=60)
        sent = recorded(pilot, monkeypatch)
        await pilot.press("m", "g", *"12", "enter")
        await pilot.press("m", "g", *"e12", "enter")
        await pilot.press("m", "g", *"50%", "enter")
        await pilot.press("m", "g", "escape")
        assert sent == [GoTo(12), GoTo(episode=12), GoTo(100)]
        await pilot.press("m", "g", *"1234", "enter")
        assert isinstance(pilot.app.screen, Form)
        assert pilot.app.screen.query_one(Input).value == "1234"
        assert "a number" not in str(pilot.app.screen.query_one("#box").border_subtitle)
        assert len(sent) == 3


async def test_the_dialog_goes_to_another_branch_and_says_which_moment_that_is_or_to_a_change_in_it(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        shows(pilot, two(1))
        sent = recorded(pilot, monkeypatch)
        await pilot.press("m", "b", "enter")
        assert sent == []
        await pilot.press("m", "b", "up", "enter")
        assert sent == [ChooseBranch(0)]
        shows(pilot, two(0), phase=Phase.SEEKING)
        assert notes(pilot.app) == []
        first, second = two(0).branches
        for here in (80, 90):
            shows(pilot, Timeline((replace(first, here=here), second)), phase=Phase.PAUSED)
        await pilot.pause()
        assert notes(pilot.app) == ["branch 1, step 80: as before"]
        await pilot.press("m", "b", "down", "enter")
        shows(pilot, two(1))
        await pilot.pause()
        assert notes(pilot.app)[-1] == "branch 2, step 80: its latest step"
        sent.clear()
        await pilot.press("m", "b", "up", "tab", "enter")
        assert sent == [ChooseBranch(0), GoTo(40)]


async def test_a_fork_is_told_once(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        for timeline in (one(200, 200), one(20, 200)):
            shows(pilot, timeline)
        await pilot.pause()
        assert notes(pilot.app) == []
        for timeline in (two(1, 20), two(1, 25), two(0), two(1, 25)):
            shows(pilot, timeline)
        await pilot.pause()
        assert notes(pilot.app) == ["branch 2 begins here. m b: back to branch 1."]


async def test_branches_that_were_there_before_are_no_news(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        shows(pilot, one(0, 0), phase=Phase.PREPARING)
        shows(pilot, two(1))
        shows(pilot, one(200, 200))
        shows(pilot, two(1), shown=1)
        await pilot.pause()
        assert notes(pilot.app) == []


async def test_controls_and_recipe_follow_what_is_in_force(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student")) as pilot:
        screen = playground(pilot)
        values = snapshot(pilot).agent.hyperparameters
        later = values.changed("alpha", 0.5).changed("epsilon", 0.3)
        shows(pilot, one(200, 200), hyperparameters=later)
        assert screen.recipe.hyperparameters == later
        assert screen.query_one("#alpha", Slider).value == 0.5
        shows(pilot, one(20, 200), hyperparameters=values)
        assert screen.query_one("#alpha", Slider).value == values.alpha
        sent = recorded(pilot, monkeypatch)
        await pilot.press("r", "r")
        assert sent == [Restart(screen.recipe)]
        assert screen.recipe.hyperparameters == values
        shows(pilot, one(20, 200), algorithm="sarsa", recipe=replace(screen.recipe, seed=7))
        assert (screen.recipe.algorithm, screen.recipe.seed) == ("sarsa", 7)


async def test_what_is_still_under_way_is_not_taken_back(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student")) as pilot:
        screen = playground(pilot)
        before = shows(pilot, one(200, 200))
        sent = recorded(pilot, monkeypatch)
        screen.query_one("#alpha", Slider).focus()
        await pilot.press("right")
        assert len(sent) == 1
        assert isinstance(sent[0], Apply)
        asked = screen.recipe.hyperparameters.alpha
        assert asked != before.agent.hyperparameters.alpha
        show(screen, changed(before, handled=screen.wanted.sent - 1))
        assert screen.recipe.hyperparameters.alpha == asked
        assert screen.query_one("#alpha", Slider).value == asked


async def test_an_episode_beyond_the_end_is_told_only_where_the_run_ends(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A seek that a person stops or redirects has not reached the end."""
    async with on_screen(make_app("student"), notifications=True) as pilot:
        sent = recorded(pilot, monkeypatch)
        for here, says_so in ((120, False), (200, True)):
            shows(pilot, one(100, 200), episodes=30)
            sent.clear()
            await pilot.press("m", "g", *"e900", "enter")
            assert sent == [GoTo(episode=900)]
            shows(pilot, one(here, 200), episodes=here // 4)
            await pilot.pause()
            assert any("End of the run so far" in each for each in notes(pilot.app)) is says_so
