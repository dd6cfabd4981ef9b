"""The numbers of a world that have a slider, with their ranges."""

from __future__ import annotations

from typing import Final

from rl_tui.agents.hyperparameters import Parameter, Range, Slide
from rl_tui.common.limits import LARGEST_NUMBER, LARGEST_STD, LONGEST_TIME_LIMIT, STRONGEST_WIND

_ANY: Final = Range(-LARGEST_NUMBER, LARGEST_NUMBER)
_WIND: Final = Range(-STRONGEST_WIND, STRONGEST_WIND)

PAYS: Final = Parameter("pays", "pays", "reward: what it pays under the cursor", _ANY, slide=Slide(-10, 10))
NOISE: Final = Parameter(
    "noise", "noise", "noise: share of moves that slip, half of it to each side", Range(0, 1), slide=Slide()
)
LIVING: Final = Parameter(
    "step_reward", "living", "living reward: added to the reward of every step", _ANY, slide=Slide(-1, 1)
)
LIMIT: Final = Parameter(
    "time_limit",
    "limit",
    "time limit: steps after which an episode is truncated, 0 for none",
    Range(0, LONGEST_TIME_LIMIT),
    whole=True,
    slide=Slide(0, 500),
)
WIND: Final = Parameter(
    "wind",
    "wind ↑",
    "wind: cells that it pushes you up in the column of the cursor",
    _WIND,
    whole=True,
    slide=Slide(-3, 3),
)
WIND_ROWS: Final = Parameter(
    "wind_rows",
    "wind →",
    "wind: cells that it pushes you to the right in the row of the cursor",
    _WIND,
    whole=True,
    slide=Slide(-3, 3),
)
CHANCE: Final = Parameter(
    "chance",
    "chance",
    "chance: probability of the chosen outcome. The others share the rest",
    Range(0, 1),
    slide=Slide(),
)
MEAN: Final = Parameter(
    "mean", "mean", "mean: what the arm under the cursor pays on average", _ANY, slide=Slide(-3, 3)
)
SUCCESS: Final = Parameter(
    "mean", "mean", "mean: how often the arm under the cursor pays", Range(0, 1), slide=Slide()
)
SPREAD: Final = Parameter(
    "std", "std", "spread: standard deviation of the rewards", Range(0, LARGEST_STD), slide=Slide(0, 5)
)
DRIFT: Final = Parameter(
    "drift",
    "drift",
    "drift: standard deviation of the step that every mean takes after every pull",
    Range(0, LARGEST_STD),
    slide=Slide(),
)
