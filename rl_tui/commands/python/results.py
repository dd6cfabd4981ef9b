"""Result classes of the Python functions.

S is the number of states, A the number of actions. Arrays [S, A] hold NaN, or −1, where an action is not
available. Expected values are None without an exact answer.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from rl_tui.common.errors import UserError

# Printing as a short table


class ShortTable:
    """A result that prints as a short table."""

    @abstractmethod
    def _caption(self) -> str:
        """Return the title line."""

    @abstractmethod
    def _rows(self) -> Sequence[Sequence[str]]:
        """Return rows of equal length. The first cell of a row is its name."""

    def __str__(self) -> str:
        rows = self._rows()
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
        return "\n".join((self._caption(), *lines))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the table as escaped HTML."""
        body = "".join(
            f"<tr><th>{escape(first)}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in others)}</tr>"
            for first, *others in self._rows()
        )
        return f"<table><caption>{escape(self._caption())}</caption><tbody>{body}</tbody></table>"


class Drawable(ShortTable):
    """A result with a picture, and a table of pandas."""

    @abstractmethod
    def plot(self) -> ResultPlot:
        """Return the picture of the result."""

    @abstractmethod
    def to_pandas(self) -> Any:
        """Return the result as a DataFrame. Raises rl_tui.Error if pandas is not installed."""

    def _repr_svg_(self) -> str | None:
        try:
            return self.plot().svg
        except UserError:  # there is nothing to draw
            return None


def figure(value: float | str | None) -> str:
    """Return a number with five digits, or a dash for None."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else format(value, ",d" if isinstance(value, int) else ".5g")


# The results


if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from rl_tui.commands.python.plots import ResultPlot

    FloatArray = npt.NDArray[np.float64]
    IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True, repr=False, eq=False)
class TrainResult(Drawable):
    """One trained agent, compared with the exact answer: the data of ``rl-tui train --json``."""

    scenario: str
    algorithm: str
    seed: int
    hyperparameters: Mapping[str, float | str]
    """Every hyperparameter by name, including the scenario's own values."""
    without_effect: tuple[str, ...]
    """Given settings that neither the algorithm nor its policy uses."""
    states: tuple[str, ...]
    """State names, [S]."""
    actions: tuple[str, ...]
    """Action names, [A]."""
    q: FloatArray
    """Estimates, [S, A]; NaN where an action is not available."""
    visits: IntArray
    """Number of times each pair was taken, [S, A]; −1 where an action is not available."""
    policy: FloatArray
    """Greedy policy of `q` as probabilities, [S, A]. Ties share evenly. Terminal states have only zeros."""
    returns: FloatArray
    """Undiscounted return of each finished episode, [E]. Empty for a planner."""
    lengths: IntArray
    """Length of each finished episode in steps, [E]."""
    steps: int
    episodes: int
    seconds: float
    """Training time in seconds, without compiling."""
    expected_return: float | None
    """Undiscounted return of the greedy policy within the time limit, exact."""
    best_expected_return: float | None
    """Best possible undiscounted return within the time limit."""
    value_at_start: float | None
    """Discounted value of the greedy policy at the start, exact."""
    optimal_value_at_start: float | None
    """Discounted optimal value at the start."""
    max_error: float | None
    """Largest |Q − Q*| over all available pairs."""
    greedy_ends: float | None
    """Probability that an episode of the greedy policy ends, 0 to 1."""
    return_last_100: float | None
    """Mean return of the last 100 episodes, with exploration."""
    figures: Mapping[str, Any]
    """The complete document of ``rl-tui train --json``."""

    def plot(self, measure: str | None = None) -> ResultPlot:
        """Return the learning curve: means over at most 200 bins of episodes.

        Args:
            measure: ``"return_mean"`` (None) or ``"length_mean"``.

        Raises:
            rl_tui.Error: The measure is unknown, or no episode was finished.
        """
        from rl_tui.commands.python.plots import curve_of_episodes, plot_of_curve

        return plot_of_curve(self._caption(), curve_of_episodes(self.returns, self.lengths), None, measure)

    def to_pandas(self) -> Any:
        """Return a DataFrame of the episodes: return and length. Raises rl_tui.Error without pandas."""
        from rl_tui.commands.python.plots import pandas_module

        frame = pandas_module().DataFrame({"return": self.returns, "length": self.lengths})
        frame.index = frame.index.rename("episode") + 1
        return frame

    def _caption(self) -> str:
        return f"{self.scenario}: {self.algorithm}, seed {self.seed}"

    def _rows(self) -> Sequence[Sequence[str]]:
        rows = [
            ("episodes", figure(self.episodes), ""),
            ("steps", figure(self.steps), ""),
            ("expected return", figure(self.expected_return), f"of {figure(self.best_expected_return)}"),
            ("value at the start", figure(self.value_at_start), f"of {figure(self.optimal_value_at_start)}"),
            ("largest error of Q", figure(self.max_error), ""),
            ("return of the last 100", figure(self.return_last_100), "exploring"),
        ]
        return [*rows, *(("without effect", name, "") for name in self.without_effect)]


