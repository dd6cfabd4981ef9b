"""Training of a user's own agent in a separate process."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TextIO

import numpy as np
import numpy.typing as npt

from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.agents.exact.policy_figures import greedy_policy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import ProgramVerdict, Rule
from rl_tui.programs.grading.watch_report import error_of
from rl_tui.programs.own_agents.loading import AgentName, AgentPlace, runs_when_imported, the_agent
from rl_tui.programs.watched.child.script import read_script
from rl_tui.programs.watched.program_log import ProgramError, ProgramLog
from rl_tui.programs.watched.program_process import ProgramRequest, watched_to_the_end
from rl_tui.programs.watched.recording import Recording
from rl_tui.runs.figures import (
    MOST_STATES,
    figures_of_estimates,
    finite,
    head,
    optimum_of,
    policy_names,
    row_of,
    table,
    world_digest,
)
from rl_tui.runs.history import History
from rl_tui.runs.measures import FIGURES, NO_EXACT_FIGURES, GreedyFigures, MeasuredRun, figures_of
from rl_tui.runs.recipe import Recipe, begin
from rl_tui.runs.run import OnEpisodes, each_of
from rl_tui.runs.training.many_runs import figures_of_runs
from rl_tui.runs.training.seeded_runs import (
    Goal,
    OnProgress,
    RunCurve,
    mean_curve,
    no_curve,
    no_progress,
)
from rl_tui.worlds.files.shipped import shipped_folder
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

# The request to the process


GIVEN: Final = ("alpha", "gamma", "epsilon", "epsilon_decay", "epsilon_min", "initial_q")


def place_of_agent(agent: AgentName) -> AgentPlace:
    """Return the place of `agent`. Raises UserError unless there is one that does not learn on import."""
    tree = read_script(agent.path).tree
    place = the_agent(tree, agent.path, agent.name)
    if runs_when_imported(tree):
        name = shown(agent.path.name)
        raise UserError(
            f"{name} starts to learn as soon as it is imported: put its loop below "
            'if __name__ == "__main__":, or use rl-tui watch, which needs no change'
        )
    return place


def agent_request(
    agent: AgentName, recipe: Recipe, given: Mapping[str, object], goal: Goal, memory: int | None = None
) -> ProgramRequest:
    """Return the request to train `agent` in the scenario of `recipe`.

    Agents can receive `GIVEN` of the hyperparameters `given`. Raises UserError if one is not a number.
    """
    numbers: dict[str, float] = {}
    for name in GIVEN:
        value = given.get(name)
        if isinstance(value, str):
            raise UserError(f"--{name.replace('_', '-')} is {shown(value)}; expected a number for an agent")
        if isinstance(value, (int, float)):
            numbers[name] = float(value)
    return ProgramRequest(
        agent.path,
        seed=recipe.seed,
        steps=goal.steps,
        agent=agent.name,
        scenario=_scenario_name(recipe),
        episodes=goal.episodes,
        hyperparameters=numbers,
        defaults=_defaults(recipe.hyperparameters),
        memory=memory,
    )


def _defaults(values: Hyperparameters) -> dict[str, float]:
    """Return the defaults. Without a decay, the least ε is ε itself, however an agent reads the decay."""
    epsilon = values.epsilon
    usual = Hyperparameters()
    return {
        "alpha": float(usual.alpha if isinstance(values.alpha, str) else values.alpha),
        "gamma": values.gamma,
        "epsilon": epsilon,
        "epsilon_decay": values.epsilon_decay,
        "epsilon_min": values.epsilon_min if values.epsilon_decay else epsilon,
        "initial_q": values.initial_q,
    }


def _scenario_name(recipe: Recipe) -> str:
    source = recipe.scenario.source
    return recipe.scenario.id if source.parent == shipped_folder() else str(source)


# A recording that counts all steps


OnFinished = Callable[[FloatArray, IntArray], None]
_STATE, _ACTION, _REWARD, _FLAGS, _EPISODE = 1, 2, 3, 5, 6
NEVER: Final = 0


class EpisodeRecording(Recording):
    """The recording of an agent in one environment.

    `on_finished` receives finished episodes in order: undiscounted returns and lengths, `[n]` each. `visits`,
    `[S·A]`, counts how often each pair was taken.
    """

    def __init__(self, states: int, actions: int, on_finished: OnFinished) -> None:
        super().__init__()
        self.visits: IntArray = np.zeros(states * actions, np.int64)
        self.episodes = 0
        self.first_reward_episode = NEVER
        """First episode, from 1, with a reward other than 0."""
        self._width = actions
        self._on_finished = on_finished
        self._return_so_far, self._length_so_far = 0.0, 0

    def add(self, steps: npt.NDArray[np.float64], changes: npt.NDArray[np.float64]) -> None:
        """Add steps, `[n, 8]`, and changes, `[m, 4]`, as received."""
        super().add(steps, changes)
        if len(steps):
            cells = (steps[:, _STATE] * self._width + steps[:, _ACTION]).astype(np.int64)
            self.visits += np.bincount(cells, minlength=len(self.visits))
            paid = np.flatnonzero(steps[:, _REWARD])
            if self.first_reward_episode == NEVER and len(paid):
                self.first_reward_episode = int(steps[paid[0], _EPISODE]) + 1
            self._finish(steps[:, _REWARD], np.flatnonzero(steps[:, _FLAGS]))

    def _finish(self, rewards: FloatArray, ends: IntArray) -> None:
        starts = np.concatenate(([0], ends + 1))
        if not len(ends):
            self._return_so_far += float(rewards.sum())
            self._length_so_far += len(rewards)
            return
        # without rewards after the last end, which reduceat would add to the last episode
        returns = np.add.reduceat(rewards[: starts[-1]], starts[:-1])
        lengths = ends - starts[:-1] + 1
        returns[0] += self._return_so_far
        lengths[0] += self._length_so_far
        rest = rewards[starts[-1] :]
        self._return_so_far, self._length_so_far = float(rest.sum()), len(rest)
        self.episodes += len(ends)
        self._on_finished(returns, lengths)


# Training and results


_LONGEST_ERROR: Final = 400


@dataclass(slots=True)
class AgentRun:
    """One run of an agent."""

    seed: int
    world: World
    history: History
    log: ProgramLog
    recording: EpisodeRecording
    seconds: float = 0.0
    verdict: ProgramVerdict = field(default_factory=ProgramVerdict)

    @property
    def q(self) -> FloatArray | None:
        """Estimates, `[P]`, 0 for missing entries, or None."""
        return estimates_of(self.log, self.world.space)

    @property
    def mdp(self) -> TabularMDP | None:
        """The table for exact results, or None if missing, large or drifting."""
        mdp = self.world.mdp
        return None if mdp is None or mdp.states > MOST_STATES or mdp.drift_std > 0.0 else mdp


class AgentRuns:
    """Runs of an agent that differ in their seed. `recipe` has the γ of exact results."""

    figures: tuple[str, ...] = FIGURES
    is_bandit = False
    plans = False

    def __init__(
        self, name: AgentName, place: AgentPlace, recipe: Recipe, given: Mapping[str, object]
    ) -> None:
        self.name, self.place, self.recipe, self.given = name, place, recipe, given
        self.first_seed = recipe.seed
        self._world = None if recipe.scenario.section.drawn_from_seed else begin(recipe).world
        self._solving = threading.Lock()
        self._optima: list[Solution | None] = []  # solution of a shared world, once known
        self._digest = None if self._world is None else world_digest(self._world)

    def new_run(self, seed: int, *on_episodes: OnEpisodes | None) -> AgentRun:
        """Return a fresh run of `seed`."""
        world = self._world or begin(_with_seed(self.recipe, seed)).world
        history, hand_on = History(), each_of(*on_episodes)

        def finished(returns: FloatArray, lengths: IntArray) -> None:
            history.add(returns, lengths)
            hand_on(returns, lengths, np.zeros(len(returns), np.bool_))

        recording = EpisodeRecording(world.space.states, len(world.space.action_names), finished)
        return AgentRun(seed, world, history, ProgramLog(recording), recording)

    def train(self, run: AgentRun, goal: Goal, on_progress: OnProgress) -> None:
        """Train `run` until `goal`. Raises UserError, with its line, if the agent fails."""
        request = agent_request(self.name, _with_seed(self.recipe, run.seed), self.given, goal)
        wanted = goal.steps or goal.episodes or 0

        def tell(log: ProgramLog) -> None:
            on_progress(log.recording.count if goal.steps else run.recording.episodes, wanted)

        start = time.perf_counter()
        watched_to_the_end(request, tell, log=run.log)
        run.seconds = time.perf_counter() - start
        error = error_of_agent(run.log, goal)
        if error is not None:
            raise UserError(f"seed {run.seed}: {error_in_a_line(self.name.path, error)}")
        run.verdict = verdict_of(run.log)

    def _exact(self, run: AgentRun) -> GreedyFigures:
        q, gamma = run.q, self.recipe.hyperparameters.gamma
        if q is None or run.mdp is None:
            return NO_EXACT_FIGURES
        if self._world is None:
            return figures_of_estimates(run.mdp, q, "random", gamma, optimum_of(run.mdp, gamma))
        with self._solving:
            if not self._optima:
                self._optima.append(optimum_of(run.mdp, gamma))
        return figures_of_estimates(run.mdp, q, "random", gamma, self._optima[0])

    def measured(self, run: AgentRun) -> MeasuredRun:
        """Return what metrics read of `run`."""
        recording, total = run.recording, run.history.total_return
        return MeasuredRun(
            recording.count,
            recording.episodes,
            total,
            total / recording.episodes if recording.episodes else None,
            run.history.last_100,
            recording.first_reward_episode,
            self._exact(run),
        )

    def row(self, run: AgentRun) -> dict[str, Any]:
        """Return the run as in `train --runs --json`."""
        digest = world_digest(run.world) if self._world is None else self._digest
        return row_of(run.seed, self.measured(run), digest)

    def head(self, verdict: ProgramVerdict | None) -> dict[str, Any]:
        """Describe the agent as JSON data, with hyperparameters that `verdict` proves."""
        of_recipe, update = head(self.recipe), (verdict or ProgramVerdict()).update
        proven: dict[str, float | str | None] = {
            "alpha": update.alpha,
            "gamma": update.gamma,
            "epsilon": update.epsilon,
        }
        if update.alpha_schedule == "1/N":
            proven["alpha"] = "sample-average"
        return {
            **of_recipe,
            "agent": {"file": str(self.name.path), "name": self.place.name, "style": self.place.style.value},
            "algorithm": None if update.rule in (Rule.UNKNOWN, Rule.MONTE_CARLO) else update.rule.value,
            "hyperparameters": dict.fromkeys(of_recipe["hyperparameters"]) | proven,
            "discount": self.recipe.hyperparameters.gamma,
        }


def train_agent(
    runs: AgentRuns, goal: Goal, on_episodes: OnEpisodes | None = None, on_progress: OnProgress = no_progress
) -> tuple[AgentRun, dict[str, Any], dict[str, list[Any]]]:
    """Return one run, its document and its mean curve. Raises UserError if the agent fails."""
    curve = None if goal.episodes is None else RunCurve(goal.episodes)
    run = runs.new_run(runs.first_seed, on_episodes, curve)
    runs.train(run, goal, on_progress)
    if curve is None or not run.recording.episodes:
        return run, _document(runs, run), no_curve(False)
    return run, _document(runs, run), mean_curve([curve.points], False)


def train_agent_often(
    runs: AgentRuns, count: int, goal: Goal, csv: Path | TextIO | None, on_progress: OnProgress = no_progress
) -> dict[str, Any]:
    """Train `count` times, and return the document of `train --runs --json`."""
    return {**runs.head(None), **figures_of_runs(runs, count, goal, csv, on_progress)}


def estimates_of(log: ProgramLog, space: FiniteSpace) -> FloatArray | None:
    """Return the table's estimates, `[P]`, 0 for missing entries, or None at another size."""
    recording, actions = log.recording, len(space.action_names)
    if recording.initial is None or len(recording.initial) != space.states * actions:
        return None
    cells = space.pair_state * actions + space.pair_action
    estimates: FloatArray = np.nan_to_num(recording.table_at(recording.count))[cells]
    return estimates


