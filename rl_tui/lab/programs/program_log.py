"""All that a watched program has told so far."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from rl_tui.lab.programs.messages import CHANGE_WIDTH, MESSAGE, STEP_WIDTH, STEPS, TABLE, Kind
from rl_tui.lab.programs.recording import Recording

MOST_OUTPUT: Final = 2_000
"""Lines of output that are kept."""


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
    environments: list[ProgramEnvironment] = field(default_factory=list)
    table: FoundTable | None = None
    shared_at: int | None = None
    """The step at which rows of the table were seen to be one and the same object."""
    numbers: dict[str, float] = field(default_factory=dict)
    """Numbers that the program's code holds, by name."""
    lines: dict[tuple[str, int], int] = field(default_factory=dict)
    """How often each line (file, number) changed the table while that was looked at."""
    output: deque[OutputLine] = field(default_factory=lambda: deque(maxlen=MOST_OUTPUT))
    notes: list[str] = field(default_factory=list)
    refused: str = ""
    """Why it cannot be watched; empty if it can."""
    error: ProgramError | None = None
    waiting_at: int | None = None
    """The step at which it waits; None: it goes on."""
    stopped_by: str | None = None
    """What it met there, None where it may simply go no further."""
    ended: bool = False

    def take(self, letter: bytes, payload: bytes) -> None:
        """Take in one frame. Raises ValueError, KeyError or TypeError where it is none of ours."""
        if letter == STEPS:
            numbers = np.frombuffer(payload, np.float64)
            until = 1 + int(numbers[0]) * STEP_WIDTH
            self.recording.add(
                numbers[1:until].reshape(-1, STEP_WIDTH), numbers[until:].reshape(-1, CHANGE_WIDTH)
            )
            self.waiting_at = None
        elif letter == TABLE:
            shape = self.environments[-1] if not self.environments else self.environments[0]
            self.recording.find_table(
                self._found_at, shape.actions, np.frombuffer(payload, np.float64).copy()
            )
        elif letter == MESSAGE:
            self._take_message(json.loads(payload))
        else:
            raise ValueError(f"no frame of ours: {letter!r}")

    _found_at: int = 0

    def _take_message(self, said: Mapping[str, Any]) -> None:
        match said["kind"]:
            case Kind.ENVIRONMENT:
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
            case Kind.TABLE:
                self.table = FoundTable(
                    said["name"],
                    said["form"],
                    tuple(said["shape"]),
                    said["dtype"],
                    tuple(said["others"]),
                    said.get("file", ""),
                    said.get("line"),
                )
                self._found_at = said["step"]
                if said["shared"]:
                    self.shared_at = said["step"]
            case Kind.REBOUND:
                self.recording.rebound.append(said["step"])
            case Kind.SHARED:
                self.shared_at = said["step"] if self.shared_at is None else self.shared_at
            case Kind.NUMBERS:
                self.numbers.update(said["numbers"])
            case Kind.LINES:
                for file, line, count in said["lines"]:
                    self.lines[file, line] = self.lines.get((file, line), 0) + count
            case Kind.OUTPUT:
                self.output.append(OutputLine(said["step"], said["stream"], said["text"]))
            case Kind.NOTE:
                self.notes.append(said["text"])
            case Kind.WAITING:
                self.waiting_at, self.stopped_by = said["step"], said["stopped"]
            case Kind.REFUSED:
                self.refused = said["text"]
            case Kind.ERROR:
                self.error = ProgramError(
                    said["type"], said["text"], said["file"], said["line"], said["traceback"]
                )
            case Kind.END:
                self.ended = True
