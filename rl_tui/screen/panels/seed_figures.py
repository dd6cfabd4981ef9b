"""The figures of a many-seeds study."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from rl_tui.runs.history import RECENT
from rl_tui.runs.measures import MEASURES
from rl_tui.screen.draw import numbers
from rl_tui.screen.kit.snapshot_facts import recent_name
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.studies.many_seeds.figures import Estimate, LaneStudy, PairedDifference, SeedStudy, StudyState

_MOST_DECIMALS: Final = 5
_LARGEST: Final = 1e7  # longer numbers are abbreviated
_SHORT: Final = 7  # cells of an abbreviated number
LEAST_SEEDS: Final = 32  # required before one run is called better
INTERVAL_ERRORS: Final = 3.0
"""Standard errors around a difference. One run is better only if 0 is outside."""


@dataclass(frozen=True, slots=True)
class StudyFigure:
    """One figure of a study: its ``id`` in ``train --runs --json``, and its names.

    ``is_secret``: it reveals what a bandit's agent cannot know.
    """

    id: str
    name: str
    in_full: str
    is_secret: bool = False

    @property
    def lower_is_better(self) -> bool:
        """True if lower is better."""
        return MEASURES[self.id].larger_is_better is False


RETURN: Final = StudyFigure("return_mean", "return", "mean return")
LAST_100: Final = StudyFigure("return_last_100", "last 100", "last 100")
WINNINGS: Final = StudyFigure("winnings", "winnings", "winnings")
REGRET: Final = StudyFigure("regret", "regret", "regret", is_secret=True)
GREEDY: Final = StudyFigure("expected_return", "greedy", "greedy, exact", is_secret=True)
BEST_ARM: Final = StudyFigure("best_arm_rate", "best arm %", "best arm pulled, %", is_secret=True)
FIGURES: Final = (WINNINGS, REGRET, BEST_ARM, LAST_100, GREEDY, RETURN)
"""In display order. Other worlds than bandits have the last three."""


def may_count_again(study: SeedStudy | None) -> bool:
    """Return whether the study is over or outdated."""
    if study is None:
        return False
    settled = (StudyState.STARTING, StudyState.RUNNING, StudyState.REFUSED)
    return study.is_outdated or study.state not in settled


def last_100_of(study: SeedStudy) -> StudyFigure:
    """Return the figure of the last 100 episodes."""
    name = recent_name(RECENT if study.episodes is None else study.episodes)
    return replace(LAST_100, name=name, in_full=f"return of the {name}")


def until_of(study: SeedStudy, reached: Iterable[int]) -> str:
    """Return `` to 500`` unless all reached it."""
    is_bounded = study.episodes is not None and any(each != study.episodes for each in reached)
    return f" to {study.episodes:,}" if is_bounded else ""


def in_percent(study: SeedStudy) -> SeedStudy:
    """Return ``study`` with its shares in percent."""
    return replace(study, lanes=tuple(map(_lane_in_percent, study.lanes)))


def _lane_in_percent(lane: LaneStudy) -> LaneStudy:
    name = BEST_ARM.id
    if name not in lane.estimates:
        return lane

    def hundredfold(found: Estimate) -> Estimate:
        error = None if found.stderr is None else 100.0 * found.stderr
        return replace(found, mean=100.0 * found.mean, stderr=error)

    own, differences = lane.this_seed.get(name), dict(lane.differences)
    if name in differences:
        differences[name] = replace(differences[name], mean=hundredfold(differences[name].mean))
    return replace(
        lane,
        estimates={**lane.estimates, name: hundredfold(lane.estimates[name])},
        this_seed={**lane.this_seed, name: None if own is None else 100.0 * own},
        seeds={**lane.seeds, name: 100.0 * lane.seeds.get(name, np.empty(0))},
        differences=differences,
    )


def shown_figures(study: SeedStudy, *, secret: bool) -> list[StudyFigure]:
    """Return the figures, except hidden and redundant ones."""
    has = {name for lane in study.lanes for name in lane.estimates}
    are_all = study.episodes is not None and study.episodes <= RECENT and LAST_100.id in has
    return [
        last_100_of(study) if figure is LAST_100 else figure
        for figure in FIGURES
        if figure.id in has
        and not (secret and figure.is_secret)
        and not (figure is RETURN and (are_all or WINNINGS.id in has))
    ]


def estimates_of(figure: StudyFigure, lanes: Iterable[LaneStudy]) -> list[Estimate]:
    """Return the known estimates."""
    return [lane.estimates[figure.id] for lane in lanes if figure.id in lane.estimates]


def figure_decimals(figure: StudyFigure, study: SeedStudy) -> int:
    """Return the decimals of a figure's texts."""
    pairs = [lane.differences[figure.id].mean for lane in study.lanes if figure.id in lane.differences]
    return decimals_of([*estimates_of(figure, study.lanes), *pairs])


