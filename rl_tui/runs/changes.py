"""Text form of journal entries, such as `500:epsilon=0.01`, `900:take=left` or `700:world.cell[1,2]=#`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

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

# A change as the name of what it sets and the value


ALGORITHM: Final = "algorithm"
TAKE: Final = "take"
SWEEP: Final = "sweep"
WORLD: Final = "world"
UNDO: Final = "world.undo"
REDO: Final = "world.redo"


def name_and_value(change: Change, action_names: Sequence[str] | None = None) -> tuple[str, float | str]:
    """Return the name and value of `change`. Without `action_names`, an action stays as it is."""
    match change:
        case SetParameter(name, value):
            return name, value
        case SwitchAlgorithm(algorithm):
            return ALGORITHM, algorithm
        case OrderSweep(phase):
            return SWEEP, phase
        case TakeAction(action):
            if action_names is None or isinstance(action, str):
                return TAKE, action
            return TAKE, action_names[action] if action < len(action_names) else f"action {action}"
        case EditWorld() | UndoEdit() | RedoEdit():
            return WORLD, written_world(change)


def change_of(name: str, value: float | str) -> Change:
    """Return the change that sets `name`. Raises ValueError only for wrong edits of a world."""
    made_of = _MADE_OF.get(name)
    return SetParameter(name, value) if made_of is None else made_of(value)


def read_world(text: str) -> WorldChange:
    """Parse a change of a world. Raises ValueError."""
    name, _, value = text.partition("=")
    if name not in (UNDO, REDO):
        return EditWorld(read_edits(text))
    if value != "1":
        raise ValueError(f"{name} is {shown(value)}; expected {name}=1, because sweeps run one at a time")
    return UndoEdit() if name == UNDO else RedoEdit()


def written_world(change: WorldChange) -> str:
    """Format `change` for `read_world`."""
    match change:
        case EditWorld(edits):
            return written_edits(edits)
        case UndoEdit():
            return f"{UNDO}=1"
        case RedoEdit():
            return f"{REDO}=1"


_MADE_OF: Final[Mapping[str, Callable[[Any], Change]]] = {
    ALGORITHM: SwitchAlgorithm,
    TAKE: TakeAction,
    SWEEP: OrderSweep,
    WORLD: read_world,
}


# An entry as text


FORM: Final = "STEP:NAME=VALUE"
LATEST: Final = 10**15
# applies only at the start of a run
_AT_THE_START_ONLY: Final = "initial_q"
_NAMES: Final = tuple(name for name in (ALGORITHM, TAKE, SWEEP, *PARAMETERS) if name != _AT_THE_START_ONLY)
_WORDS: Final[Mapping[str, tuple[Iterable[str], str]]] = {
    ALGORITHM: (BY_ID, f"one of {', '.join(BY_ID)}"),
    SWEEP: (SWEEP_PHASES, " or ".join(SWEEP_PHASES)),
}


def written_change(entry: JournalEntry, action_names: Sequence[str]) -> str:
    """Format `entry` for `read_change`, with the action names of the start."""
    name, value = name_and_value(entry.change, action_names)
    return f"{entry.step}:{value}" if name == WORLD else f"{entry.step}:{name}={written_value(value)}"


def written_value(value: float | str) -> str:
    """Format a value with all digits, whole numbers without a decimal point."""
    if isinstance(value, str):
        return value
    return str(int(value)) if value == int(value) and abs(value) < LATEST else repr(value)


def read_change(text: str) -> JournalEntry:
    """Parse a journal entry, without a check of the action. Raises ValueError."""
    before, colon, after = text.partition(":")
    if colon and after.lstrip().startswith(PREFIX):
        return JournalEntry(_step(text, before), _read(text, WORLD, after.strip()))
    name, equals, value = after.partition("=")
    if not colon or not equals:
        raise ValueError(f"{shown(text)} is not {FORM}, such as 500:epsilon=0.01")
    step = _step(text, before)
    name = name.strip().replace("-", "_")
    if name == _AT_THE_START_ONLY:
        raise ValueError(f"{shown(text)}: {name} is the first estimate, so it cannot change during the run")
    if name not in _NAMES:
        raise ValueError(
            f"{shown(text)}: unknown name {shown(name)}; expected a setting, {ALGORITHM}, {TAKE}, {SWEEP} "
            f"or a change of the world such as world.cell[1,2]=#{near(name, _NAMES)}"
        )
    return JournalEntry(step, _read(text, name, value if name == TAKE else value.strip()))


def _step(text: str, before: str) -> int:
    step = before.strip()
    if not (step.isascii() and step.isdigit()) or int(step) > LATEST:
        raise ValueError(f"{shown(text)}: {shown(step)} is not a whole number of steps in [0, {LATEST:g}]")
    return int(step)


def _read(text: str, name: str, value: str) -> Change:
    try:
        return change_of(name, _number_or_word(name, value))
    except ValueError as fault:
        raise ValueError(f"{shown(text)}: {fault}") from fault


def _number_or_word(name: str, value: str) -> float | str:
    if name in (TAKE, WORLD):
        return value
    if name in _WORDS:
        words, expected = _WORDS[name]
        if value not in words:
            raise ValueError(f"{name} is {shown(value)}; expected {expected}{near(value, words)}")
        return value
    parameter = PARAMETERS[name]
    if value in parameter.words:
        return value
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if not parameter.accepts(number):
        raise ValueError(f"{name} is {shown(value)}; expected {parameter.expected}")
    return number


# Journals


def journal_of(entries: Iterable[JournalEntry], action_names: Sequence[str]) -> tuple[JournalEntry, ...]:
    """Sort entries by step, stably, and replace names of actions by numbers.

    After an edit of the world, names stay. Before, an unknown name raises UserError.
    """
    journal, names = list[JournalEntry](), action_names
    for entry in sorted(entries, key=lambda entry: entry.step):
        match entry.change:
            case TakeAction(str(name)) if names:
                number = action_called(name, names)
                if number is None:
                    raise UserError(f"{entry.step}:{TAKE}={name.strip()}: {no_such_action(name, names)}")
                journal.append(JournalEntry(entry.step, TakeAction(number)))
            case change:
                journal.append(entry)
                if isinstance(change, WorldChange):
                    names = ()
    return tuple(journal)


def as_json(journal: Iterable[JournalEntry], action_names: Sequence[str]) -> list[dict[str, Any]]:
    """Return step, name and value of each entry, for `train --json`."""
    entries = []
    for entry in journal:
        name, value = name_and_value(entry.change, action_names)
        entries.append({"step": entry.step, "name": name, "value": value})
    return entries
