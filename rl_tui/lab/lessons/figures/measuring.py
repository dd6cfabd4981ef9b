"""A measure of a run, as conditions of tasks name it."""

from __future__ import annotations

from typing import Any, Final

from rl_tui.common.findings import near, shown
from rl_tui.lab.lessons.figures.expression import FigureError
from rl_tui.lab.run.figures import exact_world, greedy_figures, optimum_of, pulls
from rl_tui.lab.run.run import Run

Measured = float | str | bool | None

ARGUMENTS: Final = ("state", "action", "actions", "first", "last", "at")


def measured(run: Run, measure: str, arguments: dict[str, Any]) -> Measured:
    """Return a measure of ``run`` as it stands; None where it has no value."""
    learner = run.learner
    space = run.world.space
    names = list(space.state_names)

    def pair() -> int:
        state = names.index(str(arguments["state"]))
        return space.pair_of(state, space.action_names.index(str(arguments["action"])))

    if measure == "q":
        return float(learner.q[pair()])
    if measure == "visits":
        return int(learner.visits[pair()])
    if measure == "value":
        own = space.pairs_of(names.index(str(arguments["state"])))
        return max(float(learner.q[each]) for each in own)
    if measure == "policy_in":
        own = space.pairs_of(names.index(str(arguments["state"])))
        best = max(float(learner.q[each]) for each in own)
        return ", ".join(
            space.action_names[space.pair_action[each]] for each in own if learner.q[each] == best
        )
    if measure in ("reward", "td_error"):
        last = learner.last_step
        return None if last is None else float(getattr(last, measure))
    if measure == "steps":
        return run.step
    if measure == "episodes":
        return learner.episodes
    if measure == "pairs_visited":
        return int((learner.visits > 0).sum())
    if measure == "pairs_unvisited":
        return int((learner.visits == 0).sum())
    if measure == "return_last_100":
        return run.history.last_100[0]
    if measure == "length_last_100":
        return run.history.last_100[1]
    if measure == "return_mean":
        return run.mean_return
    if measure == "first_reward_episode":
        return learner.first_reward_episode or None
    if measure in ("winnings", "regret", "best_arm_rate"):
        return pulls(run).get(measure)
    if measure in ("expected_return", "greedy_ends", "value_at_start", "max_error"):
        exact = greedy_figures(run, optimum_of(exact_world(run), learner.hyperparameters.gamma))
        return getattr(exact, measure)
    raise FigureError(shown(measure), f"the name of a measure{near(measure, ['regret', 'q'])}")
