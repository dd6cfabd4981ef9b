"""What is said of a session: a row of the list, and the details."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta
from typing import Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.text import Text

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.lab.sessions.session import SessionError, StoredSession
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.screens.catalogue.facts import labelled
from rl_tui.tui.screens.catalogue.session_differences import settings_of
from rl_tui.tui.theme.look import Look

_MINUTE: Final = 60
_HOUR: Final = 60 * _MINUTE
_DAY: Final = 24 * _HOUR
_MOST_DAYS: Final = 14
_LONGEST_PATH: Final = 1_000


class SessionRow:
    """Two lines of the list: title and age; then the step, what is ``different``, and the algorithm.

    Most others of its title have what is ``different`` otherwise. ``number`` counts those that share title,
    age and step, from 1.
    """

    def __init__(
        self,
        session: StoredSession,
        now: datetime,
        look: Look,
        different: Sequence[str] = (),
        number: int = 1,
    ) -> None:
        self._look = look
        self._title = session.title
        self._age = short_age(now - session.saved, session.saved)
        self._number = f" ({number})" if number > 1 else ""
        name = algorithm_name(session.algorithm)
        step = f"step {numbers.count(session.step, 12)}"
        of_lesson = [] if session.document.lesson is None else ["lesson"]
        self._line = f"  {' · '.join((*of_lesson, step, *different, *([] if name in different else [name])))}"

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        glyphs, width = self._look.glyphs, options.max_width
        room = max(1, width - cell_len(self._number) - cell_len(self._age) - 1)
        title = f"{shortened(to_ascii(self._title, glyphs), room, glyphs.ellipsis)}{self._number}"
        gap = " " * max(1, width - cell_len(title) - cell_len(self._age))
        yield Text(f"{title}{gap}{self._age}", no_wrap=True)
        yield Text(shortened(separated(self._line, glyphs), width, glyphs.ellipsis), no_wrap=True)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(1, options.max_width)


def session_facts(session: StoredSession, now: datetime, look: Look) -> RenderableType:
    """Return the details of ``session``: its world, what was done in it, and where it stands."""
    palette, glyphs, document = look.palette, look.glyphs, session.document
    lane = document.lanes[document.shown]
    branch = lane.branches[lane.branch]
    scenario = document.scenario
    world = scenario.title if scenario.title == scenario.id else f"{scenario.title} ({scenario.id})"
    stands = f"step {session.step:,}"
    if branch.here < branch.end:
        stands = f"{stands} of {branch.end:,}"
    if len(document.lanes) > 1:
        stands = f"{stands} · lane {document.shown + 1} of {len(document.lanes)}"
    if len(lane.branches) > 1:
        stands = f"{stands} · branch {branch.name.removeprefix('branch ')} of {len(lane.branches)}"
    lines = {
        "scenario": world,
        "algorithm": f"{algorithm_name(session.algorithm)} · seed {lane.seed}",
        "settings": " · ".join(settings_of(session)) or "none",
        "stands at": stands,
        "changes": f"{session.changes:,}" if session.changes else "none so far",
        "saved": f"{long_age(now - session.saved)} · {_local(session.saved)}",
        "file": one_line(str(session.path), _LONGEST_PATH),
    }
    rows = {label: Text(separated(line, glyphs), overflow="fold") for label, line in lines.items()}
    return Group(labelled(rows, look), Text(""), Text(_how_long(session), palette.dim))


def _how_long(session: StoredSession) -> str:
    if session.document.kept:
        return "Saved under a name: it stays until you delete it."
    if session.document.lesson is not None:
        return "A lesson, kept by itself: it stays until you delete it."
    return "Kept by itself. Only the newest 50 of these stay; w in the playground gives it a name."


def session_fault(error: SessionError, look: Look) -> Text:
    """Return what is wrong with a file that gives no session."""
    text = Text("This file cannot be resumed. It is left as it is.\n", look.palette.text)
    text.append(to_ascii(f"\n{error}\n", look.glyphs), look.palette.bad)
    return text


def algorithm_name(algorithm: str) -> str:
    """Return how people call the algorithm of that id."""
    return BY_ID[algorithm].name if algorithm in BY_ID else algorithm


def short_age(age: timedelta, moment: datetime) -> str:
    """Return how long ago it was, in a few letters; after two weeks the date."""
    seconds = int(age.total_seconds())
    if seconds >= _MOST_DAYS * _DAY:
        return moment.astimezone().strftime("%Y-%m-%d")
    units = ((_DAY, "d"), (_HOUR, "h"), (_MINUTE, "min"))
    return next((f"{seconds // length} {unit}" for length, unit in units if seconds >= length), "now")


def long_age(age: timedelta) -> str:
    """Return how long ago it was, in words."""
    seconds = int(age.total_seconds())
    for length, word in ((_DAY, "day"), (_HOUR, "hour"), (_MINUTE, "minute")):
        if seconds >= length:
            return f"{counted(seconds // length, word)} ago"
    return "less than a minute ago"


def _local(moment: datetime) -> str:
    return moment.astimezone().strftime("%Y-%m-%d %H:%M")
