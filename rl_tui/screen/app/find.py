"""Search for anything by its name."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

from rich.cells import cell_len
from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.hyperparameters import PARAMETERS, Parameter
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import StoredSession, sessions_in
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.frame.action_screen import ActionScreen, Ask, Put
from rl_tui.screen.glossary.glossary import glossary
from rl_tui.screen.keys.action import Action
from rl_tui.screen.kit.bindings import ListInput, as_sentence
from rl_tui.screen.terminal.linked_app import is_open
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.catalogue import scenarios

_WORD: Final = re.compile(r"^\W+|\W+$")
_PLAIN: Final = str.maketrans({"×": "x", "−": "-", "–": "-"})
_LONGEST: Final = 60  # characters of a search
ACTION: Final = "action"
_SENTENCE: Final = 220  # characters about the row under the cursor
NOTHING: Final = "Nothing begins with these letters. ? shows all keys."


class Findable(NamedTuple):
    """An entry, which ``also`` matches and ``do`` opens."""

    name: str
    kind: str
    sentence: str
    do: Callable[[], object]
    keys: str = ""
    also: str = ""
    refused: bool = False


class FindScreen(Dialog[Findable]):
    """A search line and a row per match. The answer is the chosen entry.

    ``for_query`` makes entries, such as a setting with a new value. ``more`` reads files.
    """

    def __init__(
        self,
        look: Look,
        entries: Sequence[Findable],
        for_query: Callable[[str], list[Findable]],
        more: Callable[[], list[Findable]],
    ) -> None:
        super().__init__()
        self._look = look
        self._written = look.glyphs.spelled
        self._entries = list(entries)
        self._for_query = for_query
        self._more = more
        self._found = list[Findable]()
        self.is_searching = True
        """True while files are read, which a typed enter waits for."""

    def compose(self) -> ComposeResult:
        """Yield line, rows and sentence."""
        with self.box("Find", self._written("↑ ↓: choose   enter: do or open   esc: close"), "tall"):
            yield ListInput(placeholder="a few letters of anything", compact=True, max_length=_LONGEST)
            yield OptionList(id="found")
            yield Static(markup=False, classes="hint")

    def on_mount(self) -> None:
        """List all actions, and read the files."""
        self.query_one(OptionList).can_focus = False
        self.query_one(Input).focus()
        self.run_worker(self._read_more(), name="read what can be found")

    async def _read_more(self) -> None:
        self._entries += await asyncio.to_thread(self._more)
        self.is_searching = False
        if is_open(self) and self.query_one(Input).value:
            self.list_matches(self.query_one(Input).value, keeps_cursor=True)

    def on_resize(self) -> None:
        """Refit the rows."""
        self.call_after_refresh(lambda: self.list_matches(self.query_one(Input).value))

    @on(Input.Changed)
    def find(self, event: Input.Changed) -> None:
        """List the matches."""
        self.list_matches(event.value)

    @on(Input.Submitted)
    @on(OptionList.OptionSelected)
    def choose(self) -> None:
        """Answer the row, unless it is refused."""
        place = self.query_one(OptionList).highlighted
        if place is not None and not self._found[place].refused:
            self.dismiss(self._found[place])

    @on(OptionList.OptionHighlighted)
    def explain(self, event: OptionList.OptionHighlighted) -> None:
        """Show the row's sentence."""
        if event.option_list.highlighted == event.option_index < len(self._found):  # else outdated
            self._tell(self._found[event.option_index].sentence)

    def list_matches(self, query: str, *, keeps_cursor: bool = False) -> None:
        """List the matches. The cursor stays if it ``keeps_cursor``."""
        found = self.query_one(OptionList)
        before = None if found.highlighted is None else self._found[found.highlighted].name
        self._found = found_by(query, [*self._for_query(query), *self._entries])
        found.clear_options()
        found.add_options(Option(self._row(entry, found.size.width - 2)) for entry in self._found)
        names = [entry.name for entry in self._found]
        if self._found:
            found.highlighted = names.index(before) if keeps_cursor and before in names else 0
        else:
            self._tell(NOTHING)

    def _row(self, entry: Findable, width: int) -> Text:
        palette, glyphs = self._look.palette, self._look.glyphs
        keys, kind = self._written(entry.keys), "" if entry.kind == ACTION else entry.kind
        room = max(1, width - cell_len(keys) - cell_len(kind) - (3 if kind else 1))
        name = shortened(self._written(entry.name), room, glyphs.ellipsis)
        row = Text(name.ljust(room), palette.dim if entry.refused else "")
        return row.append(f" {keys}  "[: None if kind else -2], palette.press).append(kind, palette.dim)

    def _tell(self, sentence: str) -> None:
        self.query_one(Static).update(self._written(shortened(sentence, _SENTENCE, "…")))


