"""The metrics for the conditions of tasks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE
from rl_tui.runs.measures import BANDIT_FIGURES, measured_run
from rl_tui.runs.measures import MEASURES as RUN_MEASURES

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Measured
    from rl_tui.lessons.judging.moment import JudgedMoment
    from rl_tui.lessons.judging.seen_program import SeenProgram
    from rl_tui.runs.recipe import Recipe

Value = float | str | bool


class MissingError(Exception):
    """The reason why a metric has no value now."""


class NoMomentError(MissingError):
    """A metric has no value yet, or no longer."""


class NoStepError(NoMomentError):
    """A metric has no value before the first step."""

    def __init__(self) -> None:
        super().__init__("no step has been taken yet")


class NotYetError(Exception):
    """A metric is pending."""


class MeasureKind(StrEnum):
    """The subject of a metric."""

    SETTING = "settings"
    COUNT = "counts"
    EPISODE = "the episode that ended with this step"
    LAST_STEP = "the last step"
    LEARNED = "what was learned"
    EXACT = "exact numbers"
    RECORD = "all finished episodes"
    PROGRAM = "a program that was watched"


class Gives(StrEnum):
    """The type of a metric's values."""

    NUMBER = "a number"
    TEXT = "a string"
    EITHER = "a number or a string"
    TRUTH = "true or false"


@dataclass(frozen=True, slots=True)
class TaskMeasure:
    """A metric, computed by `of`, with required arguments `needs`.

    `accepts` lists its possible words, empty for any. `differs_by_seed` is True if many seeds make sense.
    `of_program` measures a program instead of a run.
    """

    name: str
    help: str
    kind: MeasureKind
    of: Callable[[JudgedMoment, Measured], Value]
    needs: tuple[str, ...] = ()
    gives: Gives = Gives.NUMBER
    accepts: tuple[str, ...] = ()
    differs_by_seed: bool = True
    of_program: Callable[[SeenProgram], Value] | None = None


ARGUMENTS: Final = ("state", "action", "actions", "first", "last")
"""Arguments of some metrics."""


def settings_of(recipe: Recipe) -> dict[str, float | str]:
    """Return all settings by name."""
    hyperparameters = recipe.hyperparameters
    values = {name: hyperparameters.value(name) for name in PARAMETERS}
    if hyperparameters.sample_average:
        values["alpha"] = SAMPLE_AVERAGE
    return {"algorithm": recipe.algorithm, **values}


def _setting(moment: JudgedMoment, condition: Measured) -> float | str:
    if not moment.run.step:
        raise NoStepError
    name = condition.measure
    if condition.at == "start":
        algorithm, values = moment.journal.start.algorithm, moment.journal.start.hyperparameters
    else:
        algorithm, values = moment.author
    if name == "algorithm":
        return algorithm
    return SAMPLE_AVERAGE if name == "alpha" and values.sample_average else values.value(name)


def _settings() -> Iterable[TaskMeasure]:
    def row(name: str, text: str, gives: Gives, words: Iterable[str]) -> TaskMeasure:
        return TaskMeasure(name, text, MeasureKind.SETTING, _setting, (), gives, tuple(words), False)

    yield row("algorithm", "the id of the algorithm", Gives.TEXT, BY_ID)
    for each in PARAMETERS.values():
        gives = Gives.TEXT if each.range is None else Gives.EITHER if each.words else Gives.NUMBER
        yield row(each.name, each.help, gives, each.words)


def _changed_settings(moment: JudgedMoment, condition: Measured) -> float:
    begun, wanted = settings_of(moment.journal.start), settings_of(moment.setup)
    return sum(begun[name] != wanted[name] for name in wanted)


def _counts() -> Iterable[TaskMeasure]:
    def row(name: str, text: str, of: Callable[[JudgedMoment, Measured], Value]) -> TaskMeasure:
        return TaskMeasure(name, text, MeasureKind.COUNT, of)

    def of_a_person(name: str, text: str, of: Callable[[JudgedMoment, Measured], Value]) -> TaskMeasure:
        return TaskMeasure(name, text, MeasureKind.COUNT, of, differs_by_seed=False)

    yield row("steps", "steps taken", lambda m, c: m.run.step)
    yield row("episodes", "finished episodes of an agent", lambda m, c: m.episodes)
    yield row("sweeps", "finished sweeps of a planner", lambda m, c: m.run.learner.planned.sweeps)
    yield of_a_person("taken", "steps taken by a person", lambda m, c: m.journal.taken)
    yield of_a_person("changes", "settings changed after the first step", lambda m, c: m.journal.changes)
    yield of_a_person(
        "changed_settings", "settings at the first step that differ from the setup", _changed_settings
    )
    yield of_a_person("seed", "the seed of the run", lambda m, c: m.run.recipe.seed)


def _by_agent(moment: JudgedMoment, condition: Measured) -> float:
    length = moment.last_episode[1]
    return length - moment.taken_since(moment.run.step - length)


def _ended(moment: JudgedMoment, condition: Measured) -> str:
    last = moment.last
    return "terminated" if last.terminated else "truncated" if last.truncated else "no"


