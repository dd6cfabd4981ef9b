"""Tools to edit a graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final, NamedTuple

from rl_tui.common.errors import UserError, complaint
from rl_tui.common.findings import place
from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.panels.draw_panel import SheetLine, WorldNumber
from rl_tui.screen.playground.modes import rules
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.editing.edit import Edit, as_json, json_in
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of, transition_edit, with_chance
from rl_tui.worlds.sections.mdp_section import TransitionEntry
from rl_tui.worlds.sections.schema import parsed
from rl_tui.worlds.world import World

# Outcomes of an action: as a typed line, and one by one


FORM: Final = "Pass 0.8, Class 0.2 pays -2"
_PAYS: Final = " pays "


class ActionOutcome(NamedTuple):
    """A possible outcome. ``entry`` holds all outcomes of the action."""

    action: str
    to: str
    chance: float
    pays: float
    entry: Mapping[str, Any]

    @property
    def is_alone(self) -> bool:
        """True if the action has no other outcome."""
        return len(chances_of(self.entry)) == 1


def _outcomes_in(draft: GraphDraft, state: str) -> list[ActionOutcome]:
    return [
        ActionOutcome(str(entry["action"]), to, chance, _pays(entry, to), entry)
        for entry in draft.transitions
        if entry.get("state") == state
        for to, chance in chances_of(entry).items()
    ]


def _pays(entry: Mapping[str, Any], to: str) -> float:
    own = _own(entry, to)
    pays = own.get("reward", entry.get("reward", 0.0))
    return float(pays) if isinstance(pays, int | float) else 0.0


def _own(entry: Mapping[str, Any], to: str) -> Mapping[str, Any]:
    outcomes = entry.get("to")
    own = outcomes.get(to) if isinstance(outcomes, Mapping) else None
    return own if isinstance(own, Mapping) else {}


def paying(outcome: ActionOutcome, reward: float) -> dict[str, Any]:
    """Return the entry with another reward."""
    entry = outcome.entry
    if "reward" not in _own(entry, outcome.to):
        return {**entry, "reward": reward}
    return {**entry, "to": {**entry["to"], outcome.to: {**_own(entry, outcome.to), "reward": reward}}}


def actions_in(draft: GraphDraft, state: str) -> list[str]:
    """Name the actions in ``state``."""
    return [str(each["action"]) for each in draft.transitions if each.get("state") == state]


def written(draft: GraphDraft, state: str, action: str) -> str:
    """Write an action's outcomes as typed, empty if new."""
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


def read_outcomes(draft: GraphDraft, state: str, action: str, text: str) -> str:
    """Return the edit's value for the typed outcomes. Raises ValueError for other text."""
    typed = text.strip()
    value = json_in(typed) if typed.startswith("{") else as_json(_entry(typed) if typed else None)
    try:
        entry = draft.edited(Edit("transition", (state, action), value)).entry(state, action)
    except UserError as fault:
        raise ValueError(str(fault)) from fault
    found = [] if entry is None else parsed(TransitionEntry, dict(entry))[1]
    if found:
        raise ValueError(f"{place(found[0].location)}: {complaint(found[0].found, found[0].expected)}")
    return value


def _entry(text: str) -> dict[str, object]:
    outcomes, _, reward = text.partition(_PAYS.rstrip())
    to: dict[str, float] = {}
    named = [each.strip() for each in outcomes.split(",") if each.strip()]
    for number, each in enumerate(named):
        name, _, chance = each.rpartition(" ")
        try:
            to[name] = float(chance)
        except ValueError:
            if number < len(named) - 1:
                raise ValueError(f"type states and chances, such as {FORM}") from None
            to[each] = round(1.0 - sum(to.values()), 12)
    if not to or "" in to:
        raise ValueError(f"type states and chances, such as {FORM}")
    try:
        pays = float(reward.replace("−", "-")) if reward.strip() else 0.0
    except ValueError:
        raise ValueError(f"type a number after pays, such as {FORM}") from None
    return {"reward": pays, "to": next(iter(to)) if list(to.values()) == [1.0] else to}


