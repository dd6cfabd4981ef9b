"""Outcomes of an action: as a typed line, and one by one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from rl_tui.common.errors import UserError, complaint
from rl_tui.common.findings import place
from rl_tui.worlds.editing.edit import Edit, as_json, json_in
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of
from rl_tui.worlds.sections.mdp_section import TransitionEntry
from rl_tui.worlds.sections.schema import parsed

FORM: Final = "Pass 0.8, Class 0.2 pays -2"
_PAYS: Final = " pays "


class ActionOutcome(NamedTuple):
    """A possible outcome of ``action``. ``entry`` holds all outcomes of the action."""

    action: str
    to: str
    chance: float
    pays: float
    entry: Mapping[str, Any]

    @property
    def is_alone(self) -> bool:
        """True if the action has no other outcome."""
        return len(chances_of(self.entry)) == 1


def outcomes_in(draft: GraphDraft, state: str) -> list[ActionOutcome]:
    """Return every outcome in ``state``, in the order of the file."""
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
    """Return the entry of ``outcome`` with another reward."""
    entry = outcome.entry
    if "reward" not in _own(entry, outcome.to):
        return {**entry, "reward": reward}
    return {**entry, "to": {**entry["to"], outcome.to: {**_own(entry, outcome.to), "reward": reward}}}


def actions_in(draft: GraphDraft, state: str) -> list[str]:
    """Return the names of the actions in ``state``."""
    return [str(each["action"]) for each in draft.transitions if each.get("state") == state]


def written(draft: GraphDraft, state: str, action: str) -> str:
    """Return the outcomes of ``action`` as typed, empty if new."""
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
    """Return the value of the edit that sets the outcomes of ``action`` to the typed text.

    Raises:
        ValueError: The text does not describe an action.
    """
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
                raise ValueError(f"expected states and chances, such as {FORM}") from None
            to[each] = round(1.0 - sum(to.values()), 12)
    if not to or "" in to:
        raise ValueError(f"expected states and chances, such as {FORM}")
    try:
        pays = float(reward.replace("−", "-")) if reward.strip() else 0.0
    except ValueError:
        raise ValueError(f"expected a number after pays, such as {FORM}") from None
    return {"reward": pays, "to": next(iter(to)) if list(to.values()) == [1.0] else to}


def read_name(text: str) -> str:
    """Return the typed name.

    Raises:
        ValueError: It is empty.
    """
    if not text.strip():
        raise ValueError("expected a name")
    return text.strip()
