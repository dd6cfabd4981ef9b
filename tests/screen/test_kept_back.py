"""Texts about hidden parts of a lesson."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from samples import bandit, look, student
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.draw.canvas import Line
from rl_tui.screen.kit.blocks import lines_of
from rl_tui.screen.kit.snapshot_facts import SHOWN_BY_KEY, shown_by
from rl_tui.screen.panels.budget import budget_blocks
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.last_step.last_step import last_step_lines
from rl_tui.screen.panels.model import means_key
from rl_tui.screen.panels.policies.policies import notes
from rl_tui.screen.playground.modes.drawing import title
from rl_tui.screen.theme.glyphs import UNICODE

pytestmark = pytest.mark.unit
BANDIT = bandit(100)


def kept(picture: Snapshot, *what: str) -> Snapshot:
    return changed(picture, is_hidden="answer" in what, kept_back=frozenset(what))


def text_of(lines: list[Line]) -> str:
    return "\n".join("".join(piece.text for piece in line) for line in lines)


def test_what_is_hidden_names_its_key_or_that_it_waits() -> None:
    assert shown_by(changed(student(), is_hidden=True)) == f"{SHOWN_BY_KEY} it"
    assert shown_by(kept(student(), "answer"), "them") == "the lesson hides them"


@pytest.mark.parametrize("picture", [student(), BANDIT])
def test_notes_of_policies_say_what_keeps_them_back(picture: Snapshot) -> None:
    said = list(notes(kept(picture, "answer"), look()))
    assert any("the lesson hides" in note for note in said)
    assert not any(SHOWN_BY_KEY in note for note in said)
    told = list(notes(changed(picture, is_hidden=True), look()))
    assert any(SHOWN_BY_KEY in note for note in told)


def test_who_draws_a_policy_is_told_that_its_return_waits() -> None:
    drawn = student().answers.drawn.with_action(0, 0)
    for picture, expected in (
        (kept(student(), "answer"), "its return is hidden (the lesson hides it)"),
        (changed(BANDIT, is_hidden=True), "its return is hidden (w h shows it)"),
    ):
        studied = changed(picture, drawn=drawn, studied=PolicyKind.DRAWN)
        assert any(expected in form for form in title(studied, UNICODE))


def test_texts_of_a_bandit_name_no_key_while_a_lesson_keeps_its_means_back() -> None:
    secret = changed(BANDIT, is_hidden=True)
    assert "h  shows regret" in text_of(lines_of(budget_blocks(secret, look()), 60, look()))
    said = text_of(lines_of(budget_blocks(kept(BANDIT, "answer"), look()), 60, look()))
    assert "regret and the best arm: the lesson hides it for now" in said
    assert "h  shows" not in said
    assert "until w h" in means_key(secret)[0]
    assert means_key(kept(BANDIT, "answer")) == ("the lesson hides it for now",)
    assert means_key(student()) == ()


def graph(picture: Snapshot) -> str:
    view = GraphView(picture.world, look())
    return "\n".join(strip.text for strip in view.picture(picture, 76, 21))


def with_other_chances(picture: Snapshot) -> Snapshot:
    mdp = picture.world.mdp
    chances, sums = np.array(mdp.probability), np.array(mdp.cumulative)
    for pair in range(mdp.pairs):
        own = list(mdp.outcomes_of(pair))
        chances[own] = chances[own[::-1]]
        sums[own] = np.cumsum(chances[own])
    other = replace(mdp, probability=chances, cumulative=sums)
    return changed(picture, world=replace(picture.world, space=other))


def test_a_graph_keeps_the_probabilities_of_the_model_back() -> None:
    picture = student(0)
    assert ".8" in graph(picture)
    said = graph(kept(picture, "model"))
    assert ".8" not in said
    assert ".2" not in said
    assert "?" in said
    other = with_other_chances(picture)
    assert graph(other) != graph(picture)
    assert graph(kept(other, "model")) == said


def test_a_graph_has_them_again_once_the_page_is_done() -> None:
    picture = student()
    view = GraphView(picture.world, look())
    for shown in (kept(picture, "model"), picture):
        drawn = "\n".join(strip.text for strip in view.picture(shown, 76, 21))
    assert drawn == graph(picture)


def test_the_last_step_keeps_the_probability_of_what_happened_back() -> None:
    told = text_of(last_step_lines(student(), look(), 100, 8))
    assert " chance ." in told
    assert " chance " not in text_of(last_step_lines(kept(student(), "model"), look(), 100, 8))
