"""What is said of a figure: exact, sampled, learned or counted; discounted or not; within which limit."""

from __future__ import annotations

from typing import Final, NamedTuple

from rl_tui.common.words import counted
from rl_tui.tui.glossary.glossary import FigureFacts, FigureKind, FigureLimit

_KINDS: Final = {
    FigureKind.EXACT: "exact: worked out from the table of the world, not played",
    FigureKind.SAMPLED: "sampled: what this one run met, its luck included",
    FigureKind.LEARNED: "learned: the agent's estimate, as far as it has got",
    FigureKind.COUNTED: "counted",
}
_OF_SEEDS: Final = "sampled: over many seeds, each with luck of its own"
_LIMITS: Final = {
    FigureLimit.EPISODE: "within the time limit of an episode, if it has one",
    FigureLimit.NONE: "as if there were no time limit",
    FigureLimit.STEP: "of one step",
    FigureLimit.RUN: "over all of the run so far",
    FigureLimit.MOMENT: "of the last moments",
}


class FigureSetting(NamedTuple):
    """What is in force where a figure is asked about."""

    gamma: str
    """γ as it is written on screen."""
    time_limit: int
    """Steps after which an episode is cut off; 0: none."""
    steps: int
    """Steps taken so far."""
    episodes: int
    """Episodes that have ended."""
    is_bandit: bool = False
    """Whether each pull is an episode."""
    budget: int | None = None
    """Pulls that a bandit may take."""


def figure_text(facts: FigureFacts, now: FigureSetting | None = None) -> str:
    """Return a line about a figure, with the numbers of ``now`` where that is known."""
    kind = _OF_SEEDS if facts.over_seeds else _KINDS[facts.kind]
    parts = [kind, _discounted(facts, now), _limit(facts.limit, now), _mean(facts, now)]
    return " · ".join(filter(None, parts))


def _discounted(facts: FigureFacts, now: FigureSetting | None) -> str:
    if facts.discounted is None:
        return ""
    if not facts.discounted:
        return "undiscounted"
    if now is not None and now.is_bandit:
        return "nothing follows a pull, so nothing is discounted"
    return f"discounted, γ {now.gamma}" if now is not None else "discounted"


def _limit(limit: FigureLimit, now: FigureSetting | None) -> str:
    if now is None:
        return _LIMITS[limit]
    if limit is FigureLimit.RUN:
        if now.budget is None:
            return f"over the {counted(now.steps, 'step')} so far"
        return f"over {now.steps:,} of the budget of {counted(now.budget, 'pull')}"
    if limit not in (FigureLimit.EPISODE, FigureLimit.NONE):
        return _LIMITS[limit]
    if now.is_bandit:
        return "of one pull, which is an episode"
    if not now.time_limit:
        return "this world has no time limit"
    steps = f"this world's time limit of {counted(now.time_limit, 'step')}"
    return f"within {steps}" if limit is FigureLimit.EPISODE else f"as if {steps} were not there"


def _mean(facts: FigureFacts, now: FigureSetting | None) -> str:
    if facts.episodes is None:
        return ""
    last = facts.episodes if now is None else min(facts.episodes, now.episodes)
    noun = "pull" if now is not None and now.is_bandit else "episode"
    return f"mean of the last {counted(last, noun)}" if last else ""