def read_name(text: str) -> str:
    """Return the typed name. Raises ValueError if it is empty."""
    if not text.strip():
        raise ValueError("type a name")
    return text.strip()


# The tools


_NEW: Final = "+ an action"
_NOTHING: Final = "no actions here. enter: add one"


class GraphTools(rules.Toolbox[GraphDraft]):
    """Tools for an MDP's graph."""

    rest = "states, rules, save"

    def __init__(self) -> None:
        self._chosen: tuple[str, int] | None = None
        self._added: str | None = None

    # What is shown

    def about(self, desk: rules.Desk[GraphDraft]) -> tuple[str, ...]:
        """Describe the state and its actions."""
        state = _state(desk)
        actions = ", ".join(actions_in(desk.draft, state)) or "terminal"
        return f"{state}: {actions}", state

    def advice(self, desk: rules.Desk[GraphDraft]) -> tuple[str, ...]:
        """Describe how to choose among several outcomes."""
        if len(_outcomes_in(desk.draft, _state(desk))) < 2:
            return ()
        return "shift+↑ ↓ or a click chooses an outcome", "shift+↑ ↓: another outcome"

    def lines(self, desk: rules.Desk[GraphDraft]) -> tuple[SheetLine, ...]:
        """Return the state's outcomes."""
        outcomes = _outcomes_in(desk.draft, _state(desk))
        chosen = self._number(desk, outcomes)
        return tuple(
            SheetLine(
                f"{each.action} → {each.to} {each.chance:.4g} pays {rules.number_text(each.pays)}",
                number,
                is_on=number == chosen,
            )
            for number, each in enumerate(outcomes)
        )

    def choose_line(self, desk: rules.Desk[GraphDraft], line: int) -> None:
        """Choose the line's outcome."""
        self._chosen = _state(desk), line

    def go_along(self, desk: rules.Desk[GraphDraft], step: tuple[int, int]) -> None:
        """Choose the next or previous outcome."""
        outcomes = _outcomes_in(desk.draft, _state(desk))
        if outcomes:
            self.choose_line(desk, (self._number(desk, outcomes) + sum(step)) % len(outcomes))

    def numbers(self, desk: rules.Desk[GraphDraft]) -> tuple[WorldNumber, ...]:
        """Return chance and reward of the outcome, and the time limit."""
        outcome = self.outcome(desk)
        return (
            WorldNumber(rules.CHANCE, 0.0 if outcome is None else outcome.chance),
            WorldNumber(rules.PAYS, 0.0 if outcome is None else outcome.pays),
            WorldNumber(rules.LIMIT, rules.number_of(desk.draft, rules.LIMIT.name)),
        )

    def number_edits(self, desk: rules.Desk[GraphDraft], name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set a number."""
        if name == rules.LIMIT.name:
            return rules.checked(desk.draft, Edit(name, (), str(int(value))))
        outcome = self.outcome(desk)
        if outcome is None:
            raise ValueError(_NOTHING)
        entry = paying(outcome, value) if name == rules.PAYS.name else _as_likely(outcome, value)
        return (transition_edit(_state(desk), outcome.action, entry),)

    def place_added(self, world: World) -> int | None:
        """Return the added state, once in ``world``."""
        names = world.space.state_names
        if self._added not in names:
            return None
        name, self._added = self._added, None
        return names.index(name)

    # Outcomes of actions

    def choose_action(self, desk: rules.Desk[GraphDraft]) -> None:
        """Ask for an action, then for its outcomes."""
        draft, state = desk.draft, _state(desk)
        candidates = [
            *(Candidate(each, each, (written(draft, state, each),)) for each in actions_in(draft, state)),
            Candidate(_NEW, _NEW, ("Type a name, then the outcomes.",)),
        ]
        outcome = self.outcome(desk)
        current = "" if outcome is None else outcome.action
        desk.ask(
            Choice(f"Actions in {state}", candidates, current, desk.glyphs),
            partial(self._chosen_action, desk, state),
        )

    def _chosen_action(self, desk: rules.Desk[GraphDraft], state: str, action: str) -> None:
        if action != _NEW:
            self._ask_outcomes(desk, state, action)
            return
        prompt = Prompt("A new action", f"Name of the new action in {state}.", "", read_name)
        desk.ask(prompt, lambda name: self._ask_outcomes(desk, state, str(name)))

    def _ask_outcomes(self, desk: rules.Desk[GraphDraft], state: str, action: str) -> None:
        draft = desk.draft
        hint = f"States and chances: {FORM}. A new name makes a new state. An empty line removes the action."
        was = written(draft, state, action)
        prompt = Prompt(f"{action} in {state}", hint, was, partial(read_outcomes, draft, state, action))

        def answered(text: object) -> None:
            if prompt.typed != was:
                desk.draw((Edit("transition", (state, action), str(text)),))

        desk.ask(prompt, answered)

    def take_action_away(self, desk: rules.Desk[GraphDraft]) -> None:
        """Remove the chosen action."""
        outcome = self.outcome(desk)
        if outcome is None:
            desk.tell(_NOTHING)
        else:
            desk.draw((transition_edit(_state(desk), outcome.action, None),))

    def shift(self, desk: rules.Desk[GraphDraft], chance: float) -> None:
        """Raise the probability of the chosen outcome."""
        outcome = self.outcome(desk)
        try:
            if outcome is None:
                raise ValueError(_NOTHING)
            entry = _as_likely(outcome, round(outcome.chance + chance, 10))
        except ValueError as fault:
            desk.tell(str(fault))
        else:
            desk.draw((transition_edit(_state(desk), outcome.action, entry),))

    def ask_reward(self, desk: rules.Desk[GraphDraft]) -> None:
        """Ask for the chosen outcome's reward."""
        outcome, state = self.outcome(desk), _state(desk)
        if outcome is None:
            desk.tell(_NOTHING)
            return
        title = f"Reward of {outcome.action} in {state}"
        desk.ask(
            Prompt(title, "A number.", f"{outcome.pays:g}", rules.number_in),
            lambda value: desk.draw((transition_edit(state, outcome.action, paying(outcome, float(value))),)),
        )

    # States

    def begin_here(self, desk: rules.Desk[GraphDraft]) -> None:
        """Start every episode here."""
        desk.draw((Edit("start", (), as_json(_state(desk))),))

    def add_state(self, desk: rules.Desk[GraphDraft]) -> None:
        """Ask for a new state's name, and connect it."""
        draft, state = desk.draft, _state(desk)

        def read(text: str) -> str:
            name = read_name(text)
            if name in draft.states:
                raise ValueError("this state exists: enter adds an action that leads there")
            return read_outcomes(draft, state, f"to {name}", as_json({"reward": 0.0, "to": name})) and name

        def answered(name: object) -> None:
            self._added = str(name)
            desk.draw((transition_edit(state, f"to {name}", {"reward": 0.0, "to": str(name)}),))

        hint = f"Name of the new state. An action leads there from {state}."
        desk.ask(Prompt("A new state", hint, "", read, "add"), answered)

    def remove_state(self, desk: rules.Desk[GraphDraft]) -> None:
        """Remove the state, with all outcomes that lead there."""
        desk.draw((Edit("state", (_state(desk),), "null"),))

    def go_on(self, desk: rules.Desk[GraphDraft]) -> None:
        """Go to the next state, cyclically."""
        desk.view.put_cursor(((desk.view.cursor_place or 0) + 1) % desk.snapshot.world.space.states)

    def move(self, desk: rules.Desk[GraphDraft], columns: int, rows: int) -> None:
        """Move the state, or swap two."""
        draft, state = desk.draft, _state(desk)
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

    def paint(self, desk: rules.Desk[GraphDraft], places: Sequence[int]) -> None:
        """Move the cursor, or ask for an action there."""
        was_there = desk.view.cursor == places[-1]
        desk.view.put_cursor(places[-1])
        if was_there:
            self.choose_action(desk)

    def turn(self, desk: rules.Desk[GraphDraft], place: int, amount: float) -> None:
        """Change the probability of the chosen outcome."""
        desk.view.put_cursor(place)
        self.shift(desk, amount / 20)

    def outcome(self, desk: rules.Desk[GraphDraft]) -> ActionOutcome | None:
        """Return the chosen outcome."""
        outcomes = _outcomes_in(desk.draft, _state(desk))
        return outcomes[self._number(desk, outcomes)] if outcomes else None

    def _number(self, desk: rules.Desk[GraphDraft], outcomes: Sequence[ActionOutcome]) -> int:
        if self._chosen is not None and self._chosen[0] == _state(desk):
            return min(self._chosen[1], max(0, len(outcomes) - 1))
        return next((number for number, each in enumerate(outcomes) if not each.is_alone), 0)


def _as_likely(outcome: ActionOutcome, chance: float) -> Mapping[str, Any]:
    if outcome.is_alone:
        raise ValueError(f"{outcome.action} always leads to {outcome.to}. enter: add outcomes")
    if not 0.0 < chance < 1.0:
        raise ValueError(f"{outcome.to} would be certain or impossible. enter: remove outcomes")
    return with_chance(outcome.entry, outcome.to, chance)


def _state(desk: rules.Desk[GraphDraft]) -> str:
    names = desk.snapshot.world.space.state_names
    return names[min(desk.view.cursor_place or 0, len(names) - 1)]


def _places(desk: rules.Desk[GraphDraft], draft: GraphDraft) -> dict[str, Sequence[int]]:
    world = desk.snapshot.world
    assert isinstance(world.drawing, Graph)
    seen = dict(zip(world.space.state_names, world.drawing.places, strict=True))
    return {**seen, **(draft.rules.get("place") or {})}


# The tools, one row each


def _no_outcome(box: GraphTools, desk: rules.Desk[GraphDraft]) -> str:
    return _NOTHING if box.outcome(desk) is None else ""


GraphTools.tools = (
    rules.Tool(
        "enter", "edit…", "Choose or add an action, and type its outcomes.", GraphTools.choose_action, rank=1
    ),
    rules.Tool("equals_sign", "reward…", "Type what the chosen action pays.", GraphTools.ask_reward).also(
        symbol="=", is_of_number=True, why_not=_no_outcome
    ),
    *(
        rules.Tool(
            key, label, f"Make the chosen outcome {how} by .05.", partial(GraphTools.shift, chance=chance)
        ).also(
            symbol=symbol,
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
    rules.Tool("delete", "remove", "Remove the chosen action.", GraphTools.take_action_away).also(
        symbol="del", why_not=_no_outcome
    ),
    rules.Tool("S", "start", "Let every episode start here.", GraphTools.begin_here, rank=6),
    rules.Tool("comma", "next", "Go to the next state, in the file's order.", GraphTools.go_on, ","),
    *(
        rules.Tool(
            key,
            f"move {way}",
            f"Move the state one place {way}.",
            partial(GraphTools.move, columns=columns, rows=rows),
            symbol,
        )
        for key, symbol, way, columns, rows in (
            ("less_than_sign", "<", "left", -1, 0),
            ("greater_than_sign", ">", "right", 1, 0),
            ("circumflex_accent", "^", "up", 0, -1),
            ("V", "V", "down", 0, 1),
        )
    ),
    rules.Tool("w i", "state here…", "Add a state, and an action that leads there.", GraphTools.add_state),
    rules.Tool(
        "w d", "remove state", "Remove this state, and all outcomes that lead there.", GraphTools.remove_state
    ),
    rules.Tool("w r", "rules…", "Set the start and the time limit.", rules.ask_rules),
)
