"""Policies as JSON files, with an action or probabilities for each state."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from rl_tui.agents.exact.policy_figures import SUM_TOLERANCE, Choice
from rl_tui.common.errors import Fault, UserError, first_of
from rl_tui.common.findings import Finding, near, one_line, place, shown
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.worlds.mdp.space import FiniteSpace

_FORM: Final = '{"STATE": "ACTION"} or {"STATE": {"ACTION": CHANCE}}'
_MOST_LISTED: Final = 10


class _Table(dict[str, Any]):
    """A JSON object that remembers its repeated keys."""

    def __init__(self, pairs: list[tuple[str, Any]]) -> None:
        super().__init__(pairs)
        seen: set[str] = set()
        self.repeated: list[str] = []
        for name, _ in pairs if len(self) < len(pairs) else ():
            if name in seen:
                self.repeated.append(name)
            seen.add(name)


class _Names:
    def __init__(self, space: FiniteSpace) -> None:
        self.states = {name: state for state, name in enumerate(space.state_names)}
        self._first_pair: list[int] = space.first_pair.tolist()
        self._pair_action: list[int] = space.pair_action.tolist()
        self._actions = space.action_names

    def pairs_of(self, state: str) -> dict[str, int]:
        number = self.states[state]
        pairs = range(self._first_pair[number], self._first_pair[number + 1])
        return {self._actions[self._pair_action[pair]]: pair for pair in pairs}


def read_policy(path: str, space: FiniteSpace) -> dict[int, Choice]:
    """Read a policy for `space`: a pair, or probabilities of pairs, by state number.

    Raises UserError with one line for each error. Probabilities must sum to 1 (± 1e-9).
    """
    try:
        document = _parsed(read_text(Path(path), "a JSON file"))
    except UnreadableError as reason:
        raise UserError(str(Fault(path, reason.place, reason.found, reason.expected))) from reason
    names = _Names(space)
    faults = first_of(
        Fault(path, place(at), found, wanted) for at, found, wanted in _findings(document, names)
    )
    if faults:
        raise UserError("\n".join(map(str, faults)))
    choices: dict[int, Choice] = {}
    for state, said in document.items():
        pairs = names.pairs_of(state)
        choices[names.states[state]] = (
            pairs[said] if isinstance(said, str) else {pairs[name]: chance for name, chance in said.items()}
        )
    return choices


def policy_document(space: FiniteSpace, choices: Mapping[int, Choice]) -> dict[str, Any]:
    """Return `choices` as JSON data for `read_policy`."""

    def action(pair: int) -> str:
        return space.action_names[int(space.pair_action[pair])]

    return {
        space.state_names[state]: {action(pair): chance for pair, chance in choice.items()}
        if isinstance(choice, Mapping)
        else action(choice)
        for state, choice in choices.items()
    }


def _parsed(text: str) -> Any:
    try:
        return json.loads(text, object_pairs_hook=_Table)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise UnreadableError(where, f"not valid JSON ({one_line(error.msg, 200)})") from error
    except RecursionError as error:
        raise UnreadableError("", f"tables are nested too deeply; write {_FORM}") from error
    except ValueError as error:  # an integer with thousands of digits
        raise UnreadableError("", f"not valid JSON ({one_line(str(error), 200)})") from error


def _findings(document: Any, names: _Names) -> Iterator[Finding]:
    if not isinstance(document, _Table):
        yield Finding((), shown(document), f"a table, {_FORM}")
        return
    for state, said in document.items():
        if state not in names.states:
            yield Finding((state,), f"unknown state; use one of this world{near(state, names.states)}")
        elif not (pairs := names.pairs_of(state)):
            yield Finding((state,), "a terminal state has no actions; leave it out")
        else:
            for finding in _choice_findings(said, list(pairs)):
                yield finding.inside(state)
    for state in document.repeated:
        yield Finding((state,), "this state is listed twice; list it once")


def _choice_findings(said: Any, legal: list[str]) -> Iterator[Finding]:
    if isinstance(said, str):
        yield from _action_findings(said, (), legal)
        return
    if not isinstance(said, _Table):
        yield Finding((), shown(said), 'an action, or a table {"ACTION": CHANCE}')
        return
    sound = True
    for name, chance in said.items():
        for finding in _action_findings(name, (name,), legal):
            yield finding
            sound = False
        if not _is_chance(chance):
            yield Finding((name,), shown(chance), "a number from 0 to 1")
            sound = False
    for name in said.repeated:
        yield Finding((name,), "this action is listed twice; list it once")
        sound = False
    total = math.fsum(said.values()) if sound else 1.0
    if not abs(total - 1.0) <= SUM_TOLERANCE:
        yield Finding((), f"the chances sum to {total:.10g}; make them sum to 1")


def _action_findings(name: str, location: tuple[str, ...], legal: list[str]) -> Iterator[Finding]:
    if name not in legal:
        more = f", … ({len(legal):,} in all)" if len(legal) > _MOST_LISTED else ""
        listed = ", ".join(legal[:_MOST_LISTED])
        what = "this action" if location else shown(name)
        found = f"{what} is not available here; choose one of {listed}{more}{near(name, legal)}"
        yield Finding(location, found)


def _is_chance(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value <= 1.0
