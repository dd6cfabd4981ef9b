"""The tools for graphs: what an action does in a state, the start, and where states stand."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.tui.screens.dialogs.choice import Candidate, Choice
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.screens.playground.actions.modes.editing.rules import ask_rules
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Hand, Tool, Toolbox
from rl_tui.worlds.editing.edit import Edit, as_json
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of, transition_edit, with_chance

_NEW: Final = "+ an action"
_FORM: Final = "Pass 0.8, Class 0.2 pays -2"
_PAYS: Final = " pays "


class GraphTools(Toolbox):
    """Draws the graph of an MDP: one line says what an action does."""

    def about(self, hand: Hand) -> tuple[str, ...]:
        """Return the state under the cursor, and how many actions it has."""
        state = _state(hand)
        actions = _actions(_graph_of(hand), state)
        return (
            f"{state}: {', '.join(actions) or 'terminal'} · enter: what they do",
            f"{state} · enter: actions",
        )

    def choose_action(self, hand: Hand) -> None:
        """Choose an action of the state under the cursor, or a new one, and type what it does."""
        draft, state = _graph_of(hand), _state(hand)
        candidates = [
            *(Candidate(each, each, (_written(draft, state, each),)) for each in _actions(draft, state)),
            Candidate(_NEW, _NEW, ("type its name, then what it does",)),
        ]
        hand.ask(
            Choice(f"What can be done in {state}", candidates, "", hand.glyphs),
            partial(self._chosen, hand, state),
        )

    def _chosen(self, hand: Hand, state: str, action: str) -> None:
        if action != _NEW:
            self._ask_outcomes(hand, state, action)
            return
        prompt = Prompt("A new action", f"Its name, in {state}.", "", _name)
        hand.ask(prompt, lambda name: self._ask_outcomes(hand, state, str(name)))

    def _ask_outcomes(self, hand: Hand, state: str, action: str) -> None:
        draft = _graph_of(hand)
        hint = (
            f"States and chances: {_FORM}. A new name makes a new state; an empty line takes the action away."
        )
        prompt = Prompt(
            f"{action} in {state}",
            hint,
            _written(draft, state, action),
            partial(_outcomes, draft, state, action),
        )
        was = _written(draft, state, action)

        def answered(text: object) -> None:
            if prompt.typed != was:
                hand.draw((Edit("transition", (state, action), str(text)),))

        hand.ask(prompt, answered)

    def begin_here(self, hand: Hand) -> None:
        """Let every episode start in the state under the cursor."""
        hand.draw((Edit("start", (), as_json(_state(hand))),))

    def shift(self, hand: Hand, chance: float) -> None:
        """Let the first outcome of the first action that may turn out in two ways be so much likelier.

        It never becomes certain or impossible: the others would forget how they shared the rest.
        """
        draft, state = _graph_of(hand), _state(hand)
        for action in _actions(draft, state):
            entry = draft.entry(state, action)
            chances = {} if entry is None else chances_of(entry)
            if entry is not None and len(chances) > 1:
                first = next(iter(chances))
                new = round(chances[first] + chance, 10)
                if 0.0 < new < 1.0:
                    hand.draw((transition_edit(state, action, with_chance(entry, first, new)),))
                else:
                    hand.tell(f"{first} would be certain or impossible: enter takes outcomes away")
                return
        hand.tell("nothing turns out in two ways here: enter says what actions do")

    def paint(self, hand: Hand, places: Sequence[int]) -> None:
        """Put the cursor where it was clicked; there again, ask what is done there."""
        was_there = hand.view.cursor == places[-1]
        hand.view.put_cursor(places[-1])
        if was_there:
            self.choose_action(hand)

    def turn(self, hand: Hand, place: int, amount: float) -> None:
        """Let the first outcome in a state be likelier, or less."""
        hand.view.put_cursor(place)
        self.shift(hand, amount / 20)

    def move(self, hand: Hand, columns: int, rows: int) -> None:
        """Draw the state under the cursor a place further; what stands there changes places with it."""
        draft, state = _graph_of(hand), _state(hand)
        at = (draft.rules.get("place") or {}).get(state)
        if at is None:
            hand.tell("this graph has no places of its own: give it [mdp.place] in its file")
            return
        new = [at[0] + columns, at[1] + rows]
        if min(new) >= 0:
            hand.draw((Edit("place", (state,), as_json(new)),))

    tools = (
        Tool(
            "enter",
            "enter",
            "actions",
            "What can be done in the state, and what comes of it.",
            choose_action,
            0,
        ),
        Tool("S", "S", "start", "Let every episode start here.", begin_here, 1),
        Tool(
            "plus",
            "+",
            "likelier",
            "Let the first outcome here be likelier by .05.",
            lambda box, hand: box.shift(hand, 0.05),
            2,
        ),
        Tool(
            "minus",
            "−",
            "less likely",
            "Let the first outcome here be less likely by .05.",
            lambda box, hand: box.shift(hand, -0.05),
            3,
        ),
        Tool(
            "less_than_sign",
            "<",
            "move left",
            "Draw the state one place to the left.",
            lambda box, hand: box.move(hand, -1, 0),
            5,
        ),
        Tool(
            "greater_than_sign",
            ">",
            "move right",
            "Draw the state one place to the right.",
            lambda box, hand: box.move(hand, 1, 0),
            6,
        ),
        Tool(
            "circumflex_accent",
            "^",
            "move up",
            "Draw the state one place higher.",
            lambda box, hand: box.move(hand, 0, -1),
            7,
        ),
        Tool(
            "V",
            "V",
            "move down",
            "Draw the state one place lower.",
            lambda box, hand: box.move(hand, 0, 1),
            8,
        ),
        Tool("o", "o", "rules", "The rules of the graph: start and time limit.", ask_rules, 4),
    )


def _graph_of(hand: Hand) -> GraphDraft:
    draft = hand.draft
    assert isinstance(draft, GraphDraft)
    return draft


def _state(hand: Hand) -> str:
    place = hand.view.cursor_place or 0
    state = hand.view.state_at(place)
    return hand.snapshot.world.space.state_names[0 if state is None else state]


def _actions(draft: GraphDraft, state: str) -> list[str]:
    return [str(each["action"]) for each in draft.transitions if each.get("state") == state]


def _written(draft: GraphDraft, state: str, action: str) -> str:
    """Return what ``action`` does in a line, empty where it is new; as JSON where no line says it all."""
    entry = draft.entry(state, action)
    if entry is None:
        return ""
    to = entry.get("to")
    is_plain = (
        not (isinstance(to, dict) and any(isinstance(each, dict) for each in to.values()))
        and "std" not in entry
    )
    if not is_plain or any("," in name or _PAYS in name for name in chances_of(entry)):
        return as_json({key: value for key, value in entry.items() if key not in ("state", "action")})
    chances = chances_of(entry)
    named = [f"{name} {chance!r}" for name, chance in chances.items()]
    return f"{', '.join(named)}{_PAYS}{entry.get('reward', 0.0)!r}"


def _outcomes(draft: GraphDraft, state: str, action: str, text: str) -> str:
    """Return the value of the edit that lets ``action`` do what was typed. Raises ValueError."""
    value = text.strip()
    if value.startswith("{"):
        read: object = json.loads(value)
    elif not value:
        read = None
    else:
        read = _entry(value)
    edit = Edit("transition", (state, action), as_json(read))
    try:
        findings = draft.edited(edit).findings
    except UserError as fault:
        raise ValueError(str(fault)) from fault
    here = next((each for each in findings if "probabilities" in each.expected), None)
    if here is not None:
        raise ValueError(f"found {here.found}; expected {here.expected}")
    return edit.value


def _entry(text: str) -> dict[str, object]:
    """Return what ``Pass 0.8, Class 0.2 pays -2`` says; a last chance that is left out is the rest."""
    outcomes, _, reward = text.partition(_PAYS.rstrip())
    to: dict[str, float] = {}
    named = [each.strip() for each in outcomes.split(",") if each.strip()]
    for number, each in enumerate(named):
        name, _, chance = each.rpartition(" ")
        try:
            to[name] = float(chance)
        except ValueError:
            if number < len(named) - 1:
                raise ValueError(f"expected states and chances, such as {_FORM}") from None
            to[each] = round(1.0 - sum(to.values()), 12)
    if not to or "" in to:
        raise ValueError(f"expected states and chances, such as {_FORM}")
    try:
        pays = float(reward.replace("−", "-")) if reward.strip() else 0.0
    except ValueError:
        raise ValueError(f"expected a number after pays, such as {_FORM}") from None
    return {"reward": pays, "to": next(iter(to)) if list(to.values()) == [1.0] else to}


def _name(text: str) -> str:
    if not text.strip():
        raise ValueError("expected a name")
    return text.strip()
