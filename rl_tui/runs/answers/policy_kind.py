"""The policies whose values a user can ask for."""

from __future__ import annotations

from enum import StrEnum


class PolicyKind(StrEnum):
    """A policy of a world and its agent."""

    UNIFORM = "uniform"  # all available actions equally likely
    OPTIMAL = "optimal"  # optimal for the current γ
    GREEDY = "greedy"  # greedy for the current estimates
    BEHAVIOUR = "behaviour"  # what the agent does, including exploration
    DRAWN = "drawn"  # drawn by the user
