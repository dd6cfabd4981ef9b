"""What an author wants to know of the world in force: a row each as it is worked out, and warnings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import KEPT_BLANK, Line, Piece, kept, length, spelled, strips_of, wrapped
from rl_tui.screen.draw.names import state_name
from rl_tui.screen.kit.scrolled_panel import ScrolledPanel, scroll_bindings
from rl_tui.screen.kit.snapshot_facts import hides_means, is_secret, shown_by
from rl_tui.screen.theme.look import Look
from rl_tui.studies.world_check.report import CheckStage
from rl_tui.studies.world_check.words import LABELS, NOT_KNOWN, Row, rows
from rl_tui.studies.world_check.world_checks import WorldCheckView

TITLE: Final = "World check"
WAITING: Final = "being worked out, beside all else"
OUTDATED: Final = "of before the last change; being worked out anew"
FINE: Final = "done: nothing to warn of"
_GIVE_AWAY: Final = frozenset({"best_return", "shortest_way", "flips"})
"""What would give the exact answer away."""
_TELL_MEANS: Final = frozenset({"random_return", "first_update"})
"""What would tell of the means of arms."""
_LABEL: Final = max(map(len, LABELS.values())) + 2
_BESIDE: Final = 34
"""Columns from which on texts stand beside their labels, else below them."""


class WorldCheckPanel(ScrolledPanel):
    """How far the check has come, the warnings, and its rows; arrows scroll."""

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("world_check")
    title = TITLE

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows."""
        lines = list(check_lines(snapshot, self.look, width))
        self.free_rows = max(0, height - len(lines))
        return strips_of(lines, width, max(1, len(lines)), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it."""
        return ("Q: close",)


def check_lines(snapshot: Snapshot | None, look: Look, width: int) -> Iterator[Line]:
    """Yield the lines of the check that ``snapshot`` knows."""
    palette = look.palette
    view = None if snapshot is None else snapshot.world_check
    if snapshot is None or view is None:
        yield from wrapped(WAITING, width, palette.dim, look, " ", " ")
        return
    yield from _how_far(view, look, width)
    report, world = view.report, view.world
    if report is None or world is None:
        return
    warnings = report.warnings
    if warnings and is_secret(snapshot):  # they may tell what the best policy does, or what arms pay
        warnings = (f"warnings: {shown_by(snapshot, 'them')}",)
    for warning in warnings:
        yield from wrapped(
            warning, width, palette.dim if view.is_outdated else palette.bad, look, " ! ", "   "
        )
    listed = rows(report, world.space, view.gamma, lambda state: state_name(world, state, look.glyphs))
    for row in listed:
        yield from _row(row, snapshot, view, look, width)


def _how_far(view: WorldCheckView, look: Look, width: int) -> Iterator[Line]:
    """Yield how far the check has come."""
    palette, report = look.palette, view.report
    text, style = WAITING, palette.dim
    if view.refused:
        text, style = view.refused, palette.strong
    elif view.is_outdated:
        text, style = OUTDATED, palette.strong
    elif report is not None and report.stage is CheckStage.DONE:
        count = len(report.warnings)
        text, style = FINE, palette.good
        if count:
            text, style = f"done: {counted(count, 'warning')}", palette.bad
    elif report is not None and report.trying:
        name, place = BY_ID[report.trying].name, list(BY_ID).index(report.trying) + 1
        text = f"trying {name}, {place} of {len(BY_ID)}"
    elif report is not None:
        text = "working out the flips" if report.stage is CheckStage.FLIPS else WAITING
    if view.how_long and not view.is_outdated and not view.refused:
        text = f"{text} · {view.how_long}"
    yield from wrapped(text, width, style, look, " ", " ")


def _row(row: Row, snapshot: Snapshot, view: WorldCheckView, look: Look, width: int) -> Iterator[Line]:
    """Yield the lines of ``row``: its label, what is known, and in what sense."""
    palette = look.palette
    figure, remark = _unbroken(row.figure, look) or look.glyphs.ellipsis, _unbroken(row.remark, look)
    style = palette.bad if _is_warned_of(row, view) else palette.strong
    if _is_hidden(row, snapshot):
        figure, remark = shown_by(snapshot), ""
    elif row.figure == NOT_KNOWN:
        figure, remark = f"{NOT_KNOWN}: {remark}", ""
    if row.figure in ("", NOT_KNOWN) or _is_hidden(row, snapshot) or view.is_outdated:
        style = palette.dim
    label, indent = f" {LABELS[row.field]}", "   "
    if width >= _BESIDE:
        label, indent = f"{label:<{_LABEL}}", " " * _LABEL
    both = [Piece(label, palette.dim), Piece(_plain(figure), style)]
    if remark:
        both.append(Piece(f"  {_plain(remark)}", palette.dim))
    if width >= _BESIDE and length(spelled(both, look)) <= width:
        yield both
        return
    lines = wrapped(figure, width, style, look, indent, indent)
    lines += wrapped(remark, width, palette.dim, look, indent, indent) if remark else []
    if width < _BESIDE:
        yield [Piece(label, palette.dim)]
        yield from lines
        return
    (first,), *others = lines
    yield [Piece(label, palette.dim), Piece(first.text[_LABEL:], first.style)]
    yield from others


def _unbroken(text: str, look: Look) -> str:
    """Return ``text`` with the minus sign of the screen, and γ on one line with its value."""
    if text.startswith("-"):
        text = f"{look.glyphs.minus}{text[1:]}"
    return text.replace("γ ", f"γ{KEPT_BLANK}").replace("(0, 1)", kept("(0, 1)"))


def _plain(text: str) -> str:
    return text.replace(KEPT_BLANK, " ")


def _is_warned_of(row: Row, view: WorldCheckView) -> bool:
    """Return whether a warning is about ``row``."""
    report = view.report
    assert report is not None
    assert view.world is not None
    if view.world.space.time_limit:
        return False
    is_endless = {"endless": report.endless, "endless_states": report.endless_states}
    return bool(is_endless.get(row.field))


def _is_hidden(row: Row, snapshot: Snapshot) -> bool:
    """Return whether ``row`` would tell what is hidden."""
    return (is_secret(snapshot) and row.field in _GIVE_AWAY) or (
        hides_means(snapshot) and row.field in _TELL_MEANS
    )
