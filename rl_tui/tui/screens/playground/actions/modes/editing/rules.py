"""The rules of a world, to be typed: a list of them, and a line for each."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.tui.screens.dialogs.choice import Candidate, Choice
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.edit import Edit

if TYPE_CHECKING:
    from rl_tui.tui.screens.playground.actions.modes.editing.tools import Hand
    from rl_tui.worlds.editing.draft import Draft

RULES: Final[dict[str, dict[str, str]]] = {
    "grid": {
        "noise": "share of moves that slip, half of it to each side (0 to 1)",
        "slippery": "as on Gymnasium's ice: each of three moves as likely (true or false)",
        "step_reward": "living reward: added to every step",
        "bump_reward": "added to steps that a wall or the edge stops",
        "time_limit": "steps after which an episode is cut off; 0: none",
        "rewards": "entering or leaving: when a cell pays",
        "moves": "four, clockwise, king or king+stay",
        "wind": "a number for each column: cells that it blows up",
        "wind_rows": "a number for each row: cells that it blows to the right",
        "gusts": "wind one stronger or weaker now and then (true or false)",
    },
    "mdp": {
        "time_limit": "steps after which an episode is cut off; 0: none",
        "start": "a state, or a table of states and chances",
    },
    "bandit": {
        "std": "standard deviation of the rewards",
        "drift": "standard deviation of the step that every mean takes after every pull",
    },
}
"""What can be set for a whole world, and what that is."""


def ask_rules(_: object, hand: Hand) -> None:
    """Choose one of the rules, and type what it is to be."""
    draft = hand.draft
    if isinstance(draft, ArmsDraft) and draft.is_bernoulli:
        hand.tell("arms that pay 1 or 0 have no spread and do not drift")
        return
    candidates = [
        Candidate(name, f"{name}  {rule_value(draft, name)}", (text,))
        for name, text in RULES[draft.kind].items()
    ]
    hand.ask(Choice("Rules of the world", candidates, "", hand.glyphs), lambda name: _ask_rule(hand, name))


def _ask_rule(hand: Hand, name: str) -> None:
    draft = hand.draft

    def read(text: str) -> str:
        edit = rule_edit(name, text)
        try:
            findings = draft.edited(edit).findings
        except UserError as fault:
            raise ValueError(str(fault)) from fault
        here = next((each for each in findings if each.location[:1] == (name,)), None)
        if here is not None:
            raise ValueError(f"found {here.found}; expected {here.expected}")
        return text

    hand.ask(
        Prompt(name, RULES[draft.kind][name], rule_value(draft, name), read),
        lambda text: hand.draw((rule_edit(name, str(text)),)),
    )


def rule_edit(name: str, text: str) -> Edit:
    """Return the edit that sets the rule ``name`` to what was typed."""
    return Edit(name, (), text.strip())


def rule_value(draft: Draft, name: str) -> str:
    """Return what the rule ``name`` is in ``draft``, as it is typed."""
    value: Any = draft.table.get(name)
    if value is None:
        value = draft.section_class.model_fields[name].get_default(call_default_factory=True)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
