"""The protocol between a watched program and the watching process.

The program writes frames: a letter, the length of the payload as eight bytes (little-endian), and the
payload. Steps and changes are numbers only, so nothing that a program writes can do harm.

===== ================================================================================================
S     doubles: ``n``, then ``n`` steps of ``STEP_WIDTH`` numbers, then changes of ``CHANGE_WIDTH`` numbers
T     doubles, [S·A]: the table as found, NaN for missing entries, or two of them; follows its message
J     a JSON object with a ``kind``, for rare messages
O     the same from the watching side: the output of the program, and its end
===== ================================================================================================

A step is (environment, state, action, reward, next state, flags, episode, step in its episode), and a
change is (step, cell, before, after). Episodes count from 0 over all environments, steps of an episode
from 0. States are numbers, in row-major order for a tuple of observations. A cell is state · A + action.
`step` counts from 0 over the whole program. A change belongs to the step before the next call of `step` or
`reset`. `before` is NaN for a missing entry. With two tables, the cells of the mean come first, those of the
first table count from S·A, and those of the other from 2·S·A.

The watching side writes lines of JSON, which the program reads at each wait, and about thirty times a
second while it runs. Each has a `number` from 1. A waiting program reports again after each line, with the
number of lines that it has read. `{"trace": n}` requests the lines of the next n changes. `{"stop": …}`
sets the events to stop at, null for none. Its value has one or more of

states: [s, …]     the step led into one of these states
cells: [c, …]      the pair of the step is one of these cells
reward: true       the step had a reward other than 0
episode_ends: n    the n-th end of an episode from now on
episode: k         episode k is next
value: [c, x]      the number in cell c crossed or reached x
policy: true       the greedy actions of a state changed

Events are checked before the next `step` or `reset`, and an episode is over at `reset`. The step that met
an event is thus the last one received, with its changes. The program then waits with the name of the event
as `stopped` until the next `{"stop": …}`, however far it may run.

The number of allowed steps is one int64 in memory that both processes share. It is read in `step` and in
`reset`.
"""

from __future__ import annotations

import struct
from enum import IntFlag
from typing import Final

STEP_WIDTH: Final = 8
CHANGE_WIDTH: Final = 4
HEADER: Final = struct.Struct("<cQ")
STEPS: Final = b"S"
TABLE: Final = b"T"
MESSAGE: Final = b"J"
OWN_MESSAGE: Final = b"O"
NO_LIMIT: Final = 2**62
"""Number of allowed steps for a program without a limit."""
LARGEST_FRAME: Final = 64_000_000
"""Largest frame in bytes. A longer one is not from our code."""


class StepFlag(IntFlag):
    """Flags of a step."""

    TERMINATED = 1
    TRUNCATED = 2


class MessageKind:
    """Kinds of JSON messages with their fields."""

    STARTED: Final = "started"
    """The user's code starts to run. Earlier failures are not its fault."""
    STANDS: Final = "stands"
    """file, line: position of the program after a second or more without a step."""
    ENVIRONMENT: Final = "environment"
    """number, id, kwargs (null if not plain data), states (sizes of the observation's parts), first_state
    (first value of each part), actions, first_action, time_limit, wrappers (class names). A known number
    replaces that environment, which the program uses without its wrappers.
    """
    NAMES: Final = "names"
    """number, state_names, action_names: those of a world without a known number of states. Later states
    have no name.
    """
    OWN_ENDS: Final = "own-ends"
    """A world of the program's own says "done", which may be its own limit of steps."""
    TRANSITIONS: Final = "transitions"
    """number, P: the table of an environment that only the program has: [[[[p, s', r, terminated], …] …]
    …], start: probability of each start state, or null
    """
    TABLE: Final = "table"
    """step, name, form, shape, dtype, actions (A), others (names), other_forms, shared (bool). A frame with
    its content follows.
    """
    REBOUND: Final = "rebound"
    """step: another object is the table now. Its differences are sent as changes."""
    PAIR: Final = "pair"
    """step, name: the table and another one, `name`, change in turn, and their mean is the table now. A frame
    with the content of both follows.
    """
    SHARED: Final = "shared"
    """step: rows of the table are the same object."""
    NUMBERS: Final = "numbers"
    """numbers: name → value, floats in the program's code."""
    CALLED: Final = "called"
    """method ("step" or "reset"), file, line: the first call in the user's code."""
    LINES: Final = "lines"
    """lines: [[file, line, count], …], the lines that changed the table."""
    AGENT: Final = "agent"
    """name, style, file, line (of the method that learns), done_is_either: an agent without a loop learns."""
    OUTPUT: Final = "output"
    """stream ("out" or "err"), text, replaces (the line before it on that stream); step, if known. The
    watching side reads both streams, including C code and child processes.
    """
    NOTE: Final = "note"
    """text: a workaround that was necessary to run the program."""
    WAITING: Final = "waiting"
    """step, stopped (name of the event, or null), heard (number of the last line read, 0 for none): it
    waits for permission. If an older line was read, it may have continued since.
    """
    REFUSED: Final = "refused"
    """text: the reason why it cannot be watched."""
    ERROR: Final = "error"
    """type, text, file, line, traceback (text)."""
    END: Final = "end"
    """step: the program is over."""
    GONE: Final = "gone"
    """status (as in subprocess, null if the process was ended), text (why it was ended). It is the last
    message, and comes from the watching side.
    """
