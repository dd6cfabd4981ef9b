"""The entries of a journal as text: ``500:epsilon=0.01``, ``800:algorithm=sarsa``, ``900:take=left``,
``32:sweep=improvement``, ``700:world.cell[1,2]=#``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final, NamedTuple

from rl_tui.agents.catalogue import BY_ID, SWEEP_PHASES
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.runs.recipe import (
    Change,
    EditWorld,
    JournalEntry,
    OrderSweep,
    RedoEdit,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
    UndoEdit,
    WorldChange,
    action_called,
    no_such_action,
)
from rl_tui.worlds.editing.edit import PREFIX, read_edits, written_edits

ALGORITHM: Final = "algorithm"
TAKE: Final = "take"
SWEEP: Final = "sweep"
WORLD: Final = "world"
UNDO: Final = "world.undo"
REDO: Final = "world.redo"
FORM: Final = "STEP:NAME=VALUE"
LATEST: Final = 10**15
# Every estimate starts from it: later there is nothing left to set
_AT_THE_START_ONLY: Final = "initial_q"
_NAMES: Final = tuple(name for name in (ALGORITHM, TAKE, SWEEP, *PARAMETERS) if name != _AT_THE_START_ONLY)


class ChangeText(NamedTuple):
    """One entry as it was written; the value is checked but for the name of an action."""

    step: int
    name: str
    value: float | str


def read_change(text: str) -> ChangeText:
    """Return what ``text`` says; raises ValueError, naming what was expected, where it says nothing."""
    before, colon, after = text.partition(":")
    if colon and after.lstrip().startswith(PREFIX):
        return ChangeText(_step(text, before), WORLD, _world_change(text, after.strip()))
    name, equals, value = after.partition("=")
    if not colon or not equals:
        raise ValueError(f"{shown(text)} is not {FORM}, such as 500:epsilon=0.01")
    step = _step(text, before)
    name = name.strip().replace("-", "_")
    if name == _AT_THE_START_ONLY:
        raise ValueError(f"{shown(text)}: every estimate starts from {name}; it cannot change on the way")
    if name not in _NAMES:
        raise ValueError(
            f"{shown(text)}: expected the name of a hyper-parameter, {ALGORITHM}, {TAKE}, {SWEEP}, or a "
            f"change of the world such as world.cell[1,2]=#{near(name, _NAMES)}"
        )
    return ChangeText(step, name, value if name == TAKE else _value(text, name, value.strip()))


def _step(text: str, before: str) -> int:
    step = before.strip()
    if not (step.isascii() and step.isdigit()) or int(step) > LATEST:
        raise ValueError(f"{shown(text)}: {shown(step)} is not a whole number of steps in [0, {LATEST:g}]")
    return int(step)


def _world_change(text: str, written: str) -> str:
    try:
        return written_world(read_world(written))
    except ValueError as fault:
        raise ValueError(f"{shown(text)}: {fault}") from fault


def read_world(text: str) -> WorldChange:
    """Return the change of a world that ``text`` says; raises ValueError where it says none."""
    name, _, value = text.partition("=")
    if name not in (UNDO, REDO):
        return EditWorld(read_edits(text))
    if value != "1":
        raise ValueError(f"{name} is {shown(value)}; expected {name}=1, one at a time")
    return UndoEdit() if name == UNDO else RedoEdit()


def written_world(change: WorldChange) -> str:
    """Return ``change`` as :func:`read_world` reads it."""
    match change:
        case EditWorld(edits):
            return written_edits(edits)
        case UndoEdit():
            return f"{UNDO}=1"
        case RedoEdit():
            return f"{REDO}=1"


def _value(text: str, name: str, value: str) -> float | str:
    if name == ALGORITHM:
        if value not in BY_ID:
            expected = f"one of {', '.join(BY_ID)}{near(value, BY_ID)}"
            raise ValueError(f"{shown(text)}: algorithm is {shown(value)}; expected {expected}")
        return value
    if name == SWEEP:
        if value not in SWEEP_PHASES:
            raise ValueError(
                f"{shown(text)}: sweep is {shown(value)}; expected {' or '.join(SWEEP_PHASES)}"
                f"{near(value, SWEEP_PHASES)}"
            )
        return value
    parameter = PARAMETERS[name]
    if value in parameter.words:
        return value
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if not parameter.accepts(number):
        raise ValueError(f"{shown(text)}: {name} is {shown(value)}; expected {parameter.expected}")
    return number


def journal_of(changes: Iterable[ChangeText], action_names: Sequence[str]) -> tuple[JournalEntry, ...]:
    """Return the journal of ``changes``, by their steps; those of one step stay in their order.

    ``action_names`` are those of the world that a run begins in. Once the world is another one, an action is
    known by its name alone, which the run looks up when it comes there. Raises UserError, naming the actions,
    where there is none of that name before.
    """
    entries, names = list[JournalEntry](), action_names
    for each in sorted(changes, key=lambda change: change.step):
        if each.name == WORLD:
            names = ()
        entries.append(JournalEntry(each.step, _change(each, names)))
    return tuple(entries)


def _change(change: ChangeText, action_names: Sequence[str]) -> Change:
    """Return what is changed; no ``action_names`` are there where they are not known yet."""
    if change.name == ALGORITHM:
        return SwitchAlgorithm(str(change.value))
    if change.name == WORLD:
        return read_world(str(change.value))
    if change.name == SWEEP:
        return OrderSweep("improvement" if change.value == "improvement" else "evaluation")
    if change.name != TAKE:
        return SetParameter(change.name, change.value)
    wanted = str(change.value)
    if not action_names:
        return TakeAction(wanted)
    number = action_called(wanted, action_names)
    if number is None:
        raise UserError(f"{change.step}:{TAKE}={wanted.strip()}: {no_such_action(wanted, action_names)}")
    return TakeAction(number)


def name_and_value(change: Change, action_names: Sequence[str]) -> tuple[str, float | str]:
    """Return what ``change`` sets and to what; an action by its name.

    ``action_names`` are those of the world that the run began in.
    """
    match change:
        case SetParameter(name, value):
            return name, value
        case SwitchAlgorithm(algorithm):
            return ALGORITHM, algorithm
        case OrderSweep(phase):
            return SWEEP, phase
        case TakeAction(action):
            if isinstance(action, str):
                return TAKE, action
            return TAKE, action_names[action] if action < len(action_names) else f"action {action}"
        case EditWorld() | UndoEdit() | RedoEdit():
            return WORLD, written_world(change)


def written_change(entry: JournalEntry, action_names: Sequence[str]) -> str:
    """Return ``entry`` as :func:`read_change` reads it."""
    name, value = name_and_value(entry.change, action_names)
    if name == WORLD:
        return f"{entry.step}:{value}"
    return f"{entry.step}:{name}={written_value(value)}"


def written_value(value: float | str) -> str:
    """Return a value with all its digits, a whole number without a point."""
    if isinstance(value, str):
        return value
    return str(int(value)) if value == int(value) and abs(value) < LATEST else repr(value)


def as_json(journal: Iterable[JournalEntry], action_names: Sequence[str]) -> list[dict[str, Any]]:
    """Return ``journal`` as ``train --json`` prints it: after so many steps, what was set to what."""
    entries = []
    for entry in journal:
        name, value = name_and_value(entry.change, action_names)
        entries.append({"step": entry.step, "name": name, "value": value})
    return entries
