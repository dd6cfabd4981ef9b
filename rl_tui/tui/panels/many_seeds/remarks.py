"""What is to be said below the figures of a study: how usual this seed is, and what its numbers mean."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.many_seeds.figures import SeedStudy
from rl_tui.lab.run.bandit import true_means
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.pieces import KEPT_BLANK, Line, wrapped
from rl_tui.tui.panels.many_seeds.figures import (
    LAST_100,
    REGRET,
    WINNINGS,
    decimals_of,
    deviation,
    figure_text,
)
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

_RECENT: Final = 100  # episodes in the mean of the last


def remarks(study: SeedStudy, snapshot: Snapshot, look: Look, width: int, *, secret: bool) -> Iterator[Line]:
    """Yield the lines; ``secret`` says that a bandit's true means must not show."""
    palette, glyphs = look.palette, look.glyphs
    own = [] if study.is_outdated else [(_how_usual(study, glyphs, secret=secret), palette.text)]
    texts = [
        *own,
        (_noise(study, snapshot, glyphs, secret=secret), palette.text),
        (_arms(study, snapshot), palette.dim),
        (_meaning(study), palette.dim),
    ]
    for text, style in texts:
        if text:
            yield from wrapped(text, width, style, look, " ", "   ")


def _how_usual(study: SeedStudy, glyphs: Glyphs, *, secret: bool) -> str:
    """Return how far this seed of the lane shown is from the mean, in standard deviations of the seeds."""
    lane = study.lanes[study.shown]
    for figure in (LAST_100, WINNINGS) if secret else (REGRET, LAST_100, WINNINGS):
        found = deviation(figure, lane)
        if found is None:
            continue
        away, spread = found
        sizes = f"(one is {figure_text(spread, decimals_of(figure, study.lanes), glyphs)})"
        sizes = sizes.replace(" ", KEPT_BLANK)
        if abs(away) <= 1.0:
            return f"this seed is a usual one: its {figure.name} is within one standard deviation {sizes}"
        way = "above" if away > 0.0 else "below"
        return (
            f"this seed's {figure.name} is {numbers.fixed(abs(away), 1, glyphs)} standard deviations {sizes} "
            f"{way} the mean"
        )
    return ""


def _noise(study: SeedStudy, snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return why the mean of the last 100 pulls of a bandit may be above the best arm's."""
    mdp, recent = snapshot.world.mdp, snapshot.results.return_last_100
    if not isinstance(snapshot.world.drawing, Arms) or mdp is None or recent is None:
        return ""
    pulls = min(_RECENT, snapshot.counters.episodes)
    noise = np.unique(mdp.reward_std)
    # one and the same for all arms, or else it would tell of the arm that is pulled
    is_known = len(noise) == 1 and float(noise[0]) > 0.0
    off = f" by about {figure_text(float(noise[0]) / math.sqrt(pulls), 2, glyphs)}" if is_known else ""
    luck = f"a mean of {pulls} noisy rewards is off{off} by luck alone"
    if secret or mdp.drift_std > 0.0:
        return f"last 100: {luck}, so it can be above the best arm's mean"
    best = float(true_means(mdp).max())
    if recent <= best:
        return ""
    shown, above = (figure_text(each, 2, glyphs) for each in (recent, best))
    return f"last 100, {shown}, is above the best arm's mean, {above}: {luck}"


def _arms(study: SeedStudy, snapshot: Snapshot) -> str:
    """Return whether the worlds of the seeds are different ones."""
    if not snapshot.recipe.scenario.section.drawn_from_seed:
        return ""
    what = "arms" if isinstance(snapshot.world.drawing, Arms) else "a world"
    return f"each seed draws {what} of its own"


def _meaning(study: SeedStudy) -> str:
    """Return what stands behind ±, and in brackets."""
    error = "± is the standard error: how far a mean of so many seeds is typically off"
    pairs = "lanes are compared seed by seed; in brackets two standard errors on either side"
    return error if len(study.lanes) == 1 else f"{error}; {pairs}"
