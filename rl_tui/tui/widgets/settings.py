"""What the agent is told besides the sliders: algorithm, action rule, seed, speed …, each with its key."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment
from textual import events
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.agents.catalogue import BY_ID, RULE_BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, Parameter
from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.tui.theme.look import Look
from rl_tui.tui.written import written

_KEY_COLUMNS = 4
_LABEL_COLUMNS = 10
_GAPS = (3, 2)
_KEYED: Final = frozenset({"policy", "ties", "initial_q"})  # have a key and an entry of their own


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting: the key that changes it, its name short and in full, its value, the action behind it.

    Where there is no room for all, those of the highest ``rank`` are left out first.
    """

    key: str
    short: str
    full: str
    value: str
    action: str
    rank: int


def settings_of(snapshot: Snapshot) -> tuple[Setting, ...]:
    """Return what is in force, for algorithm and action rule in force."""
    return tuple(_settings(snapshot))


def _settings(snapshot: Snapshot) -> Iterator[Setting]:
    values = snapshot.hyperparameters
    parameters = parameters_of(snapshot.algorithm, values.policy)
    yield Setting("a", "", "algorithm", BY_ID[snapshot.algorithm].name, "algorithm", 0)
    if "policy" in parameters:
        yield Setting("p", "", "policy", RULE_BY_ID[values.policy].name, "policy", 1)
    if "ties" in parameters:
        yield Setting("t", "ties", "ties", values.ties, "ties", 4)
    if "initial_q" in parameters:
        yield Setting("i", "Q₀", "initial Q", f"{values.initial_q:g}", "initial_q", 5)
    yield Setting("n", "seed", "seed", str(snapshot.recipe.seed), "seed", 6)
    if snapshot.phase in (Phase.SPENT, Phase.DONE):
        yield Setting("r", "", "", "start again", "reset", 2)
    else:
        yield Setting("+ −", "", "speed", speed_text(snapshot.speed), "faster", 2)
    yield Setting("o", "options", "options", "", "options", 3)
    for name in parameters:
        parameter = PARAMETERS[name]
        if is_an_option(parameter):
            value = option_text(values.value(name))
            yield Setting("", parameter.symbol, parameter.symbol, value, "options", 7)
    yield from _decaying(values, parameters, snapshot.episodes)


def _decaying(values: Hyperparameters, parameters: tuple[str, ...], episode: int) -> Iterator[Setting]:
    """Yield what schedules have made of α and ε by now, where they change them."""
    alpha = values.alpha_at(episode)
    moves_alpha = values.step_size_schedule != "constant" and values.alpha_decay > 0.0
    if "alpha" in parameters and alpha is not None and moves_alpha:
        yield Setting("", "α now", "α now", f"{alpha:.3f}", "", 8)
    moves_epsilon = values.epsilon_schedule != "constant" and values.epsilon_decay > 0.0
    if "epsilon" in parameters and moves_epsilon:
        yield Setting("", "ε now", "ε now", f"{values.epsilon_at(episode):.3f}", "", 8)


def is_an_option(parameter: Parameter) -> bool:
    """Tell whether ``parameter`` has neither slider nor key and is not merely part of a schedule."""
    return parameter.slide is None and not parameter.schedule and parameter.name not in _KEYED


def option_text(value: float | str) -> str:
    """Return a value as settings show it."""
    return value if isinstance(value, str) else f"{value:g}"


def speed_text(speed: float | None) -> str:
    """Return a wanted speed as people read it: ``10/s``, ``max``."""
    return "max" if speed is None else f"{speed:,.0f}/s"


_Cell = tuple[int, int, Setting]


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
            column = start + self._columns(setting)
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
            return self._in_columns(setting)
        label = f"{setting.short} {setting.value}".strip().removesuffix(setting.value)
        return setting.key, f" {label}" if setting.key else label, setting.value

    def _in_columns(self, setting: Setting) -> tuple[str, str, str]:
        return f"{setting.key:<{_KEY_COLUMNS}}", f"{setting.full:<{_LABEL_COLUMNS}} ", setting.value

    def _columns(self, setting: Setting) -> int:
        return cell_len(written("".join(self._texts(setting)), self.look.glyphs))

    @property
    def _lines(self) -> int:
        """How many lines two columns take."""
        return -(-len(self._settings) // 2)

    @property
    def _is_tall(self) -> bool:
        if self.size.height <= 1 or self.size.height < self._lines:
            return False
        room = self.size.width // 2 - 1
        return all(cell_len("".join(self._in_columns(each))) < room for each in self._settings)

    def _cells(self, y: int) -> list[_Cell]:
        """Return the settings of line ``y`` with their first column and the one after their last."""
        return self._in_two_columns(y) if self._is_tall else self._running_on(y)

    def _in_two_columns(self, y: int) -> list[_Cell]:
        half = self.size.width // 2
        numbers = range(y, len(self._settings), self._lines) if y < self._lines else ()
        return [
            (1 + column * half, (column + 1) * half, self._settings[number])
            for column, number in enumerate(numbers)
        ]

    def _running_on(self, y: int) -> list[_Cell]:
        """Return line ``y`` where the settings follow one another; the least important ones give way."""
        kept = list(self._settings)
        while True:
            for gap in _GAPS:
                lines = self._lines_with(kept, gap)
                if len(lines) <= self.size.height:
                    return lines[y] if y < len(lines) else []
            if len(kept) <= 1:
                return []
            kept.remove(max(reversed(kept), key=lambda setting: setting.rank))

    def _lines_with(self, settings: list[Setting], gap: int) -> list[list[_Cell]]:
        lines: list[list[_Cell]] = [[]]
        column = 1
        for setting in settings:
            columns = self._columns(setting)
            if lines[-1] and column + columns > self.size.width:
                lines.append([])
                column = 1
            lines[-1].append((column, column + columns, setting))
            column += columns + gap
        return lines
