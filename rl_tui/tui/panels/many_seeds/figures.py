"""The figures of a study as texts: which are shown, which way each is better, and with how many decimals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from rl_tui.lab.many_seeds.figures import Estimate, LaneStudy, PairedDifference, SeedStudy, StudyState
from rl_tui.tui.draw import numbers
from rl_tui.tui.theme.glyphs import Glyphs

_MOST_DECIMALS: Final = 5
_LARGEST: Final = 1e7  # from here on numbers are written in short
_SHORT: Final = 7  # cells of those


@dataclass(frozen=True, slots=True)
class StudyFigure:
    """One figure of a study: its ``id`` in the document of ``train --runs --json``, and its ``name``.

    ``in_full`` is the name where there is room for more. ``is_secret`` says that of a bandit it tells what
    the agent cannot know.
    """

    id: str
    name: str
    in_full: str
    is_secret: bool = False
    lower_is_better: bool = False


RETURN: Final = StudyFigure("return_mean", "return", "mean return")
LAST_100: Final = StudyFigure("return_last_100", "last 100", "last 100")
WINNINGS: Final = StudyFigure("winnings", "winnings", "winnings")
REGRET: Final = StudyFigure("regret", "regret", "regret", is_secret=True, lower_is_better=True)
GREEDY: Final = StudyFigure("expected_return", "greedy", "greedy, exact", is_secret=True)
FIGURES: Final = (
    WINNINGS,
    REGRET,
    StudyFigure("best_arm_rate", "best arm", "best arm pulled", is_secret=True),
    LAST_100,
    GREEDY,
    RETURN,
)
"""In the order in which they are shown; a world that is no bandit has only the last three."""


def may_count_again(study: SeedStudy | None) -> bool:
    """Return whether there is anything to count again: it is over, or tells of other runs."""
    if study is None:
        return False
    return study.is_outdated or study.state not in (StudyState.STARTING, StudyState.RUNNING)


def shown_figures(study: SeedStudy, *, secret: bool) -> list[StudyFigure]:
    """Return the figures that any lane has, but for what must be hidden while ``secret``.

    The mean return of a bandit's pulls says no more than its winnings.
    """
    return [
        figure
        for figure in FIGURES
        if any(figure.id in lane.estimates for lane in study.lanes)
        and not (secret and figure.is_secret)
        and not (figure is RETURN and any(WINNINGS.id in lane.estimates for lane in study.lanes))
    ]


def estimates_of(figure: StudyFigure, lanes: Iterable[LaneStudy]) -> list[Estimate]:
    """Return the estimates of ``figure`` in those of ``lanes`` that have it."""
    return [lane.estimates[figure.id] for lane in lanes if figure.id in lane.estimates]


def decimals_of(found: Sequence[Estimate]) -> int:
    """Return the decimals for all estimates ``found`` of a figure: those that the least error needs.

    It has one digit, two where that is a 1; where there is no error to go by, up to three show the means.
    """
    errors = [each.stderr for each in found if each.stderr is not None and each.stderr > numbers.NEGLIGIBLE]
    if errors:
        return min(_MOST_DECIMALS, max(0, -math.floor(math.log10(min(errors) / 2.0))))
    return next((d for d in range(3) if all(abs(round(e.mean, d) - e.mean) < 1e-6 for e in found)), 3)


def figure_text(x: float | None, decimals: int, glyphs: Glyphs) -> str:
    """Return ``x`` with so many decimals: ``−47.1``, ``.82``, ``1,213``; a dash for None."""
    if x is None or not math.isfinite(x):
        return "-" if glyphs.name == "ascii" else "–"
    if abs(x) >= _LARGEST:
        return numbers.value(x, _SHORT, glyphs)
    text = f"{abs(x):,.{decimals}f}"
    text = f".{text.removeprefix('0.')}" if text.startswith("0.") else text
    return f"{glyphs.minus}{text}" if x < 0.0 and numbers.has_digits(text) else text


def estimate_text(estimate: Estimate | None, decimals: int, glyphs: Glyphs) -> str:
    """Return ``−47.1 ± .5``: a mean and its standard error."""
    if estimate is None:
        return figure_text(None, decimals, glyphs)
    mean = figure_text(estimate.mean, decimals, glyphs)
    return mean if estimate.stderr is None else f"{mean} ± {error_text(estimate.stderr, decimals, glyphs)}"


def error_text(stderr: float, decimals: int, glyphs: Glyphs) -> str:
    """Return a standard error; 0 where all seeds agree, two digits where so many decimals show none."""
    if stderr < numbers.NEGLIGIBLE:
        return "0"
    text = figure_text(stderr, decimals, glyphs)
    return text if numbers.has_digits(text) else numbers.scientific(stderr, 1, glyphs)


def deviation(figure: StudyFigure, lane: LaneStudy) -> tuple[float, float] | None:
    """Return by how many standard deviations of the seeds this seed is above the mean, and that deviation.

    None where it is not known, or where all seeds agree.
    """
    estimate, own = lane.estimates.get(figure.id), lane.this_seed.get(figure.id)
    if estimate is None or estimate.stderr is None or own is None:
        return None
    spread = estimate.stderr * math.sqrt(estimate.count)
    if spread < numbers.NEGLIGIBLE or not math.isfinite(own):
        return None
    return (own - estimate.mean) / spread, spread


@dataclass(frozen=True, slots=True)
class Verdict:
    """Which of two lanes has the better figure: the one shown or the other; None where neither is seen to.

    ``by`` is how much better it is on average, at least 0, with ``stderr``, and ``better_in`` the seeds in
    which it is. One is better where 0 lies beyond two standard errors; else ``by`` is the figure of the lane
    shown less that of the other, and ``better_in`` counts the lane shown.
    """

    is_shown_better: bool | None
    by: float
    stderr: float
    better_in: int
    equal: int
    count: int


def verdict_of(figure: StudyFigure, difference: PairedDifference) -> Verdict | None:
    """Return what the differences say, the lane shown less the other; None for fewer than two seeds."""
    mean, stderr, count = difference.mean.mean, difference.mean.stderr, difference.mean.count
    if stderr is None:
        return None
    lower = count - difference.greater - difference.equal
    better, worse = (lower, difference.greater) if figure.lower_is_better else (difference.greater, lower)
    gain = -mean if figure.lower_is_better else mean
    if abs(gain) <= max(2.0 * stderr, numbers.NEGLIGIBLE):
        return Verdict(None, mean, stderr, better, difference.equal, count)
    return Verdict(gain > 0.0, abs(gain), stderr, better if gain > 0.0 else worse, difference.equal, count)
