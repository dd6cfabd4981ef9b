"""Between which bounds the rewards of a world lie, worked out once for a world of any size."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class RewardRange(NamedTuple):
    """The least and the greatest mean reward, and the greatest standard deviation."""

    low: float
    high: float
    noise: float

    @property
    def has_one_sign(self) -> bool:
        """Whether rewards cannot cancel out."""
        return self.low >= 0.0 or self.high <= 0.0


@lru_cache(maxsize=1)  # one world is on screen; no other is kept alive
def reward_range(mdp: TabularMDP) -> RewardRange:
    """Return the range of the rewards of ``mdp``, which has at least one outcome."""
    return RewardRange(float(mdp.reward.min()), float(mdp.reward.max()), float(mdp.reward_std.max()))
