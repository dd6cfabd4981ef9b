"""The policies whose values a user can ask for."""

from __future__ import annotations

from enum import StrEnum
from typing import Final


class PolicyKind(StrEnum):
    """A policy of a world and its agent."""

    UNIFORM = "uniform"  # all available actions equally likely
    OPTIMAL = "optimal"  # optimal for the current γ
    GREEDY = "greedy"  # greedy for the current estimates
    BEHAVIOUR = "behaviour"  # what the agent does, including exploration
    DRAWN = "drawn"  # drawn by the user


PLANS: Final = "a planner takes no actions"
BROKE_DOWN: Final = "the estimates diverged"
"""Reasons why a policy of the agent has no values."""
