"""What the policies that a person may ask about are called."""

from __future__ import annotations

from typing import Final, NamedTuple

from rl_tui.runs.answers.policy_kind import PolicyKind


class PolicyName(NamedTuple):
    """``row`` names it in a table, ``line`` at the end of a line of the curve, ``of`` behind ``V of``."""

    row: str
    line: str
    of: str


POLICY_NAMES: Final = {
    PolicyKind.UNIFORM: PolicyName("uniform random", "uniform", "uniform random"),
    PolicyKind.GREEDY: PolicyName("greedy now", "greedy", "greedy now"),
    PolicyKind.BEHAVIOUR: PolicyName("as it acts now", "as it acts", "the agent as it acts"),
    PolicyKind.OPTIMAL: PolicyName("optimal", "optimal", "the optimal policy"),
    PolicyKind.DRAWN: PolicyName("drawn", "drawn", "the drawn policy"),
}
"""In the order in which they are listed."""
