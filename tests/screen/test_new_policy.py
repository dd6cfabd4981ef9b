"""A policy with an ε need not be ε-greedy."""

from __future__ import annotations

from dataclasses import astuple, replace

import pytest
from curious_policy import curious
from samples import lake
from snapshots import changed

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.panels.controls.controls import sliders_of
from rl_tui.screen.panels.controls.settings import settings_of
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.screen.panels.curve.text import remark
from rl_tui.screen.panels.last_step.words import words_of
from rl_tui.screen.theme.glyphs import ASCII, UNICODE

__all__ = ["curious"]


@pytest.mark.parametrize("row", [*BY_ID.values(), *POLICY_BY_ID.values()], ids=lambda row: row.id)
def test_what_a_row_says_can_be_spelled_in_ascii(row: Algorithm | Policy) -> None:
    said = [row.name, row.summary, row.equation, row.source]
    if isinstance(row, Algorithm):
        said += [each for each in astuple(row.update) if isinstance(each, str)]
    assert "?" not in ASCII.spelled(" ".join(said))


def chosen_by(policy: str, *, explored: bool = False) -> Snapshot:
    shown = lake()
    last = shown.counters.last_step
    assert last is not None
    values = Hyperparameters(policy=policy, epsilon=0.5, epsilon_decay=0.1)
    return changed(shown, hyperparameters=values, last_step=replace(last, epsilon=0.2, explored=explored))


@pytest.mark.parametrize(
    ("explored", "words"),
    [
        (True, ("curious (ε = .20), not the greedy one", "curious, not greedy")),
        (False, ("curious (ε = .20), the greedy one", "curious, greedy")),
    ],
)
def test_its_choice_is_told_as_its_own(curious: str, explored: bool, words: tuple[str, str]) -> None:
    shown = chosen_by(curious, explored=explored)
    story = story_of(shown)
    assert story is not None
    assert words_of(story, UNICODE).choices == words


def test_its_settings_are_those_of_its_row(curious: str) -> None:
    assert [row.name for row in sliders_of("sarsa", Hyperparameters(policy=curious))] == [
        "alpha",
        "gamma",
        "epsilon",
    ]
    values = {setting.label or setting.action: setting.value for setting in settings_of(chosen_by(curious))}
    assert values["agent.choose_policy"] == "curious"
    # Its row names no schedule, so the decay set for another policy changes nothing
    assert not {"ties", "ε now"} & set(values)


def test_the_gap_is_not_laid_to_its_epsilon(curious: str) -> None:
    usual, other = (
        changed(lake(behaviour_return=0.4), hyperparameters=Hyperparameters(policy=policy))
        for policy in ("epsilon-greedy", curious)
    )
    for shown in (usual, other):
        assert "cost of exploring" in remark(shown, curve_data(shown), UNICODE, 2)[0]
