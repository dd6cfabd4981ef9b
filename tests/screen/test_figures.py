"""Help for every number on screen."""

from __future__ import annotations

import re

import pytest
from samples import answered, bandit, lake, look, planning

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line
from rl_tui.screen.glossary.glossary import (
    FigureKind,
    FigureLimit,
    FigureSetting,
    GlossaryTerm,
    figure_text,
    glossary,
    term_at,
)
from rl_tui.screen.kit.blocks import lines_of
from rl_tui.screen.kit.layers import WORDS, Layer
from rl_tui.screen.kit.row import BUDGET, CURVE, LAST_STEP, TABLE, WORLD
from rl_tui.screen.panels import seed_figures as study_figures
from rl_tui.screen.panels.budget import budget_blocks
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.curve.text import BEST_ARM, GREEDY, OPTIMAL
from rl_tui.screen.panels.last_step.last_step import last_step_lines
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.panels.world.scale_line import VALUE
from rl_tui.screen.theme.glyphs import UNICODE

TERMS = {row.id: row.terms for row in PANELS}
STUDIED = [name for each in study_figures.FIGURES for name in (each.name, each.in_full)]
LABELS = (GREEDY, OPTIMAL, BEST_ARM[0], "cost of exploring")
SHOWN = (lake(), planning(), bandit(400))


def figures_in(label: str) -> list[GlossaryTerm]:
    ids = dict.fromkeys(term_at(label, column, UNICODE) for column in range(len(label)))
    terms = [glossary()[each] for each in ids if each is not None]
    return [term for term in terms if term.figure is not None]


def text_of(line: Line) -> str:
    return "".join(piece.text for piece in line)


def numbered(text: str) -> list[str]:
    return re.findall(r"(?<!\w)([a-z]+(?: [a-z]+)*) +(?=[−.\d])", re.sub(r" of (?=\d)", "/", text))


@pytest.mark.parametrize(
    "label",
    [*LABELS, *STUDIED, *(str(each) for each in Layer if each is not Layer.LANES), *(VALUE, *WORDS.values())],
)
def test_a_label_of_a_figure_names_one(label: str) -> None:
    assert figures_in(label)


@pytest.mark.parametrize("snapshot", SHOWN, ids=lambda each: each.recipe.scenario.id)
@pytest.mark.parametrize("width", [80, 120])
def test_the_numbers_of_the_status_line_do(snapshot: Snapshot, width: int) -> None:
    text = StatusLine(look()).picture(snapshot, width, 1)[0].text
    labels = [each for each in numbered(text) if each != "seed"]
    assert labels
    assert not [each for each in labels if not figures_in(each)], text


def test_the_speed_does() -> None:
    assert figures_in("37.4 M steps/s")


def test_the_sums_of_a_budget_do() -> None:
    lines = [text_of(line) for line in lines_of(budget_blocks(answered(bandit(400)), look()), 60, look())]
    labels = [label for line in lines for label in numbered(line)]
    assert len(labels) >= 5
    assert not [each for each in labels if not figures_in(each)], labels


@pytest.mark.parametrize("height", [1, 4, 9])
def test_the_numbers_of_an_update_do(height: int) -> None:
    text = "\n".join(text_of(line) for line in last_step_lines(lake(), look(), 100, height))
    labels = [each for each in ("reward", "δ", "α", "γ") if each in text]
    assert set(labels) == ({"δ"} if height == 1 else {"reward", "δ", "α", "γ"})
    assert all(term_at(f"{each} ", 0, UNICODE) is not None for each in labels)
    assert figures_in("δ = ")


def test_a_panel_in_focus_lists_its_figures() -> None:
    for panel, ids in (
        (WORLD, ("value", "reward", "standard-error")),
        (TABLE, ("q", "q-star", "error", "visits")),
        (CURVE, ("return", "last-100", "greedy", "gamma-best", "best-arm", "gap")),
        (BUDGET, ("winnings", "regret", "best-possible", "best-arm-share")),
        (LAST_STEP, ("td-error", "target", "reward")),
    ):
        assert set(ids) <= set(TERMS[panel])
        assert all(glossary()[each].figure is not None for each in ids)


def test_every_kind_of_limit_has_words() -> None:
    now = FigureSetting(gamma=".99", time_limit=100, steps=1_000, episodes=40)
    figures = [term.figure for term in glossary().values() if term.figure is not None]
    assert {each.kind for each in figures} == set(FigureKind)
    assert {each.limit for each in figures} == set(FigureLimit)
    assert all(figure_text(each) and figure_text(each, now) for each in figures)


def test_the_numbers_of_the_world_are_told() -> None:
    mean, value, won = (glossary()[each].figure for each in ("last-100", "value", "winnings"))
    assert mean is not None
    assert value is not None
    assert won is not None
    lake = FigureSetting(gamma=".99", time_limit=100, steps=1_000, episodes=40)
    arms = FigureSetting(gamma="0", time_limit=0, steps=400, episodes=400, is_bandit=True, budget=1_000)
    assert "time limit of 100 steps" in figure_text(mean, lake)
    assert "last 40 episodes" in figure_text(mean, lake)
    assert "γ .99" in figure_text(value, lake)
    assert "no time limit" in figure_text(value, lake._replace(time_limit=0))
    assert "400 of the budget of 1,000 pulls" in figure_text(won, arms)
    assert "nothing is discounted" in figure_text(value, arms)
