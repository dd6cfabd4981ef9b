"""The part of a script that makes the agent: it learns or plans, and prints the policy."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.export.parameter_text import ParameterText
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds.text import WorldText
from rl_tui.worlds.mdp.space import FiniteSpace

_BEGIN_WORLD: Final = "env.reset(seed=SEED)  # the randomness of the world"
_RANDOM_TIES: Final = """def argmax(values):
    # The place of the greatest value; one of equals is drawn. (np.argmax takes the first of them,
    # and where all values are equal, as at the start, an agent may then never get anywhere.)
    return int(rng.choice(np.flatnonzero(values == values.max())))"""
_FIRST_OF_TIES: Final = """def argmax(values):
    # The place of the greatest value; of equals the first
    return int(np.argmax(values))"""
_END_OF_TIME: Final = "# An episode that is only cut off would have gone on: it is not worth 0 from here"
_CUT_OFF: Final = "G = 0.0 if terminated else expected_value(state)  # what is cut off would have gone on"
_LEARNED: Final = """
print(f"mean return of the last {len(returns[-100:])} episodes: {np.mean(returns[-100:]):.3f}")

$report
"""
_LEAST_VARIANCE: Final = 1e-12
_LOOK_AHEAD: Final = """
def look_ahead(state, action):
    # Σ p(s',r|s,a) [r + γ V(s')]; after the end there is nothing
    return sum(
        probability * (reward + GAMMA * (0.0 if terminated else V[next_state]))
        for $fields in outcomes(state, action)
    )


# The states that can be reached from the start: only these count
states, waiting = set(), list($starts)
while waiting:
    state = waiting.pop()
    if state not in states:
        states.add(state)
        for action in range(len(Q[state])):
            waiting += [result[1] for result in outcomes(state, action) if not result[3]]
states = sorted(states)
"""
_PLAYED: Final = """
# How good is it? Play it
returns = []
for _ in range(100):
    state, _ = env.reset()
    total, done, steps = 0.0, False, 0
    while not done and steps < 10_000:
        action = $act
        state, reward, terminated, truncated, _ = env.step(action)
        total, done, steps = total + reward, terminated or truncated, steps + 1
    returns.append(total)

print(f"{sweeps} sweeps; mean return of the last 100 episodes: {np.mean(returns):.3f}")

