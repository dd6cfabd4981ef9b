"""The start screen's doors and their pages."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from rich.segment import Segment
from textual.binding import BindingType
from textual.events import Click
from textual.geometry import Size
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.common.findings import is_plain
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import StoredSession
from rl_tui.screen.catalogue.facts import minutes_of_page
from rl_tui.screen.catalogue.session_text import algorithm_name, short_age
from rl_tui.screen.draw.canvas import shortened, wrapped
from rl_tui.screen.frame.shape import MEDIUM_HEIGHT, ROOMY_HEIGHT
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.editing.templates import BLANK
from rl_tui.worlds.files.catalogue import user_folder

if TYPE_CHECKING:
    from rl_tui.live.sessions.progress import LessonEntries
    from rl_tui.screen.dialogs.form import Choice

# The doors


LEARN: Final = 1
WATCH: Final = 2
GO_ON: Final = 3
OWN_CODE: Final = 4
_TALL, _MEDIUM, _LOW = 4, 2, 1  # rows


@dataclass(frozen=True, slots=True)
class Door:
    """A door's texts, as far as they fit."""

    title: str
    text: str
    state: str
    short: str = ""  # the state without the text above it, if different
    brief: str = ""  # the title for a single row, if different


class Doors(Widget, can_focus=True):
    """Doors side by side. ``current`` counts from 1."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("left", "move(-1)", "doors.left", "Go to the previous card."),
        binding("right", "move(1)", "doors.right", "Go to the next card."),
        binding("home", "move(-9)", "doors.first", "Go to the first card."),
        binding("end", "move(9)", "doors.last", "Go to the last card."),
        binding("down,j", "leave", "doors.leave", "Go to the list."),
    ]

    current: reactive[int] = reactive(WATCH)

    def __init__(self, look: Look, doors: Sequence[Door]) -> None:
        super().__init__(id="doors")
        self._look = look
        self._doors = list(doors)

    def show(self, number: int, door: Door) -> None:
        """Change a door's texts."""
        self._doors[number - 1] = door
        self.refresh()

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the rows for the screen's height."""
        if viewport.height >= ROOMY_HEIGHT:
            return _TALL
        return _MEDIUM if viewport.height >= MEDIUM_HEIGHT else _LOW

    def render_line(self, y: int) -> Strip:
        """Draw one row of all doors."""
        palette, glyphs, width = self._look.palette, self._look.glyphs, self.size.width
        segments = []
        for number in range(1, len(self._doors) + 1):
            is_here = self.has_focus and number == self.current
            room = self._edge(number) - self._edge(number - 1)
            text = shortened(self._rows(number, room - 3)[y], room - 3, glyphs.ellipsis)
            style = palette.text if y else palette.strong
            edge = (glyphs.mark_left, palette.press) if is_here else (glyphs.axis_vertical, palette.rule)
            title = palette.strong + palette.press if is_here and not y else style
            segments += [Segment(edge[0], edge[1]), Segment(f" {text}".ljust(room - 1), title)]
        return Strip(segments).adjust_cell_length(width, palette.text).apply_style(self.rich_style)

    def action_move(self, by: int) -> None:
        """Move the cursor by ``by`` doors."""
        self.current = min(max(1, self.current + by), len(self._doors))

    def action_leave(self) -> None:
        """Go to the list below."""
        self.screen.focus_next()

    def on_click(self, event: Click) -> None:
        """Open the door under the mouse."""
        at = next((each for each in range(1, len(self._doors) + 1) if event.x < self._edge(each)), None)
        if at is not None:
            self.current = at
            self.call_later(self.run_action, f"screen.door({at})")

    def _edge(self, number: int) -> int:
        if self.size.height > _LOW:
            return self.size.width * number // len(self._doors)
        titles = [len(self._title(each)) + 3 for each in range(1, number + 1)]
        return min(sum(titles), self.size.width)

    def _title(self, number: int) -> str:
        door = self._doors[number - 1]
        return f"{number} {door.brief or door.title if self.size.height == _LOW else door.title}"

    def _rows(self, number: int, room: int) -> list[str]:
        door, height, glyphs = self._doors[number - 1], self.size.height, self._look.glyphs
        title = self._title(number)
        rows = [title, door.short or door.state]
        if height == _TALL:
            lines = wrapped(door.text, max(1, room), self._look.palette.text, self._look)
            rows = [title, *[*(line[0].text for line in lines), ""][:2], door.state]
        return [glyphs.separated(row) for row in rows]


