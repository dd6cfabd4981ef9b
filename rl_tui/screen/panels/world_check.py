"""The world check."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from typing import ClassVar, Final

from textual.binding import BindingType

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import KEPT_BLANK, Piece
from rl_tui.screen.draw.names import state_name
from rl_tui.screen.kit.blocks import BLANK, Block, Labelled, Row, Text
from rl_tui.screen.kit.layers import veiled
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.kit.snapshot_facts import hides_means, is_secret, shown_by
from rl_tui.screen.theme.look import Look
from rl_tui.studies.world_check.report import CheckStage
from rl_tui.studies.world_check.words import LABELS, NOT_KNOWN, rows
from rl_tui.studies.world_check.words import Row as CheckRow
from rl_tui.studies.world_check.world_checks import WorldCheckView

TITLE: Final = "World check"
WAITING: Final = "computing in the background …"
OUTDATED: Final = "outdated; recomputing …"
FINE: Final = "sound: no warnings"
_GIVE_AWAY: Final = frozenset({"best_return", "shortest_way", "flips"})
"""Rows that would reveal the exact values."""
_TELL_MEANS: Final = frozenset({"random_return", "first_update"})
"""Rows that would reveal the means of arms."""
_NUMBERS: Final = frozenset({"random_return", "best_return", "shortest_way"})
_LABEL: Final = max(map(len, LABELS.values())) + 2
_BESIDE: Final = 34
"""Least columns for texts beside their labels."""


class WorldCheckPanel(ScrolledPanel):
    """The check's progress, warnings and results."""

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("world_check")
    title = TITLE

    def blocks(self, snapshot: Snapshot | None, left_out: int) -> Iterator[Block]:
        """Yield the known results."""
        palette, view = self.look.palette, None if snapshot is None else snapshot.world_check
        if snapshot is None or view is None:
            yield Text(WAITING, palette.dim)
            return
        yield _how_far(view, self.look)
        report, world = view.report, view.world
        if report is None or world is None:
            return
        warnings = report.warnings
        if warnings and is_secret(snapshot):  # they may reveal the optimal policy or the rewards of arms
            warnings = (f"warnings: {shown_by(snapshot, 'them')}",)
        for warning in warnings:
            yield Text(warning, palette.dim if view.is_outdated else palette.bad, " ! ", "   ")
        names = partial(state_name, world, glyphs=self.look.glyphs)
        for row in rows(report, world.space, view.gamma, names):
            label = LABELS[row.field]
            yield from () if left_out else (BLANK,)
            yield Labelled(label, palette.dim, _LABEL, _said(row, snapshot, view, self.look), _BESIDE)
        if is_secret(snapshot):
            yield Text(f"{veiled(self.look.glyphs)} is hidden: {shown_by(snapshot)}", palette.dim)


def _how_far(view: WorldCheckView, look: Look) -> Text:
    palette, report = look.palette, view.report
    text, style = WAITING, palette.dim
    if view.refused:
        text, style = view.refused, palette.strong
    elif view.is_outdated:
        text, style = OUTDATED, palette.strong
    elif report is not None and report.stage is CheckStage.DONE:
        count = len(report.warnings)
        text, style = (counted(count, "warning"), palette.bad) if count else (FINE, palette.good)
    elif report is not None and report.trying:
        name, place = BY_ID[report.trying].name, list(BY_ID).index(report.trying) + 1
        text = f"trying {name}, {place} of {len(BY_ID)}"
    elif report is not None:
        text = "computing the flip points …" if report.stage is CheckStage.FLIPS else WAITING
    if view.how_long and not view.is_outdated and not view.refused:
        text = f"{text} · {view.how_long}"
    return Text(text, style)


def _said(row: CheckRow, snapshot: Snapshot, view: WorldCheckView, look: Look) -> Block:
    palette = look.palette
    is_hidden = is_secret(snapshot) and row.field in _GIVE_AWAY
    is_hidden = is_hidden or (hides_means(snapshot) and row.field in _TELL_MEANS)
    figure, remark = _unbroken(row.figure, look) or look.glyphs.ellipsis, _unbroken(row.remark, look)
    style = (
        palette.bad if _is_warned_of(row, view) else palette.strong if row.field in _NUMBERS else palette.text
    )
    if is_hidden:
        figure, remark = veiled(look.glyphs), ""
    elif row.figure == NOT_KNOWN:
        figure, remark = f"{NOT_KNOWN}: {remark}", ""
    if row.figure in ("", NOT_KNOWN) or is_hidden or view.is_outdated:
        style = palette.dim
    pieces = Piece(figure, style), Piece(f"  {remark}" if remark else "", palette.dim)
    line = [Piece(each.text.replace(KEPT_BLANK, " "), each.style) for each in pieces]
    return Row(line, instead=(Text(figure, style, "", ""), Text(remark, palette.dim, "", "")))


def _unbroken(text: str, look: Look) -> str:
    """Return ``text`` with a minus sign, and γ next to its neighbours."""
    if text.startswith("-"):
        text = f"{look.glyphs.minus}{text[1:]}"
    return re.sub("(?<=γ) | (?=γ)", KEPT_BLANK, text)


def _is_warned_of(row: CheckRow, view: WorldCheckView) -> bool:
    is_bounded = view.world is None or view.world.space.time_limit
    is_endless = row.field in ("endless", "endless_states") and bool(getattr(view.report, row.field))
    return is_endless and not is_bounded
