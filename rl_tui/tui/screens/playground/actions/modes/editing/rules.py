"""The rules of a world: a list of them, a line to type for each, and why one cannot be what was asked for."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.tui.screens.dialogs.choice import Candidate, Choice
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.edit import BETWEEN, JSON_BEGINS, Edit, as_json, json_in
from rl_tui.worlds.grid.moves import MOVES
from rl_tui.worlds.grid.section import REWARDS

if TYPE_CHECKING:
    from rl_tui.tui.screens.playground.actions.modes.editing.tools import Desk
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
WORDS: Final[dict[str, tuple[str, ...]]] = {
    "slippery": ("false", "true"),
    "gusts": ("false", "true"),
    "rewards": REWARDS,
    "moves": tuple(MOVES),
}
"""What a rule may be that is no number."""


def ask_rules(_: object, desk: Desk) -> None:
    """Choose one of the rules, and type or choose what it is to be."""
    draft = desk.draft
    if isinstance(draft, ArmsDraft) and draft.is_bernoulli:
        desk.tell("arms that pay 1 or 0 have no spread and do not drift")
        return
    candidates = [
        Candidate(name, f"{name}  {rule_value(draft, name)}", (text,))
        for name, text in RULES[draft.kind].items()
    ]
    desk.ask(Choice("Rules of the world", candidates, "", desk.glyphs), lambda name: _ask_rule(desk, name))


def _ask_rule(desk: Desk, name: str) -> None:
    draft, now = desk.draft, rule_value(desk.draft, name)
    if name in WORDS:
        candidates = [
            Candidate(word, word, refused=fault_of(draft, (rule_edit(name, word),), name))
            for word in WORDS[name]
        ]
        title = f"{name}: {RULES[draft.kind][name]}"
        desk.ask(
            Choice(title, candidates, now, desk.glyphs), lambda word: desk.draw((rule_edit(name, word),))
        )
        return

    def read(text: str) -> str:
        fault = fault_of(draft, (rule_edit(name, text),), name)
        if fault:
            raise ValueError(fault)
        return text

    desk.ask(
        Prompt(name, RULES[draft.kind][name], now, read),
        lambda text: desk.draw((rule_edit(name, str(text)),)),
    )


def next_word(desk: Desk, name: str) -> None:
    """Let a rule be the next of its words, where it can be that."""
    words, now = WORDS[name], rule_value(desk.draft, name)
    edit = rule_edit(name, words[(words.index(now) + 1) % len(words)] if now in words else words[0])
    fault = fault_of(desk.draft, (edit,), name)
    if fault:
        desk.tell(f"{name} stays {now}: {fault}")
    else:
        desk.draw((edit,))


def fault_of(draft: Draft, edits: Sequence[Edit], name: str) -> str:
    """Return why the rule ``name`` of ``draft`` cannot be what ``edits`` say; empty where it can.

    What was unfinished before is no reason.
    """
    before = draft.findings
    try:
        for edit in edits:
            draft = draft.edited(edit)
        findings = draft.findings
    except UserError as fault:
        return str(fault)
    new = (each for each in findings if each not in before or each.location[:1] == (name,))
    here = next(new, None)
    return "" if here is None else f"found {here.found}; expected {here.expected}"


def rule_edit(name: str, text: str) -> Edit:
    """Return the edit that sets the rule ``name`` to what was typed, as a session reads it again."""
    value = text.strip()
    if BETWEEN in value or value.startswith(JSON_BEGINS):
        try:
            value = json_in(value)
        except ValueError:
            value = as_json(value)  # a name that looks like more than that
    return Edit(name, (), value)


def rule_value(draft: Draft, name: str) -> str:
    """Return what the rule ``name`` is in ``draft``, as it is typed."""
    value = rule_of(draft, name)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def rule_of(draft: Draft, name: str) -> Any:
    """Return what the rule ``name`` is in ``draft``: as drawn, else the usual."""
    value = draft.rules.get(name)
    if value is None:
        value = draft.section_class.model_fields[name].get_default(call_default_factory=True)
    return value


def number_of(draft: Draft, name: str) -> float:
    """Return the number that the rule ``name`` is; 0 where what stands there is none."""
    value = rule_of(draft, name)
    return float(value) if isinstance(value, int | float) else 0.0