def _td_error(moment: JudgedMoment, condition: Measured) -> float:
    if not moment.last.learned:
        raise MissingError("nothing was learned in this step")
    return moment.last.td_error


def _reward(moment: JudgedMoment, condition: Measured) -> float:
    if moment.last.planned:
        raise MissingError("a planner has no rewards")
    return moment.last.reward


def _episode_ended(moment: JudgedMoment, condition: Measured) -> str:
    return "terminated" if moment.last_episode and moment.last.terminated else "truncated"


def _steps() -> Iterable[TaskMeasure]:
    episode, last = MeasureKind.EPISODE, MeasureKind.LAST_STEP
    text, ends = Gives.TEXT, ("terminated", "truncated")
    yield TaskMeasure("episode_return", "its undiscounted return", episode, lambda m, c: m.last_episode[0])
    yield TaskMeasure("episode_length", "its length in steps", episode, lambda m, c: m.last_episode[1])
    yield TaskMeasure("episode_by_agent", "how many of its steps the agent took, not you", episode, _by_agent)
    yield TaskMeasure("episode_ended", "how it ended", episode, _episode_ended, gives=text, accepts=ends)
    yield TaskMeasure("reward", "reward of the step", last, _reward)
    yield TaskMeasure("td_error", "TD error of the step", last, _td_error)
    yield TaskMeasure(
        "ended", "whether the step ended an episode, and how", last, _ended, gives=text, accepts=(*ends, "no")
    )


def _q(moment: JudgedMoment, condition: Measured) -> float:
    return float(moment.run.learner.q[moment.pair(condition.state, condition.action)])


def _value(moment: JudgedMoment, condition: Measured) -> float:
    state = moment.state(condition.state)
    planned = moment.planned_values
    if planned is not None:
        return float(planned[state])
    own = moment.run.world.space.pairs_of(state)
    return float(moment.run.learner.q[own.start : own.stop].max()) if own else 0.0


def _gap(moment: JudgedMoment, condition: Measured) -> float:
    one, other = (moment.pair(condition.state, action) for action in condition.actions)
    q = moment.run.learner.q
    return abs(float(q[one]) - float(q[other]))


def _policy_in(moment: JudgedMoment, condition: Measured) -> str:
    q = moment.run.learner.q

    def best(own: range) -> list[int]:
        greatest = q[own.start : own.stop].max()
        return [pair for pair in own if q[pair] == greatest]

    return moment.actions_in(condition.state, best)


def _visits(moment: JudgedMoment, condition: Measured) -> float:
    return int(moment.run.learner.visits[moment.pair(condition.state, condition.action)])


def _visited(moment: JudgedMoment) -> int:
    return int((moment.run.learner.visits > 0).sum())


def _learned() -> Iterable[TaskMeasure]:
    def row(
        name: str,
        text: str,
        of: Callable[[JudgedMoment, Measured], Value],
        *needs: str,
        gives: Gives = Gives.NUMBER,
    ) -> TaskMeasure:
        return TaskMeasure(name, text, MeasureKind.LEARNED, of, needs, gives)

    pair = ("state", "action")
    yield row("q", "the estimate of a pair", _q, *pair)
    yield row("value", "the largest estimate of a state (for a planner its V)", _value, "state")
    yield row("gap", "|Q(a) − Q(b)| of two actions", _gap, "state", "actions")
    yield row("policy_in", "the greedy actions of a state", _policy_in, "state", gives=Gives.TEXT)
    yield row("visits", "number of visits of a pair, or of its updates", _visits, *pair)
    yield row("pairs_visited", "number of pairs with a visit", lambda m, c: _visited(m))
    yield row(
        "pairs_unvisited",
        "number of pairs without a visit",
        lambda m, c: m.run.world.space.pairs - _visited(m),
    )
    yield row("pairs", "number of state–action pairs", lambda m, c: m.run.world.space.pairs)
    yield row("states", "number of states of the world", lambda m, c: m.run.world.space.states)
    yield row(
        "converged",
        "whether a planner has converged",
        lambda m, c: m.run.learner.came_to_rest,
        gives=Gives.TRUTH,
    )


def _max_error(moment: JudgedMoment, condition: Measured) -> float:
    return float(abs(moment.run.learner.q - moment.optimum.q).max())


def _optimal_value(moment: JudgedMoment, condition: Measured) -> float:
    return float(moment.optimum.v[moment.state(condition.state)])


def _optimal_actions(moment: JudgedMoment, condition: Measured) -> str:
    greedy = moment.optimum.greedy
    return moment.actions_in(condition.state, lambda own: [pair for pair in own if greedy[pair]])