# Ranking


def found_by(query: str, entries: Sequence[Findable]) -> list[Findable]:
    """Return the matches, best first, or all actions."""
    if not query.strip():
        return [entry for entry in entries if entry.kind == ACTION]
    ranked = [(relevance(query, entry), entry) for entry in entries]
    found = [pair for pair in ranked if pair[0] > 0.0]
    return [entry for _, entry in sorted(found, key=lambda pair: -pair[0])]


def relevance(query: str, entry: Findable) -> float:
    """Return how well ``query`` fits, from 0 (not at all) to 1.

    It is the key of the entry, or each word begins a word of the entry or is part of its name.
    """
    if entry.keys and query.strip() == entry.keys:
        return 1.0
    return min((_weight(word, entry) for word in _words(query)), default=0.0)


def _weight(word: str, entry: Findable) -> float:
    name = _words(entry.name)
    if word in name:
        return 1.0
    if any(each.startswith(word) for each in name):
        return 0.9 if name[0].startswith(word) else 0.8
    if any(each.startswith(word) for each in _words(entry.also)):
        return 0.7
    if len(word) > 1 and word in " ".join(name):
        return 0.5
    return 0.3 if any(each.startswith(word) for each in _words(entry.sentence)) else 0.0


def _words(text: str) -> list[str]:
    return [_WORD.sub("", each) or each for each in text.lower().translate(_PLAIN).split()]


# Entries


def entries_on(screen: ActionScreen) -> list[Findable]:
    """Return the actions, settings and words."""
    actions = [_of_action(screen, action) for action in screen.actions if action.id != "find"]
    settings = [
        Findable(parameter.name, "setting", as_sentence(parameter.help), ask, also=parameter.symbol)
        for parameter, (ask, _) in _settings(screen)
    ]
    explain = screen.pages.show_words
    words = [
        Findable(term.word, "word", term.text, partial(explain, (id_,)), also=" ".join(term.also))
        for id_, term in glossary().items()
    ]
    return [*actions, *settings, *words]


def new_values(screen: ActionScreen, query: str) -> list[Findable]:
    """Return a new setting for a query such as ``epsilon .3``."""
    word, _, number = query.replace("=", " ").strip().rpartition(" ")
    try:
        value = float(number)
    except ValueError:
        return []
    asked = word.strip().lower()
    return [
        Findable(
            f"Set {parameter.symbol} to {value:g}",
            "setting",
            as_sentence(parameter.help),
            partial(put, value),
            also=query,
        )
        for parameter, (_, put) in _settings(screen)
        if asked
        and (asked == parameter.symbol or parameter.name.startswith(asked))
        and parameter.accepts(value)
    ]


def _of_action(screen: ActionScreen, action: Action) -> Findable:
    name = action.label[0].upper() + action.label[1:]
    do = partial(screen.run_action, action.textual_action)
    return Findable(name, ACTION, action.sentence, do, action.shown, action.aliases, bool(action.refused))


def _settings(screen: ActionScreen) -> Iterator[tuple[Parameter, tuple[Ask, Put]]]:
    return ((PARAMETERS[name], does) for name, does in screen.settings.items())


def entries_in_files(open_found: Callable[[Any], object], sessions: Path | None) -> list[Findable]:
    """Return the worlds, lessons and sessions. Call it in a thread."""
    from rl_tui.lessons.catalogue import read_lessons

    worlds = [
        Findable(each.title, "world", each.summary, partial(open_found, each), also=each.id)
        for each in scenarios()
    ]
    lessons = [
        Findable(each.title, "lesson", each.summary, partial(open_found, each), also=each.id)
        for each in read_lessons().lessons
    ]
    kept = () if sessions is None else sessions_in(sessions)[0]
    return [*worlds, *lessons, *(_of_session(each, partial(open_found, each)) for each in kept)]


def _of_session(session: StoredSession, do: Callable[[], object]) -> Findable:
    from rl_tui.screen.catalogue.session_text import algorithm_name, long_age, settings_of, short_age

    age, table = datetime.now(UTC) - session.saved, session.document.table
    name = f"{session.title} · {short_age(age, session.saved)} · step {session.step:,}"
    played = [] if table is None else [counted(table.episodes, "episode")]
    made_of = ", ".join((algorithm_name(session.algorithm), *settings_of(session), *played))
    return Findable(name, "session", f"{made_of}. Saved {long_age(age)}.", do)
