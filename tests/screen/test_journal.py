"""The journal in words."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from lane_samples import lane_views
from samples import bandit, lake, look, planning, student
from snapshots import changed
from textual.app import App
from textual.widgets import OptionList, Static

from rl_tui.live.commands import AddBranch, GoTo
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import (
    EditWorld,
    JournalEntry,
    RedoEdit,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
    UndoEdit,
)
from rl_tui.runs.results import Curve, RunResults
from rl_tui.runs.timeline.branches import Branch, Furthest, Timeline
from rl_tui.runs.timeline.run_names import LanePast
from rl_tui.screen.dialogs.journal import (
    HOW_TO_BRANCH,
    NO_CHANGE,
    JournalScreen,
    Moment,
    goto_form,
    journal_lines,
    parse_goto,
)
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.worlds.editing.edit import read_edits

HANDS = tuple(JournalEntry(step, TakeAction(1)) for step in range(3_400, 3_461))


def words(*journal: JournalEntry, of: Snapshot | None = None, glyphs: Glyphs = UNICODE) -> list[str]:
    snapshot = of or lake()
    lines = journal_lines(journal, snapshot.recipe, snapshot.world, glyphs)
    return [glyphs.spelled(line.text) for line in lines]


def test_a_change_tells_what_was_before() -> None:
    assert words(
        JournalEntry(1_200, SetParameter("alpha", 0.5)),
        JournalEntry(3_000, SwitchAlgorithm("sarsa")),
        JournalEntry(3_000, SetParameter("policy", "softmax")),
        JournalEntry(4_000, SetParameter("alpha", 0.25)),
        JournalEntry(5_000, SwitchAlgorithm("q-learning")),
        JournalEntry(5_001, SetParameter("ties", "first")),
    ) == [
        "step 1,200: α 0.1 → 0.5",
        "step 3,000: Q-learning → SARSA",
        "step 3,000: policy ε-greedy → softmax",
        "step 4,000: α 0.5 → 0.25",
        "step 5,000: SARSA → Q-learning",
        "step 5,001: ties random → first",
    ]


def test_a_slider_that_was_dragged_is_one_change() -> None:
    drag = [JournalEntry(7, SetParameter("gamma", value / 100)) for value in range(98, 49, -1)]
    assert words(*drag) == ["step 7: γ 0.99 → 0.5"]
    again = JournalEntry(8, SetParameter("gamma", 0.4))
    assert words(*drag, again) == ["step 7: γ 0.99 → 0.5", "step 8: γ 0.5 → 0.4"]


def test_each_stroke_is_a_line() -> None:
    edits = read_edits("world.cell[1,2]=#;world.cell[0,0:3]=.;world.rows=+1@0;world.noise=0.2")
    assert words(
        JournalEntry(7, EditWorld(edits[:1])),
        JournalEntry(7, EditWorld(edits)),
        JournalEntry(7, UndoEdit()),
        JournalEntry(7, UndoEdit()),
        JournalEntry(8, RedoEdit()),
    ) == [
        "step 7: world: cell[1,2]=#",
        "step 7: world: cell[1,2]=#; cell[0,0:3]=. and 2 more",
        "step 7: world: an edit undone",
        "step 7: world: an edit undone",
        "step 8: world: an edit redone",
    ]


def test_steps_by_hand_in_a_row_are_one_line() -> None:
    assert words(JournalEntry(3_300, TakeAction(0)), *HANDS, JournalEntry(3_500, TakeAction(2))) == [
        "step 3,301: by hand ←",
        "steps 3,401–3,461: 61 by hand",
        "step 3,501: by hand →",
    ]
    between = JournalEntry(3_461, SetParameter("alpha", 0.5))
    assert words(*HANDS, between, JournalEntry(3_461, TakeAction(0))) == [
        "steps 3,401–3,461: 61 by hand",
        "step 3,461: α 0.1 → 0.5",
        "step 3,462: by hand ←",
    ]
    assert words(JournalEntry(1, TakeAction(0)), of=student()) == ["step 2: by hand study"]


def test_ascii() -> None:
    lines = words(JournalEntry(7, SetParameter("alpha", 0.5)), *HANDS, glyphs=ASCII)
    assert lines[0] == "step 7: alpha 0.1 -> 0.5"
    assert lines[1] == "steps 3,401-3,461: 61 by hand"
    assert all(line.isascii() for line in lines)


# The dialog

FIRST = (JournalEntry(1_200, SetParameter("alpha", 0.5)), JournalEntry(3_000, SwitchAlgorithm("sarsa")))
SECOND = (JournalEntry(1_200, SetParameter("alpha", 0.3)), *HANDS)
TWO = Timeline(
    (
        Branch("branch 1", FIRST, end=10_000, here=10_000),
        Branch("branch 2", SECOND, 0, 1_200, end=5_001, here=5_001),
    ),
    1,
)


class Bench(App[None]):
    CSS_PATH = "../../rl_tui/screen/app/app.tcss"

    def __init__(self, timeline: Timeline, snapshot: Snapshot | None = None) -> None:
        super().__init__()
        self.snapshot = snapshot or lake(timeline=timeline)
        self.answers: list[Moment | AddBranch | None] = []

    def on_mount(self) -> None:
        self.push_screen(JournalScreen(look(), self.snapshot), self.answers.append)

    @property
    def rows(self) -> list[str]:
        return [str(each.prompt) for each in self.screen.query_one(OptionList).options]

    @property
    def about(self) -> str:
        return str(self.screen.query_one("#about", Static).render())


async def test_the_branches_are_told_apart() -> None:
    app = Bench(TWO)
    async with app.run_test(size=(100, 24)) as pilot:
        assert app.rows == [
            "1   branch 1            to step 10,000  2 changes",
            "2 ▸ branch 2 (current)  to step 5,001   from branch 1 at step 1,200, 1 change, 61 by…",
        ]
        assert app.about.splitlines() == [
            "From branch 1 at step 1,200, 1 change, 61 by hand.",
            "step 1,200: α 0.1 → 0.3 · steps 3,401–3,461: 61 by hand",
        ]
        await pilot.press("up")
        assert app.rows[0].startswith("1 ▸ branch 1")
        assert app.about.endswith("step 1,200: α 0.1 → 0.5 · step 3,000: Q-learning → SARSA")
        await pilot.press("tab")
        assert app.rows == ["1 ▸ step 1,200: α 0.1 → 0.5", "2   step 3,000: Q-learning → SARSA"]


async def test_enter_goes_to_a_branch_or_to_a_change() -> None:
    app = Bench(TWO)
    async with app.run_test(size=(80, 24)) as pilot:
        for keys, answer in (
            ("enter", Moment(1)),
            ("up enter", Moment(0)),
            ("1", Moment(0)),
            ("k enter", Moment(0)),
            ("up tab enter", Moment(0, 1_200)),
            ("up tab down enter", Moment(0, 3_000)),
            ("tab down escape up tab enter", Moment(0, 1_200)),
            ("tab down enter", Moment(1, 3_400)),
            ("tab 2", Moment(1, 3_400)),
            ("escape", None),
            ("q", None),
        ):
            await pilot.press(*keys.split())
            assert app.answers == [answer], keys
            app.answers.clear()
            app.on_mount()
            await pilot.pause()


async def test_c_compares_with_another_branch_that_is_no_run_yet() -> None:
    app = Bench(TWO)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("c")
        assert app.about == "Not here: branch 2 is the current one. Choose another branch."
        assert app.answers == []
        await pilot.press("up", "c")
    assert app.answers == [AddBranch(0)]
    snapshot = lake(timeline=TWO)
    past = LanePast(snapshot.recipe, snapshot.recipe, "branch 1", FIRST)
    there = replace(lane_views(2)[1], past=past)
    app = Bench(TWO, changed(snapshot, lanes=(lane_views(2)[0], there)))
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("up", "c")
        assert app.about == "Not here: branch 1 is already open as a run."
    assert app.answers == []


async def test_steps_by_hand_are_counted_apart_and_a_bandit_has_pulls() -> None:
    by_hand = Timeline((Branch("branch 1", HANDS, end=4_000, here=4_000),))
    one = Timeline((Branch("branch 1", end=1, here=1),))
    app = Bench(one)
    async with app.run_test(size=(80, 24)) as pilot:
        for snapshot, told in (
            (lake(timeline=by_hand), "to step 4,000  61 by hand"),
            (lake(timeline=one), "to step 1  no change"),
            (bandit(1, timeline=one), "to pull 1  no change"),
        ):
            await app.push_screen(JournalScreen(look(), snapshot))
            await pilot.pause()
            (only,) = app.rows
            assert only.endswith(told)


async def test_an_empty_journal_says_how_to_make_a_branch() -> None:
    app = Bench(Timeline((Branch("branch 1", end=7, here=7),)))
    async with app.run_test(size=(80, 24)) as pilot:
        assert NO_CHANGE in app.about
        assert HOW_TO_BRANCH in app.about
        await pilot.press("tab", "enter")
    assert app.answers == [Moment(0)]


# The prompt for a moment


def here(end: int, now: int | None = None) -> Timeline:
    return Timeline((Branch("branch 1", end=end, here=end if now is None else now),))


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("1234", GoTo(1_234)),
        ("1,234", GoTo(1_234)),
        (" step 1234 ", GoTo(1_234)),
        ("Step 1,234", GoTo(1_234)),
        ("0", GoTo(0)),
        ("10000", GoTo(10_000)),
        ("50%", GoTo(5_000)),
        ("12.5 %", GoTo(1_250)),
        ("100%", GoTo(10_000)),
        ("start", GoTo(0)),
        ("END", GoTo(10_000)),
        ("episode 12", GoTo(episode=12)),
        ("e12", GoTo(episode=12)),
        ("ep 12", GoTo(episode=12)),
    ],
)
def test_a_moment_may_be_written_in_many_ways(text: str, command: GoTo) -> None:
    assert parse_goto(text, lake(timeline=here(10_000))) == command


NO_MOMENT = "type a step (500, +50, -50), an episode (e12), a percentage, start or end"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", NO_MOMENT),
        ("x", NO_MOMENT),
        ("1.5", NO_MOMENT),
        ("1,2", NO_MOMENT),
        ("٣", NO_MOMENT),
        ("9" * 5_000, NO_MOMENT),
        ("month 3", NO_MOMENT),
        ("10001", "the run has reached step 10,000 so far; esc, then space goes on from there"),
        ("101%", "type a percentage from 0% to 100%"),
        ("e0", "episodes count from 1"),
        ("e12502", "the run has reached episode 12,501 so far; esc, then space goes on from there"),
    ],
)
def test_what_is_wrong_is_told(text: str, fault: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(fault)}$"):
        parse_goto(text, lake(timeline=here(10_000), episodes=12_500, episode_step=5))


@pytest.mark.parametrize(
    ("text", "step"), [("-50", 350), ("− 1", 399), ("+50", 450), ("-1,000", 0), ("+100", 500)]
)
def test_a_sign_counts_from_the_step_in_view(text: str, step: int) -> None:
    assert parse_goto(text, lake(timeline=here(500, 400))) == GoTo(step)


def test_in_the_past_nobody_knows_how_many_episodes_there_were() -> None:
    assert parse_goto("e12502", lake(timeline=here(10_000, 5_000))) == GoTo(episode=12_502)


@pytest.mark.parametrize(
    ("snapshot", "hint"),
    [
        (
            lake(timeline=here(10_000)),
            "a step from 0 to 10,000, e12 for episode 12, -50 for 50 back, 50%, start or end",
        ),
        (planning(timeline=here(132)), "a step from 0 to 132, sweep 12, -50 for 50 back, 50%, start or end"),
        (bandit(400, timeline=here(400)), "a pull from 0 to 400, -50 for 50 back, 50%, start or end"),
    ],
)
def test_the_prompt_names_the_range(snapshot: Snapshot, hint: str) -> None:
    form = goto_form(snapshot, look().glyphs)
    assert form.entry is not None
    assert form.entry.hint == hint


def test_moments_that_people_look_for_are_rows_and_what_is_unknown_says_so() -> None:
    rows = {each.name: each for each in goto_form(lake(timeline=TWO), look().glyphs).candidates}
    assert list(rows) == ["start", "first reward", "last change", "50 %", "end", "branches"]
    assert rows["last change"].value == "step 3,460"
    assert parse_goto(rows["last change"].id, lake(timeline=TWO)) == GoTo(3_460)
    assert rows["50 %"].value == "step 2,500"
    assert rows["branches"].value == "2"
    assert parse_goto(rows["end"].id, lake(timeline=TWO)) == GoTo(5_001)
    fresh = {each.name: each for each in goto_form(lake(timeline=here(10)), look().glyphs).candidates}
    assert fresh["last change"].refused == "nothing was changed in this branch"


def test_the_first_reward_keeps_its_episode_in_a_wide_bin_and_from_before_it() -> None:
    one_bin = Curve(np.array([4_096]), *(np.array([each]) for each in (0.5, 0.0, 1.0, 9.0)))
    now = lake(timeline=here(10_000))
    now = replace(now, results=RunResults(one_bin, first_reward_episode=247))
    past = lake(timeline=replace(here(10_000, 5), furthest=Furthest(now.counters, now.results)))
    for snapshot in (now, past):
        rows = {each.name: each for each in goto_form(snapshot, look().glyphs).candidates}
        assert rows["first reward"].value == "episode 247"
        assert rows["first reward"].id == "e247"


def test_sweeps_and_pulls() -> None:
    assert parse_goto("sweep 3", planning(timeline=here(132))) == GoTo(episode=3)
    assert parse_goto("pull 3", bandit(400, timeline=here(400))) == GoTo(3)
    with pytest.raises(ValueError, match="sweeps count from 1"):
        parse_goto("sweep 0", planning(timeline=here(132)))
