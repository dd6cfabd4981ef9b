"""What goes through the pipes between a program that is watched and the one that watches it.

The watched side writes frames: a letter, the length of what follows as eight bytes (little end first), and
that. Steps and changes are numbers only, so that nothing that a program writes can do anything here.

=====  ================================================================================================
S      doubles: first ``n`` steps of ``STEP_WIDTH`` numbers, then changes of ``CHANGE_WIDTH`` numbers;
       before them, as one double, ``n``
T      doubles, [S·A]: the table as it was found, NaN where it has no such entry; follows its message
J      a JSON object with a ``kind``: what is rare
O      the same, by the watching side itself: what the program wrote, and how it ended
=====  ================================================================================================

A step is (environment, state, action, reward, next state, flags, episode, step in its episode), a change
(step, cell, before, after). Episodes count from 0 over all environments, steps of an episode from 0.
States are numbers: of a tuple of observations its place in row-major order. A cell is state · A + action.
``step`` counts from 0 over the whole program; a change belongs to the step before the next call of ``step``
or ``reset``. ``before`` is NaN where the table had no such entry.

The watching side writes lines of JSON, which are heard at each wait, and while the program runs some thirty
times a second. Each has a ``number``, counted from 1; a program that goes on waiting says again that it
waits after each of them, and how many it has heard. ``{"trace": n}`` asks for the lines of the next n
changes.
``{"stop": …}`` says at what to stop, null at nothing. Its value holds one or more of

    states: [s, …]      the step led into one of these states
    cells: [c, …]       the pair of the step is one of these cells
    reward: true        the step brought a reward other than 0
    episode_ends: n     the n-th end of an episode from now on
    episode: k          episode k comes next
    value: [c, x]       the number in cell c moved across, or to, x
    policy: true        the greedy actions of a state changed

What is met is looked at before the next ``step`` or ``reset``, an episode is over with ``reset``. So the step
that met it is the last one that came, with its changes. The program then waits with that name as
``stopped``, however far it may go, until it hears the next ``{"stop": …}``.

How far the program may go stands in memory that both share: one int64, the number of steps. It is looked at
in ``step`` and in ``reset``.
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
"""How far a program may go that nobody holds up."""
LARGEST_FRAME: Final = 64_000_000
"""Bytes of one frame; a longer one comes from no watched side of ours."""


class StepFlag(IntFlag):
    """What else is told of a step."""

    TERMINATED = 1
    TRUNCATED = 2


class MessageKind:
    """The kinds of JSON messages, with what else they hold."""

    STARTED: Final = "started"
    """The user's code runs from now on: what fails before is no fault of it."""
    STANDS: Final = "stands"
    """file, line: where the program has stood for a second or longer without a step."""
    ENVIRONMENT: Final = "environment"
    """number, id, kwargs (null where they are no plain data), states (the sizes of the observation's parts),
    first_state (what each part counts from), actions, first_action, time_limit, wrappers (class names)"""
    TRANSITIONS: Final = "transitions"
    """number, P: the table of an environment that only the program knows: [[[[p, s', r, ended], …] …] …],
    start: the probability to begin in each state, or null"""
    TABLE: Final = "table"
    """step, name, form, shape, dtype, actions (A), others (names), shared (bool); file, line: where it was
    made, if known. A frame with its content follows."""
    REBOUND: Final = "rebound"
    """step: another object is the table now; what differs in it comes as changes."""
    SHARED: Final = "shared"
    """step: rows of the table are one and the same object."""
    NUMBERS: Final = "numbers"
    """numbers: name → value, floats that the program's code holds."""
    CALLED: Final = "called"
    """method ("step" or "reset"), file, line: where the user's code called it first."""
    LINES: Final = "lines"
    """lines: [[file, line, count], …], the lines that changed the table."""
    AGENT: Final = "agent"
    """name, style, file, line (of the method that learns), done_is_either: an agent without a loop learns."""
    OUTPUT: Final = "output"
    """stream ("out" or "err"), text, replaces (the line before it on that stream); step, if it is known.
    It comes from the watching side, which reads both streams: also those of C code and of child processes."""
    NOTE: Final = "note"
    """text: what had to be done otherwise for the program to run."""
    WAITING: Final = "waiting"
    """step, stopped (the name of what it met, or null), heard (the number of the last line that it has heard,
    0 of none): it goes no further until it may. Of an older one than the last line nothing can be concluded:
    it may have gone on meanwhile."""
    REFUSED: Final = "refused"
    """text: why it cannot be watched."""
    ERROR: Final = "error"
    """type, text, file, line, traceback (text)."""
    END: Final = "end"
    """step: the program is over."""
    GONE: Final = "gone"
    """status (as subprocess counts it; null where the process was ended), text (why it was ended).
    It comes from the watching side, and is the last message."""
