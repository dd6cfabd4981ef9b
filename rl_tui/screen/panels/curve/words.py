"""The wording of the curve, once: its titles, labels and notes, each with shorter forms."""

from __future__ import annotations

from typing import Final

from rl_tui.screen.kit.panel import MAY_NEVER_END

RETURN: Final = "Return"
REWARD: Final = "Reward"
STEPS: Final = "Steps"
SWEEPS: Final = "Greedy return"
TITLES: Final = {"episode": RETURN, "pull": REWARD, "sweep": SWEEPS}
"""By what the horizontal axis counts."""
MEAN: Final = "mean"
MEAN_AND_BAND: Final = "mean and middle half"
AFTER_SWEEP: Final = "exact, after each sweep"

GREEDY: Final = "greedy"
AGENT: Final = "agent"
OPTIMAL: Final = "optimal"
BEST_ARM: Final = ("best arm", "best")
RANDOM: Final = "random"
ACTING: Final = "acting"
DRAWN: Final = "drawn"
TIES: Final = "ties"
NEVER_ENDS: Final = "never ends"
NO_END: Final = "no end"

HIDDEN_ARMS: Final = ("h: show the best arm", "h: best arm")
HIDDEN_OPTIMUM: Final = ("h: show the optimal return", "h: optimal")
KEPT_BACK: Final = ("exact values: hidden by the lesson", "exact values: hidden")

COST_AT_PAUSE: Final = ("cost of exploring: when paused", "exploring: when paused")
COST_BY_KEY: Final = "P: cost of exploring"
NO_LINE_WITHOUT_TABLE: Final = ("no greedy line: your program has no table", "no table: no greedy line")
NO_LINE_WITHOUT_END: Final = (
    f"gap in greedy: that policy {MAY_NEVER_END}",
    f"gap in greedy: {MAY_NEVER_END}",
)

NO_SWEEP_YET: Final = ("no sweep has ended:", "space: run · e: sweep")
NO_PULL_YET: Final = ("no arm was pulled:", "space: run · s: pull")
NO_EPISODE_YET: Final = ("no episode has ended:", "space: run · e: episode")
NOTHING_LEARNED: Final = "nothing learned"
NO_REWARD: Final = "no reward yet"

ONE_SEED: Final = "one seed"
COUNTS_SEEDS: Final = "M: many seeds"
EQUAL_STEPS: Final = ("equal steps per run, not equal episodes", "equal steps per run")