@dataclass(frozen=True, repr=False, eq=False)
class TrainResults(Drawable):
    """R runs of one agent with consecutive seeds: the data of ``rl-tui train --runs --json``.

    Arrays [R] hold NaN where a run lacks the number.
    """

    scenario: str
    algorithm: str
    hyperparameters: Mapping[str, float | str]
    """Every hyperparameter by name, including the scenario's own values."""
    without_effect: tuple[str, ...]
    """Given settings that neither the algorithm nor its policy uses."""
    seeds: IntArray
    """Seed of each run, [R]."""
    expected_return: FloatArray
    """Undiscounted return of each greedy policy within the time limit, exact, [R]."""
    best_expected_return: float | None
    """Best possible undiscounted return; None if each seed has its own world."""
    value_at_start: FloatArray
    """Discounted value of each greedy policy at the start, exact, [R]."""
    max_error: FloatArray
    """Largest |Q − Q*| over all available pairs, [R]."""
    return_last_100: FloatArray
    """Mean return of the last 100 episodes of each run, with exploration, [R]."""
    runs: tuple[Mapping[str, Any], ...]
    """All numbers of each run, by name."""
    summary: Mapping[str, Mapping[str, float | int | None]]
    """For each number over all runs: mean, stderr (n − 1), min, max and count of runs that have it."""
    curve: Mapping[str, FloatArray]
    """Mean learning curve in at most 200 bins of episodes: name → array over the bins."""
    seconds: float
    """Time of all runs together, in seconds."""
    figures: Mapping[str, Any]
    """The complete document of ``rl-tui train --runs --json``."""

    def plot(self, measure: str | None = None) -> ResultPlot:
        """Return the mean learning curve, with its 95 % interval.

        Args:
            measure: ``"return_mean"`` (None), ``"length_mean"``, or ``"optimal_action_rate"`` of a bandit.

        Raises:
            rl_tui.Error: The measure is unknown, or no episode was finished.
        """
        from rl_tui.commands.python.plots import plot_of_curve

        return plot_of_curve(self._caption(), self.curve, len(self), measure)

    def to_pandas(self) -> Any:
        """Return a DataFrame of the runs: all their numbers, by seed. Raises rl_tui.Error without pandas."""
        from rl_tui.commands.python.plots import pandas_module

        return pandas_module().DataFrame(list(self.runs)).set_index("seed")

    def __len__(self) -> int:
        return len(self.runs)

    def _caption(self) -> str:
        seeds = f"seeds {self.seeds[0]} to {self.seeds[-1]}" if len(self) > 1 else f"seed {self.seeds[0]}"
        return f"{self.scenario}: {self.algorithm}, {seeds}"

    def _rows(self) -> Sequence[Sequence[str]]:
        keys = ("mean", "stderr", "min", "max", "count")
        rows: list[tuple[str, ...]] = [("", *keys)]
        for name, of_all in self.summary.items():
            if of_all["count"]:
                rows.append((name, *(figure(of_all[key]) for key in keys)))
        nothing = ("",) * (len(keys) - 1)
        return [*rows, *(("without effect", name, *nothing) for name in self.without_effect)]


@dataclass(frozen=True, repr=False, eq=False)
class SolveResult(Drawable):
    """Optimal values and policy, exact to 1e-9: the data of ``rl-tui solve --json``."""

    scenario: str
    gamma: float
    states: tuple[str, ...]
    """State names, [S]."""
    actions: tuple[str, ...]
    """Action names, [A]."""
    v: FloatArray
    """Optimal discounted value of each state, [S]; 0 in terminal states."""
    q: FloatArray
    """Optimal value of each action, [S, A]; NaN where an action is not available."""
    policy: FloatArray
    """Optimal policy as probabilities, [S, A]. Ties share evenly. Terminal states have only zeros."""
    value_at_start: float
    """Discounted optimal value at the start."""
    expected_return: float | None
    """Undiscounted return of this policy within the time limit."""
    best_expected_return: float | None
    """Best possible undiscounted return, also by policies that use the elapsed time."""
    figures: Mapping[str, Any]
    """The complete document of ``rl-tui solve --json``."""

    def plot(self) -> ResultPlot:
        """Return the values of the states. Raises rl_tui.Error if no state has one."""
        from rl_tui.commands.python.plots import plot_of_values

        return plot_of_values(self._caption(), self.v.tolist())

    def to_pandas(self) -> Any:
        """Return a DataFrame of the states: the value, then Q of each action.

        Raises:
            rl_tui.Error: pandas is not installed.
        """
        from rl_tui.commands.python.plots import state_frame

        return state_frame(self.states, self.v, self.actions, self.q)

    def _caption(self) -> str:
        return f"{self.scenario}: exact, gamma {self.gamma:g}"

    def _rows(self) -> Sequence[Sequence[str]]:
        return [
            ("value at the start", figure(self.value_at_start)),
            ("expected return", figure(self.expected_return)),
            ("best return", figure(self.best_expected_return)),
            ("states, actions", f"{len(self.states):,}, {len(self.actions):,}"),
        ]


