"""The policies that a person may ask about."""

from __future__ import annotations

from enum import StrEnum


class PolicyKind(StrEnum):
    """One policy of a world and of the agent in it."""

    UNIFORM = "uniform"  # every legal action as likely as any other
    OPTIMAL = "optimal"  # best for the γ in force
    GREEDY = "greedy"  # greedy for the estimates of this moment
    BEHAVIOUR = "behaviour"  # what the agent does now, exploring as it does
    DRAWN = "drawn"  # what a person drew
