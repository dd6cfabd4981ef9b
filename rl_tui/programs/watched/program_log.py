"""All that a watched program has told so far."""

from __future__ import annotations

import json
import signal
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

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
"""Lines of output that are kept."""
GARBLED: Final = "what came from the program is garbled: something else wrote into rl-tui's pipe"
_COUNTED: Final = (0, 2, 5, 6, 7)
"""The columns of steps that are whole numbers, other than states."""
_STATES: Final = (1, 4)
_EPISODE: Final = 6
_COUNTS: Final = ("number", "actions", "time_limit", "heard")
_WHOLE: Final = ("first_action", "step", "line", "status")
_TEXTS: Final = (
    "id",
    "name",
    "form",
    "dtype",
    "text",
    "type",
    "file",
    "traceback",
    "method",
    "stream",
    "style",
)
_MAY_BE_NULL: Final = ("line", "status", "stopped")
_NONE_OF_OURS: Final = (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError)


@dataclass(frozen=True, slots=True)
class ProgramEnvironment:
    """An environment that the program made.

    ``parts`` are the sizes of the parts of an observation, one for a plain number, ``first_state`` what each
    counts from. ``kwargs`` is None where it was made with something that is no plain data. ``transitions`` is
    its table, ``[s][a]`` a list of (probability, next state, reward, ended), where only the program has it;
    ``start`` are then the probabilities to begin in each state, None where it does not tell them.
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

    @property
    def states(self) -> int:
        """How many observations there may be."""
        return int(np.prod(self.parts))


@dataclass(frozen=True, slots=True)
class FoundTable:
    """The table of a program: its way in the code, its form, and what else might be one."""

    name: str
    form: str
    """array, dict-of-arrays, dict-of-pairs or lists."""
    shape: tuple[int, ...]
    dtype: str
    """As NumPy calls it; empty where it is Python's own numbers."""
    others: tuple[str, ...] = ()
    other_forms: tuple[str, ...] = ()
    """The form of each of ``others``."""
    file: str = ""
    line: int | None = None
    """Where it was made, if that is known."""


@dataclass(frozen=True, slots=True)
class ProgramError:
    """What a program raised."""

    type: str
    text: str
    file: str = ""
    line: int | None = None
    traceback: str = ""


@dataclass(frozen=True, slots=True)
class ProgramAgent:
    """The agent without a loop that a program is; ``done_is_either`` as its shape has it."""

    name: str
    style: str
    done_is_either: bool


@dataclass(slots=True)
class OutputLine:
    """One line that a program wrote, after so many steps; ``stream`` is "out" or "err"."""

    step: int
    stream: str
    text: str


