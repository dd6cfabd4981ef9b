"""Texts in ASCII."""

from __future__ import annotations

import re

import pytest

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.screen.keys.action import Action
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.theme.glyphs import ASCII, UNICODE

EQUATIONS = [each.equation for each in (*BY_ID.values(), *POLICY_BY_ID.values())]
GREEK = "alpha|gamma|epsilon|delta|theta|lambda|tau|pi|sigma|mu|sum"


@pytest.mark.parametrize("equation", EQUATIONS)
def test_an_equation_can_be_read(equation: str) -> None:
    spelled = ASCII.spelled(equation)
    assert ",*" not in spelled
    assert not re.search(rf"({GREEK})(?!{GREEK})[A-Za-z]", spelled)
    assert "?" not in spelled
    assert UNICODE.spelled(equation) == equation


@pytest.mark.parametrize("row", [*PANELS, *ACTIONS], ids=lambda row: row.id)
def test_each_character_of_a_help_has_a_spelling(row: PanelRow | Action) -> None:
    assert ASCII.spelled(row.help).count("?") == row.help.count("?")


def test_a_star_is_a_product_or_belongs_to_what_is_optimal() -> None:
    assert ASCII.spelled("r + γ · max Q*(s′,·)") == "r + gamma * max Q*(s',a)"
    assert ASCII.spelled("p·(r + γV)") == "p*(r + gamma V)"
    assert {name for name in ASCII.__slots__ if getattr(ASCII, name) == "*"} == {"times"}
    assert ASCII.spelled("★") == ASCII.goal


def test_words_are_left_as_they_are() -> None:
    assert ASCII.spelled("ε-greedy, α_min, SARSA(λ)") == "epsilon-greedy, alpha_min, SARSA(lambda)"
