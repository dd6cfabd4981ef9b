"""What can only be seen by holding the entries of an ``[mdp]`` table together.

It reads the raw table, so that these faults are reported together with faults of form.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rl_tui.common.findings import Finding, Location, near, shown
from rl_tui.common.limits import MOST_ACTIONS_WRITTEN, MOST_STATES_WRITTEN
from rl_tui.worlds.sections.schema import is_name, is_number


@dataclass(frozen=True, slots=True)
class Arrows:
    """One ``[[mdp.transition]]``, as far as it can be read; ``possible`` are the states with p > 0."""

    index: int
    state: str | None
    action: str | None
    to: tuple[str, ...]
    possible: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """Return whether all of it could be read."""
        return self.state is not None and self.action is not None and bool(self.possible)


def connection_findings(raw: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield unknown and unreachable states, pairs given twice and shared places of a raw ``[mdp]`` table."""
    entries = raw.get("transition")
    arrows = [_read(index, entry) for index, entry in enumerate(entries if isinstance(entries, list) else [])]
    places, looks = _table(raw.get("place")), _table(raw.get("seen_as"))
    yield from _unpaid(entries if isinstance(entries, list) else [])
    yield from _given_twice(arrows)
    yield from _shared_places(places)
    if not arrows or any(each.state is None for each in arrows):
        return  # without every state that acts, the rest would only repeat that fault
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
    """Return each state of a ``to`` or ``start`` and whether it is possible."""
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
                    f"state {shown(each.state)} with action {shown(each.action)} a second time",
                    f"each state and action once (it is already mdp.transition[{before}])",
                )


def _shared_places(places: Mapping[str, Any]) -> Iterator[Finding]:
    taken: dict[tuple[Any, ...], str] = {}
    for name, at in places.items():
        if isinstance(at, list) and all(isinstance(each, int) for each in at):
            holder = taken.setdefault(tuple(at), name)
            if holder != name:
                yield Finding(("place", name), f"{shown(at)}, where {shown(holder)} stands", "a free place")


def _unknown_destinations(arrows: Sequence[Arrows], places: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield destinations that nothing else in the file knows.

    With ``[mdp.place]`` a terminal state must stand in it: that is how a slip of the pen differs from a
    terminal state. Without it only names that differ from another in nothing but case and spaces are refused.
    """
    known = {each.state or "" for each in arrows} | set(places)
    alike = {_loosely(name): name for name in known}
    for each in arrows:
        for name in each.to:
            if name not in known and (places or _loosely(name) in alike):
                expected = "a state with transitions, or a terminal one named in mdp.place"
                yield _unknown(("transition", each.index, "to"), name, expected, known)


def _unknown(location: Location, name: str, expected: str, known: Iterable[str]) -> Finding:
    return Finding(location, f"unknown state {shown(name)}", f"{expected}{near(name, known)}")


def _loosely(name: str) -> str:
    return "".join(name.split()).casefold()


def _unknown_starts(start: object, arrows: Sequence[Arrows]) -> Iterator[Finding]:
    acting = {each.state or "" for each in arrows}
    mentioned = acting.union(*(each.to for each in arrows))
    for name, possible in _weights(start).items():
        if name not in mentioned:
            yield _unknown(("start",), name, "a state with transitions", acting)
        elif possible and name not in acting:
            yield Finding(("start",), f"terminal state {shown(name)}", "a state with transitions")


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
    """Yield states that are not there, and those in which other actions are legal than where it looks so."""
    mentioned = _mentioned(arrows)
    legal: dict[str, set[str]] = {name: set() for name in mentioned}
    for each in arrows:
        legal[each.state or ""].add(each.action or "")
    first: dict[str, str] = {}
    faulty = set[str]()  # of each look one fault is enough
    for name in sorted(mentioned, key=lambda name: (name in looks, name)):  # first what is seen as itself
        look = looks.get(name, name)
        if not is_name(look) or look in faulty:
            continue
        other = first.setdefault(look, name)
        if legal[name] != legal[other]:
            faulty.add(look)
            here, there = (", ".join(sorted(legal[state])) or "none" for state in (name, other))
            yield Finding(
                ("seen_as", name if name in looks else other),
                f"{shown(look)} with the actions {here}, but {there} where it is {shown(other)}",
                "the same actions in all states that look alike",
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
                    f"unreachable state {shown(name)}",
                    "states that can be reached from the start",
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
