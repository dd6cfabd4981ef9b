"""What works out the flips of a world, in a process of its own or where all else waits for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.lab.answers.flip_answer import FlipAnswer, FlipState, OptimalValueCurves, as_json, refused
from rl_tui.lab.workers.answering import answer, bound_processor_time

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

GAMMAS: Final = 200
"""Equal parts of 0 to 1 at whose ends Q* is worked out: more than a chart has columns of dots."""
MOST_VALUES: Final = 300_000
"""Of all pairs at all γ, which are one message: a world of very many actions has fewer γ."""
MOST_SECONDS: Final = 300
"""Of a processor. The dearest of the shipped worlds takes 5."""
_LONGEST_REASON: Final = 200


def main() -> None:
    """Work out what stdin asks for, and end when that is done or stdin ends, be it in the middle."""
    answer(_work)


def _work(mdp: TabularMDP, tell: Callable[[dict[str, Any]], None]) -> None:
    from rl_tui.common.findings import one_line

    bound_processor_time(MOST_SECONDS)
    try:
        tell(as_json(worked_out(mdp)))
    except Exception as error:
        tell(as_json(refused(one_line(f"{type(error).__name__}: {error}", _LONGEST_REASON))))


def worked_out(mdp: TabularMDP) -> FlipAnswer:
    """Return all flips of ``mdp`` and Q* from γ = 0 to 1, or why there are none."""
    from rl_tui.agents.exact.flips.flips import flips
    from rl_tui.agents.exact.solution import NoExactAnswer

    try:
        found = flips(mdp)
    except NoExactAnswer as reason:
        return refused(str(reason))
    return FlipAnswer(FlipState.KNOWN, flips=found, curves=optimal_value_curves(mdp))


def optimal_value_curves(mdp: TabularMDP) -> OptimalValueCurves:
    """Return Q* from γ = 0 to 1, where there is one at 1, else to the last γ that has one."""
    from rl_tui.agents.exact.exact_model import exact_model
    from rl_tui.agents.exact.policy_iteration import policy_iteration
    from rl_tui.agents.exact.solution import NoExactAnswer

    model = exact_model(mdp)
    gammas, q = list[float](), list[Any]()
    parts = min(GAMMAS, max(2, MOST_VALUES // mdp.pairs))
    for part in range(parts + 1):
        gamma = part / parts
        try:
            optimum = policy_iteration(model, gamma)
        except NoExactAnswer:
            break
        gammas.append(gamma)
        q.append((optimum.v[model.pair_state] + optimum.advantage).astype(np.float64))
    return OptimalValueCurves(np.array(gammas), np.array(q))
