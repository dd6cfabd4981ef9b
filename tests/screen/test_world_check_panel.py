"""The panel of the world check."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

from click.testing import CliRunner
from conftest import MakeApp
from samples import bandit, lake, look, student
from seams import on_screen, press, screen_text, snapshot
from snapshots import changed

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.commands.main import program
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.view import AnswersView
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.panels.world_check import FINE, OUTDATED, TITLE, WAITING, WorldCheckPanel
from rl_tui.studies.world_check.deep_check import Question, reports
from rl_tui.studies.world_check.report import CheckStage, WorldReport
from rl_tui.studies.world_check.world_checks import IN_KIOSK, WorldCheckView

SIZES = ((118, 30), (58, 19), (36, 17), (36, 5), (20, 30), (16, 10), (5, 3), (1, 1))


@cache
def grown(shown: Snapshot) -> tuple[WorldReport, ...]:
    mdp = shown.world.mdp
    assert mdp is not None
    return tuple(reports(Question(mdp, "q-learning", Hyperparameters(gamma=0.9), 20)))


def with_check(shown: Snapshot, report: WorldReport | None = None, **view: Any) -> Snapshot:
    known = WorldCheckView(report or grown(shown)[-1], shown.world, 0.9)
    return changed(shown, world_check=replace(known, **view))


@cache
def walk() -> Snapshot:
    """A world in which each policy ends, which needs no trials."""
    return changed(student(), world=begin(recipe_named("random-walk")).world)


def drawn(shown: Snapshot | None, width: int = 58, height: int = 30, *, ascii: bool = False) -> str:  # noqa: A002
    panel = WorldCheckPanel(look(ascii))
    rows = panel.picture(shown, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def said(shown: Snapshot | None, width: int = 58) -> str:
    return " ".join(drawn(shown, width).split())


def test_it_tells_how_long_the_rest_takes() -> None:
    assert said(changed(walk(), world_check=WorldCheckView(how_long="40 s"))) == f"{WAITING} · 40 s"
    assert "40 s" in said(with_check(walk(), grown(walk())[0], how_long="40 s"))
    assert "40 s" not in said(with_check(walk(), is_outdated=True, how_long="40 s"))


def test_it_is_drawn_at_any_size() -> None:
    shown = [with_check(walk(), report) for report in grown(walk())]
    shown += [with_check(walk(), is_outdated=True), with_check(walk(), refused="too large")]
    shown += [changed(walk(), world_check=WorldCheckView(refused=IN_KIOSK)), student()]
    shown += [changed(walk(), world_check=WorldCheckView(how_long="about 40 s left"))]
    for each, size in product(shown, SIZES):
        drawn(each, *size)
        assert drawn(each, *size, ascii=True).isascii()


def test_rows_are_closer_together_where_they_would_not_fit() -> None:
    shown = with_check(walk())
    assert "\n\n" in drawn(shown).rstrip("\n")
    assert "\n\n" not in drawn(shown, 40, 15).rstrip("\n")


def test_it_says_how_far_it_has_come() -> None:
    assert said(None) == said(student()) == said(changed(student(), world_check=WorldCheckView())) == WAITING
    first, *_, last = grown(walk())
    assert "computing the flip points" in said(with_check(walk(), first))
    assert FINE in said(with_check(walk(), last))
    trying = replace(last, stage=CheckStage.TRIALS, trying="sarsa")
    assert "trying SARSA, 2 of 12" in said(with_check(walk(), trying))
    assert OUTDATED in said(with_check(walk(), is_outdated=True))
    warned = replace(last, warnings=("never ends: add a time_limit to end such episodes",))
    text = said(with_check(walk(), warned))
    assert text.startswith("1 warning ! never ends: add a time_limit to end such episodes random policy")
    broken_off = said(with_check(walk(), first, refused="it took too long"))
    assert "it took too long" in broken_off
    assert "0.50000" in broken_off


def test_what_is_not_known_yet_and_what_never_will_be_look_different() -> None:
    first = grown(walk())[0]
    assert "may never end …" in said(with_check(walk(), first))
    unknown = replace(first, random_return=None, unknown={"random_return": "too large"})
    assert "random policy not known: too large" in said(with_check(walk(), unknown))


def test_while_hidden_nothing_gives_the_answer_away() -> None:
    hidden = said(changed(with_check(walk()), answers=AnswersView(is_hidden=True)))
    assert "best policy ···" in hidden
    assert "flip points ···" in hidden
    assert "random policy 0.50000" in hidden
    assert "··· is hidden: w h shows it" in hidden
    warning = "the best policy never ends"
    warned = replace(grown(walk())[-1], warnings=(warning,))
    told = with_check(walk(), warned)
    assert warning in said(told)
    hidden = said(changed(told, answers=AnswersView(is_hidden=True)))
    assert warning not in hidden
    assert "1 warning" in hidden
    assert "warnings: w h shows them" in hidden
    arms = said(changed(with_check(bandit(1)), answers=AnswersView(is_hidden=True)))
    assert "random policy ···" in arms
    assert "no way out no states" in arms


def test_a_report_of_another_world_names_the_states_of_that_one() -> None:
    far = replace(grown(lake())[0], never_reached=(15,))
    view = WorldCheckView(far, lake().world, 0.9, is_outdated=True)
    assert "1 state: 15" in said(changed(student(), world_check=view))


async def test_figures_on_screen_are_the_commands(make_app: MakeApp) -> None:
    printed = CliRunner().invoke(program, ["check", "--deep", "random-walk", "--json"])
    command = json.loads(printed.stdout)
    async with on_screen(make_app("random-walk"), (120, 40)) as pilot:
        await press(pilot, "w", "c")
        await settle(pilot)
        text = " ".join(screen_text(pilot.app).split())
        assert TITLE in text
        assert f"random policy {command['random_return']:.5f}" in text
        assert f"best policy {command['best_return']:.5f}" in text
        assert f"optimal path {command['shortest_way']} steps" in text
        await press(pilot, "w", "c")
        await settle(pilot)
        assert snapshot(pilot).world_check is None
