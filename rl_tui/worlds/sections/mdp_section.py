"""The ``[mdp]`` table of a scenario file.

Contradictions are found in the raw table, to report them together with errors in single values.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from rl_tui.common.findings import Finding, Location, near, shown
from rl_tui.common.limits import (
    LARGEST_PLACE,
    LARGEST_STD,
    LONGEST_TIME_LIMIT,
    MOST_ACTIONS_WRITTEN,
    MOST_STATES_WRITTEN,
    MOST_TRANSITIONS,
)
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.mdp.tabular_mdp import PROBABILITY_TOLERANCE
from rl_tui.worlds.sections.chain import Move, chain_order
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Name,
    Number,
    Probability,
    WorldSection,
    is_name,
    is_number,
    is_table,
    number,
    refused,
    sized,
    whole_number,
)
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator

    from rl_tui.worlds.mdp.tabular_mdp import Outcome


# Contradictions between entries


@dataclass(frozen=True, slots=True)
class Arrows:
    """The readable part of a transition. `possible` are next states with p > 0."""

    index: int
    state: str | None
    action: str | None
    to: tuple[str, ...]
    possible: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """True if all of it could be read."""
        return self.state is not None and self.action is not None and bool(self.possible)


def connection_findings(raw: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield unknown and unreachable states, repeated pairs, and shared places."""
    entries = raw.get("transition")
    arrows = [_read(index, entry) for index, entry in enumerate(entries if isinstance(entries, list) else [])]
    places, looks = _table(raw.get("place")), _table(raw.get("seen_as"))
    yield from _unpaid(entries if isinstance(entries, list) else [])
    yield from _given_twice(arrows)
    yield from _shared_places(places)
    if not arrows or any(each.state is None for each in arrows):
        return  # with a missing state, everything else would repeat that error
    unknown = [*_unknown_destinations(arrows, places), *_unknown_starts(raw.get("start"), arrows)]
    unknown += _unknown_places(arrows, places, looks)
    yield from unknown
    yield from _seen_findings(arrows, looks)
    mentioned = dict.fromkeys(
        [*places, *looks, *(name for each in arrows for name in (each.state or "", *each.to))]
    )
    actions = {each.action for each in arrows}
    if len(mentioned) > MOST_STATES_WRITTEN:
        yield Finding(("transition",), f"{len(mentioned):,} states", f"at most {MOST_STATES_WRITTEN:,}")
    elif len(actions) > MOST_ACTIONS_WRITTEN:
        yield Finding(("transition",), f"{len(actions):,} actions", f"at most {MOST_ACTIONS_WRITTEN:,}")
    elif not unknown and all(each.whole for each in arrows):
        yield from _unreachable(raw.get("start"), arrows)


