"""Everything a watched program has reported."""

from __future__ import annotations

import json
import signal
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final, TypeVar

import numpy as np
import numpy.typing as npt

from rl_tui.programs.watched.messages import (
    CHANGE_WIDTH,
    MESSAGE,
    NO_LIMIT,
    OWN_MESSAGE,
    STEP_WIDTH,
    STEPS,
    TABLE,
    MessageKind,
)
from rl_tui.programs.watched.recording import Recording

MOST_OUTPUT: Final = 2_000
GARBLED: Final = "data from the program is damaged: something else wrote into rl-tui's pipe"
_COUNTED: Final = (0, 2, 5, 6, 7)
"""Integer columns of steps, other than states."""
_STATES: Final = (1, 4)
_EPISODE: Final = 6
_MAY_BE_NULL: Final = ("line", "status", "stopped")
_NONE_OF_OURS: Final = (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError)

Made = TypeVar("Made", "ProgramEnvironment", "FoundTable", "ProgramAgent", "ProgramError")


@dataclass(frozen=True, slots=True)
class ProgramEnvironment:
    """An environment of the program.

    Attributes:
        kwargs: Its arguments, or None if they are not plain data.
        parts: Sizes of an observation's parts, one for a plain number.
        time_limit: Longest episode in steps, 0 for none.
        first_state: First value of each part.
        wrappers: Class names of its wrappers.
        transitions: Its table if only the program has it, `[s][a]` a list of (probability, next state,
            reward, terminated).
        start: Probability of each start state for that table, if known.
        state_names: Names of states, if their number is unknown.
    """

    number: int
    id: str
    kwargs: Mapping[str, Any] | None
    parts: tuple[int, ...]
    actions: int
    time_limit: int
    first_action: int = 0
    first_state: tuple[int, ...] = ()
    wrappers: tuple[str, ...] = ()
    transitions: Any = None
    start: Any = None
    state_names: tuple[str, ...] = ()
    action_names: tuple[str, ...] = ()

    @property
    def states(self) -> int:
        """Number of possible observations."""
        return int(np.prod(self.parts))


@dataclass(frozen=True, slots=True)
class FoundTable:
    """The table of a program, and other candidates."""

    name: str
    form: str
    """array, lists, dict-of-arrays, dict-of-dicts, dict-of-pairs, dict-of-parts or data-frame."""
    shape: tuple[int, ...]
    dtype: str
    """NumPy's name, or "" for Python numbers."""
    others: tuple[str, ...] = ()
    other_forms: tuple[str, ...] = ()
    other: str = ""
    """Path of another table, if both change in turn. The recorded one is their mean then."""


@dataclass(frozen=True, slots=True)
class ProgramError:
    """The exception of a program."""

    type: str
    text: str
    file: str = ""
    line: int | None = None
    traceback: str = ""


@dataclass(frozen=True, slots=True)
class ProgramAgent:
    """An agent without a loop."""

    name: str
    style: str
    done_is_either: bool


@dataclass(slots=True)
class OutputLine:
    """A line of output after `step` steps. `stream` is "out" or "err"."""

    step: int
    stream: str
    text: str


