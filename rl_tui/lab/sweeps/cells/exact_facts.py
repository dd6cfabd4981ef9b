"""The exact answers of one world that all runs in it are held against."""

from __future__ import annotations

import threading
from functools import cached_property
from typing import Final

from rl_tui.agents.exact.policies import uniform_policy
from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.exact.solution import Solution
from rl_tui.agents.exact.solve import best_expected_return
from rl_tui.lab.run.figures import MOST_STATES, optimum_of
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

_MOST_GAMMAS: Final = 64


class ExactFacts:
    """The exact answers of the table ``mdp``, each worked out once; None where there is no exact answer.

    Safe to be asked from several threads.
    """

    def __init__(self, mdp: TabularMDP | None) -> None:
        self.mdp = None if mdp is None or mdp.states > MOST_STATES else mdp
        """The table; None where there is none, or where it is too large for exact figures."""
        self._optima: dict[float, Solution | None] = {}
        self._lock = threading.RLock()

    def optimum(self, gamma: float) -> Solution | None:
        """Return the optimal values for ``gamma``."""
        with self._lock:
            if gamma not in self._optima:
                if len(self._optima) == _MOST_GAMMAS:
                    self._optima.clear()
                self._optima[gamma] = optimum_of(self.mdp, gamma)
            return self._optima[gamma]

    @property
    def best(self) -> float | None:
        """What the best policy that may look at the clock earns in an episode."""
        with self._lock:
            return self._best

    @property
    def random(self) -> float | None:
        """What a policy earns in an episode that takes any action at random."""
        with self._lock:
            return self._random

    @cached_property
    def _best(self) -> float | None:
        return None if self.mdp is None else best_expected_return(self.mdp)

    @cached_property
    def _random(self) -> float | None:
        return None if self.mdp is None else expected_return(self.mdp, uniform_policy(self.mdp))