@dataclass(slots=True)
class ProgramLog:
    """What came through the pipe, put in its place by :meth:`take`."""

    recording: Recording = field(default_factory=Recording)
    episodes: int = 0
    """How many have begun, over all environments."""
    environments: list[ProgramEnvironment] = field(default_factory=list)
    table: FoundTable | None = None
    shared_at: int | None = None
    """The step at which rows of the table were seen to be one and the same object."""
    agent: ProgramAgent | None = None
    """None for a script with a loop of its own."""
    numbers: dict[str, float] = field(default_factory=dict)
    """Numbers that the program's code holds, by name."""
    lines: dict[tuple[str, int], int] = field(default_factory=dict)
    """How often each line (file, number) changed the table while that was looked at."""
    called: dict[str, tuple[str, int]] = field(default_factory=dict)
    """The first line (file, number) that called ``step``, and that which called ``reset``."""
    output: deque[OutputLine] = field(default_factory=lambda: deque(maxlen=MOST_OUTPUT))
    notes: list[str] = field(default_factory=list)
    refused: str = ""
    """Why it cannot be watched; empty if it can."""
    error: ProgramError | None = None
    waiting_at: int | None = None
    """The step at which it waits; None: it goes on."""
    stopped_by: str | None = None
    """What it met there, None where it may simply go no further."""
    heard: int = 0
    """How many lines it had heard of the watching side when it last said that it waits."""
    started: bool = False
    """Whether the program's own code has begun to run."""
    stands_at: tuple[str, int] | None = None
    """The line (file, number) where it has stood for long without a step, None where it goes on."""
    ended: bool = False
    is_garbled: bool = False
    """Whether something came that is none of ours."""

    @property
    def table_now(self) -> FoundTable | None:
        """The table, its shape as it is now: a dict grows. ``(rows, actions)`` where a row is a state's."""
        table, actions = self.table, self.recording.actions
        if table is None or not table.form.startswith("dict") or not actions:
            return table
        is_there = ~np.isnan(self.recording.table_at(self.recording.count)).reshape(-1, actions)
        rows = int(is_there.any(axis=1).sum())
        by_pair = table.form == "dict-of-pairs"
        return replace(table, shape=(int(is_there.sum()),) if by_pair else (rows, actions))

    def frozen(self) -> ProgramLog:
        """Return it as it is now, without output, which another thread may read while this one grows."""
        return replace(
            self,
            recording=self.recording.frozen(),
            environments=list(self.environments),
            numbers=dict(self.numbers),
            lines=dict(self.lines),
            called=dict(self.called),
            notes=list(self.notes),
            output=deque(),
        )

    def take(self, letter: bytes, payload: bytes) -> None:
        """Take in one frame. One that is none of ours is an end: no more counts of what the program says."""
        if self.is_garbled and letter != OWN_MESSAGE:
            return
        try:
            self._take(letter, payload)
        except _NONE_OF_OURS:
            self.is_garbled = self.ended = True
            self.error = self.error or ProgramError("Garbled", GARBLED)

    def _take(self, letter: bytes, payload: bytes) -> None:
        if letter == STEPS:
            self._take_steps(np.frombuffer(payload, np.float64))
        elif letter == TABLE:
            content = np.frombuffer(payload, np.float64).copy()
            self.recording.find_table(self._found_at, self._found_actions, content)
        elif letter in (MESSAGE, OWN_MESSAGE):
            self._take_message(json.loads(payload))
        else:
            raise ValueError(f"no frame of ours: {letter!r}")

    _found_at: int = 0
    _found_actions: int = 0
    _unfinished: dict[str, OutputLine] = field(default_factory=dict)
    """The last line of each stream, as long as it may be replaced."""

    def _take_steps(self, numbers: npt.NDArray[np.float64]) -> None:
        until = 1 + int(numbers[0]) * STEP_WIDTH
        steps = numbers[1:until].reshape(-1, STEP_WIDTH)
        changes = numbers[until:].reshape(-1, CHANGE_WIDTH)
        states = max((each.states for each in self.environments), default=0)
        if not (_is_within(steps[:, _COUNTED], NO_LIMIT) and _is_within(steps[:, _STATES], states)):
            raise ValueError("no steps of ours")
        cells = 0 if self.recording.initial is None else len(self.recording.initial)
        if not (_is_within(changes[:, 1], cells) and _is_within(changes[:, 0], NO_LIMIT)):
            raise ValueError("no changes of ours")
        self.episodes = max(self.episodes, 1 + int(steps[:, _EPISODE].max(initial=-1)))
        self.recording.add(steps, changes)
        self.waiting_at = self.stands_at = None

    def _take_message(self, said: Mapping[str, Any]) -> None:
        _check_types(said)
        match said["kind"]:
            case MessageKind.ENVIRONMENT:
                if len(said["states"]) != len(said["first_state"]) or min(said["states"], default=0) < 1:
                    raise ValueError("no observations of ours")
                self.environments.append(
                    ProgramEnvironment(
                        said["number"],
                        said["id"],
                        said["kwargs"],
                        tuple(said["states"]),
                        said["actions"],
                        said["time_limit"],
                        said["first_action"],
                        tuple(said["first_state"]),
                        tuple(said["wrappers"]),
                    )
                )
            case MessageKind.TABLE:
                if len(said["others"]) != len(said["other_forms"]):
                    raise ValueError("no tables of ours")
                self.table = FoundTable(
                    said["name"],
                    said["form"],
                    tuple(said["shape"]),
                    said["dtype"],
                    tuple(said["others"]),
                    tuple(said["other_forms"]),
                    said.get("file", ""),
                    said.get("line"),
                )
                self._found_at, self._found_actions = said["step"], said["actions"]
                if said["shared"]:
                    self.shared_at = said["step"]
            case MessageKind.REBOUND:
                self.recording.rebound.append(said["step"])
            case MessageKind.SHARED:
                self.shared_at = said["step"] if self.shared_at is None else self.shared_at
            case MessageKind.NUMBERS:
                self.numbers.update(said["numbers"])
            case MessageKind.CALLED:
                if self.agent is None:  # else the loop is ours
                    self.called[said["method"]] = (said["file"], said["line"])
            case MessageKind.TRANSITIONS:
                self.environments[said["number"]] = replace(
                    self.environments[said["number"]], transitions=said["P"], start=said["start"]
                )
            case MessageKind.LINES:
                for file, line, count in said["lines"]:
                    self.lines[file, line] = self.lines.get((file, line), 0) + count
            case MessageKind.AGENT:
                self.agent = ProgramAgent(said["name"], said["style"], said["done_is_either"])
                self.called.setdefault("step", (said["file"], said["line"]))
            case MessageKind.OUTPUT:
                self._take_output(said)
            case MessageKind.NOTE:
                if said["text"] not in self.notes:  # once, however often the program does it
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
                self.error = ProgramError(
                    said["type"], said["text"], said["file"], said["line"], said["traceback"]
                )
            case MessageKind.END:
                self.ended = True
            case MessageKind.GONE:
                self._take_end(said["status"], said["text"])

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
        """Take in that the process is over, which is an error where the program did not say so itself."""
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
        """Return why our own side in the process failed, by the last that it wrote."""
        written = [line.text for line in self.output if line.stream == "err" and line.text.strip()]
        why = f": {written[-1].strip()}" if written else ""
        return f"rl-tui could not start its own part of the process, which is no fault of the script{why}"