@dataclass(slots=True)
class ProgramLog:
    """The contents of all frames, sorted by `take`."""

    recording: Recording = field(default_factory=Recording)
    episodes: int = 0
    """Number of episodes begun, over all environments."""
    environments: list[ProgramEnvironment] = field(default_factory=list)
    table: FoundTable | None = None
    shared_at: int | None = None
    """Step at which rows of the table were the same object, or None."""
    agent: ProgramAgent | None = None
    """The agent, or None for a script with its own loop."""
    numbers: dict[str, float] = field(default_factory=dict)
    """Numbers in the code by name, another object after each change."""
    lines: dict[tuple[str, int], int] = field(default_factory=dict)
    """Number of changes by line (file, number), while traced."""
    called: dict[str, tuple[str, int]] = field(default_factory=dict)
    """The first line (file, number) that called `step`, and `reset`."""
    output: deque[OutputLine] = field(default_factory=lambda: deque(maxlen=MOST_OUTPUT))
    notes: list[str] = field(default_factory=list)
    refused: str = ""
    error: ProgramError | None = None
    waiting_at: int | None = None
    """Step at which it waits, or None."""
    stopped_by: str | None = None
    """The event that it met there, or None."""
    heard: int = 0
    """Number of lines that it had read at its last report."""
    started: bool = False
    """True once the program's own code runs."""
    stands_at: tuple[str, int] | None = None
    """Line (file, number) at which it is without a step, or None."""
    ended: bool = False
    is_garbled: bool = False
    """True if a frame is not from our code."""

    @property
    def table_now(self) -> FoundTable | None:
        """The table with its current shape, as a dict grows: `(rows, actions)`, if rows are states."""
        table, actions = self.table, self.recording.actions
        if table is None or not table.form.startswith(("dict", "data")) or not actions:
            return table
        is_there = ~np.isnan(self.recording.table_at(self.recording.count)).reshape(-1, actions)
        rows = int(is_there.any(axis=1).sum())
        by_pair = table.form in ("dict-of-pairs", "dict-of-parts")
        return replace(table, shape=(int(is_there.sum()),) if by_pair else (rows, actions))

    def frozen(self) -> ProgramLog:
        """Return a copy without output for another thread."""
        return replace(
            self,
            recording=self.recording.frozen(),
            environments=list(self.environments),
            lines=dict(self.lines),
            called=dict(self.called),
            notes=list(self.notes),
            output=deque(),
        )

    def take(self, letter: bytes, payload: bytes) -> None:
        """Process one frame. An invalid one ends the messages."""
        if self.is_garbled and letter != OWN_MESSAGE:
            return
        try:
            if letter == STEPS:
                self._take_steps(np.frombuffer(payload, np.float64))
            elif letter == TABLE:
                content = np.frombuffer(payload, np.float64).copy()
                if self.table is not None and self.table.other:
                    self.recording.find_pair(self._found_at, content)
                else:
                    self.recording.find_table(self._found_at, self._found_actions, content)
            elif letter in (MESSAGE, OWN_MESSAGE):
                self._take_message(json.loads(payload))
            else:
                raise ValueError(f"unknown frame: {letter!r}")
        except _NONE_OF_OURS:
            self.is_garbled = self.ended = True
            self.error = self.error or ProgramError("Garbled", GARBLED)

    _states: int = 0
    _found_at: int = 0
    _found_actions: int = 0
    _unfinished: dict[str, OutputLine] = field(default_factory=dict)
    """Last line of each stream, while it may be replaced."""

    def _take_steps(self, numbers: npt.NDArray[np.float64]) -> None:
        until = 1 + int(numbers[0]) * STEP_WIDTH
        steps = numbers[1:until].reshape(-1, STEP_WIDTH)
        changes = numbers[until:].reshape(-1, CHANGE_WIDTH)
        if not (_is_within(steps[:, _COUNTED], NO_LIMIT) and _is_within(steps[:, _STATES], self._states)):
            raise ValueError("the steps are damaged")
        recording = self.recording
        cells = sum(len(each) for each in (recording.initial, recording.initial_pair) if each is not None)
        if not (_is_within(changes[:, 1], cells) and _is_within(changes[:, 0], NO_LIMIT)):
            raise ValueError("the changes are damaged")
        self.episodes = max(self.episodes, 1 + int(steps[:, _EPISODE].max(initial=-1)))
        self.recording.add(steps, changes)
        self.waiting_at = self.stands_at = None

    def _take_message(self, said: Mapping[str, Any]) -> None:
        _check_types(said)
        match said["kind"]:
            case MessageKind.ENVIRONMENT:
                if len(said["states"]) != len(said["first_state"]) or min(said["states"], default=0) < 1:
                    raise ValueError("the observations are damaged")
                self._take_environment(_made(ProgramEnvironment, said, parts=tuple(said["states"])))
            case MessageKind.NAMES:
                self._take_names(said["number"], said["state_names"], said["action_names"])
            case MessageKind.OWN_ENDS:
                self.recording.has_own_ends = True
            case MessageKind.TABLE:
                if len(said["others"]) != len(said["other_forms"]):
                    raise ValueError("the tables are damaged")
                self.table = _made(FoundTable, said)
                self._found_at, self._found_actions = said["step"], said["actions"]
                if said["shared"]:
                    self.shared_at = said["step"]
            case MessageKind.PAIR:
                if self.table is None:
                    raise ValueError("the tables are damaged")
                self.table = replace(self.table, other=said["name"])
                self._found_at = said["step"]
            case MessageKind.REBOUND:
                self.recording.rebound.append(said["step"])
            case MessageKind.SHARED:
                self.shared_at = said["step"] if self.shared_at is None else self.shared_at
            case MessageKind.NUMBERS:
                self.numbers = {**self.numbers, **said["numbers"]}
            case MessageKind.CALLED:
                if self.agent is None:  # otherwise the loop is ours
                    self.called[said["method"]] = (said["file"], said["line"])
            case MessageKind.TRANSITIONS:
                self.environments[said["number"]] = replace(
                    self.environments[said["number"]], transitions=said["P"], start=said["start"]
                )
            case MessageKind.LINES:
                for file, line, count in said["lines"]:
                    self.lines[file, line] = self.lines.get((file, line), 0) + count
            case MessageKind.AGENT:
                self.agent = _made(ProgramAgent, said)
                self.called.setdefault("step", (said["file"], said["line"]))
            case MessageKind.OUTPUT:
                self._take_output(said)
            case MessageKind.NOTE:
                if said["text"] not in self.notes:  # once, however often it happens
                    self.notes.append(said["text"])
            case MessageKind.STARTED:
                self.started = True
            case MessageKind.STANDS:
                self.stands_at = (str(said["file"]), int(said["line"]))
            case MessageKind.WAITING:
                self.stands_at = None
                self.waiting_at, self.stopped_by = said["step"], said["stopped"]
                self.heard = said["heard"]
            case MessageKind.REFUSED:
                self.refused = said["text"]
            case MessageKind.ERROR:
                self.error = _made(ProgramError, said)
            case MessageKind.END:
                self.ended = True
            case MessageKind.GONE:
                self._take_end(said["status"], said["text"])

    def _take_environment(self, environment: ProgramEnvironment) -> None:
        """Add an environment, or replace it if the program uses it without its wrappers."""
        known = self.environments[environment.number : environment.number + 1]
        if not known:
            self.environments.append(environment)
            self._states = max(self._states, environment.states)
        elif (known[0].parts, known[0].actions) == (environment.parts, environment.actions):
            self.environments[environment.number] = environment
        else:
            raise ValueError("the environment is damaged")

    def _take_names(self, number: int, states: list[str], actions: list[str]) -> None:
        known = self.environments[number]
        if len(states) > known.states or len(actions) != known.actions:
            raise ValueError("the names are damaged")
        self.environments[number] = replace(known, state_names=tuple(states), action_names=tuple(actions))

    def _take_output(self, said: Mapping[str, Any]) -> None:
        step = self.recording.count if said["step"] is None else said["step"]
        line, before = OutputLine(step, said["stream"], said["text"]), self._unfinished.get(said["stream"])
        self._unfinished[line.stream] = line
        if said["replaces"] and before is not None:
            for place in range(len(self.output) - 1, -1, -1):
                if self.output[place] is before:
                    self.output[place] = line
                    return
        self.output.append(line)

    def _take_end(self, status: int | None, text: str) -> None:
        if not (self.ended or self.error or self.refused):
            if text or status is None:
                self.error = ProgramError("Ended", text)
            elif status > 0 and not self.started:
                self.error = ProgramError("NotStarted", self._why_not_started())
            elif status:
                self.error = ProgramError("Died", _death_in_words(status))
            else:
                self.notes.append("the program ended at once, by os._exit(0)")
        self.ended = True

    def _why_not_started(self) -> str:
        written = [line.text for line in self.output if line.stream == "err" and line.text.strip()]
        why = f": {written[-1].strip()}" if written else ""
        return f"rl-tui could not start its own part of the process; this is not a bug of the script{why}"


