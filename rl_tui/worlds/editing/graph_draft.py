"""The draft of a written-out MDP: what each action does in each state, the start, and where states stand."""

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
"""What can be set for the whole graph, by the names of the file's keys."""
_PAIR: Final = ("state", "action")
_DECIMALS: Final = 15  # of a chance that is worked out: 1 − 0.8 is 0.2
# Where a new state is put: the free place nearest to the state that leads to it
_AROUND: Final = ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1))


@dataclass(frozen=True, eq=False)
class GraphDraft(Draft):
    """The transitions in the order of the file, and the rest of the table."""

    kind = "mdp"
    section_class = MDPSection
    transitions: tuple[Mapping[str, Any], ...]
    rules: Mapping[str, Any]

    @property
    def table(self) -> dict[str, Any]:
        """The table as a file would have it."""
        return {**self.rules, "transition": [dict(each) for each in self.transitions]}

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Every state that is mentioned, in the order of its first mention."""
        return tuple(dict.fromkeys(_mentioned(self.transitions)))

    def edited(self, edit: Edit) -> GraphDraft:
        """Return what comes of ``edit``; raises UserError where nothing can."""
        if edit.name in RULES:
            return replace(self, rules={**self.rules, edit.name: rule_value(edit)})
        make = _EDITS.get(edit.name)
        if make is None:
            known = (*_EDITS, *RULES)
            what = f"a graph has nothing called {shown(edit.name)}{near(edit.name, known)}"
            raise UserError(f"{what}; it has {', '.join(known)}")
        return make(self, edit)

    def state_keys(self, world: World) -> Sequence[str]:
        """Return the names of the states of ``world``, [S]."""
        return world.space.state_names

    def entry(self, state: str, action: str) -> Mapping[str, Any] | None:
        """Return what ``action`` does in ``state``, as the file has it; None where it does nothing there."""
        index = self.index(state, action)
        return None if index is None else self.transitions[index]

    def index(self, state: str, action: str) -> int | None:
        """Return the place of that entry among all of them."""
        pairs = ((each.get("state"), each.get("action")) for each in self.transitions)
        return next((index for index, pair in enumerate(pairs) if pair == (state, action)), None)


def graph_draft(scenario: Scenario, seed: int) -> GraphDraft:
    """Return the draft of an ``[mdp]`` scenario; no seed shapes it.

    Raises UserError where several states look alike to the agent: no edit says what it would see.
    """
    rules = dict(tables_in(scenario.text)["mdp"])
    if rules.get("seen_as"):
        raise UserError("states of this world look alike to the agent (seen_as): it cannot be drawn")
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
    """Let an action do in a state what the value says; null takes the pair away."""
    state, action = _pair(edit)
    index = draft.index(state, action)
    entry = plain_value(edit)
    transitions = list(draft.transitions)
    if entry is None:
        if index is None:
            raise UserError(f"{shown(action)} does nothing in {shown(state)}: there is nothing to take away")
        del transitions[index]
    elif not isinstance(entry, Mapping):
        raise UserError(f'{named(edit)} is {shown(edit.value)}; expected {{"to":…,"reward":…}}')
    elif (entry.get("state", state), entry.get("action", action)) != (state, action):
        raise UserError(f"{named(edit)} names another state or action: leave them out of its table")
    else:
        entry = {"state": state, "action": action, **entry}
        # beside the other actions of its state, so that a file reads well
        own = [place for place, each in enumerate(transitions) if each.get("state") == state]
        if index is not None:
            transitions[index] = entry
        else:
            transitions.insert(own[-1] + 1 if own else len(transitions), entry)
    changed = replace(draft, transitions=tuple(transitions))
    _check_size(changed)
    return _with_places(changed, near_to=state)


def _check_size(draft: GraphDraft) -> None:
    """Raise UserError where there is more in ``draft`` than a file may hold."""
    actions = len({each.get("action") for each in draft.transitions})
    for name, count, most in (
        ("states", len(draft.states), MOST_STATES_WRITTEN),
        ("actions", actions, MOST_ACTIONS_WRITTEN),
        ("transitions", len(draft.transitions), MOST_TRANSITIONS),
    ):
        if count > most:
            raise UserError(f"a graph has at most {most:,} {name}")


def _remove_state(draft: GraphDraft, edit: Edit) -> GraphDraft:
    """Take a state away: what can be done there, and what leads there; other outcomes share its chance."""
    (state,) = edit.at if len(edit.at) == 1 else ("",)
    if plain_value(edit) is not None:
        raise UserError(f"{named(edit)} is {shown(edit.value)}; expected null, which takes it away")
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
    """Return ``rules`` without ``state`` among the starts: the others share its chance, or there is none."""
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
    """Return ``draft`` with a place for each new state, near to ``near_to``, and none for those gone."""
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
    """Yield where states can be put, the nearest to ``origin`` first: not where those of ``place`` are."""
    taken = {tuple(at) for at in place.values()}
    for distance in range(1, LARGEST_PLACE):
        for columns, rows in _AROUND:
            at = origin[0] + columns * distance, origin[1] + rows * distance
            if at not in taken and min(at) >= 0:
                yield at
    raise UserError("there is no free place left in the drawing")


def _put(draft: GraphDraft, edit: Edit) -> GraphDraft:
    """Draw a state at another column and row; what stands there changes places with it."""
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
    """Return how likely each next state of an entry is, as far as it says so."""
    to = entry.get("to")
    if isinstance(to, str):
        return {to: 1.0}
    chances = {}
    for name, outcome in to.items() if isinstance(to, Mapping) else ():
        chance = outcome.get("p") if isinstance(outcome, Mapping) else outcome
        chances[name] = float(chance) if isinstance(chance, (int, float)) else 0.0
    return chances


def with_chance(entry: Mapping[str, Any], state: str, chance: float) -> dict[str, Any]:
    """Return ``entry`` with so great a ``chance`` of ``state``; the others share the rest as they shared it.

    Where they had nothing to share in proportion to, they share it evenly. ``chance`` is from 0 to 1; where
    ``state`` is the only one, it is certain.
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
    """Return ``entry``, which leads to other states too, without ``state``: those share its chance."""
    rest = with_chance(entry, state, 0.0)
    return {**rest, "to": {name: outcome for name, outcome in rest["to"].items() if name != state}}


def transition_edit(state: str, action: str, entry: Mapping[str, Any] | None) -> Edit:
    """Return the edit that lets ``action`` do in ``state`` what ``entry`` says, or nothing."""
    value = None if entry is None else {k: v for k, v in entry.items() if k not in _PAIR}
    return Edit("transition", (state, action), as_json(value))