def learn_door(found: LessonEntries | None) -> Door:
    """Return the lessons' door, with progress."""
    text = "Interactive lessons. Five are the core."
    if found is None or not found.entries:
        return Door("Learn", text, "")
    here = next((each for each in found.entries if each.lesson.id == found.goes_on_at), None)
    core = [each for each in found.entries if each.lesson.is_core]
    count = len(found.entries)
    finished, brief = f"{found.finished} of {count} done", f"Learn {found.finished}/{count}"
    if here is None:
        return Door("Learn", text, finished, brief=brief)
    minutes = f"{minutes_of_page(here.lesson)} min a page"
    state = f"core {sum(each.is_finished for each in core)}/{len(core)} · {minutes}"
    return Door("Learn", text, state, finished if found.finished else minutes, brief)


def watch_door() -> Door:
    """Return the demonstration's door."""
    return Door(
        "Watch it learn",
        "See an agent slowly learn to cross a lake.",
        "space pauses",
        brief="Watch",
    )


def go_on_door(sessions: Sequence[StoredSession] | None, now: datetime, *, in_kiosk: bool) -> Door:
    """Return the sessions' door. Without ``sessions``, they are still being read."""
    if not sessions:
        if in_kiosk:
            return Door("Continue", "This is a kiosk.", "nothing is saved")
        found = "" if sessions is None else "nothing yet"
        return Door("Continue", "Your runs are saved automatically.", found)
    newest = sessions[0]
    age = short_age(now - newest.saved, newest.saved)
    age = age if age == "now" or age[0:4].isdigit() else f"{age} ago"
    more = f"tab: {len(sessions) - 1} older" if len(sessions) > 1 else f"step {newest.step:,}"
    text = f"{newest.title} · {algorithm_name(newest.algorithm)}"
    return Door("Continue", text, f"{age} · {more}", f"{age}: {newest.title}")


def own_code_door(scripts: Sequence[Path]) -> Door:
    """Return the door of own scripts."""
    found = f"{counted(len(scripts), 'script')} here" if scripts else "enter: see how"
    text = "rl-tui watch my_script.py shows your program here."
    return Door("Your own code", text, found, brief="Your code")


# Your own code


_MOST_FILES: Final = 200
_MOST_SCRIPTS: Final = 12
_MOST_LINES: Final = 60
_LONGEST_LINE: Final = 300
_IMPORTS: Final = re.compile(r"\s*(?:import|from)\s+gymnasium\b")


def scripts_here(folder: Path | None = None) -> list[Path]:
    """Return the scripts in ``folder`` (default: the current one) that import Gymnasium."""
    try:
        files = sorted(islice((folder or Path(os.curdir)).glob("*.py"), _MOST_FILES))
    except OSError:
        return []
    return [path for path in files if is_plain(path.name) and _imports_gymnasium(path)][:_MOST_SCRIPTS]


def _imports_gymnasium(path: Path) -> bool:
    if not path.is_file():  # reading a pipe would wait for its writer
        return False
    try:
        with path.open(encoding="utf-8", errors="replace") as stream:
            lines = (stream.readline(_LONGEST_LINE) for _ in range(_MOST_LINES))
            return any(_IMPORTS.match(line) for line in lines)
    except OSError:
        return False


_COMMAND: Final = "rl-tui watch"


def own_code_page(scripts: Sequence[Path], glyphs: Glyphs) -> Choice:
    """Return the commands for own programs."""
    from rl_tui.screen.dialogs.form import Candidate, Choice

    mine = [(f"{_COMMAND} {path}", "This script is here and imports gymnasium.") for path in scripts]
    commands = [
        *(mine or [(f"{_COMMAND} my_script.py", "Watch your script step by step, unchanged.")]),
        ("rl-tui agent new my_agent.py", "Begin an agent without a loop."),
        ("rl-tui play frozenlake --agent my_agent.py", "Watch that agent learn."),
    ]
    candidates = [Candidate(command, command, (what,)) for command, what in commands]
    question = "Type a command in a shell. Your code runs with all your rights: there is no sandbox."
    return Choice("Your own code", candidates, "", glyphs, question, does="close, but show it")


# A new world


_KINDS: Final = {
    "grid": ("Map", "Cells, walls, rewards: draw it with brushes."),
    "mdp": ("Graph", "States and actions: say where each action leads."),
    "bandit": ("Bandit", "One state, several arms."),
}


def new_world_choice(glyphs: Glyphs) -> Choice:
    """Ask for a new world's kind."""
    from rl_tui.screen.dialogs.form import Candidate, Choice

    candidates = [Candidate(kind, _KINDS[kind][0], (_KINDS[kind][1],)) for kind in BLANK]
    return Choice("New world", candidates, "", glyphs, f"w s saves it in {user_folder()}")
