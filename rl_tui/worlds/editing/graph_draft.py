"""The draft of an ``[mdp]`` table: transitions, start, and places of states."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.common.limits import LARGEST_PLACE, MOST_ACTIONS_WRITTEN, MOST_STATES_WRITTEN, MOST_TRANSITIONS
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.edit import Edit, as_json, named, plain_value, rule_value
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.sections.mdp_section import PLACE_FORM, MDPSection, is_place

if TYPE_CHECKING:
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.world import World

RULES: Final = ("start", "time_limit")
"""Settings for the whole graph, named like the keys of the file."""
_PAIR: Final = ("state", "action")
_DECIMALS: Final = 15  # precision of computed chances, so that 1 − 0.8 gives 0.2
# Directions in which a free place for a new state is searched
_AROUND: Final = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))


@dataclass(frozen=True, eq=False)
class GraphDraft(Draft):
    """Transitions in file order, and the rest of the table."""

    kind = "mdp"
    section_class = MDPSection
    transitions: tuple[Mapping[str, Any], ...]
    rules: Mapping[str, Any]

    @property
    def table(self) -> dict[str, Any]:
        """The table for a file."""
        return {**self.rules, "transition": [dict(each) for each in self.transitions]}

    @cached_property
    def states(self) -> tuple[str, ...]:
        """All states, in the order of first mention."""
        return tuple(dict.fromkeys(_mentioned(self.transitions)))

    def edited(self, edit: Edit) -> GraphDraft:
        """Return the draft after `edit`."""
        if edit.name in RULES:
            return replace(self, rules={**self.rules, edit.name: rule_value(edit)})
        make = _EDITS.get(edit.name)
        if make is None:
            known = (*_EDITS, *RULES)
            what = f"a graph has nothing called {shown(edit.name)}{near(edit.name, known)}"
            raise UserError(f"{what}; choose one of {', '.join(known)}")
        return make(self, edit)

    def state_keys(self, world: World) -> Sequence[str]:
        """Return the names of the states of `world`, [S]."""
        return world.space.state_names

    def entry(self, state: str, action: str) -> Mapping[str, Any] | None:
        """Return the transition of `action` in `state`, or None."""
        index = self.index(state, action)
        return None if index is None else self.transitions[index]

    def index(self, state: str, action: str) -> int | None:
        """Return the index of this transition, or None."""
        pairs = ((each.get("state"), each.get("action")) for each in self.transitions)
        return next((index for index, pair in enumerate(pairs) if pair == (state, action)), None)


def graph_draft(scenario: Scenario, seed: int) -> GraphDraft:
    """Return the draft of an ``[mdp]`` scenario, whatever the seed.

    Raises:
        UserError: The agent cannot tell some states apart (seen_as), which no edit can express.
    """
    rules = dict(tables_in(scenario.text)["mdp"])
    if rules.get("seen_as"):
        raise UserError("some states have equal observations (seen_as), so this world cannot be edited")
    return GraphDraft(tuple(rules.pop("transition")), rules)


def _mentioned(transitions: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    for each in transitions:
        yield str(each.get("state"))
        to = each.get("to")
        if isinstance(to, str):
            yield to
        elif isinstance(to, Mapping):
            yield from to


def _set_transition(draft: GraphDraft, edit: Edit) -> GraphDraft:
    state, action = _pair(edit)
    index = draft.index(state, action)
    entry = plain_value(edit)
    transitions = list(draft.transitions)
    if entry is None:
        if index is None:
            raise UserError(f"{shown(action)} does nothing in {shown(state)}: there is nothing to remove")
        del transitions[index]
    elif not isinstance(entry, Mapping):
        raise UserError(f'{named(edit)} is {shown(edit.value)}; expected {{"to":…,"reward":…}}')
    elif (entry.get("state", state), entry.get("action", action)) != (state, action):
        raise UserError(f"{named(edit)}: the table must not name another state or action")
    else:
        entry = {"state": state, "action": action, **entry}
        # next to the other actions of its state, for a readable file
        own = [place for place, each in enumerate(transitions) if each.get("state") == state]
        if index is not None:
            transitions[index] = entry
        else:
            transitions.insert(own[-1] + 1 if own else len(transitions), entry)
    changed = replace(draft, transitions=tuple(transitions))
    _check_size(changed)
    return _with_places(changed, near_to=state)


def _check_size(draft: GraphDraft) -> None:
    actions = len({each.get("action") for each in draft.transitions})
    for name, count, most in (
        ("states", len(draft.states), MOST_STATES_WRITTEN),
        ("actions", actions, MOST_ACTIONS_WRITTEN),
        ("transitions", len(draft.transitions), MOST_TRANSITIONS),
    ):
        if count > most:
            raise UserError(f"a graph has at most {most:,} {name}")


def _remove_state(draft: GraphDraft, edit: Edit) -> GraphDraft:
    # Other outcomes share its chance
    (state,) = edit.at if len(edit.at) == 1 else ("",)
    if plain_value(edit) is not None:
        raise UserError(f"{named(edit)} is {shown(edit.value)}; expected null, which removes it")
    if state not in draft.states:
        raise UserError(f"there is no state {shown(state)}{near(state, draft.states)}")
    transitions = []
    for entry in draft.transitions:
        if entry.get("state") == state or list(chances_of(entry)) == [state]:
            continue
        transitions.append(without_outcome(entry, state) if state in chances_of(entry) else entry)
    changed = replace(draft, transitions=tuple(transitions), rules=_without_start(draft.rules, state))
    return _with_places(changed, near_to=state)


def _without_start(rules: Mapping[str, Any], state: str) -> Mapping[str, Any]:
    # Other starts share its chance
    starts = chances_of({"to": rules.get("start")})
    if state not in starts:
        return rules
    if len(starts) > 1:
        return {**rules, "start": without_outcome({"to": rules["start"]}, state)["to"]}
    return {name: value for name, value in rules.items() if name != "start"}


def _pair(edit: Edit) -> tuple[str, str]:
    if len(edit.at) != 2:
        raise UserError(f"{named(edit)}: expected a state and an action")
    return edit.at[0], edit.at[1]


def _with_places(draft: GraphDraft, near_to: str) -> GraphDraft:
    # New states are placed near `near_to`
    before = draft.rules.get("place")
    if not isinstance(before, Mapping):
        return draft
    states = frozenset(draft.states)
    place = {name: at for name, at in before.items() if name in states}
    free = _free_places(place, place.get(near_to, (0, 0)))
    for name in draft.states:
        if name not in place:
            place[name] = list(next(free))
    return draft if place == before else replace(draft, rules={**draft.rules, "place": place})


def _free_places(place: Mapping[str, Sequence[int]], origin: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Yield the free places nearest to `origin` first."""
    taken = {tuple(at) for at in place.values()}
    for distance in range(1, LARGEST_PLACE):
        for columns, rows in _AROUND:
            at = origin[0] + columns * distance, origin[1] + rows * distance
            if at not in taken and min(at) >= 0:
                yield at
    raise UserError("there is no free place left in the drawing")