@dataclass(frozen=True, repr=False, eq=False)
class EvaluateResult(Drawable):
    """Exact values of a policy: the data of ``rl-tui evaluate --json``."""

    scenario: str
    gamma: float
    policy_name: str
    """Name of the policy: a word, a file, "trained" or "array"."""
    epsilon: float
    """Probability that a random action replaces the policy's."""
    states: tuple[str, ...]
    """State names, [S]."""
    actions: tuple[str, ...]
    """Action names, [A]."""
    policy: FloatArray
    """Probability of each action, random ones included, [S, A]; NaN where not available."""
    v: FloatArray
    """Discounted value of each state, [S]; NaN if it does not exist."""
    value_at_start: float | None
    """Discounted value at the start."""
    expected_return: float | None
    """Undiscounted return of an episode within the time limit."""
    steps: float | None
    """Expected length of an episode, in steps."""
    ends: float | None
    """Probability that an episode ends, 0 to 1."""
    figures: Mapping[str, Any]
    """The complete document of ``rl-tui evaluate --json``."""

    def plot(self) -> ResultPlot:
        """Return the values of the states. Raises rl_tui.Error if no state has one."""
        from rl_tui.commands.python.plots import plot_of_values

        return plot_of_values(self._caption(), self.v.tolist())

    def to_pandas(self) -> Any:
        """Return a DataFrame of the states: the value, then the probability of each action.

        Raises:
            rl_tui.Error: pandas is not installed.
        """
        from rl_tui.commands.python.plots import state_frame

        return state_frame(self.states, self.v, self.actions, self.policy)

    def _caption(self) -> str:
        mixed = f", epsilon {self.epsilon:g}" if self.epsilon else ""
        return f"{self.scenario}: policy {self.policy_name}{mixed}, gamma {self.gamma:g}"

    def _rows(self) -> Sequence[Sequence[str]]:
        return [
            ("value at the start", figure(self.value_at_start)),
            ("expected return", figure(self.expected_return)),
            ("steps of an episode", figure(self.steps)),
            ("chance to end", figure(self.ends)),
        ]


@dataclass(frozen=True, repr=False)
class ScenarioInfo(ShortTable):
    """Sizes of a scenario, and its default training."""

    id: str
    title: str
    kind: str
    """grid, mdp, bandit or gymnasium."""
    states: int
    actions: int
    pairs: int
    """Number of available state–action pairs."""
    time_limit: int
    """Steps after which an episode is truncated; 0: none."""
    defaults: Mapping[str, Any]
    """Algorithm, episodes and every hyperparameter, by name."""

    def _caption(self) -> str:
        return f"{self.id}: {self.title}"

    def _rows(self) -> Sequence[Sequence[str]]:
        return [
            ("states, actions, pairs", f"{self.states:,}, {self.actions:,}, {self.pairs:,}"),
            ("time limit", figure(self.time_limit or None)),
            ("algorithm", str(self.defaults["algorithm"])),
            ("episodes", figure(self.defaults["episodes"])),
        ]


class ScenarioTable(ShortTable, list[ScenarioInfo]):
    """A list of scenarios that prints as one table."""

    def to_pandas(self) -> Any:
        """Return a DataFrame of the scenarios, by id. Raises rl_tui.Error if pandas is not installed."""
        from rl_tui.commands.python.plots import pandas_module

        return pandas_module().DataFrame([vars(each) for each in self]).set_index("id")

    def _caption(self) -> str:
        return f"{len(self):,} scenarios"

    def _rows(self) -> Sequence[Sequence[str]]:
        head = ("id", "title", "states", "actions", "algorithm")
        return [
            head,
            *(
                (
                    each.id,
                    each.title,
                    figure(each.states),
                    figure(each.actions),
                    str(each.defaults["algorithm"]),
                )
                for each in self
            ),
        ]