def decimals_of(found: Sequence[Estimate]) -> int:
    """Return the smallest error's decimals: one digit, or two if the first is a 1."""
    errors = [each.stderr for each in found if each.stderr is not None and each.stderr > numbers.NEGLIGIBLE]
    if errors:
        return min(_MOST_DECIMALS, max(0, -math.floor(math.log10(min(errors) / 2.0))))
    return next((d for d in range(3) if all(abs(round(e.mean, d) - e.mean) < 1e-6 for e in found)), 3)


def figure_text(x: float | None, decimals: int, glyphs: Glyphs) -> str:
    """Write ``−47.1``, ``.82``, or a dash."""
    if x is None or not math.isfinite(x):
        return numbers.missing(glyphs)
    if abs(x) >= _LARGEST:
        return numbers.value(x, _SHORT, glyphs)
    text = f"{abs(x):,.{decimals}f}"
    text = f".{text.removeprefix('0.')}" if text.startswith("0.") else text
    return f"{glyphs.minus}{text}" if x < 0.0 and numbers.has_digits(text) else text


def estimate_text(estimate: Estimate | None, decimals: int, glyphs: Glyphs) -> str:
    """Write ``−47.1 ± .5``: mean and standard error."""
    if estimate is None:
        return figure_text(None, decimals, glyphs)
    mean = figure_text(estimate.mean, decimals, glyphs)
    return mean if estimate.stderr is None else f"{mean} ± {error_text(estimate.stderr, decimals, glyphs)}"


def error_text(stderr: float, decimals: int, glyphs: Glyphs) -> str:
    """Write a standard error, scientific if ``decimals`` are too few."""
    if stderr < numbers.NEGLIGIBLE:
        return "0"
    text = figure_text(stderr, decimals, glyphs)
    return text if numbers.has_digits(text) else numbers.scientific(stderr, 1, glyphs)


def deviation(figure: StudyFigure, lane: LaneStudy) -> tuple[float, float] | None:
    """Return this seed's standard score, and one standard deviation."""
    estimate, own = lane.estimates.get(figure.id), lane.this_seed.get(figure.id)
    if estimate is None or estimate.stderr is None or own is None:
        return None
    spread = estimate.stderr * math.sqrt(estimate.count)
    if spread < numbers.NEGLIGIBLE or not math.isfinite(own):
        return None
    return (own - estimate.mean) / spread, spread


@dataclass(frozen=True, slots=True)
class Verdict:
    """The comparison of two runs by one figure, so far.

    ``by``: average advantage ≥ 0. ``better_in``: number of seeds. ``is_seen`` requires 32 seeds and 0 outside
    three standard errors: people watch a study grow, and every look is another chance to be wrong.
    """

    is_shown_better: bool
    is_seen: bool
    by: float
    stderr: float
    better_in: int
    equal: int
    count: int


def verdict_of(figure: StudyFigure, difference: PairedDifference) -> Verdict | None:
    """Compare two runs, from two seeds on."""
    mean, stderr, count = difference.mean.mean, difference.mean.stderr, difference.mean.count
    if stderr is None:
        return None
    is_shown_better = mean <= 0.0 if figure.lower_is_better else mean >= 0.0
    is_greater_better = is_shown_better is not figure.lower_is_better
    lower = count - difference.greater - difference.equal
    return Verdict(
        is_shown_better,
        count >= LEAST_SEEDS and abs(mean) > max(INTERVAL_ERRORS * stderr, numbers.NEGLIGIBLE),
        abs(mean),
        stderr,
        difference.greater if is_greater_better else lower,
        difference.equal,
        count,
    )