def _put(draft: GraphDraft, edit: Edit) -> GraphDraft:
    # A state already there swaps places with it
    at = plain_value(edit)
    (state,) = edit.at if len(edit.at) == 1 else ("",)
    if state not in draft.states:
        raise UserError(f"there is no state {shown(state)}{near(state, draft.states)}")
    if not is_place(at):
        raise UserError(f"{named(edit)} is {shown(edit.value)}; expected {PLACE_FORM}")
    place = dict(draft.rules.get("place") or {})
    other = next((name for name, taken in place.items() if list(taken) == at and name != state), None)
    if other is not None and state in place:
        place[other] = place[state]
    return replace(draft, rules={**draft.rules, "place": {**place, state: at}})


_EDITS: Final[Mapping[str, Callable[[GraphDraft, Edit], GraphDraft]]] = {
    "transition": _set_transition,
    "state": _remove_state,
    "place": _put,
}


def chances_of(entry: Mapping[str, Any]) -> dict[str, float]:
    """Return the given chances of next states."""
    to = entry.get("to")
    if isinstance(to, str):
        return {to: 1.0}
    chances = {}
    for name, outcome in to.items() if isinstance(to, Mapping) else ():
        chance = outcome.get("p") if isinstance(outcome, Mapping) else outcome
        chances[name] = float(chance) if isinstance(chance, (int, float)) else 0.0
    return chances


def with_chance(entry: Mapping[str, Any], state: str, chance: float) -> dict[str, Any]:
    """Set the chance of one next state. The others keep their proportions in the rest.

    If they had no chance before, they share it evenly. A single outcome stays certain.
    """
    chances = chances_of(entry)
    others = {name: share for name, share in chances.items() if name != state}
    total, rest = sum(others.values()), round(1.0 - chance, _DECIMALS)
    if not others:
        new = {state: 1.0}
    else:
        new = {
            name: round(rest * (share / total if total else 1 / len(others)), _DECIMALS)
            for name, share in others.items()
        }
        new = {name: chance if name == state else new[name] for name in dict.fromkeys((*chances, state))}
    to = entry.get("to")
    outcomes = to if isinstance(to, Mapping) else {}
    return {
        **entry,
        "to": {
            name: {**outcome, "p": share} if isinstance(outcome := outcomes.get(name), Mapping) else share
            for name, share in new.items()
        },
    }


def without_outcome(entry: Mapping[str, Any], state: str) -> dict[str, Any]:
    """Remove one of several outcomes. The others share its chance."""
    rest = with_chance(entry, state, 0.0)
    return {**rest, "to": {name: outcome for name, outcome in rest["to"].items() if name != state}}


def transition_edit(state: str, action: str, entry: Mapping[str, Any] | None) -> Edit:
    """Return the edit that sets a transition, or removes it if None."""
    value = None if entry is None else {k: v for k, v in entry.items() if k not in _PAIR}
    return Edit("transition", (state, action), as_json(value))
