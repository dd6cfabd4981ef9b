"""What is to be said below the figures of a study: how usual this seed is, and what its numbers mean."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.many_seeds.figures import SeedStudy
from rl_tui.lab.run.bandit import true_means
from rl_tui.lab.run.history import RECENT
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.pieces import Line, kept, wrapped
from rl_tui.tui.panels.many_seeds.figures import (
    LEAST_SEEDS,
    REGRET,
    WINNINGS,
    deviation,
    figure_decimals,
    figure_text,
    last_100_of,
)
from rl_tui.tui.panels.snapshot_facts import recent_name, shown_lane
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

ABOVE_BEST: Final = "is above the best arm's mean"


def remarks(study: SeedStudy, snapshot: Snapshot, look: Look, width: int, *, secret: bool) -> Iterator[Line]:
    """Yield the lines; ``secret`` says that a bandit's true means must not show."""
    palette, glyphs = look.palette, look.glyphs
    usual = "" if study.is_outdated else _how_usual(study, shown_lane(study, snapshot), glyphs, secret=secret)
    texts = [
        (_luck_now(snapshot, glyphs, secret=secret), palette.text),
        (usual, palette.text),
        (_luck_of_100(snapshot, glyphs, secret=secret), palette.text),
        (_arms(study, snapshot), palette.dim),
        (_meaning(study), palette.dim),
    ]
    for text, style in texts:
        if text:
            yield from wrapped(text, width, style, look, " ", "   ")


def _how_usual(study: SeedStudy, shown: int, glyphs: Glyphs, *, secret: bool) -> str:
    """Return how far this seed of the lane shown is from the mean, in standard deviations of the seeds."""
    lane, last_100 = study.lanes[shown], last_100_of(study)
    for figure in (last_100, WINNINGS) if secret else (REGRET, last_100, WINNINGS):
        found = deviation(figure, lane)
        if found is None:
            continue
        away, spread = found
        sizes = kept(f"(one is {figure_text(spread, figure_decimals(figure, study), glyphs)})")
        if abs(away) <= 1.0:
            return f"this seed is a usual one: its {figure.name} is within one standard deviation {sizes}"
        way = "above" if away > 0.0 else "below"
        return (
            f"this seed's {figure.name} is {numbers.fixed(abs(away), 1, glyphs)} standard deviations {sizes} "
            f"{way} the mean"
        )
    return ""


def _luck_now(snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return that the mean of the last 100 pulls is above the best arm's, where it is, and why."""
    mdp, recent = snapshot.world.mdp, snapshot.results.return_last_100
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    if not is_bandit or secret or mdp is None or mdp.drift_std > 0.0 or recent is None:
        return ""
    best = float(true_means(mdp).max())
    if recent <= best:
        return ""
    shown, above = (figure_text(each, 2, glyphs) for each in (recent, best))
    pulls = recent_name(snapshot.counters.episodes)
    return f"{pulls}, {shown}, {ABOVE_BEST}, {above}: {_noise(snapshot, glyphs)}"


def _luck_of_100(snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return that it may be, while the means are secret."""
    if not secret or snapshot.results.return_last_100 is None:
        return ""
    pulls = recent_name(snapshot.counters.episodes)
    return f"{pulls}: {_noise(snapshot, glyphs)}, so it can be above the best arm's mean"


def _noise(snapshot: Snapshot, glyphs: Glyphs) -> str:
    """Return how far the mean of the last pulls is off by luck; a number where all arms have one noise."""
    pulls = min(RECENT, snapshot.counters.episodes)
    noise = np.unique([] if snapshot.world.mdp is None else snapshot.world.mdp.reward_std)
    is_known = len(noise) == 1 and float(noise[0]) > 0.0  # or else it would tell which arm is pulled
    off = f" by about {figure_text(float(noise[0]) / math.sqrt(pulls), 2, glyphs)}" if is_known else ""
    return f"a mean of {pulls} noisy rewards is off{off} by luck alone"


def _arms(study: SeedStudy, snapshot: Snapshot) -> str:
    """Return whether the worlds of the seeds are different ones."""
    if not snapshot.recipe.scenario.section.drawn_from_seed:
        return ""
    what = "arms" if isinstance(snapshot.world.drawing, Arms) else "a world"
    return f"each seed draws {what} of its own"


def _meaning(study: SeedStudy) -> str:
    """Return what stands behind ±, and when a lane is called better."""
    error = "± is the standard error: how far a mean of so many seeds is typically off"
    pairs = (
        f"lanes are compared seed by seed; one is called better, from {LEAST_SEEDS} seeds on, "
        "where 0 is outside the brackets"
    )
    return error if len(study.lanes) == 1 else f"{error}; {pairs}"
