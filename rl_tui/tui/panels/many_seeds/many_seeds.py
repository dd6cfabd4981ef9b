"""What many seeds say of the runs on screen: means with their errors beside the figures of this one seed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, length, spelled, strips_of, wrapped
from rl_tui.tui.panels.bindings import binding
from rl_tui.tui.panels.many_seeds.figures import in_percent, may_count_again, shown_figures, until_of
from rl_tui.tui.panels.many_seeds.remarks import remarks
from rl_tui.tui.panels.many_seeds.table import table_lines
from rl_tui.tui.panels.scrolled_panel import ScrolledPanel, scroll_bindings
from rl_tui.tui.panels.snapshot_facts import (
    episodes_reached,
    hides_greedy,
    hides_means,
    keeps_back,
    shown_lane,
)
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

_LEAST_BAR: Final = 8
_MOST_BAR: Final = 32
_UNDER_WAY: Final = (StudyState.STARTING, StudyState.RUNNING)
_SAYS_WHY: Final = (StudyState.FAILED, StudyState.REFUSED)


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
            lines = list(study_lines(snapshot, self.look, width, is_short=is_short))
            if len(lines) <= height:
                break
        return strips_of(lines, width, len(lines), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it, and enter where there is something to count again."""
        study = None if snapshot is None else snapshot.study
        if not may_count_again(study):
            return ("M: close",)
        return "enter: count again · M: close", "enter: again · M: close"


def study_lines(snapshot: Snapshot | None, look: Look, width: int, *, is_short: bool) -> Iterator[Line]:
    """Yield the lines; of a bandit what the agent cannot know only where it is not hidden.

    Where room ``is_short`` there are no blank lines, and the figures stand above what was counted for them.
    """
    study = None if snapshot is None else snapshot.study
    if snapshot is None or study is None:
        yield from wrapped("the first seeds are being counted", width, look.palette.dim, look, " ", " ")
        return
    study = in_percent(study)
    yield from _how_far(study, snapshot, look, width)
    what = _what_is_counted(study, snapshot, look, width)
    if not study.lanes or not study.seeds:
        yield from what
        return
    if not is_short:
        yield from what
        yield []
    secret = hides_greedy(snapshot)
    figures = shown_figures(study, secret=secret)
    until = until_of(study, episodes_reached(snapshot))
    lanes = _names(study, snapshot), shown_lane(study, snapshot)
    table = table_lines(study, *lanes, figures, look, width, until=until)
    yield from (line for line in table if line or not is_short)
    if hides_means(snapshot) and not keeps_back(snapshot, "answer"):
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


def _how_far(study: SeedStudy, snapshot: Snapshot, look: Look, width: int) -> Iterator[Line]:
    """Yield how far it has come, and whether it is out of date or out of time."""
    palette = look.palette
    if study.most:
        yield _progress(study, _span(study, snapshot), look, width)
    elif study.state is StudyState.STARTING:
        yield [Piece(" starting", palette.dim)]
    if study.state in _UNDER_WAY and not study.seeds:
        yield from wrapped("the first figures come after 8 seeds", width, palette.dim, look, " ", " ")
    if study.how_long and study.state in _UNDER_WAY:
        yield from wrapped(study.how_long, width, palette.dim, look, " ", " ")
    if study.is_outdated:
        text = "the run has been changed since: enter counts again"
        yield from wrapped(text, width, palette.accent, look, " ", " ")
    if study.state is StudyState.OUT_OF_TIME:
        text = "it has used up the processor time that it may take"
        yield from wrapped(text, width, palette.accent, look, " ", " ")


def _progress(study: SeedStudy, span: str, look: Look, width: int) -> Line:
    """Return ``64 of 256 seeds · episodes 1–500`` and a bar, or what is left of that."""
    palette, glyphs = look.palette, look.glyphs
    is_whole = study.seeds >= study.most
    count = f"{study.seeds}" if is_whole else f"{study.seeds} of {study.most}"
    said = Piece(f" {count} seeds", palette.strong)
    spans = [[Piece(f" · {form}", palette.dim)] for form in (span, span.partition(" ")[2]) if form]
    forms: list[Line] = [*([said, *form] for form in spans), [said], [Piece(f" {count}", palette.strong)]]
    fitting = first_that_fits(forms, width, look)
    whole = [*forms[0], Piece(" · low priority", palette.dim)]
    if study.state in _UNDER_WAY and length(spelled(whole, look)) + _LEAST_BAR + 2 <= width:
        fitting = whole
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
    """Yield why it is bounded as it is or has failed, and which seeds there are so far."""
    palette = look.palette
    if study.message:
        style = palette.accent if study.state in _SAYS_WHY else palette.text
        yield from wrapped(study.message, width, style, look, " ", " ")
    if study.seeds and not study.is_outdated:
        first = snapshot.recipe.seed
        yield from wrapped(f"seeds {first} to {first + study.seeds - 1}", width, palette.dim, look, " ", " ")


def _span(study: SeedStudy, snapshot: Snapshot) -> str:
    """Return how long the run of each seed is, empty where that is not bounded or not known."""
    pulls = isinstance(snapshot.world.drawing, Arms)
    unit, last = ("pull" if pulls else "episode", study.episodes) if study.episodes else ("step", study.steps)
    if not last:
        return ""
    return f"{unit}s 1–{last:,}" if last > 1 else f"{unit} 1"
