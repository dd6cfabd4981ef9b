"""Settings of the agent without sliders."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment
from textual import events
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.agents.catalogue import POLICY_BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, why_idle
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

_BETWEEN: Final = " · "
_WIDE_GAP: Final = 3
_GAP: Final = 2
_KEYED: Final = frozenset({"policy", "ties", "initial_q"})  # have their own key


@dataclass(frozen=True, slots=True)
class Setting:
    """A setting. High ``rank`` is dropped first."""

    key: str
    label: str
    value: str
    action: str
    rank: int


def settings_of(snapshot: Snapshot) -> Iterator[Setting]:
    """Yield the current settings."""
    values = snapshot.agent.hyperparameters
    is_bandit = snapshot.world.is_bandit
    parameters = parameters_of(snapshot.agent.algorithm, values.policy)
    lanes = snapshot.run_group.lanes
    if lanes:
        yield Setting("", "run", f"{snapshot.run_group.shown + 1}/{len(lanes)}", "lanes.next_lane", 2)
    yield Setting("", "", snapshot.agent.row.name, "agent.choose_algorithm", 0)
    if "policy" in parameters:
        yield Setting("", "", POLICY_BY_ID[values.policy].name, "agent.choose_policy", 1)
    if "ties" in parameters:
        yield Setting("", "ties", values.ties, "agent.next_ties", 4)
    if "initial_q" in parameters:
        yield Setting("", "Q₀", f"{values.initial_q:g}", "agent.ask_initial_q", 5)
    yield Setting("", "seed", str(snapshot.recipe.seed), "agent.ask_seed", 6)
    if snapshot.playback.phase in (Phase.SPENT, Phase.DONE):
        yield Setting("r r", "", "start again", "run.reset", 2)
    else:
        yield Setting("", "", speed_text(snapshot.playback.speed), "run.faster", 3)
    for name in parameters:
        parameter = PARAMETERS[name]
        idle = why_idle(name, snapshot.agent.algorithm, values, is_bandit=is_bandit)
        is_shown_elsewhere = parameter.slide is not None or parameter.schedule or name in _KEYED
        if not (is_shown_elsewhere or idle):
            value = option_text(values.value(name))
            yield Setting("", parameter.symbol, value, "agent.show_options", 7)
    episode = snapshot.counters.episodes
    alpha = values.alpha_at(episode)
    if "alpha_decay" in parameters and alpha is not None and alpha_moves(values):
        yield Setting("", "α now", f"{alpha:.3f}", "", 8)
    if "epsilon_decay" in parameters and epsilon_moves(values):
        yield Setting("", "ε now", f"{values.epsilon_at(episode):.3f}", "", 8)
    yield Setting("a:", "change", "", "menus.open('a')", 2)


def alpha_moves(values: Hyperparameters) -> bool:
    """Return whether α changes between episodes."""
    is_scheduled = values.step_size_schedule != "constant" and not values.sample_average
    return is_scheduled and values.alpha_decay > 0.0


def epsilon_moves(values: Hyperparameters) -> bool:
    """Return whether ε changes between episodes."""
    return values.epsilon_schedule != "constant" and values.epsilon_decay > 0.0


def option_text(value: float | str) -> str:
    """Write a value as shown in settings."""
    return value if isinstance(value, str) else f"{value:g}"


def called(name: str, value: float | str) -> str:
    """Return the display name of a value."""
    return POLICY_BY_ID[str(value)].name if name == "policy" else option_text(value)


def speed_text(speed: float | None) -> str:
    """Write a speed: ``10/s``, ``max``."""
    return "max" if speed is None else f"{speed:,.0f}/s"


@dataclass(frozen=True, slots=True)
class SettingCell:
    """A setting's text, in columns ``start`` to before ``end``."""

    start: int
    end: int
    setting: Setting
    key: str
    label: str
    value: str


def laid_out(settings: Sequence[Setting], width: int, height: int, glyphs: Glyphs) -> list[list[SettingCell]]:
    """Arrange ``settings``, dropping unimportant ones if needed."""
    kept = list(settings)
    while kept:
        for gap in (_WIDE_GAP, _GAP):
            lines = _running_on(kept, width, gap, glyphs)
            if len(lines) <= height and all(cell.end <= width for line in lines for cell in line):
                return lines
        kept.remove(max(reversed(kept), key=lambda setting: setting.rank))
    return []


def _running_on(settings: Sequence[Setting], width: int, gap: int, glyphs: Glyphs) -> list[list[SettingCell]]:
    lines: list[list[SettingCell]] = [[]]
    column = 1
    for setting in settings:
        cell = _cell(column, setting, glyphs)
        if lines[-1] and cell.end > width:
            lines.append([])
            cell = _cell(1, setting, glyphs)
        lines[-1].append(cell)
        column = cell.end + gap
    return lines


def _cell(start: int, setting: Setting, glyphs: Glyphs) -> SettingCell:
    label = f"{setting.label} " if setting.label and setting.value else setting.label
    texts = (setting.key, f" {label}" if setting.key else label, setting.value)
    key, label, value = (glyphs.spelled(text) for text in texts)
    return SettingCell(start, start + cell_len(key + label + value), setting, key, label, value)


class AgentSettings(Widget):
    """The settings, changed by clicks."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self._settings: tuple[Setting, ...] = ()

    def show(self, snapshot: Snapshot) -> None:
        """Draw the current settings."""
        settings = tuple(settings_of(snapshot))
        if settings != self._settings:
            self._settings = settings
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return one line."""
        palette = self.look.palette
        segments: list[Segment] = []
        column = 0
        for cell in self._line(y):
            space = cell.start - column
            between = self.look.glyphs.separated(_BETWEEN) if space == _WIDE_GAP else " " * space
            segments += [
                Segment(between, palette.dim),
                Segment(cell.key, palette.press),
                Segment(cell.label, palette.dim),
                Segment(cell.value, palette.text),
            ]
            column = cell.end
        strip = Strip(segments or [Segment(" ", palette.text)])
        return strip.adjust_cell_length(self.size.width, palette.text).apply_style(self.rich_style)

    async def on_click(self, event: events.Click) -> None:
        """Change the clicked setting."""
        for cell in self._line(event.y):
            if cell.start <= event.x < cell.end and cell.setting.action:
                await self.screen.run_action(f"do({cell.setting.action!r})")
                return

    def _line(self, y: int) -> list[SettingCell]:
        width, height = self.size
        lines = laid_out(self._settings, width, height, self.look.glyphs)
        first = int(sum(map(len, lines)) == len(self._settings) and len(lines) < height)  # below a blank row
        return lines[y - first] if first <= y < first + len(lines) else []