def _made(kind: type[Made], said: Mapping[str, Any], **more: Any) -> Made:
    """Return an object of `kind`, whose fields have the names of those in a message."""
    given = {each.name: said[each.name] for each in fields(kind) if each.name in said}
    lists = {name: tuple(value) for name, value in given.items() if isinstance(value, list)}
    return kind(**{**given, **lists, **more})


def _death_in_words(status: int) -> str:
    if status > 0:
        return f"the program ended at once, by os._exit({status})"
    try:
        name = signal.Signals(-status).name
    except ValueError:
        name = str(-status)
    reason = "; the system sends it, for example, when memory runs out" if name == "SIGKILL" else ""
    return f"the program was stopped by the signal {name}{reason}"


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and -NO_LIMIT <= value <= NO_LIMIT


def _is_list(value: object, fits: Callable[[object], bool]) -> bool:
    return isinstance(value, list) and all(map(fits, value))


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _is_table_of_numbers(value: object) -> bool:
    return isinstance(value, dict) and all(isinstance(each, int | float) for each in value.values())


_FITS: Final[Mapping[str, Callable[[Any], bool]]] = {
    **dict.fromkeys(
        ("number", "actions", "time_limit", "heard"), lambda value: _is_whole(value) and value >= 0
    ),
    **dict.fromkeys(("first_action", "step", "line", "status"), _is_whole),
    **dict.fromkeys(("id", "name", "other", "form", "dtype", "text", "type", "file", "traceback"), _is_text),
    **dict.fromkeys(("method", "stream", "style", "stopped"), _is_text),
    **dict.fromkeys(("states", "shape", "first_state"), lambda value: _is_list(value, _is_whole)),
    **dict.fromkeys(("others", "other_forms", "wrappers"), lambda value: _is_list(value, _is_text)),
    **dict.fromkeys(("state_names", "action_names"), lambda value: _is_list(value, _is_text)),
    "numbers": _is_table_of_numbers,
}


def _check_types(said: Mapping[str, Any]) -> None:
    """Raise TypeError for wrong types, because a program may write anything."""
    for name, value in said.items():
        is_unknown_step = name == "step" and said["kind"] == MessageKind.OUTPUT
        is_null = value is None and (name in _MAY_BE_NULL or is_unknown_step)
        if not (is_null or name not in _FITS or _FITS[name](value)):
            raise TypeError(f"unknown message: {name}")


def _is_within(numbers: npt.NDArray[np.float64], end: int) -> bool:
    return bool(((numbers >= 0) & (numbers < end)).all())
