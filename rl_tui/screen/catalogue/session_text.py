"""Recent sessions as the start screen lists them, newest first, with their details."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from datetime import datetime, timedelta
from typing import Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import SessionError, StoredSession
from rl_tui.runs.timeline.run_names import feature_text, features_of
from rl_tui.screen.catalogue.facts import FullWidth, labelled
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.theme.look import Look

# What differs between similar sessions


_SCENARIO = "scenario"
_LANES = "lanes"
_Features = Mapping[str, float | str]


def differences(sessions: Sequence[StoredSession]) -> list[list[str]]:
    """Return, for each of ``sessions``, in a few words each what it has otherwise than most of its title.

    Scenario, algorithm, settings in force, seed and lanes count, in this order; the step is not among them.
    Of two that are equally common the one of the session that stands last is the usual one.
    """
    by_title = defaultdict[str, list[_Features]](list)
    every = [_features(session) for session in sessions]
    for session, features in zip(sessions, every, strict=True):
        by_title[session.title].insert(0, features)
    usual = {title: _usual(alike) for title, alike in by_title.items()}
    return [
        [_text(name, value) for name, value in features.items() if usual[session.title][name] != value]
        for session, features in zip(sessions, every, strict=True)
    ]


def settings_of(session: StoredSession) -> list[str]:
    """Return in a few words each the numbers in force in ``session`` that a slider sets."""
    return [
        feature_text(name, value)
        for name, value in _features(session).items()
        if name in PARAMETERS and PARAMETERS[name].slide is not None
    ]


def _usual(sessions: Sequence[_Features]) -> _Features:
    names = dict.fromkeys(name for features in sessions for name in features)
    values = {name: [features[name] for features in sessions if name in features] for name in names}
    return {name: max(there, key=there.count) for name, there in values.items()}


def _features(session: StoredSession) -> _Features:
    """Return what there is to tell of ``session``; what this version does not know is left out."""
    document = session.document
    lane = document.lanes[document.shown]
    features: dict[str, float | str] = {_SCENARIO: document.scenario.id}
    values = Hyperparameters()
    for name, value in lane.settings_in_force.items():
        with suppress(ValueError):
            values = values.changed(name, value)
    if lane.algorithm_in_force in BY_ID and values.policy in POLICY_BY_ID:
        features.update(features_of(lane.algorithm_in_force, values, lane.seed))
    return {**features, _LANES: len(document.lanes)}


def _text(name: str, value: float | str) -> str:
    if name == _SCENARIO:
        return str(value)
    return counted(int(value), "lane") if name == _LANES else feature_text(name, value)


# Row and details of a session


_MINUTE: Final = 60
_HOUR: Final = 60 * _MINUTE
_DAY: Final = 24 * _HOUR
_MOST_DAYS: Final = 14
_LONGEST_PATH: Final = 1_000


class SessionRow(FullWidth):
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
        "saved": f"{long_age(now - session.saved)} · {session.saved.astimezone():%Y-%m-%d %H:%M}",
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


# The list of sessions


_LONGEST_NAME: Final = 255
_WITHOUT_FOCUS: Final = "shift+tab: here"
_WITH_FOCUS: Final = "enter: go on   del: delete"

Entry = StoredSession | SessionError


class SessionList(OptionList):
    """A list of sessions, of which ``current`` is under the cursor.

    Until the files are read it keeps room for ``files`` of them, so that nothing jumps.
    """

    def __init__(self, look: Look, files: int) -> None:
        super().__init__(
            *(Option(Text("\n"), disabled=True) for _ in range(files)), id="sessions", classes="panel"
        )
        self.look = look
        self.border_title = "Recent sessions"
        self.border_subtitle = _WITHOUT_FOCUS
        self.display = files > 0
        self._entries: Sequence[Entry] = ()

    def show(self, entries: Sequence[Entry], now: datetime) -> None:
        """List ``entries``; where there is none, not even the frame is there."""
        self._entries = entries
        place = self.highlighted or 0
        self.clear_options()
        self.add_options(self._rows(now))
        self.display = bool(entries)
        if self.has_focus and entries:
            self.highlighted = min(place, len(entries) - 1)

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, None where there is no cursor."""
        if self.highlighted is None or self.highlighted >= len(self._entries):
            return None
        return self._entries[self.highlighted]

    def on_blur(self) -> None:
        """Show in the border how to come here."""
        self.border_subtitle = _WITHOUT_FOCUS

    def on_focus(self) -> None:
        """Begin at the newest; tell what can be done."""
        self.border_subtitle = _WITH_FOCUS
        if self.highlighted is None and self._entries:
            self.highlighted = 0

    def _rows(self, now: datetime) -> Iterable[Option]:
        different = iter(differences([entry for entry in self._entries if isinstance(entry, StoredSession)]))
        alike = Counter[tuple[str, str, int]]()
        for entry in self._entries:
            if isinstance(entry, StoredSession):
                key = entry.title, short_age(now - entry.saved, entry.saved), entry.step
                alike[key] += 1
                yield Option(SessionRow(entry, now, self.look, next(different), alike[key]))
            else:
                name = to_ascii(one_line(entry.path.name, _LONGEST_NAME), self.look.glyphs)
                yield Option(Text(f"{name}\n  faulty", no_wrap=True))
