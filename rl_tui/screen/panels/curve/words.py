"""The wording of the return curve, once: its titles, names of lines and remarks, each with shorter forms."""

from __future__ import annotations

from typing import Final

from rl_tui.screen.kit.panel import MAY_NEVER_END

RETURN_TITLES: Final = ("Return per episode", "Return")
REWARD_TITLE: Final = "Reward per pull"
SWEEP_TITLES: Final = ("Greedy return, exact, per sweep", "Greedy return per sweep", "Greedy return")
TITLES: Final = {"episode": RETURN_TITLES, "pull": (REWARD_TITLE,), "sweep": SWEEP_TITLES}
"""By what the horizontal axis counts, the longest form first."""

GREEDY: Final = "greedy, exact"
GREEDY_ARM: Final = "greedy arm, exact"
OPTIMUM: Final = "best for this γ"
SHORT_OPTIMUM: Final = "γ-best"
BEST_ARM: Final = "best arm"
TIES: Final = "greedy: ties"
NEVER_ENDS: Final = "never ends"
NO_END: Final = "no end"

HIDDEN_ARMS: Final = (
    "h adds the best arm and the greedy arm, exact",
    "h adds best and greedy arm",
    "h adds the best arm",
)
HIDDEN_OPTIMUM: Final = (
    "h adds what is best for this γ, exact",
    "h adds what is best for γ",
    "h adds γ-best",
)
KEPT_BACK: Final = ("the lesson keeps back what is exact", "what is exact: later")

COST_AT_PAUSE: Final = ("pause to see what exploring costs", "pause: what exploring costs")
COST_BY_KEY: Final = ("P: what exploring costs", "P: exploring")
BELOW_AXIS: Final = "below the axis"
NO_LINE_WITHOUT_TABLE: Final = (
    "no greedy line: no table was found in your program",
    "no table: no greedy line",
    "no table",
)
NO_LINE_WITHOUT_END: Final = (
    f"no greedy line where that policy {MAY_NEVER_END}: it has no return there",
    f"no greedy line where it {MAY_NEVER_END}",
    f"no line: {MAY_NEVER_END}",
)

NO_SWEEP_YET: Final = ("no sweep has ended yet:", "space runs, e runs one sweep")
NO_PULL_YET: Final = ("no arm has been pulled yet:", "space runs, s pulls once")
NO_EPISODE_YET: Final = ("no episode has ended yet:", "space runs, e runs one episode")
NOTHING_LEARNED: Final = "nothing learned"
NO_REWARD: Final = "no reward seen yet"

ONE_SEED: Final = "one seed"
COUNTS_SEEDS: Final = "; M counts many"
BESIDE_NAMES: Final = "beside names"
EQUAL_STEPS: Final = (
    "lanes take the same number of steps, so one may have finished more episodes",
    "lanes take equal steps, not equal episodes",
)
