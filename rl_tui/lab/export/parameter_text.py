"""The hyper-parameters of an agent as the constants of a script, and the expressions that use them."""

from __future__ import annotations

import re
from typing import Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters

_NAMES: Final = {"n": "STEPS"}
_SCHEDULES: Final = {
    "epsilon": ("epsilon_schedule", "epsilon_min", "epsilon_decay"),
    "alpha": ("step_size_schedule", "alpha_min", "alpha_decay"),
}


class ParameterText:
    """The hyper-parameters of one algorithm, in the words of a script."""

    def __init__(self, algorithm: str, hyperparameters: Hyperparameters) -> None:
        self.algorithm = BY_ID[algorithm]
        self.policy = POLICY_BY_ID[hyperparameters.policy]
        self.hyperparameters = hyperparameters
        self.used = parameters_of(algorithm, hyperparameters.policy)
        self.sample_average = hyperparameters.sample_average and not self.algorithm.planner

    @property
    def flags(self) -> set[str]:
        """What lines of a text may be for: the words chosen, such as ``ties first``, and the step size."""
        words = {
            f"{name} {self.hyperparameters.value(name)}"
            for name, parameter in PARAMETERS.items()
            if not (parameter.range or parameter.schedule)
        }
        return {*words, "sample average"} if self.sample_average else words

    def constants(self, episodes: int, seed: int, episodes_of_run: int = 0) -> str:
        """Return the lines of the constants, each with what it is beside it.

        ``episodes_of_run`` are those of the run on screen, which had another number mostly; 0: not known.
        """
        constants = [*self._parameters()]
        if not self.algorithm.planner:
            other = f" (the run had {episodes_of_run:,})" if episodes_of_run not in (0, episodes) else ""
            constants.append(("EPISODES", f"{episodes:_}", f"how many episodes to train{other}"))
        constants.append(("SEED", str(seed), "where all randomness comes from"))
        width = max(len(f"{name} = {value}") for name, value, _ in constants)
        return "\n".join(f"{f'{name} = {value}':<{width}}  # {text}" for name, value, text in constants)

    def _parameters(self) -> list[tuple[str, str, str]]:
        # What is a word and no number is in the text itself
        skipped = {"initial_q", *(name for name in self.used if PARAMETERS[name].range is None)}
        for name, parts in _SCHEDULES.items():
            if not self.is_scheduled(name):
                skipped.update(parts)
        if self.sample_average:
            skipped.update(("alpha", *_SCHEDULES["alpha"]))
        names = [name for name in self.used if name not in skipped]
        if "gamma" not in names:
            names.insert(0, "gamma")
        return [self._constant(name) for name in [*names, "initial_q"]]

    def _constant(self, name: str) -> tuple[str, str, str]:
        parameter = PARAMETERS[name]
        symbol = "" if parameter.symbol in (name, "planning", "accuracy") else f"{parameter.symbol}, "
        return self.name_of(name), repr(self.hyperparameters.value(name)), f"{symbol}{parameter.help}"

    def name_of(self, name: str) -> str:
        """Return what the constant of a hyper-parameter is called."""
        return _NAMES.get(name, name.upper())

    def is_scheduled(self, name: str) -> bool:
        """Return True if ``name``, epsilon or alpha, changes from episode to episode."""
        schedule, _, decay = _SCHEDULES[name]
        if name not in self.used or (name == "alpha" and self.sample_average):
            return False
        return self.hyperparameters.value(schedule) != "constant" and self.hyperparameters.value(decay) != 0.0

    def schedules(self) -> str:
        """Return the lines at the start of an episode that say what a schedule makes of ε and α."""
        return "\n".join(self._schedule(name) for name in _SCHEDULES if self.is_scheduled(name))

    def in_episode(self, text: str) -> str:
        """Return ``text`` with ``epsilon`` for ``EPSILON``, and so for α, where a schedule changes it."""
        for name in filter(self.is_scheduled, _SCHEDULES):
            text = re.sub(rf"\b{name.upper()}\b", name, text)
        return text

    def _schedule(self, name: str) -> str:
        schedule, least, decay = _SCHEDULES[name]
        start, end, fall = (self.name_of(each) for each in (name, least, decay))
        if self.hyperparameters.value(schedule) == "exponential":
            return f"{name} = {end} + ({start} - {end}) * np.exp(-{fall} * episode)"
        if float(self.hyperparameters.value(name)) >= float(self.hyperparameters.value(least)):
            return f"{name} = max({end}, {start} - {fall} * episode)"
        return f"{name} = min({end}, {start} + {fall} * episode)"

    @property
    def counts_visits(self) -> bool:
        """Whether the script counts how often each pair is taken."""
        averages = self.sample_average and not self.algorithm.counts_updates
        return averages or (self.policy.counts_visits and not self.algorithm.planner)
