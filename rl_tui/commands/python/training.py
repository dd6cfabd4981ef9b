"""``rl_tui.train``: training from Python."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, overload

from rl_tui.commands.python.answers import MOST_RUNS, Settings, goal_of, recipe_of, whole
from rl_tui.commands.python.results import TrainResult, TrainResults
from rl_tui.worlds.gym.advice import advice_kept

if TYPE_CHECKING:
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.training.seeded_runs import Goal
    from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


@overload
def train(
    scenario: str | Path,
    *,
    algorithm: str | None = None,
    runs: None = None,
    episodes: int | None = None,
    steps: int | None = None,
    seed: int = 0,
    **settings: Unpack[Settings],
) -> TrainResult: ...


@overload
def train(
    scenario: str | Path,
    *,
    algorithm: str | None = None,
    runs: int,
    episodes: int | None = None,
    steps: int | None = None,
    seed: int = 0,
    **settings: Unpack[Settings],
) -> TrainResults: ...


@advice_kept()
def train(
    scenario: str | Path,
    *,
    algorithm: str | None = None,
    runs: int | None = None,
    episodes: int | None = None,
    steps: int | None = None,
    seed: int = 0,
    **settings: Unpack[Settings],
) -> TrainResult | TrainResults:
    """Train an agent on a scenario and compare the result with the exact answer.

    Nothing is printed. All numbers equal those of ``rl-tui train``, bit for bit. Every hyperparameter is
    optional and defaults to the scenario's value.

    Args:
        scenario: Scenario id (see :func:`rl_tui.scenarios`), path of a scenario file, or ``gym:ENV_ID``.
        algorithm: Algorithm id, such as ``"q-learning"``; None: the scenario's.
        runs: Number of runs, 1 to 100,000, trained in parallel with `seed` and the seeds after it. None: one
            run.
        episodes: Episodes to train; None: the scenario's number.
        steps: Steps to train, instead of `episodes`.
        seed: Seed of the world and of the agent, 0 or more.
        **settings: Hyperparameters by keyword, listed here.
        alpha: Step size α in (0, 1], or ``"sample-average"`` for 1/N(s, a).
        step_size_schedule: How α changes per episode: ``"constant"``, ``"linear"``, ``"exponential"`` or
            ``"sample-average"``.
        alpha_min: Value at which the decay of α ends, 0 to 1.
        alpha_decay: Decay of α per episode, 0 or more; 0: α is constant.
        gamma: Discount γ, 0 to 1.
        policy: How actions are chosen: ``"epsilon-greedy"``, ``"softmax"``, ``"ucb"``, ``"gradient"`` or
            ``"thompson"``. The last two are for bandits only.
        epsilon: Exploration ε: probability of a random action, 0 to 1.
        epsilon_schedule: How ε changes per episode: ``"constant"``, ``"linear"`` or ``"exponential"``.
        epsilon_min: Value at which the decay of ε ends, 0 to 1.
        epsilon_decay: Decay of ε per episode, 0 or more; 0: ε is constant.
        temperature: Softmax temperature τ in (0, 1e6]. A high value makes actions more equally likely.
        confidence: UCB constant c, 0 to 1e6: bonus of actions that were rarely tried.
        baseline: Gradient bandit: ``"mean"`` compares rewards with their mean, ``"none"`` with 0.
        lambda_: Trace decay λ, 0 to 1, of SARSA(λ) and Q(λ).
        traces: What a repeated visit does to a trace: ``"replacing"`` or ``"accumulating"``.
        n: Steps per update of n-step SARSA, 1 to 1,000.
        planning_steps: Updates from the learned model after every step, 0 to 10,000 (Dyna-Q, prioritized
            sweeping).
        threshold: Prioritized sweeping ignores value changes up to this θ, 0 to 1e6.
        accuracy: Planners stop if no value changes by more than this in a sweep, 0 to 1e6.
        initial_q: Initial estimate Q₀ of every pair, −1e12 to 1e12.
        ties: How equal best actions are chosen: ``"random"``, or ``"first"`` in the world's own order.

    Returns:
        A :class:`~rl_tui.commands.python.results.TrainResult`. With `runs`, a
        :class:`~rl_tui.commands.python.results.TrainResults`.

    Raises:
        rl_tui.Error: A name is unknown or a value is out of range. The message is one line.

    Example:
        >>> run = rl_tui.train("frozenlake", algorithm="sarsa", alpha=0.5, epsilon=0.2, episodes=1000)
        >>> run.expected_return, run.q.shape
        (1.0, (16, 4))
        >>> many = rl_tui.train("frozenlake", runs=50)
        >>> many.plot().save("frozenlake.svg")
    """
    recipe, unused = recipe_of(scenario, algorithm, settings, seed)
    goal = goal_of(recipe, episodes, steps)
    if runs is None:
        return _one_run(recipe, goal, unused)
    return _several_runs(recipe, goal, whole(runs, "runs", 1, MOST_RUNS), unused)


class _Episodes:
    def __init__(self) -> None:
        self._returns: list[FloatArray] = []
        self._lengths: list[IntArray] = []

    def __call__(self, returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        self._returns.append(returns.copy())
        self._lengths.append(lengths.copy())

    def joined(self) -> tuple[FloatArray, IntArray]:
        import numpy as np

        nothing = np.empty(0), np.empty(0, np.int64)
        return np.concatenate([nothing[0], *self._returns]), np.concatenate([nothing[1], *self._lengths])


def _one_run(recipe: Recipe, goal: Goal, unused: tuple[str, ...]) -> TrainResult:
    from rl_tui.agents.exact.policy_figures import greedy_policy
    from rl_tui.agents.exact.solve import best_expected_return
    from rl_tui.commands.python.arrays import by_state
    from rl_tui.runs.figures import exact_world, training_figures
    from rl_tui.runs.recipe import begin
    from rl_tui.runs.run import Run
    from rl_tui.runs.training.seeded_runs import train as train_run

    finished = _Episodes()
    run = Run(recipe, begin(recipe), evaluate=False, on_episodes=finished)
    figures = training_figures(run, train_run(run, goal))
    space, mdp = run.world.space, exact_world(run)
    returns, lengths = finished.joined()
    return TrainResult(
        without_effect=unused,
        states=tuple(figures["states"]),
        actions=tuple(figures["actions"]),
        q=by_state(space, run.learner.q),
        visits=by_state(space, run.learner.visits, -1),
        policy=by_state(space, greedy_policy(space, run.learner.q, "random"), 0.0),
        returns=returns,
        lengths=lengths,
        best_expected_return=None if mdp is None else best_expected_return(mdp),
        figures=figures,
        **_taken(
            figures, "scenario", "algorithm", "seed", "hyperparameters", "steps", "episodes", "seconds",
            "expected_return", "value_at_start", "optimal_value_at_start", "max_error", "greedy_ends",
            "return_last_100",
        ),
    )  # fmt: skip


def _several_runs(recipe: Recipe, goal: Goal, runs: int, unused: tuple[str, ...]) -> TrainResults:
    import numpy as np

    from rl_tui.agents.exact.solve import best_expected_return
    from rl_tui.commands.python.arrays import numbers
    from rl_tui.runs.figures import MOST_STATES
    from rl_tui.runs.recipe import begin
    from rl_tui.runs.training.many_runs import many_runs

    figures = many_runs(recipe, runs, goal)
    rows = figures["runs"]
    mdp = None if recipe.scenario.section.drawn_from_seed else begin(recipe).world.mdp
    known = mdp is not None and mdp.states <= MOST_STATES and mdp.drift_std == 0.0

    def of_all(name: str) -> FloatArray:
        return numbers(row[name] for row in rows)

    return TrainResults(
        without_effect=unused,
        seeds=np.array([row["seed"] for row in rows]),
        expected_return=of_all("expected_return"),
        best_expected_return=best_expected_return(mdp) if known and mdp is not None else None,
        value_at_start=of_all("value_at_start"),
        max_error=of_all("max_error"),
        return_last_100=of_all("return_last_100"),
        runs=tuple(rows),
        curve={name: numbers(values) for name, values in figures["curve"].items()},
        figures=figures,
        **_taken(figures, "scenario", "algorithm", "hyperparameters", "summary", "seconds"),
    )


def _taken(figures: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: figures[name] for name in names}