def _death_in_words(status: int) -> str:
    """Return how a process ended whose ``status`` is not 0, as subprocess counts it."""
    if status > 0:
        return f"the program ended at once, by os._exit({status})"
    try:
        name = signal.Signals(-status).name
    except ValueError:
        name = str(-status)
    reason = "; where nobody sent it, memory may have run out" if name == "SIGKILL" else ""
    return f"the program was ended by the signal {name}{reason}"


def _check_types(said: Mapping[str, Any]) -> None:
    """Raise TypeError where a message holds something else than ours do: a program may write anything."""
    for name, value in said.items():
        is_unknown_step = name == "step" and said["kind"] == MessageKind.OUTPUT
        if value is None and (name in _MAY_BE_NULL or is_unknown_step):
            continue
        if name in _COUNTS:
            fits = _is_whole(value) and value >= 0
        elif name in _WHOLE:
            fits = _is_whole(value)
        elif name in (*_TEXTS, "stopped"):
            fits = isinstance(value, str)
        elif name in ("states", "shape", "first_state"):
            fits = isinstance(value, list) and all(_is_whole(each) for each in value)
        elif name in ("others", "wrappers"):
            fits = isinstance(value, list) and all(isinstance(each, str) for each in value)
        elif name == "numbers":
            fits = isinstance(value, dict) and all(isinstance(each, int | float) for each in value.values())
        else:
            continue
        if not fits:
            raise TypeError(f"no message of ours: {name}")


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and -NO_LIMIT <= value <= NO_LIMIT


def _is_within(numbers: npt.NDArray[np.float64], end: int) -> bool:
    """Return whether all ``numbers`` are from 0 on and below ``end``; NaN is not."""
    return bool(((numbers >= 0) & (numbers < end)).all())