def _exact() -> Iterable[TaskMeasure]:
    def row(
        name: str,
        text: str,
        of: Callable[[JudgedMoment, Measured], Value],
        *needs: str,
        gives: Gives = Gives.NUMBER,
    ) -> TaskMeasure:
        return TaskMeasure(name, text, MeasureKind.EXACT, of, needs, gives)

    yield row(
        "expected_return", "the undiscounted return of the greedy policy", lambda m, c: m.expected_return
    )
    yield row(
        "greedy_ends", "the probability that an episode of the greedy policy ends", lambda m, c: m.greedy_ends
    )
    yield row("value_at_start", "the value of the greedy policy at the start", lambda m, c: m.value_at_start)
    yield row("max_error", "max |Q − Q*|", _max_error)
    yield row("optimal_value", "V* of a state", _optimal_value, "state")
    yield row(
        "optimal_actions_in", "the optimal actions of a state", _optimal_actions, "state", gives=Gives.TEXT
    )


_NOT_YET: Final = {
    "first_reward_episode": "there has been no reward yet",
    "best_arm_rate": "no arm has been pulled yet",
}
"""Reasons why recorded metrics have no value yet, if it is not a missing episode."""


def _recorded(moment: JudgedMoment, condition: Measured) -> float:
    name, run = condition.measure, measured_run(moment.run)
    if name in BANDIT_FIGURES and run.bandit is None:
        raise MissingError("this world is not a bandit")
    value = RUN_MEASURES[name].of(run)
    if value is None:
        raise NoMomentError(_NOT_YET.get(name, "no episode has finished yet"))
    return value


def _steps_of_episodes(moment: JudgedMoment, condition: Measured) -> float:
    first, last = condition.first or 1, condition.last or 1
    lengths = moment.run.history.first_lengths[:last]
    if len(lengths) < last:
        raise NoMomentError(f"episode {last} is not finished yet")
    return int(lengths[first - 1 :].sum())


def _record() -> Iterable[TaskMeasure]:
    def row(name: str, text: str) -> TaskMeasure:
        return TaskMeasure(name, text, MeasureKind.RECORD, _recorded)

    yield row("return_last_100", "mean return of the last 100 episodes")
    yield row("length_last_100", "mean length of the last 100 episodes")
    yield row("return_mean", "mean return of all episodes")
    yield row("first_reward_episode", "the first episode with a reward")
    text, needs = "steps in total, from episode `first` to `last`", ("first", "last")
    yield TaskMeasure("steps_of_episodes", text, MeasureKind.RECORD, _steps_of_episodes, needs)
    yield row("winnings", "sum of the rewards of a bandit")
    yield row("regret", "loss compared with always pulling the best arm")
    yield row("best_arm_rate", "share of pulls on the best arm")


_OF_NO_RULE: Final = ("Q(s′, a)", "max Q(s)", "argmax Q(s′)")
"""Targets with a wrong value of the next state."""


def _no_program(moment: JudgedMoment, condition: Measured) -> Value:
    raise MissingError("no program was watched")


def _found(value: float | None, seen: SeenProgram, what: str) -> float:
    if value is None:
        raise MissingError(seen.verdict.update.reason or f"nothing tells {what}")
    return value


def _rule(seen: SeenProgram) -> str:
    """Return the rule with its target, if no rule of the book has that target."""
    update = seen.verdict.update
    takes_another = update.target.value in _OF_NO_RULE and update.rule.value != "unknown"
    return f"{update.rule.value} with {update.target.value}" if takes_another else update.rule.value


def _departs(seen: SeenProgram) -> float:
    update = seen.verdict.update
    if update.rule.value == "unknown":
        raise MissingError("its update is not known")
    return 0 if update.departs_at is None else update.departs_at + 1


def _faults(seen: SeenProgram) -> float:
    return sum(finding.kind == "fault" for finding in seen.verdict.findings)


def _program_return(seen: SeenProgram) -> float:
    if seen.expected_return is None:
        raise MissingError("its table does not allow that")
    return seen.expected_return


def _programs() -> Iterable[TaskMeasure]:
    def row(
        name: str, text: str, of: Callable[[SeenProgram], Value], gives: Gives = Gives.NUMBER
    ) -> TaskMeasure:
        return TaskMeasure(
            name, text, MeasureKind.PROGRAM, _no_program, (), gives, differs_by_seed=False, of_program=of
        )

    text = Gives.TEXT
    yield row("program_world", "the id of the environment it learns in", lambda s: s.environment, text)
    yield row("program_steps", "steps that it took", lambda s: s.steps)
    yield row("program_episodes", "episodes that it finished", lambda s: s.episodes)
    yield row("program_rule", "the update that it makes", _rule, text)
    yield row("program_departs", "the first step that this update does not explain, 0 for none", _departs)
    yield row("program_faults", "its bugs", _faults)
    yield row("program_alpha", "its α", lambda s: _found(s.verdict.update.alpha, s, "its α"))
    yield row("program_gamma", "its γ", lambda s: _found(s.verdict.update.gamma, s, "its γ"))
    yield row(
        "program_return", "the exact undiscounted return of the greedy policy of its table", _program_return
    )


MEASURES: Final[Mapping[str, TaskMeasure]] = {
    measure.name: measure
    for group in (_settings, _counts, _steps, _learned, _exact, _record, _programs)
    for measure in group()
}
"""All metrics by name."""