def error_of_agent(log: ProgramLog, goal: Goal) -> ProgramError | None:
    """Return why the agent failed, could not be watched, or ended early."""
    error = error_of(log)
    if error is not None:
        return error
    for name, taken, wanted in (
        ("steps", log.recording.count, goal.steps),
        ("episodes", log.episodes, goal.episodes),
    ):
        if wanted is not None and taken < wanted:
            return ProgramError(
                "Ended", f"the agent stopped its process after {taken:,} of {wanted:,} {name}"
            )
    return None


def error_in_a_line(path: Path, error: ProgramError) -> str:
    """Return the error with its place, in one line."""
    place = str(path) if error.line is None else f"{error.file or path}, line {error.line}"
    raised = error.text if error.type == UserError.__name__ else f"{error.type}: {error.text}"
    return one_line(raised if error.type == UserError.__name__ else f"{place}: {raised}", _LONGEST_ERROR)


def _document(runs: AgentRuns, run: AgentRun) -> dict[str, Any]:
    space, q, measured = run.world.space, run.q, runs.measured(run)
    cells = space.pair_state * len(space.action_names) + space.pair_action
    found = run.log.table
    document: dict[str, Any] = finite(
        {
            **runs.head(run.verdict),
            **row_of(run.seed, measured, world_digest(run.world)),
            "seconds": run.seconds,
            "steps_per_second": run.recording.count / run.seconds if run.seconds > 0.0 else None,
            "states": list(space.state_names),
            "actions": list(space.action_names),
            "table": None if found is None else found.name,
            "q": None if q is None else table(space, q),
            "visits": table(space, run.recording.visits[cells]),
            "policy": None if q is None else policy_names(space, greedy_policy(space, q, "random")),
            **figures_of(measured, ("optimal_value_at_start", "greedy_ends")),
        }
    )
    return document


def _with_seed(recipe: Recipe, seed: int) -> Recipe:
    return Recipe(recipe.scenario, recipe.algorithm, recipe.hyperparameters, seed)
