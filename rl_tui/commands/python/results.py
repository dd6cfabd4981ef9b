"""Results of training, solving and evaluating from Python, as arrays and numbers.

S is the number of states, A the number of actions. Arrays over [S, A] are NaN, or −1, where an action
is not available. Expected values are None without an exact answer.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

# Printing as a short table


class ShortTable:
    """What a result says of itself when it is printed, or is the last value of a notebook's cell."""

    @abstractmethod
    def _caption(self) -> str:
        """Return what it is the result of, in a line."""

    @abstractmethod
    def _rows(self) -> Sequence[Sequence[str]]:
        """Return the cells, all rows of equal length. The first of a row says what the others are."""

    def __str__(self) -> str:
        rows = self._rows()
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
        return "\n".join((self._caption(), *lines))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return it as a table of HTML; whatever stands in it is text there."""
        body = "".join(
            f"<tr><th>{escape(first)}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in others)}</tr>"
            for first, *others in self._rows()
        )
        return f"<table><caption>{escape(self._caption())}</caption><tbody>{body}</tbody></table>"


def figure(value: float | str | None) -> str:
    """Return a figure as it stands in a table: five digits, a dash for what is not known."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else format(value, ",d" if isinstance(value, int) else ".5g")


# The results


if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    FloatArray = npt.NDArray[np.float64]
    IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True, repr=False, eq=False)
class TrainResult(ShortTable):
    """One trained agent, held against the exact answer: the figures of ``rl-tui train --json``."""

    scenario: str
    algorithm: str
    seed: int
    hyperparameters: Mapping[str, float | str]
    """Every hyper-parameter by name, those of the scenario included."""
    without_effect: tuple[str, ...]
    """Which of the settings asked for neither the algorithm nor its policy uses."""
    states: tuple[str, ...]
    """[S], the names of the states."""
    actions: tuple[str, ...]
    """[A], the names of the actions."""
    q: FloatArray
    """[S, A], what was estimated; NaN where an action is not legal."""
    visits: IntArray
    """[S, A], how often each pair was taken; −1 where an action is not legal."""
    policy: FloatArray
    """[S, A], the greedy policy of ``q``: probabilities, ties shared evenly. 0 in every action at an end."""
    returns: FloatArray
    """[E], the undiscounted return of each finished episode, in their order. Empty for a planner."""
    lengths: IntArray
    """[E], its length in steps."""
    steps: int
    episodes: int
    seconds: float
    """How long it learned, compiling left out."""
    expected_return: float | None
    """Of the greedy policy, undiscounted, within the time limit."""
    best_expected_return: float | None
    """Likewise, of the best policy there is."""
    value_at_start: float | None
    """Of the greedy policy, discounted."""
    optimal_value_at_start: float | None
    """Likewise, of the optimal policy."""
    max_error: float | None
    """The largest |Q − Q*| of all legal pairs."""
    greedy_ends: float | None
    """The probability (0 to 1) that an episode of the greedy policy ends."""
    return_last_100: float | None
    """The mean return of the last 100 episodes, exploring as the agent does."""
    figures: Mapping[str, Any]
    """The whole document that ``rl-tui train --json`` prints."""

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
class TrainResults(ShortTable):
    """R runs of one agent, with one seed after the other: the figures of ``rl-tui train --runs --json``.

    Arrays over [R] are NaN where a run has no such figure.
    """

    scenario: str
    algorithm: str
    hyperparameters: Mapping[str, float | str]
    """Every hyper-parameter by name, those of the scenario included."""
    without_effect: tuple[str, ...]
    """Which of the settings asked for neither the algorithm nor its policy uses."""
    seeds: IntArray
    """[R]"""
    expected_return: FloatArray
    """[R], of the greedy policy, exact, undiscounted, within the time limit."""
    best_expected_return: float | None
    """Likewise, of the best policy there is; None where each seed has a world of its own."""
    value_at_start: FloatArray
    """[R], of the greedy policy, exact, discounted."""
    max_error: FloatArray
    """[R], the largest |Q − Q*| of all legal pairs."""
    return_last_100: FloatArray
    """[R], the mean return of the last 100 episodes, exploring as the agent does."""
    runs: tuple[Mapping[str, Any], ...]
    """All figures of each run, by name."""
    summary: Mapping[str, Mapping[str, float | int | None]]
    """Of each figure over the runs: mean, stderr (of n − 1), min, max, and the count of runs that have it."""
    curve: Mapping[str, FloatArray]
    """The mean learning curve in at most 200 bins of episodes: name → an array over the bins."""
    seconds: float
    """How long all of it took."""
    figures: Mapping[str, Any]
    """The whole document that ``rl-tui train --runs --json`` prints."""

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
class SolveResult(ShortTable):
    """The optimal values and policy, exact to 1e-9: the figures of ``rl-tui solve --json``."""

    scenario: str
    gamma: float
    states: tuple[str, ...]
    """[S], the names of the states."""
    actions: tuple[str, ...]
    """[A], the names of the actions."""
    v: FloatArray
    """[S], the optimal value of each state, discounted; 0 at an end."""
    q: FloatArray
    """[S, A], the optimal value of each action; NaN where it is not legal."""
    policy: FloatArray
    """[S, A], the optimal policy: probabilities, ties shared evenly. 0 in every action at an end."""
    value_at_start: float
    """Discounted."""
    expected_return: float | None
    """Of this policy, undiscounted, within the time limit."""
    best_expected_return: float | None
    """Likewise, of the best policy, which may look at the clock."""
    figures: Mapping[str, Any]
    """The whole document that ``rl-tui solve --json`` prints."""

    def _caption(self) -> str:
        return f"{self.scenario}: exact, gamma {self.gamma:g}"

    def _rows(self) -> Sequence[Sequence[str]]:
        return [
            ("value at the start", figure(self.value_at_start)),
            ("expected return", figure(self.expected_return)),
            ("best possible", figure(self.best_expected_return)),
            ("states, actions", f"{len(self.states):,}, {len(self.actions):,}"),
        ]


@dataclass(frozen=True, repr=False, eq=False)
class EvaluateResult(ShortTable):
    """What a policy is worth, exactly: the figures of ``rl-tui evaluate --json``."""

    scenario: str
    gamma: float
    policy_name: str
    """What was asked for: a name, a file, or "array"."""
    epsilon: float
    """How much of the time a random action is taken instead."""
    states: tuple[str, ...]
    """[S], the names of the states."""
    actions: tuple[str, ...]
    """[A], the names of the actions."""
    policy: FloatArray
    """[S, A], the probability of each action, random ones included; NaN where it is not legal."""
    v: FloatArray
    """[S], the value of each state, discounted; NaN where there is none."""
    value_at_start: float | None
    """Discounted."""
    expected_return: float | None
    """Of an episode, undiscounted, within the time limit."""
    steps: float | None
    """The expected length of an episode."""
    ends: float | None
    """The probability (0 to 1) that an episode ends."""
    figures: Mapping[str, Any]
    """The whole document that ``rl-tui evaluate --json`` prints."""

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
    """A scenario: its sizes, and how an agent is trained where nothing else is asked for."""

    id: str
    title: str
    kind: str
    """grid, mdp, bandit or gymnasium."""
    states: int
    actions: int
    pairs: int
    """How many pairs of state and action are legal."""
    time_limit: int
    """The number of steps after which an episode is truncated; 0 for none."""
    defaults: Mapping[str, Any]
    """algorithm, episodes and every hyper-parameter, by name."""

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
    """Scenarios, which print as one table."""

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
