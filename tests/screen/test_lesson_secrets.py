"""While a lesson hides the exact values, nothing reveals them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from seams import playground, press, screen_rows, show, snapshot, train
from study_samples import bandit_study, lake_study
from textual.pilot import Pilot
from textual.strip import Strip

from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import begun
from rl_tui.lessons.lesson import Lesson, lesson_of
from rl_tui.live.commands import AddLane, HideAnswer, KeepLesson
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.flip_answer import FlipAnswer, worked_out
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.runs.exact_answers import Answer
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import SetParameter, begin
from rl_tui.runs.results import RunResults
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.kit.snapshot_facts import is_secret
from rl_tui.studies.many_seeds.figures import LaneStudy, SeedStudy
from rl_tui.worlds.drawing import Grid

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
"""The offset of all exact numbers."""
EXACT_FIGURES = ("value_at_start", "expected_return", "max_error", "regret", "best_arm_rate")


def lesson(scenario: str) -> Lesson:
    return lesson_of(TEXT.replace("{scenario}", scenario), Path("secret.toml"))


def moved(figure: float | None) -> float | None:
    return None if figure is None else figure + OTHER


def otherwise(snapshot: Snapshot) -> Snapshot:
    solution = snapshot.exact_answer.solution
    assert solution is not None
    answer = replace(
        solution,
        v=solution.v + OTHER,
        q=solution.q[::-1] + OTHER,
        best=~solution.best,
        greedy=~solution.greedy,
        value_at_start=solution.value_at_start + OTHER,
    )
    group = snapshot.run_group
    lanes = tuple(replace(lane, results=_other_results(lane.results)) for lane in group.lanes)
    return replace(
        snapshot,
        exact_answer=Answer(answer, "", moved(snapshot.exact_answer.expected_return)),
        results=_other_results(snapshot.results),
        run_group=replace(group, lanes=lanes),
        answers=replace(
            snapshot.answers,
            flips=flips_of_the_student(),
            policies={
                kind: worth if kind is PolicyKind.UNIFORM else _other_worth(worth)
                for kind, worth in snapshot.answers.policies.items()
            },
        ),
        beside=None if snapshot.beside is None else otherwise(snapshot.beside),
        study=None if snapshot.study is None else _other_study(snapshot.study),
    )


@cache
def flips_of_the_student() -> FlipAnswer:
    mdp = begin(recipe_named("student")).world.mdp
    assert mdp is not None
    return worked_out(mdp)


def _other_study(study: SeedStudy) -> SeedStudy:
    return replace(study, lanes=tuple(_other_lane(lane) for lane in study.lanes))


def _other_lane(lane: LaneStudy) -> LaneStudy:
    return replace(
        lane,
        estimates={
            name: replace(each, mean=each.mean + OTHER) if name in EXACT_FIGURES else each
            for name, each in lane.estimates.items()
        },
        this_seed={
            name: moved(each) if name in EXACT_FIGURES else each for name, each in lane.this_seed.items()
        },
        differences={
            name: replace(each, mean=replace(each.mean, mean=each.mean.mean + OTHER), greater=1)
            if name in EXACT_FIGURES
            else each
            for name, each in lane.differences.items()
        },
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


async def pictures(pilot: Pilot[Any], study: SeedStudy | None = None) -> tuple[list[Strip], list[Strip]]:
    """Return the screen, with colours, and the screen for other exact values."""
    await settle(pilot)
    screen, now = playground(pilot), snapshot(pilot)
    assert is_secret(now)
    now = now if study is None else replace(now, study=study)
    drawn = []
    for each in (now, otherwise(now)):
        show(screen, each)
        await pilot.pause()
        drawn.append(screen_rows(pilot.app))
    show(screen, now)
    return drawn[0], drawn[1]


@pytest.mark.exhaustive("opens everything in each world", but=["frozenlake-slippery-size1"])
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
        await train(pilot, 1_000)  # the budget of the bandit is spent
        if size == (80, 24):
            await press(pilot, "escape")
        turn = ["w", "a"] if isinstance(snapshot(pilot).world.drawing, Grid) else []
        policies = ["t", "p"]
        for keys in (["v"], ["v"], ["d"], ["d", *policies], [*policies, "f"], ["f", *turn], [*turn, "u"]):
            await press(pilot, *keys)
            before, other = await pictures(pilot)
            assert before == other, keys
        for keys in (["escape"], ["w"], ["escape"]):
            await press(pilot, *keys)
            before, other = await pictures(pilot)
            assert before == other, keys
        # help, the model, and the slider of γ with its flip points
        for keys in (["question_mark"], ["escape", "w", "m"], ["escape", "2"], ["escape"]):
            await press(pilot, *keys)
            before, other = await pictures(pilot)
            assert before == other, keys
        await press(pilot, "t", "m")
        study = bandit_study() if scenario == "bandit" else lake_study()
        before, other = await pictures(pilot, replace(study, lanes=study.lanes[:1], shown=0))
        assert before == other
        await press(pilot, "t", "m")
        screen.send(AddLane((SetParameter("alpha", 0.25),)))
        for keys in ([], ["c", "o"], ["c", "c"]):
            await press(pilot, *keys)
            before, other = await pictures(pilot)
            assert before == other, keys


async def test_the_pictures_would_tell() -> None:
    """The test above can fail: with exact values visible, the pictures differ."""
    taught = lesson("student")
    app = RlTuiApp(
        Display(fps=1000.0), recipe_of(taught, "only"), partial(Player, automatic=False), picture=True
    )
    async with app.run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        screen = playground(pilot)
        screen.send(HideAnswer(is_hidden=False))
        await train(pilot, 100)
        for keys in ([], ["w", "m"], ["escape", "2"], ["escape", "t", "m"]):
            await press(pilot, *keys)
            now = replace(snapshot(pilot), study=lake_study())
            drawn = []
            for each in (now, otherwise(now)):
                show(screen, each)
                await pilot.pause()
                drawn.append(screen_rows(app))
            assert drawn[0] != drawn[1], keys
