"""The budget of a bandit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from rich.style import Style
from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.bandit import BanditFigures
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece, shortened, strips_of
from rl_tui.screen.kit.blocks import BLANK, Block, Column, Labelled, Row, Table, lines_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import ANSWER_KEPT, is_secret, keeps_back
from rl_tui.screen.panels.side_by_side import sides
from rl_tui.screen.theme.look import Look

WAITING: Final = "the arms are being drawn"
BEST_ARM_PULLED: Final = "best arm pulled"
_LABEL: Final = 11
_FIGURE: Final = 8
_ROWS_OF_TWO: Final = 6
_LANE: Final = 21  # cells of number and name
_MANY: Final = 100.0  # sums from here on have no decimals


class BudgetPanel(Panel):
    """Pulls, winnings, and unless hidden, regret."""

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Lay out one or two runs."""
        self.heading = self.fitting((*self.captioned("Budget"), "Budget"), width)
        blocks = budget_blocks(snapshot, self.look)
        if snapshot is not None and snapshot.beside is not None and height >= _ROWS_OF_TWO:
            blocks = pair_blocks(snapshot, self.look)
        return strips_of(lines_of(blocks, width, self.look), width, height, self.look)


def budget_blocks(snapshot: Snapshot | None, look: Look) -> Iterator[Block]:
    """Yield the numbers of one run."""
    if snapshot is None or snapshot.results.bandit is None:
        why = WAITING if snapshot is None else "this world has no budget"
        yield Row([Piece(f" {why}", look.palette.dim)])
        return
    yield _pulls(snapshot, snapshot.results.bandit, look)
    known = not is_secret(snapshot)
    yield from _winnings(snapshot.results.bandit, look, known)
    if not known:
        yield _hint(snapshot, look)


def pair_blocks(snapshot: Snapshot, look: Look) -> Iterator[Block]:
    """Yield two runs, the controlled one marked."""
    palette, glyphs, known = look.palette, look.glyphs, not is_secret(snapshot)
    lanes = [(lane, lane.results.bandit) for lane in sides(snapshot)]
    found = [(lane.run_group, figures) for lane, figures in lanes if figures is not None]
    decimals = sum_decimals([x for _, figures in found for x in (figures.winnings, figures.regret)])
    names, columns = list[Piece](), dict[str, list[Piece]]()
    for group, figures in found:
        is_led = group.shown == snapshot.run_group.shown
        style = palette.strong if is_led else palette.text
        mark, name = glyphs.cursor if is_led else " ", group.lanes[group.shown].name
        name = glyphs.spelled(f" {mark}{group.shown + 1} {name}")
        names.append(Piece(shortened(name, _LANE, glyphs.ellipsis), style))
        texts = {"winnings": sum_text(figures.winnings, decimals, look), "a pull": _mean_text(figures, look)}
        if known:
            texts["regret"] = sum_text(figures.regret, decimals, look)
            texts["best arm"] = _share(figures)
        for head, text in texts.items():
            columns.setdefault(head, []).append(Piece(text, style))
    first = Column("", names, palette.text, right=False, gap=0, width=_LANE)
    shown = [Column(head, cells, palette.text, width=_FIGURE) for head, cells in columns.items()]
    yield Table([(first, *shown[:count]) for count in range(len(shown), 0, -1)])
    if snapshot.results.bandit is not None:
        yield BLANK
        yield _pulls(snapshot, snapshot.results.bandit, look)
    if not known:
        yield _hint(snapshot, look)


def _hint(snapshot: Snapshot, look: Look) -> Row:
    key, dim = Piece(" w h  ", look.palette.press), look.palette.dim
    forms = [[key, Piece(each, dim)] for each in ("shows regret and the best arm", "shows regret")]
    if keeps_back(snapshot, "answer"):
        kept = f" regret and the best arm: {ANSWER_KEPT}"
        forms = [[Piece(each, dim)] for each in (kept, f" {ANSWER_KEPT}")]
    return Row(*forms, [])


def _pulls(snapshot: Snapshot, figures: BanditFigures, look: Look) -> Labelled:
    palette, mdp = look.palette, snapshot.world.mdp
    is_spent, drifts = snapshot.playback.phase is Phase.SPENT, mdp is not None and mdp.drift_std > 0.0
    pieces = [
        Piece(f"{figures.pulls:,} of {figures.budget:,}", palette.strong),
        Piece(look.glyphs.separated(" · spent") if is_spent else "", palette.strong),
        Piece("   r r starts again" if is_spent else "", palette.dim),
        Piece("   means drift" if drifts else "", palette.dim),
    ]
    return Labelled("pulls", palette.dim, _LABEL, Row(pieces))


def _winnings(figures: BanditFigures, look: Look, known: bool) -> Iterator[Block]:
    palette = look.palette
    shown = [figures.winnings] if not known else [figures.winnings, figures.regret, figures.best_possible]
    decimals = sum_decimals(shown)

    def figure(label: str, x: float, remarks: Iterable[str], style: Style) -> Labelled:
        number = Piece(f"{sum_text(x, decimals, look):<{_FIGURE}}", palette.strong)
        return Labelled(
            label, palette.dim, _LABEL, Row(*([number, Piece(remark, style)] for remark in remarks))
        )

    if not known:
        remark = f"   {_mean_text(figures, look)} a pull" if figures.pulls else ""
        yield figure("winnings", figures.winnings, [remark], palette.text)
        return
    best = sum_text(figures.best_possible, decimals, look)
    remarks = f"   best possible {best} on average", f"   best {best} on average"
    yield figure("winnings", figures.winnings, remarks, palette.text)
    remarks = "   by true means, without luck", "   in true means"
    yield figure("regret", figures.regret, remarks, palette.dim)
    if share := _share(figures):
        yield Row([Piece(f" {BEST_ARM_PULLED} {share}", palette.text)])


def _mean_text(figures: BanditFigures, look: Look) -> str:
    mean = figures.winnings / figures.pulls if figures.pulls else 0.0
    return numbers.fixed(mean, 2, look.glyphs, leading_zero=False)


def _share(figures: BanditFigures) -> str:
    return "" if figures.best_arm_rate is None else numbers.percent(figures.best_arm_rate)


def sum_decimals(sums: Iterable[float]) -> int:
    """Return a sum's decimals: 0 from 100 on."""
    return 0 if max(map(abs, sums)) >= _MANY else 1


def sum_text(x: float, decimals: int, look: Look) -> str:
    """Write a sum with thousands separators."""
    if x == 0.0:
        return "0"
    text = f"{abs(x):,.{decimals}f}" if abs(x) < 1e9 else numbers.value(abs(x), _FIGURE, look.glyphs)
    return look.glyphs.minus + text if x < 0 and numbers.has_digits(text) else text
