"""While a lesson keeps the answer back, no panel and no dialog shows anything that depends on it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from seams import playground, press, show, snapshot, train
from textual.pilot import Pilot

from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.answers.policy_values import PolicyAnswer
from rl_tui.lab.lessons.lesson import Lesson, lesson_of
from rl_tui.lab.lessons.record import begun
from rl_tui.lab.lessons.setups import recipe_of
from rl_tui.lab.live.commands import AddLane, HideAnswer, KeepLesson
from rl_tui.lab.live.player import Player
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.run.exact_answers import Answer
from rl_tui.lab.run.recipe import SetParameter
from rl_tui.lab.run.results import RunResults
from rl_tui.tui.app.app import RlTuiApp
from rl_tui.tui.app.display import Display
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.panels.snapshot_facts import is_secret

TEXT = """
title = "Kept back"
summary = "A question that waits."
minutes = 1
goals = ["Find out"]
[setups.only]
scenario = "{scenario}"
[[pages]]
id = "ask"
title = "Ask"
hides = ["answer"]
[pages.question]
ask = "How much?"
answer = 12345
"""
OTHER = 3.0625
"""By how much all exact figures are other ones."""


def lesson(scenario: str) -> Lesson:
    return lesson_of(TEXT.replace("{scenario}", scenario), Path("secret.toml"))


def moved(figure: float | None) -> float | None:
    return None if figure is None else figure + OTHER


def otherwise(snapshot: Snapshot) -> Snapshot:
    """``snapshot`` with another exact answer: all that is worked out exactly is another figure."""
    solution = snapshot.exact_answer.solution
    assert solution is not None
    answer = replace(
        solution,
        v=solution.v + OTHER,
        q=solution.q[::-1] + OTHER,
        best=~solution.best,
        greedy=~solution.greedy,
        value_at_start=solution.value_at_start + OTHER,
        expected_return=moved(solution.expected_return),
        best_expected_return=moved(solution.best_expected_return),
    )
    group = snapshot.run_group
    lanes = tuple(replace(lane, results=_other_results(lane.results)) for lane in group.lanes)
    return replace(
        snapshot,
        exact_answer=Answer(answer, ""),
        results=_other_results(snapshot.results),
        run_group=replace(group, lanes=lanes),
        answers=replace(
            snapshot.answers,
            policies={
                kind: worth if kind is PolicyKind.UNIFORM else _other_worth(worth)
                for kind, worth in snapshot.answers.policies.items()
            },
        ),
        beside=None if snapshot.beside is None else otherwise(snapshot.beside),
    )


def _other_results(results: RunResults) -> RunResults:
    bandit = results.bandit
    if bandit is not None:
        bandit = replace(bandit, regret=bandit.regret + 50.0, best_possible=bandit.best_possible + 50.0)
    return replace(
        results,
        marks=replace(results.marks, expected_return=results.marks.expected_return + OTHER),
        greedy_return=moved(results.greedy_return),
        behaviour_return=moved(results.behaviour_return),
        bandit=bandit,
    )


def _other_worth(worth: PolicyAnswer) -> PolicyAnswer:
    def other(values: Any) -> Any:
        return None if values is None else np.asarray(values) + OTHER

    return replace(
        worth,
        v=other(worth.v),
        q=other(worth.q),
        value_at_start=moved(worth.value_at_start),
        expected_return=moved(worth.expected_return),
    )


async def pictures(pilot: Pilot[Any]) -> tuple[str, str]:
    """What is on screen, colours and all, and what would be there if the answer were another one."""
    await settle(pilot)
    screen, now = playground(pilot), snapshot(pilot)
    assert is_secret(now)
    drawn = []
    for each in (now, otherwise(now)):
        show(screen, each)
        await pilot.pause()
        drawn.append(pilot.app.export_screenshot(title="", simplify=True))
    show(screen, now)
    return drawn[0], drawn[1]


@pytest.mark.parametrize("size", [(120, 40), (80, 24)])
@pytest.mark.parametrize("scenario", ["student", "frozenlake-slippery", "bandit"])
async def test_no_panel_depends_on_the_answer(scenario: str, size: tuple[int, int]) -> None:
    taught = lesson(scenario)
    app = RlTuiApp(
        Display(fps=1000.0), recipe_of(taught, "only"), partial(Player, automatic=False), picture=True
    )
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        screen = playground(pilot)
        screen.send(KeepLesson(begun(taught)))
        screen.send(HideAnswer(is_hidden=False))
        await train(pilot, 1_000)  # that spends the budget of the bandit
        if size == (80, 24):
            await press(pilot, "R")
        for keys in (["v"], ["v"], ["d"], ["d", "P"], ["P", "f"], ["f", "V"], ["V", "u"], ["escape"]):
            await press(pilot, *keys)
            before, other = await pictures(pilot)
            assert before == other, keys
        screen.send(AddLane((SetParameter("alpha", 0.25),)))
        for keys in ([], ["z"], ["c"]):
            await press(pilot, *keys)
            before, other = await pictures(pilot)
            assert before == other, keys


async def test_the_pictures_would_tell() -> None:
    """What is asked for above can fail: with the answer shown, the pictures differ."""
    taught = lesson("student")
    app = RlTuiApp(
        Display(fps=1000.0), recipe_of(taught, "only"), partial(Player, automatic=False), picture=True
    )
    async with app.run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        screen = playground(pilot)
        screen.send(HideAnswer(is_hidden=False))
        await train(pilot, 100)
        drawn = []
        for each in (snapshot(pilot), otherwise(snapshot(pilot))):
            show(screen, each)
            await pilot.pause()
            drawn.append(app.export_screenshot(title="", simplify=True))
        assert drawn[0] != drawn[1]
