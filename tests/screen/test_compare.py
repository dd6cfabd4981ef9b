"""The dialog of several runs."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from lane_samples import lane_views, showing
from sample_worlds import bandit_world, lake_world
from seams import choose, notes, on_screen, playground, screen_text, show, snapshot
from snapshots import changed
from textual.pilot import Pilot
from textual.widgets import Input, OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddBranch, AddLane, ChooseLane, Command, DropLane, HideAnswer, MarkLane
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import JournalEntry, SetParameter, SwitchAlgorithm
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.compare_lanes import RunTable, lane_changes, what_may_differ
from rl_tui.screen.dialogs.form import Choice, Prompt
from rl_tui.screen.playground.actions.lanes import ONE_RUN
from rl_tui.worlds.files.catalogue import find

LAKE, ARMS = lake_world().space, bandit_world().space
RECIPE = recipe_for(find("frozenlake-slippery"), {"alpha": 0.1, "epsilon": 0.1}, 0)


# Possible differences


def test_what_counts_may_be_different_and_what_does_not_may_not() -> None:
    names = what_may_differ(RECIPE)
    assert names[:7] == ("algorithm", "alpha", "gamma", "policy", "epsilon", "ties", "initial_q")
    assert "epsilon_decay" in names
    assert "temperature" not in names
    assert "gamma" not in what_may_differ(recipe_for(find("bandit"), {}, 0))
    planner = what_may_differ(replace(RECIPE, algorithm="value-iteration"))
    assert planner == ("algorithm", "gamma", "accuracy", "initial_q")


def test_a_difference_becomes_the_changes_that_make_it() -> None:
    assert lane_changes(LAKE, RECIPE, "alpha", 0.5) == (SetParameter("alpha", 0.5),)
    assert lane_changes(LAKE, RECIPE, "algorithm", "sarsa") == (SwitchAlgorithm("sarsa"),)
    assert lane_changes(LAKE, RECIPE, "ties", "first") == (SetParameter("ties", "first"),)
    assert lane_changes(LAKE, RECIPE, "policy", "softmax") == (SetParameter("policy", "softmax"),)


def test_a_step_size_comes_along_where_it_was_the_sample_average() -> None:
    recipe = recipe_for(find("bandit"), {}, 0)
    assert recipe.hyperparameters.sample_average
    gradient = lane_changes(ARMS, recipe, "policy", "gradient")
    assert gradient[-1] == SetParameter("policy", "gradient")
    assert SetParameter("alpha", 0.1) in gradient
    assert lane_changes(ARMS, recipe, "alpha", 0.3)[-1] == SetParameter("alpha", 0.3)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("alpha", 0.1, "changes nothing"),
        ("algorithm", "q-learning", "changes nothing"),
        ("alpha_min", 0.05, "changes nothing"),  # without a decay, α never reaches it
        ("policy", "gradient", "is for bandits"),
    ],
)
def test_what_is_no_difference_or_cannot_work_is_refused(name: str, value: float | str, reason: str) -> None:
    with pytest.raises(UserError, match=reason):
        lane_changes(LAKE, RECIPE, name, value)


# The dialog


def rows(pilot: Pilot[UserError]) -> list[str]:
    choices = pilot.app.screen.query_one(OptionList)
    prompts = (choices.get_option_at_index(place).prompt for place in range(choices.option_count))
    return [str(prompt) for prompt in prompts]


async def beside(pilot: Pilot[UserError], count: int, monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    screen, sent = playground(pilot), list[Command]()
    monkeypatch.setattr(screen.link, "send", sent.append)
    before = screen.snapshot
    assert before is not None
    lanes = tuple(replace(lane, q=before.agent.q) for lane in lane_views(count))
    shown = 1 if count > 1 else 0
    show(screen, changed(showing(before, lanes[shown]), lanes=lanes if count > 1 else (), shown=shown))
    await pilot.pause()
    return sent


async def test_the_branches_of_the_run_can_be_runs_once_the_world_is_there(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    def entry(step: int) -> JournalEntry:
        return JournalEntry(step, SetParameter("epsilon", step / 100))

    first = Branch("branch 1", end=1_000, here=7)
    forks = (Branch(f"branch {n}", (entry(n),), 0, n, end=700 + n, here=9) for n in range(2, 8))
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        sent = await beside(pilot, 1, monkeypatch)
        await pilot.press("c", "b")
        assert "this run has one branch" in screen_text(pilot.app), "that cannot be chosen"
        await pilot.press("escape")
        show(playground(pilot), changed(snapshot(pilot), timeline=Timeline((first, *forks), 6)))
        await pilot.press("c", "b")
        listed = rows(pilot)
        assert listed[0] == "1 ▸ branch 6: ε 0.06 from step 6 · to step 706"
        assert listed[3] == "4   branch 3: ε 0.03 from step 3 · to step 703"
        assert len(listed) == 6
        await pilot.press("1")
        assert sent == [AddBranch(5)]
        playground(pilot).link.snapshot = None
        await pilot.press("c", "b")
        assert not isinstance(pilot.app.screen, Choice), "nothing is asked without a world"


async def test_of_another_setting_the_sliders_come_first_and_schedules_are_folded(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        await beside(pilot, 1, monkeypatch)
        await pilot.press("c", "s")
        listed = rows(pilot)
        assert [row[4:].split()[0] for row in listed] == ["α", "γ", "ε", "policy", "ties", "Q₀", "schedules"]
        assert listed[0].split() == ["1", "▸", "α", "constant", "0.1", "step", "size"]
        assert listed[-1] == "7   schedules (6)"
        await pilot.press("7")
        unfolded = rows(pilot)
        assert [row.split() for row in unfolded[1:6]] == [row.split() for row in listed[1:6]]
        assert unfolded[6].split() == ["7", "▸", "α", "schedule", "constant", "no", "effect", "now"]


async def test_the_table_of_the_runs_controls_one_puts_one_beside_it_or_ends_one(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        sent = await beside(pilot, 3, monkeypatch)
        await pilot.press("c", "c")
        assert isinstance(pilot.app.screen, RunTable)
        listed = rows(pilot)
        assert listed[0].split() == ["run", "algorithm", "step", "last", "100", "greedy"]
        assert listed[1].split() == ["1", "α", "0.1", "Q-learning", "150,000", ".500", ".730"]
        assert listed[2].startswith("2 ▸ α 0.5 ")
        assert listed[2].endswith("control")
        assert listed[3].split()[:3] == ["3", "SARSA", "SARSA"]
        assert pilot.app.screen.query_one(OptionList).highlighted == 2
        await pilot.press("up", "enter")
        assert sent == [ChooseLane(0)]
        assert not pilot.app.screen.query(OptionList)
        await pilot.press("c", "c", "3")
        assert sent[1:] == [ChooseLane(2)]
        await pilot.press("c", "c", "down", "delete", "enter")
        assert sent[2:] == [DropLane(2)]
        await pilot.press("c", "c", "up", "backspace", "enter")
        assert sent[3:] == [DropLane(0)]
        await pilot.press("c", "c", "space")
        about = pilot.app.screen.query_one("#about", Static)
        assert str(about.render()).startswith("Not here: you control this one.")
        await pilot.press("up", "space")
        assert sent[4:] == [MarkLane(0)]
        await pilot.press("c", "c", "enter", "c", "l")  # the visible one first, then the next
        assert sent[5:] == [ChooseLane(2)]


async def test_one_run_is_compared_with_what_is_chosen(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("frozenlake-slippery")
    async with on_screen(app, notifications=True) as pilot:
        sent = await beside(pilot, 1, monkeypatch)
        for key in "lco":
            await pilot.press("c", key)
            assert f"Not here: {ONE_RUN}." in screen_text(pilot.app)
            await pilot.press("escape")
        await pilot.press("c", "s")
        await choose(pilot, "alpha")
        assert isinstance(app.screen, Prompt)
        app.screen.query_one(Input).value = "0.5"
        await pilot.press("enter")
        await pilot.press("c", "a")
        assert isinstance(app.screen, Choice)
        assert app.screen.query_one("#box").border_title == "Another algorithm beside Q-learning"
        await choose(pilot, "sarsa")
        await pilot.press("c", "s")
        await choose(pilot, "initial_q")
        assert "starts again" not in str(app.screen.query_one(".hint", Static).render())
        await pilot.press("5", "enter")
        assert sent == [
            AddLane((SetParameter("alpha", 0.5),)),
            AddLane((SwitchAlgorithm("sarsa"),)),
            AddLane((SetParameter("initial_q", 5.0),)),
        ]
        await pilot.press("c", "s")
        await choose(pilot, "gamma")
        await pilot.press("enter")  # the current value
        assert len(sent) == 3
        assert "changes nothing" in notes(pilot.app)[-1]


async def test_in_a_narrow_terminal_each_run_keeps_to_its_row_and_four_are_the_most(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (60, 18)) as pilot:
        await beside(pilot, 4, monkeypatch)
        await pilot.press("c", "a")
        assert "four runs are open" in screen_text(pilot.app)
        await pilot.press("c")
        listed = rows(pilot)
        assert listed[1].split() == ["1", "α", "0.1", "150,000", ".500", ".730"]
        width = pilot.app.screen.query_one(OptionList).scrollable_content_region.width
        assert max(map(len, listed[:5])) <= width
        await pilot.resize_terminal(120, 40)
        await settle(pilot)
        assert "softmax, τ 0.3" in rows(pilot)[4]


async def test_the_menu_and_the_question_name_the_run_that_would_end(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        sent = await beside(pilot, 2, monkeypatch)
        group = snapshot(pilot).run_group
        number, name = group.shown + 1, group.lanes[group.shown].name
        await pilot.press("c")
        assert f"end run {number}: {name}" in " ".join(screen_text(pilot.app).split())
        await pilot.press("e")
        assert f"End run {number}?" in screen_text(pilot.app)
        assert f"{name} is at step " in screen_text(pilot.app)
        await pilot.press("escape")
        assert sent == []


async def test_a_hidden_bandit_gives_nothing_away(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("bandit", ascii=True)) as pilot:
        sent = await beside(pilot, 2, monkeypatch)
        await pilot.press("c", "c")
        assert "-" in rows(pilot)[1].split()
        assert ".730" not in " ".join(rows(pilot))
        assert "Hidden until w h." in str(pilot.app.screen.query_one("#about", Static).render())
        assert all(row.isascii() for row in rows(pilot))
        await pilot.press("escape", "w", "h")
        assert sent == [HideAnswer(is_hidden=False)]
        show(playground(pilot), changed(snapshot(pilot), is_hidden=False))
        await pilot.press("c", "c")
        assert ".730" in rows(pilot)[1].split()