def _table(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _read(index: int, entry: object) -> Arrows:
    table: Mapping[str, Any] = entry if isinstance(entry, dict) else {}
    state, action, to = table.get("state"), table.get("action"), table.get("to")
    names = _weights(to)
    return Arrows(
        index,
        state if is_name(state) else None,
        action if is_name(action) else None,
        tuple(names),
        tuple(name for name, weight in names.items() if weight),
    )


def _weights(distribution: object) -> dict[str, bool]:
    # Next state → possible or not, for a `to` or `start`
    if isinstance(distribution, str):
        return {distribution: True} if is_name(distribution) else {}
    if not isinstance(distribution, dict):
        return {}
    return {name: _is_possible(value) for name, value in distribution.items() if is_name(name)}


def _is_possible(value: object) -> bool:
    probability = value.get("p") if isinstance(value, dict) else value
    return not is_number(probability) or probability != 0


def _unpaid(entries: Sequence[object]) -> Iterator[Finding]:
    for index, entry in enumerate(entries):
        if isinstance(entry, dict) and "to" in entry and "reward" not in entry:
            to = entry["to"]
            outcomes = to.values() if isinstance(to, dict) else [to]
            if not all(isinstance(outcome, dict) and "reward" in outcome for outcome in outcomes):
                yield Finding(
                    ("transition", index, "reward"), "nothing", "a reward, here or in every outcome"
                )


def _given_twice(arrows: Sequence[Arrows]) -> Iterator[Finding]:
    first: dict[tuple[str, str], int] = {}
    for each in arrows:
        if each.state is not None and each.action is not None:
            before = first.setdefault((each.state, each.action), each.index)
            if before != each.index:
                yield Finding(
                    ("transition", each.index),
                    f"state {shown(each.state)} with action {shown(each.action)} is listed already, in "
                    f"mdp.transition[{before}]; list it once",
                )


def _shared_places(places: Mapping[str, Any]) -> Iterator[Finding]:
    taken: dict[tuple[Any, ...], str] = {}
    for name, at in places.items():
        if isinstance(at, list) and all(isinstance(each, int) for each in at):
            holder = taken.setdefault(tuple(at), name)
            if holder != name:
                yield Finding(
                    ("place", name), f"{shown(holder)} is already at {shown(at)}; choose a free place"
                )


def _unknown_destinations(arrows: Sequence[Arrows], places: Mapping[str, Any]) -> Iterator[Finding]:
    # Without [mdp.place], only names that differ in case or spaces from another are refused
    known = {each.state or "" for each in arrows} | set(places)
    alike = {_loosely(name): name for name in known}
    for each in arrows:
        for name in each.to:
            if name not in known and (places or _loosely(name) in alike):
                expected = "a state with transitions, or a terminal one named in mdp.place"
                yield _unknown(("transition", each.index, "to"), name, expected, known)


def _unknown(location: Location, name: str, expected: str, known: Iterable[str]) -> Finding:
    return Finding(location, f"unknown state {shown(name)}; use {expected}{near(name, known)}")


def _loosely(name: str) -> str:
    return "".join(name.split()).casefold()


def _unknown_starts(start: object, arrows: Sequence[Arrows]) -> Iterator[Finding]:
    acting = {each.state or "" for each in arrows}
    mentioned = acting.union(*(each.to for each in arrows))
    for name, possible in _weights(start).items():
        if name not in mentioned:
            yield _unknown(("start",), name, "a state with transitions", acting)
        elif possible and name not in acting:
            yield Finding(("start",), f"{shown(name)} is a terminal state; start in a state with transitions")


def _mentioned(arrows: Sequence[Arrows]) -> set[str]:
    return {name for each in arrows for name in (each.state or "", *each.to)}


def _unknown_places(
    arrows: Sequence[Arrows], places: Mapping[str, Any], looks: Mapping[str, Any]
) -> Iterator[Finding]:
    mentioned = _mentioned(arrows)
    known = mentioned.union(look for look in looks.values() if is_name(look))
    for name in places:
        if name not in known:
            yield _unknown(("place", name), name, "a state that a transition mentions", mentioned)


def _seen_findings(arrows: Sequence[Arrows], looks: Mapping[str, Any]) -> Iterator[Finding]:
    # Also states whose actions differ from those of an equal observation
    mentioned = _mentioned(arrows)
    legal: dict[str, set[str]] = {name: set() for name in mentioned}
    for each in arrows:
        legal[each.state or ""].add(each.action or "")
    first: dict[str, str] = {}
    faulty = set[str]()  # one error per observation is enough
    for name in sorted(mentioned, key=lambda name: (name in looks, name)):  # plain ones first
        look = looks.get(name, name)
        if not is_name(look) or look in faulty:
            continue
        other = first.setdefault(look, name)
        if legal[name] != legal[other]:
            faulty.add(look)
            here, there = (", ".join(sorted(legal[state])) or "none" for state in (name, other))
            yield Finding(
                ("seen_as", name if name in looks else other),
                f"the actions are {here}, but {there} in {shown(other)}, which looks the same; "
                "give both the same actions",
            )
    for name in looks:
        if name not in mentioned:
            yield _unknown(("seen_as", name), name, "a state that a transition mentions", mentioned)


def _unreachable(start: object, arrows: Sequence[Arrows]) -> Iterator[Finding]:
    starts = [name for name, possible in _weights(start).items() if possible]
    if not starts:
        return
    reached = _reached_from(starts, arrows)
    reported = set()
    for each in arrows:
        for name, key in [(each.state or "", "state"), *((name, "to") for name in each.to)]:
            if name not in reached and name not in reported:
                reported.add(name)
                yield Finding(
                    ("transition", each.index, key),
                    f"unreachable state {shown(name)}; add a way from the start, or remove it",
                )


def _reached_from(starts: Iterable[str], arrows: Sequence[Arrows]) -> set[str]:
    leads_to: dict[str, list[str]] = {}
    for each in arrows:
        leads_to.setdefault(each.state or "", []).extend(each.possible)
    reached = set(starts)
    to_visit = list(reached)
    while to_visit:
        for name in leads_to.get(to_visit.pop(), []):
            if name not in reached:
                reached.add(name)
                to_visit.append(name)
    return reached


# The table


_TABLE: Final = f"a table of at most {MOST_STATES_WRITTEN:,} states"
PLACE_FORM: Final = f"[column, row], whole numbers from 0 to {LARGEST_PLACE}"
"""The form of a state's place in the drawing."""
_COLUMN_OR_ROW: Final = whole_number(0, LARGEST_PLACE)
_STATES: Final = sized(dict, MOST_STATES_WRITTEN)

Deviation = Annotated[float, number(0, LARGEST_STD)]


class Destination(FileSection):
    """A next state, with its own reward and noise if they differ."""

    p: Probability
    reward: Number | None = None
    std: Deviation | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_number(cls, value: object) -> object:
        if is_table(value):
            return value
        if is_number(value) and 0 <= value <= 1:  # type: ignore[operator]
            return {"p": value}
        raise refused(shown(value), "a probability from 0 to 1, or { p = …, reward = …, std = … }")


Share = TypeVar("Share", float, Destination)


def _certain(value: object) -> object:
    return {value: 1.0} if isinstance(value, str) else value


def _sums_to_one(distribution: dict[str, Share]) -> dict[str, Share]:
    chances = (each.p if isinstance(each, Destination) else each for each in distribution.values())
    total = math.fsum(chances)
    if not abs(total - 1.0) <= PROBABILITY_TOLERANCE:
        raise refused(f"{total:.12g}", "probabilities that sum to 1 (±1e-9)")
    return distribution


def is_place(value: object) -> bool:
    """Return True if `value` is a valid place of a state."""
    return isinstance(value, list) and len(value) == 2 and all(map(_COLUMN_OR_ROW.test, value))


class TransitionEntry(FileSection):
    """The result of an action in a state. `std` is for Gaussian noise on the reward."""

    state: Name
    action: Name
    reward: Number | None = None
    std: Deviation = 0.0
    to: Annotated[
        dict[Name, Destination],
        AfterValidator(_sums_to_one),
        Expect(f"{_TABLE} and their probabilities", _STATES),
        BeforeValidator(_certain),
    ]

    def outcomes(self, index: Mapping[str, int], action: int) -> list[Outcome]:
        """Return the outcomes. `index` numbers the states."""
        from rl_tui.worlds.mdp.tabular_mdp import Outcome

        return [
            Outcome(
                probability=destination.p,
                next_state=index[state],
                reward=next(each for each in (destination.reward, self.reward) if each is not None),
                terminated=False,
                reward_std=self.std if destination.std is None else destination.std,
                action=action,
            )
            for state, destination in self.to.items()
        ]


class MDPSection(WorldSection):
    """The ``[mdp]`` table. States without transitions are terminal.

    `seen_as` gives the observation of a state. If two states share one, the world is simulated.
    """

    start: Annotated[
        dict[Name, Probability],
        AfterValidator(_sums_to_one),
        Expect(f"the name of a state, or {_TABLE} and their probabilities", _STATES),
        BeforeValidator(_certain),
    ]
    time_limit: Annotated[int, whole_number(0, LONGEST_TIME_LIMIT)] = 0
    place: Annotated[
        dict[
            Name,
            Annotated[
                tuple[int, int],
                Expect(PLACE_FORM, is_place),
            ],
        ],
        Expect(f"{_TABLE} and their [column, row]", _STATES),
    ] = Field(default_factory=dict)
    seen_as: Annotated[dict[Name, Name], Expect(f"{_TABLE} and what they are seen as", _STATES)] = Field(
        default_factory=dict
    )
    transition: Annotated[
        list[TransitionEntry],
        Expect(f"1 to {MOST_TRANSITIONS:,} tables [[mdp.transition]]", sized(list, MOST_TRANSITIONS, 1)),
    ]

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield contradictions between entries."""
        return connection_findings(raw)

    def sketch(self) -> Graph:
        """Return the drawing of the world."""
        seen, states = self._numbered()
        return self._graph(states) if len(seen) == len(states) else Graph(self._places(seen))

    def build(self, generator: Generator) -> World:
        """Build the world. `generator` is not used."""
        from rl_tui.worlds.mdp.tabular_mdp import Transition, tabular_mdp

        seen, states = self._numbered()
        actions = _in_order(each.action for each in self.transition)
        names = [self._look(name) for name in states]
        is_plain = len(seen) == len(states)
        mdp = tabular_mdp(
            names if is_plain else list(states),
            list(actions),
            (
                Transition(
                    states[each.state], actions[each.action], each.outcomes(states, actions[each.action])
                )
                for each in self.transition
            ),
            {states[name]: probability for name, probability in self.start.items()},
            self.time_limit,
        )
        if is_plain:
            return World(mdp, self._graph(states))
        from rl_tui.worlds.sections.mdp_observed import observed_world

        return observed_world(mdp, list(seen), [seen[name] for name in names], Graph(self._places(seen)))

    def _numbered(self) -> tuple[dict[str, int], dict[str, int]]:
        # Without `seen_as` observations and states are equal
        mentioned = [name for each in self.transition for name in (each.state, *each.to)]
        seen = _in_order(map(self._look, [*self.place, *mentioned]))
        return seen, _in_order(sorted(mentioned, key=lambda name: seen[self._look(name)]))

    def _graph(self, states: Mapping[str, int]) -> Graph:
        moves = (
            Move(states[each.state], each.action, {states[name]: to.p for name, to in each.to.items()})
            for each in self.transition
        )
        own = {states[name]: place for name, place in self.place.items() if name in states}
        return Graph(self._places(states), chain_order(len(states), moves, own))

    def _look(self, name: str) -> str:
        return self.seen_as.get(name, name)

    def _places(self, states: Iterable[str]) -> tuple[tuple[int, int], ...]:
        # Those without a place fill rows below the others
        states = list(states)
        place = {self._look(name): at for name, at in reversed(self.place.items())}
        place |= {name: at for name, at in self.place.items() if name in states}
        width = max(1, round(len(states) ** 0.5))
        below = 1 + max((row for _, row in place.values()), default=-1)
        unplaced = [state for state in states if state not in place]
        free = {state: (i % width, below + i // width) for i, state in enumerate(unplaced)}
        return tuple(place.get(state) or free[state] for state in states)


def _in_order(names: Iterable[str]) -> dict[str, int]:
    return {name: index for index, name in enumerate(dict.fromkeys(names))}
