"""How a bandit's budget is being spent: pulls, winnings and, once it may be known, regret."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rich.cells import set_cell_size
from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.bandit import BanditFigures
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, first_that_fits, shortened, strips_of
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import ANSWER_KEPT, is_secret, keeps_back
from rl_tui.screen.panels.side_by_side import sides
from rl_tui.screen.theme.look import Look

WAITING: Final = "the arms are being drawn"
BEST_ARM_PULLED: Final = "best arm pulled"
NO_BUDGET: Final = "this world has no budget"
_LABEL: Final = 10
_FIGURE: Final = 8
_ROWS_OF_TWO: Final = 6
_LANE: Final = 21  # its number and name
_COLUMN: Final = 9
_MANY: Final = 100.0  # from here on the sum of so many rewards is shown in whole numbers


class BudgetPanel(Panel):
    """Pulls and winnings; regret and the share of the best arm unless hidden."""

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the picture of the figures of ``snapshot``."""
        self.heading = self.fitting((*self.captioned("Budget"), "Budget"), width)
        lines = budget_lines(snapshot, self.look, width)
        if snapshot is not None and snapshot.beside is not None and height >= _ROWS_OF_TWO:
            lines = pair_lines(sides(snapshot), snapshot, self.look)
        return strips_of(lines, width, height, self.look)


def budget_lines(snapshot: Snapshot | None, look: Look, width: int) -> list[Line]:
    """Return the lines; what the agent cannot know only where it is not hidden."""
    if snapshot is None or snapshot.results.bandit is None:
        return [[Piece(f" {WAITING if snapshot is None else NO_BUDGET}", look.palette.dim)]]
    figures, spent = snapshot.results.bandit, snapshot.playback.phase is Phase.SPENT
    drifts = snapshot.world.mdp is not None and snapshot.world.mdp.drift_std > 0.0
    known = not is_secret(snapshot)
    lines = [_pulls(figures, look, spent, drifts), *_winnings(figures, look, width, known)]
    return lines if known else [*lines, _hint(snapshot, look)]


def _hint(snapshot: Snapshot, look: Look) -> Line:
    if keeps_back(snapshot, "answer"):
        return [Piece(f" regret and the best arm: {ANSWER_KEPT}", look.palette.dim)]
    return [Piece(" h  ", look.palette.press), Piece("shows regret and the best arm", look.palette.dim)]


def pair_lines(lanes: tuple[Snapshot, Snapshot], led: Snapshot, look: Look) -> list[Line]:
    """Return the lines of two lanes, of which that of ``led`` is marked."""
    palette, known = look.palette, not is_secret(led)
    heads = ("winnings", "a pull", *(("regret", "best arm") if known else ()))
    lines: list[Line] = [[Piece(" " * _LANE + "".join(f"{head:>{_COLUMN}}" for head in heads), palette.dim)]]
    bandits = [lane.results.bandit for lane in lanes if lane.results.bandit is not None]
    decimals = sum_decimals([each.winnings for each in bandits] + [each.regret for each in bandits])
    for lane in lanes:
        group, figures = lane.run_group, lane.results.bandit
        if figures is None:
            continue
        is_led = group.shown == led.run_group.shown
        mark, name = look.glyphs.cursor if is_led else " ", group.lanes[group.shown].name
        name = shortened(
            to_ascii(f" {mark}{group.shown + 1} {name}", look.glyphs), _LANE, look.glyphs.ellipsis
        )
        mean = figures.winnings / figures.pulls if figures.pulls else 0.0
        texts = [
            sum_text(figures.winnings, decimals, look),
            numbers.fixed(mean, 2, look.glyphs, leading_zero=False),
        ]
        if known:
            rate = figures.best_arm_rate
            texts += [sum_text(figures.regret, decimals, look), "" if rate is None else numbers.percent(rate)]
        row = set_cell_size(name, _LANE) + "".join(f"{text:>{_COLUMN}}" for text in texts)
        lines.append([Piece(row, palette.strong if is_led else palette.text)])
    if led.results.bandit is not None:
        drifts = led.world.mdp is not None and led.world.mdp.drift_std > 0.0
        lines += [[], _pulls(led.results.bandit, look, led.playback.phase is Phase.SPENT, drifts)]
    return lines if known else [*lines, _hint(led, look)]


def _pulls(figures: BanditFigures, look: Look, spent: bool, drifts: bool) -> Line:
    palette = look.palette
    line = [
        Piece(f" {'pulls':<{_LABEL}}", palette.dim),
        Piece(f"{figures.pulls:,} of {figures.budget:,}", palette.strong),
    ]
    if spent:
        line += [
            Piece(separated(" · spent", look.glyphs), palette.strong),
            Piece("   r starts again", palette.dim),
        ]
    return [*line, *([Piece("   means drift", palette.dim)] if drifts else [])]


def _winnings(figures: BanditFigures, look: Look, width: int, known: bool) -> list[Line]:
    palette = look.palette
    shown = [figures.winnings] if not known else [figures.winnings, figures.regret, figures.best_possible]
    decimals = sum_decimals(shown)
    winnings = _figure("winnings", sum_text(figures.winnings, decimals, look), look)
    if not known:
        mean = [] if not figures.pulls else [_mean(figures, look)]
        return [[*winnings, *mean]]
    regret = _figure("regret", sum_text(figures.regret, decimals, look), look)
    best = sum_text(figures.best_possible, decimals, look)
    possible = Piece(f"   best possible {best} on average", palette.text)
    shorter = Piece(f"   best {best} on average", palette.text)
    rate = "" if figures.best_arm_rate is None else numbers.percent(figures.best_arm_rate)
    share = f"{BEST_ARM_PULLED} {rate}" if rate else ""
    remarks = [Piece(f"   {text}", palette.dim) for text in ("in true means, luck left out", "in true means")]
    return [
        first_that_fits(([*winnings, possible], [*winnings, shorter]), width, look),
        first_that_fits(([*regret, remark] for remark in remarks), width, look),
        *([[Piece(f" {share}", palette.text)]] if share else []),
    ]


def _mean(figures: BanditFigures, look: Look) -> Piece:
    mean = numbers.fixed(figures.winnings / figures.pulls, 2, look.glyphs, leading_zero=False)
    return Piece(f"   {mean} a pull", look.palette.text)


def _figure(label: str, number: str, look: Look) -> list[Piece]:
    palette = look.palette
    return [Piece(f" {label:<{_LABEL}}", palette.dim), Piece(f"{number:<{_FIGURE}}", palette.strong)]


def sum_decimals(sums: Iterable[float]) -> int:
    """Return the decimals of sums of rewards beside one another: none where one is 100 or more, else one."""
    return 0 if max(map(abs, sums)) >= _MANY else 1


def sum_text(x: float, decimals: int, look: Look) -> str:
    """Return a sum of rewards with commas and so many decimals; 0 as it is."""
    if x == 0.0:
        return "0"
    text = f"{abs(x):,.{decimals}f}" if abs(x) < 1e9 else numbers.value(abs(x), _FIGURE, look.glyphs)
    return look.glyphs.minus + text if x < 0 and numbers.has_digits(text) else text
