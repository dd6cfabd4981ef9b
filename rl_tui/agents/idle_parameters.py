"""Hyper-parameters that change nothing as things stand, and why."""

from __future__ import annotations

from typing import Final

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Hyperparameters

_LOOKS_AHEAD: Final = {
    "gamma": "every pull ends its episode, so there is no later reward to discount",
    "lambda": "every pull ends its episode, so no earlier step can be taught",
    "traces": "every pull ends its episode, so no earlier step can be taught",
    "n": "every pull ends its episode, so there is one reward to gather",
}


def why_idle(name: str, algorithm: str, values: Hyperparameters, *, is_bandit: bool) -> str:
    """Return why the parameter ``name``, one of those of ``algorithm``, changes nothing; empty if it does.

    ``is_bandit``: every step ends its episode.
    """
    if is_bandit and not algorithm_row(algorithm).planner and name in _LOOKS_AHEAD:
        return _LOOKS_AHEAD[name]
    match name:
        case "traces" if values.lambda_ == 0.0:
            return "λ is 0, so there are no traces"
        case "step_size_schedule" if values.alpha == SAMPLE_AVERAGE:
            return "α is the sample average"
        case "alpha_min" | "alpha_decay" if values.sample_average:
            return "α is the sample average"
        case "step_size_schedule" | "alpha_min" if values.alpha_decay == 0.0 and not values.sample_average:
            return "the decay of α is 0, so α is constant"
        case "epsilon_schedule" | "epsilon_min" if values.epsilon_decay == 0.0:
            return "the decay of ε is 0, so ε is constant"
        case "alpha_min" | "alpha_decay" if values.step_size_schedule == "constant":
            return "the schedule of α is constant"
        case "epsilon_min" | "epsilon_decay" if values.epsilon_schedule == "constant":
            return "the schedule of ε is constant"
        case _:
            return ""
