"""How the last action came about, in words."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.agents.last_step import LastStep
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.last_step.update_text import setting
from rl_tui.tui.theme.glyphs import Glyphs


def choice_text(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> tuple[str, str]:
    """Return how the action came about, in full and in short."""
    if last.by_hand:
        return "you chose it", "by you"
    _, params = snapshot.learned_by
    rule = RULE_BY_ID[params.policy]
    if "epsilon" in rule.parameters:
        return _epsilon_greedy(snapshot, last, glyphs)
    values = [
        f"{PARAMETERS[name].symbol} = {_value(params.value(name), glyphs)}"
        for name in rule.parameters
        if PARAMETERS[name].slide is not None
    ]
    rule_text = f"{rule.name} ({', '.join(values)})" if values else rule.name
    if last.explored:
        return f"{rule_text}, not the greedy one", f"{rule.name}, not greedy"
    return f"{rule_text}, the greedy one", f"{rule.name}, greedy"


def _value(value: float | str, glyphs: Glyphs) -> str:
    return value if isinstance(value, str) else setting(value, glyphs)


def _epsilon_greedy(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> tuple[str, str]:
    best = _greedy_before(snapshot, last)
    epsilon = setting(last.epsilon, glyphs)
    if last.explored:
        luck = ", greedy by chance" if last.pair in best else ""
        return f"random (ε = {epsilon}){luck}", f"explored{luck}"
    if len(best) > 1:
        return f"greedy (ε = {epsilon}), one of {len(best)} equal", f"greedy, {len(best)} equal"
    return f"greedy (ε = {epsilon})", "greedy"


def _greedy_before(snapshot: Snapshot, last: LastStep) -> list[int]:
    """Return the pairs that were greedy when the action was chosen, that is before the update.

    None are known where the step changed more than one estimate, or one of two tables.
    """
    if last.others or last.table:
        return []
    pairs = snapshot.world.space.pairs_of(last.state)
    estimates = snapshot.q[pairs.start : pairs.stop].copy()
    if last.updated_pair in pairs:
        estimates[last.updated_pair - pairs.start] = last.before
    best = [pairs.start + int(each) for each in np.flatnonzero(estimates == estimates.max())]
    return best if last.explored or last.pair in best else []  # chosen before the last update but one