$report
"""


def learner_text(params: ParameterText, text: WorldText, space: FiniteSpace) -> list[str]:
    """Return the parts that make the world, choose actions, learn, and print what was learned."""
    algorithm, policy = (
        _template("algorithms", params.algorithm),
        _template("policies", params.hyperparameters.policy),
    )
    loop = fill(algorithm.TEXT, _pieces(params, text, algorithm, policy))
    functions = _functions(params, policy, space, expects="expected_value" in loop)
    needs_argmax = any(" argmax(" in each or "[argmax(" in each for each in [loop, *functions])
    return [
        text.setup,
        _BEGIN_WORLD,
        text.new_table,
        _tables(params, algorithm, policy),
        *([_argmax(params)] if needs_argmax else []),
        *functions,
        loop,
        fill(_LEARNED, {"report": _report(text, params)}),
    ]


def planner_text(params: ParameterText, text: WorldText) -> list[str]:
    """Return the parts that make the world, plan with its model, and play what was planned.

    Raises UserError where the world of the script has no model.
    """
    if not text.starts:
        raise UserError(
            "no script: this environment itself shows no transition table to plan with; take an algorithm "
            "that learns, such as q-learning"
        )
    planner = _template("algorithms", params.algorithm)
    has_policy = params.algorithm == "policy-iteration"
    act, improve = "argmax(Q[state])", ""
    if has_policy:
        act = "int(rng.choice(len(Q[state]), p=policy[state]))"
        improve = planner.AMONG_EQUALS if params.hyperparameters.ties == "random" else planner.FIRST_OF_EQUALS
    return [
        text.setup,
        _BEGIN_WORLD,
        *([text.model.strip("\n")] if text.model else []),
        text.new_table,
        "Q = new_table(INITIAL_Q)",
        *([] if has_policy else [_argmax(params)]),
        fill(_LOOK_AHEAD, {"fields": text.fields.replace("noise", "_"), "starts": text.starts}),
        fill(planner.TEXT, {"improve": improve}),
        fill(_PLAYED, {"act": act, "report": _report(text, params)}),
    ]


def _tables(params: ParameterText, algorithm: Any, policy: Any) -> str:
    """Return the tables: Q, and what the algorithm and the policy need besides."""
    lines = ["Q = new_table(INITIAL_Q)"]
    if params.counts_visits:
        step_size = "; the step size is 1/N" if params.sample_average and not params.counts_updates else ""
        lines.append(f"N = new_table(0.0)  # how often each action was taken{step_size}")
    counts = {"update_counts": algorithm.COUNTS if params.counts_updates else ""}
    own = fill(algorithm.TABLES, counts) if hasattr(algorithm, "TABLES") else ""
    of_policy = policy.TABLES.strip("\n") if hasattr(policy, "TABLES") else ""
    return "\n".join([*lines, *(each for each in (own, of_policy) if each)])


def _pieces(params: ParameterText, text: WorldText, algorithm: Any, policy: Any) -> dict[str, str]:
    """Return the pieces to fill in the loop of an algorithm."""
    state, action = getattr(algorithm, "UPDATED", ("state", "action"))
    counts = "updates" if params.counts_updates else "N"
    accumulates = params.hyperparameters.traces == "accumulating"
    visits = "N[state][action] += 1" if params.counts_visits else ""
    return {
        "begin": params.begin(),
        "note": "\n".join(each for each in (visits, _note(params, policy)) if each),
        "alpha": params.alpha(state, action, counts),
        "count_update": getattr(algorithm, "COUNT_UPDATE", "") if params.counts_updates else "",
        "end_of_time": _END_OF_TIME if text.truncates else "",
        "trace": "trace.get((state, action), 0.0) + 1.0" if accumulates else "1.0",
        "first_return": _CUT_OFF if text.truncates else "G = 0.0",
    }


def _note(params: ParameterText, policy: Any) -> str:
    """Return what a policy learns from a step; most learn nothing."""
    if not hasattr(policy, "NOTE"):
        return ""
    pieces = {"policy_alpha": params.alpha("state", "action", "N")}
    if hasattr(policy, "BASELINE"):
        with_baseline = params.hyperparameters.baseline == "mean"
        pieces["baseline"] = policy.BASELINE if with_baseline else policy.NO_BASELINE
        pieces["mean"] = policy.MEAN if with_baseline else ""
    return fill(policy.NOTE, pieces)


def _functions(params: ParameterText, policy: Any, space: FiniteSpace, *, expects: bool) -> list[str]:
    """Return the functions of the policy, and what they need to know of the world."""
    pieces = {"epsilon": params.epsilon}
    if hasattr(policy, "AMONG_EQUALS"):
        first = params.hyperparameters.ties == "first"
        pieces["among_highest"] = policy.FIRST_OF_EQUALS if first else policy.AMONG_EQUALS
    parts = [fill(policy.TEXT, pieces)] if hasattr(policy, "TEXT") else _posterior(policy, params, space)
    return [*parts, fill(policy.EXPECTED, pieces)] if expects else parts


def _posterior(policy: Any, params: ParameterText, space: FiniteSpace) -> list[str]:
    from rl_tui.agents.policies.thompson import new_rule

    rule = new_rule(space, params.hyperparameters)
    if rule.bernoulli:
        return [policy.BERNOULLI.strip("\n")]
    # A reward without noise settles the mean at once; the least variance spares a division by 0
    variances = [max(float(each), _LEAST_VARIANCE) for each in rule.variance]
    variance = repr(variances[0]) if len(set(variances)) == 1 else f"np.array({variances})"
    constant = f"VARIANCE = {variance}  # σ², the noise of the rewards, is told to this rule"
    return [constant, policy.GAUSSIAN.strip("\n")]


def _template(package: str, name: str) -> Any:
    """Return the module of texts of an algorithm (``algorithms``) or of a policy (``policies``).

    Raises UserError where there is none yet.
    """
    try:
        return import_module(f"rl_tui.lab.export.{package}.{name.replace('-', '_')}")
    except ModuleNotFoundError as error:
        raise UserError(f"there is no script for {name} yet") from error


def _argmax(params: ParameterText) -> str:
    """Return the function that finds the best action, with ties taken as the hyper-parameters say."""
    return _RANDOM_TIES if params.hyperparameters.ties == "random" else _FIRST_OF_TIES


def _report(text: WorldText, params: ParameterText) -> str:
    """Return what prints the policy; values that a planner has worked out are equal but for rounding."""
    worked_out = "np.isclose(values, values.max(), rtol=0, atol=1e-6)"
    equals = worked_out if params.planner else "values == values.max()"
    return fill(text.report, {**text.report_pieces, "equals": equals})
