"""Tools to edit a graph: states, outcomes of actions, and the start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final

from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.panels.draw_panel import SheetLine, WorldNumber
from rl_tui.screen.playground.modes.numbers import CHANCE, LIMIT, PAYS
from rl_tui.screen.playground.modes.outcomes import (
    FORM,
    ActionOutcome,
    actions_in,
    outcomes_in,
    paying,
    read_name,
    read_outcomes,
    written,
)
from rl_tui.screen.playground.modes.rules import Desk, Tool, Toolbox, ask_rules, fault_of, number_of
from rl_tui.screen.playground.modes.texts import number_in, number_text
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.editing.edit import Edit, as_json
from rl_tui.worlds.editing.graph_draft import GraphDraft, transition_edit, with_chance
from rl_tui.worlds.world import World

# The tools, one row each


_NEW: Final = "+ an action"
_NOTHING: Final = "no actions here. enter: add one"


def _no_outcome(box: GraphTools, desk: Desk) -> str:
    return _NOTHING if box.outcome(desk) is None else ""


GRAPH_TOOLS: Final = (
    Tool(
        "enter",
        "edit…",
        "Choose or add an action, and type its outcomes.",
        lambda box, desk: box.choose_action(desk),
        rank=1,
    ),
    Tool(
        "equals_sign",
        "reward…",
        "Type what the chosen action pays.",
        lambda box, desk: box.ask_reward(desk),
        "=",
        is_of_number=True,
        why_not=_no_outcome,
    ),
    *(
        Tool(
            key,
            label,
            f"Let the chosen outcome be {how} by .05.",
            partial(lambda chance, box, desk: box.shift(desk, chance), chance),
            symbol,
            is_of_number=True,
            why_not=_no_outcome,
            rank=2 if symbol == "[" else None,
            hint=("[ ]", "chance"),
        )
        for key, symbol, label, how, chance in (
            ("left_square_bracket", "[", "less", "less likely", -0.05),
            ("right_square_bracket", "]", "more", "likelier", 0.05),
        )
    ),
    Tool(
        "delete",
        "remove",
        "Remove the chosen action.",
        lambda box, desk: box.take_action_away(desk),
        "del",
        why_not=_no_outcome,
    ),
    Tool("S", "start", "Let every episode start here.", lambda box, desk: box.begin_here(desk), rank=6),
    Tool(
        "comma",
        "next",
        "Go to the next state, in the file's order.",
        lambda box, desk: box.go_on(desk),
        ",",
    ),
    *(
        Tool(
            key,
            f"move {way}",
            f"Move the state one place {way}.",
            partial(lambda step, box, desk: box.move(desk, *step), step),
            symbol,
        )
        for key, symbol, way, step in (
            ("less_than_sign", "<", "left", (-1, 0)),
            ("greater_than_sign", ">", "right", (1, 0)),
            ("circumflex_accent", "^", "up", (0, -1)),
            ("V", "V", "down", (0, 1)),
        )
    ),
    Tool(
        "w i",
        "state here…",
        "Add a state, and an action that leads there.",
        lambda box, desk: box.add_state(desk),
    ),
    Tool(
        "w d",
        "state away",
        "Remove this state, and all outcomes that lead there.",
        lambda box, desk: box.remove_state(desk),
    ),
    Tool("w r", "rules…", "Set the start and the time limit.", ask_rules),
)


# What they do


class GraphTools(Toolbox):
    """Tools for the graph of an MDP, with a typed line per action."""

    tools = GRAPH_TOOLS
    rest = "states, rules, save"

    def __init__(self) -> None:
        self._chosen: tuple[str, int] | None = None
        self._added: str | None = None

    # What is shown

    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return the state under the cursor and its actions."""
        state = _state(desk)
        actions = ", ".join(actions_in(_graph_of(desk), state)) or "terminal"
        return f"{state}: {actions}", state

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return how to choose among several outcomes."""
        if len(outcomes_in(_graph_of(desk), _state(desk))) < 2:
            return ()
        return "shift+↑ ↓ or a click chooses an outcome", "shift+↑ ↓: another outcome"

    def lines(self, desk: Desk) -> tuple[SheetLine, ...]:
        """Return a line for each outcome in the state under the cursor."""
        outcomes = outcomes_in(_graph_of(desk), _state(desk))
        chosen = self._number(desk, outcomes)
        return tuple(
            SheetLine(
                f"{each.action} → {each.to} {each.chance:.4g} pays {number_text(each.pays)}",
                number,
                is_on=number == chosen,
            )
            for number, each in enumerate(outcomes)
        )

    def choose_line(self, desk: Desk, line: int) -> None:
        """Choose the outcome of that line."""
        self._chosen = _state(desk), line

    def go_along(self, desk: Desk, step: tuple[int, int]) -> None:
        """Choose the next or previous outcome."""
        outcomes = outcomes_in(_graph_of(desk), _state(desk))
        if outcomes:
            self.choose_line(desk, (self._number(desk, outcomes) + sum(step)) % len(outcomes))

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return chance and reward of the chosen outcome, and the time limit."""
        outcome = self.outcome(desk)
        return (
            WorldNumber(CHANCE, 0.0 if outcome is None else outcome.chance),
            WorldNumber(PAYS, 0.0 if outcome is None else outcome.pays),
            WorldNumber(LIMIT, number_of(desk.draft, LIMIT.name)),
        )

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set the number ``name``."""
        if name == LIMIT.name:
            edits = (Edit(name, (), str(int(value))),)
            fault = fault_of(desk.draft, edits, name)
            if fault:
                raise ValueError(fault)
            return edits
        outcome = self.outcome(desk)
        if outcome is None:
            raise ValueError(_NOTHING)
        entry = paying(outcome, value) if name == PAYS.name else _as_likely(outcome, value)
        return (transition_edit(_state(desk), outcome.action, entry),)

    def place_added(self, world: World) -> int | None:
        """Return the added state once it is in ``world``."""
        names = world.space.state_names
        if self._added not in names:
            return None
        name, self._added = self._added, None
        return names.index(name)

    # Outcomes of actions

    def choose_action(self, desk: Desk) -> None:
        """Ask for an action of the state, then for its outcomes."""
        draft, state = _graph_of(desk), _state(desk)
        candidates = [
            *(Candidate(each, each, (written(draft, state, each),)) for each in actions_in(draft, state)),
            Candidate(_NEW, _NEW, ("type its name, then what it does",)),
        ]
        outcome = self.outcome(desk)
        current = "" if outcome is None else outcome.action
        desk.ask(
            Choice(f"What can be done in {state}", candidates, current, desk.glyphs),
            partial(self._chosen_action, desk, state),
        )

    def _chosen_action(self, desk: Desk, state: str, action: str) -> None:
        if action != _NEW:
            self._ask_outcomes(desk, state, action)
            return
        prompt = Prompt("A new action", f"Its name, in {state}.", "", read_name)
        desk.ask(prompt, lambda name: self._ask_outcomes(desk, state, str(name)))

    def _ask_outcomes(self, desk: Desk, state: str, action: str) -> None:
        draft = _graph_of(desk)
        hint = f"States and chances: {FORM}. A new name makes a new state. An empty line removes the action."
        was = written(draft, state, action)
        prompt = Prompt(f"{action} in {state}", hint, was, partial(read_outcomes, draft, state, action))

        def answered(text: object) -> None:
            if prompt.typed != was:
                desk.draw((Edit("transition", (state, action), str(text)),))

        desk.ask(prompt, answered)

    def take_action_away(self, desk: Desk) -> None:
        """Remove the chosen action."""
        outcome = self.outcome(desk)
        if outcome is None:
            desk.tell(_NOTHING)
        else:
            desk.draw((transition_edit(_state(desk), outcome.action, None),))

    def shift(self, desk: Desk, chance: float) -> None:
        """Raise the probability of the chosen outcome by ``chance``."""
        outcome = self.outcome(desk)
        try:
            if outcome is None:
                raise ValueError(_NOTHING)
            entry = _as_likely(outcome, round(outcome.chance + chance, 10))
        except ValueError as fault:
            desk.tell(str(fault))
        else:
            desk.draw((transition_edit(_state(desk), outcome.action, entry),))

    def ask_reward(self, desk: Desk) -> None:
        """Ask for the reward of the chosen outcome."""
        outcome, state = self.outcome(desk), _state(desk)
        if outcome is None:
            desk.tell(_NOTHING)
            return
        title = f"Reward of {outcome.action} in {state}"
        desk.ask(
            Prompt(title, "A number.", f"{outcome.pays:g}", number_in),
            lambda value: desk.draw((transition_edit(state, outcome.action, paying(outcome, float(value))),)),
        )

    # States

    def begin_here(self, desk: Desk) -> None:
        """Make the state under the cursor the start of every episode."""
        desk.draw((Edit("start", (), as_json(_state(desk))),))

    def add_state(self, desk: Desk) -> None:
        """Ask for the name of a new state, and connect it."""
        draft, state = _graph_of(desk), _state(desk)

        def read(text: str) -> str:
            name = read_name(text)
            if name in draft.states:
                raise ValueError("this state exists: enter adds an action that leads there")
            return read_outcomes(draft, state, f"to {name}", as_json({"reward": 0.0, "to": name})) and name

        def answered(name: object) -> None:
            self._added = str(name)
            desk.draw((transition_edit(state, f"to {name}", {"reward": 0.0, "to": str(name)}),))

        hint = f"Its name. An action leads there from {state}."
        desk.ask(Prompt("A new state", hint, "", read, "add"), answered)

    def remove_state(self, desk: Desk) -> None:
        """Remove the state under the cursor, with all outcomes that lead there."""
        desk.draw((Edit("state", (_state(desk),), "null"),))

    def go_on(self, desk: Desk) -> None:
        """Move the cursor to the next state, after the last to the first."""
        desk.view.put_cursor(((desk.view.cursor_place or 0) + 1) % desk.snapshot.world.space.states)

    def move(self, desk: Desk, columns: int, rows: int) -> None:
        """Move the state under the cursor, or swap two."""
        draft, state = _graph_of(desk), _state(desk)
        place = _places(desk, draft)
        missing = [
            Edit("place", (name,), as_json(list(at)))
            for name, at in place.items()
            if name not in (draft.rules.get("place") or {})
        ]
        column, row = place[state]
        new = [column + columns, row + rows]
        if min(new) < 0:
            desk.tell("No room in that direction. Move the other states first.")
            return
        desk.draw((*missing, Edit("place", (state,), as_json(new))))

    # The pointer

    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Move the cursor to the click, or ask for an action there."""
        was_there = desk.view.cursor == places[-1]
        desk.view.put_cursor(places[-1])
        if was_there:
            self.choose_action(desk)

    def turn(self, desk: Desk, place: int, amount: float) -> None:
        """Change the probability of the chosen outcome by the wheel."""
        desk.view.put_cursor(place)
        self.shift(desk, amount / 20)

    def outcome(self, desk: Desk) -> ActionOutcome | None:
        """Return the chosen outcome in the state under the cursor, or None."""
        outcomes = outcomes_in(_graph_of(desk), _state(desk))
        return outcomes[self._number(desk, outcomes)] if outcomes else None

    def _number(self, desk: Desk, outcomes: Sequence[ActionOutcome]) -> int:
        """Return the index of the chosen outcome."""
        if self._chosen is not None and self._chosen[0] == _state(desk):
            return min(self._chosen[1], max(0, len(outcomes) - 1))
        return next((number for number, each in enumerate(outcomes) if not each.is_alone), 0)


def _as_likely(outcome: ActionOutcome, chance: float) -> Mapping[str, Any]:
    """Return the entry of ``outcome`` with probability ``chance``, except 0 and 1."""
    if outcome.is_alone:
        raise ValueError(f"{outcome.action} always leads to {outcome.to}. enter: add outcomes")
    if not 0.0 < chance < 1.0:
        raise ValueError(f"{outcome.to} would be certain or impossible. enter: remove outcomes")
    return with_chance(outcome.entry, outcome.to, chance)


def _graph_of(desk: Desk) -> GraphDraft:
    draft = desk.draft
    assert isinstance(draft, GraphDraft)
    return draft


def _state(desk: Desk) -> str:
    names = desk.snapshot.world.space.state_names
    return names[min(desk.view.cursor_place or 0, len(names) - 1)]


def _places(desk: Desk, draft: GraphDraft) -> dict[str, Sequence[int]]:
    world = desk.snapshot.world
    assert isinstance(world.drawing, Graph)
    seen = dict(zip(world.space.state_names, world.drawing.places, strict=True))
    return {**seen, **(draft.rules.get("place") or {})}
