"""What the agent is told besides the sliders: algorithm, ties, initial Q, seed, speed, each with its key."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rich.segment import Segment
from textual import events
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.agents.catalogue import BY_ID
from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.tui.theme.look import Look
from rl_tui.tui.written import written

_KEY_COLUMNS = 4
_LABEL_COLUMNS = 10
_GAPS = (3, 2)


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting: the key that changes it, its name short and in full, its value, the action behind it."""

    key: str
    short: str
    full: str
    value: str
    action: str


def settings_of(snapshot: Snapshot) -> tuple[Setting, ...]:
    """Return what is in force, for the algorithm in force."""
    return tuple(_settings(snapshot))


def _settings(snapshot: Snapshot) -> Iterator[Setting]:
    algorithm, values = BY_ID[snapshot.algorithm], snapshot.hyperparameters
    yield Setting("a", "", "algorithm", algorithm.name, "algorithm")
    if "ties" in algorithm.parameters:
        yield Setting("t", "ties", "ties", values.ties, "ties")
    if "initial_q" in algorithm.parameters:
        yield Setting("i", "Q₀", "initial Q", f"{values.initial_q:g}", "initial_q")
    yield Setting("n", "seed", "seed", str(snapshot.recipe.seed), "seed")
    if snapshot.phase is Phase.SPENT:
        yield Setting("r", "", "", "start again", "reset")
    else:
        yield Setting("+ −", "speed", "speed", speed_text(snapshot.speed), "faster")
    if "epsilon_decay" in algorithm.parameters and values.epsilon_decay > 0.0:
        yield Setting("", "ε now", "ε now", f"{values.epsilon_at(snapshot.episodes):.3f}", "")


def speed_text(speed: float | None) -> str:
    """Return a wanted speed as people read it: ``10/s``, ``max``."""
    return "max" if speed is None else f"{speed:,.0f}/s"


class Settings(Widget):
    """Draws the settings on one line, or in two columns where it is taller; a click changes one."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self._settings: tuple[Setting, ...] = ()

    def show(self, snapshot: Snapshot) -> None:
        """Draw the settings in force."""
        settings = settings_of(snapshot)
        if settings != self._settings:
            self._settings = settings
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Draw one line."""
        palette, glyphs = self.look.palette, self.look.glyphs
        segments: list[Segment] = []
        column = 0
        for start, _, setting in self._cells(y):
            key, label, value = self._texts(setting)
            segments += [
                Segment(" " * (start - column), palette.text),
                Segment(written(key, glyphs), palette.accent),
                Segment(written(label, glyphs), palette.dim),
                Segment(written(value, glyphs), palette.text),
            ]
            column = start + len(written(key + label + value, glyphs))
        strip = Strip(segments or [Segment(" ", palette.text)])
        return strip.adjust_cell_length(self.size.width, palette.text).apply_style(self.rich_style)

    async def on_click(self, event: events.Click) -> None:
        """Change the setting under the pointer."""
        for start, end, setting in self._cells(event.y):
            if start <= event.x < end and setting.action:
                await self.screen.run_action(setting.action)
                return

    def _texts(self, setting: Setting) -> tuple[str, str, str]:
        if self._is_tall:
            return f"{setting.key:<{_KEY_COLUMNS}}", f"{setting.full:<{_LABEL_COLUMNS}} ", setting.value
        return setting.key, f" {setting.short} " if setting.short else " ", setting.value

    @property
    def _lines(self) -> int:
        """How many lines two columns take."""
        return -(-len(self._settings) // 2)

    @property
    def _is_tall(self) -> bool:
        return 1 < self.size.height >= self._lines

    def _cells(self, y: int) -> list[tuple[int, int, Setting]]:
        """Return the settings of line ``y`` with their first column and the one after their last."""
        return self._columns(y) if self._is_tall else self._running_on(y)

    def _columns(self, y: int) -> list[tuple[int, int, Setting]]:
        half = self.size.width // 2
        numbers = range(y, len(self._settings), self._lines) if y < self._lines else ()
        return [
            (1 + column * half, (column + 1) * half, self._settings[number])
            for column, number in enumerate(numbers)
        ]

    def _running_on(self, y: int) -> list[tuple[int, int, Setting]]:
        """Return line ``y`` where the settings follow one another; those that do not fit are left out."""
        lines: list[list[tuple[int, int, Setting]]] = []
        for gap in _GAPS:
            lines = self._lines_with(gap)
            if len(lines) <= self.size.height:
                break
        return lines[y] if y < len(lines) else []

    def _lines_with(self, gap: int) -> list[list[tuple[int, int, Setting]]]:
        lines: list[list[tuple[int, int, Setting]]] = [[]]
        column = 1
        for setting in self._settings:
            columns = len(written("".join(self._texts(setting)), self.look.glyphs))
            if lines[-1] and column + columns > self.size.width:
                lines.append([])
                column = 1
            if column + columns <= self.size.width:
                lines[-1].append((column, column + columns, setting))
            column += columns + gap
        return lines
