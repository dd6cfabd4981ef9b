"""What many seeds say of the runs on screen: means with their errors beside the figures of this one seed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.tui.draw.pieces import (
    KEPT_BLANK,
    Line,
    Piece,
    first_that_fits,
    length,
    spelled,
    strips_of,
    wrapped,
)
from rl_tui.tui.panels.bindings import binding
from rl_tui.tui.panels.many_seeds.figures import may_count_again, shown_figures
from rl_tui.tui.panels.many_seeds.remarks import remarks
from rl_tui.tui.panels.many_seeds.table import table_lines
from rl_tui.tui.panels.scrolled_panel import ScrolledPanel, scroll_bindings
from rl_tui.tui.panels.snapshot_facts import is_secret
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

_LEAST_BAR: Final = 8
_MOST_BAR: Final = 32
_UNDER_WAY: Final = (StudyState.STARTING, StudyState.RUNNING)


class ManySeeds(ScrolledPanel):
    """Each figure of this seed beside its mean over many; with lanes, the paired differences too."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *scroll_bindings("many_seeds"),
        binding("enter", "screen.do('seeds.count_again')", "many_seeds.count_again", "Count again"),
    ]
    title = "Many seeds"

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of what is known so far."""
        for is_short in (False, True):
            lines = list(study_lines(snapshot, self.look, width, revealed=self.tells_all, is_short=is_short))
            if len(lines) <= height:
                break
        return strips_of(lines, width, len(lines), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it, and enter where there is something to count again."""
        study = None if snapshot is None else snapshot.study
        if not may_count_again(study):
            return ("M: close",)
        return "enter: count again · M: close", "enter: again · M: close"


def study_lines(
    snapshot: Snapshot | None, look: Look, width: int, *, revealed: bool, is_short: bool
) -> Iterator[Line]:
    """Yield the lines; of a bandit what the agent cannot know only if ``revealed``.

    Where room ``is_short`` there are no blank lines, and the figures stand above what was counted for them.
    """
    study = None if snapshot is None else snapshot.study
    if snapshot is None or study is None:
        yield from wrapped("the first seeds are being counted", width, look.palette.dim, look, " ", " ")
        return
    yield from _how_far(study, look, width)
    what = _what_is_counted(study, snapshot, look, width)
    if not study.lanes or not study.seeds:
        yield from what
        return
    if not is_short:
        yield from what
        yield []
    secret = is_secret(snapshot, revealed=revealed)
    figures = shown_figures(study, secret=secret)
    table = table_lines(study, _names(study, snapshot), figures, look, width)
    yield from (line for line in table if line or not is_short)
    if secret:
        yield from wrapped("h shows regret and best arm", width, look.palette.dim, look, " ", "   ")
    if is_short:
        yield from what
    else:
        yield []
    yield from remarks(study, snapshot, look, width, secret=secret)


def _names(study: SeedStudy, snapshot: Snapshot) -> Sequence[str]:
    """Return the names of the lanes when the study began, or none where they may be others now."""
    names = [lane.name for lane in snapshot.run_group.lanes]
    return names if len(names) == len(study.lanes) and not study.is_outdated else [""] * len(study.lanes)


def _how_far(study: SeedStudy, look: Look, width: int) -> Iterator[Line]:
    """Yield how far it has come, and whether it is out of date or out of time."""
    palette = look.palette
    if study.most:
        yield _progress(study, look, width)
    elif study.state is StudyState.STARTING:
        yield [Piece(" starting", palette.dim)]
    if study.is_outdated:
        text = "the run has been changed since: enter counts again"
        yield from wrapped(text, width, palette.accent, look, " ", " ")
    if study.state is StudyState.OUT_OF_TIME:
        text = "it has used up the processor time that it may take"
        yield from wrapped(text, width, palette.accent, look, " ", " ")


def _progress(study: SeedStudy, look: Look, width: int) -> Line:
    """Return ``64 of 256 seeds`` and a bar, or what is left of that."""
    palette, glyphs = look.palette, look.glyphs
    is_whole = study.seeds >= study.most
    count = f"{study.seeds}" if is_whole else f"{study.seeds} of {study.most}"
    said = Piece(f" {count} seeds", palette.strong)
    way = Piece(" · low priority", palette.dim)
    parts = [said, way] if study.state in _UNDER_WAY else [said]
    forms: list[Line] = [parts, [said], [Piece(f" {count}", palette.strong)]]
    fitting = first_that_fits(forms, width, look)
    room = min(_MOST_BAR, width - length(spelled(fitting, look)) - 2)
    if is_whole or room < _LEAST_BAR:
        return fitting
    done = max(1, room * study.seeds // study.most) if study.seeds else 0
    return [
        *fitting,
        Piece(f" {glyphs.track_done * done}", palette.slider_done),
        Piece(glyphs.track_rest * (room - done), palette.slider_rest),
    ]


def _what_is_counted(study: SeedStudy, snapshot: Snapshot, look: Look, width: int) -> Iterator[Line]:
    """Yield why it is bounded as it is or has failed, and which seeds there are so far, how long each."""
    palette = look.palette
    if study.message:
        style = palette.accent if study.state is StudyState.FAILED else palette.text
        yield from wrapped(study.message, width, style, look, " ", " ")
    span = _span(study, snapshot)
    if span:
        yield from wrapped(span, width, palette.dim, look, " ", " ")


def _span(study: SeedStudy, snapshot: Snapshot) -> str:
    """Return which seeds, and how long each run is; nothing where there is none yet."""
    if not study.seeds:
        return ""
    if study.episodes is not None:
        unit = "pull" if isinstance(snapshot.world.drawing, Arms) else "episode"
        span = f"first {study.episodes:,} {unit}s" if study.episodes != 1 else f"first {unit}"
    elif study.steps is not None:
        span = f"first {study.steps:,} steps"
    else:
        span = "runs"
    first = snapshot.recipe.seed
    which = "each seed" if study.is_outdated else _kept(f"seeds {first} to {first + study.seeds - 1}")
    return f"{span} of {which}"


def _kept(text: str) -> str:
    return text.replace(" ", KEPT_BLANK)
