"""The part of a script that makes the agent: it learns or plans, and prints the policy."""

from __future__ import annotations

from typing import Final

from rl_tui.agents.catalogue import Algorithm, Policy
from rl_tui.agents.compatibility import is_bandit
from rl_tui.common.errors import UserError
from rl_tui.lab.export.parameter_text import ParameterText
from rl_tui.lab.export.template import fill, sections
from rl_tui.lab.export.worlds.text import WorldText
from rl_tui.worlds.mdp.space import FiniteSpace

_TEXTS: Final = f"{__package__}.agent"
_BEGIN_WORLD: Final = "env.reset(seed=SEED)  # the randomness of the world"
_NEW_Q: Final = "Q = new_table(INITIAL_Q)"
_LEAST_VARIANCE: Final = 1e-12


def learner_text(params: ParameterText, text: WorldText, space: FiniteSpace) -> list[str]:
    """Return the parts that make the world, choose actions, learn, and print what was learned.

    Raises UserError where the algorithm or the policy has no text for scripts.
    """
    flags = {*params.flags, *(["time limit"] if text.truncates else [])}
    reward_flags, noise = _known_rewards(params, space)
    algorithm = _texts_of(params.algorithm, params, flags)
    policy = _texts_of(params.policy, params, {*flags, *reward_flags})
    own = sections(_TEXTS, flags)
    visit = "N[state][action] += 1" if params.counts_visits else ""
    pieces = {
        "schedules": params.schedules(),
        "note": "\n".join(each for each in (visit, policy.get("note", "")) if each),
    }
    loop = fill(algorithm["learn"], pieces)
    functions = [fill(policy["choose"], {"noise": noise})]
    if "expected_value" in loop:
        functions.append(policy["expected value"])
    return [
        text.setup,
        _BEGIN_WORLD,
        text.new_table,
        _tables(params, algorithm, policy),
        *_argmax(own, [loop, *functions]),
        *functions,
        loop,
        fill(own["learned"], {"report": _report(text, params)}),
    ]


def planner_text(params: ParameterText, text: WorldText) -> list[str]:
    """Return the parts that make the world, plan with its model, and play what was planned.

    Raises UserError where the world of the script has no model, or the algorithm no text for scripts.
    """
    if not text.starts:
        raise UserError(
            "no script: this environment itself shows no transition table to plan with; take an algorithm "
            "that learns, such as q-learning"
        )
    planner, own = _texts_of(params.algorithm, params, params.flags), sections(_TEXTS, params.flags)
    pieces = {
        "fields": text.fields.replace("noise", "_"),
        "starts": text.starts,
        "act": planner["act"],
        "report": _report(text, params),
    }
    played = fill(own["played"], pieces)
    return [
        text.setup,
        _BEGIN_WORLD,
        *([text.model] if text.model else []),
        text.new_table,
        _NEW_Q,
        *_argmax(own, [planner["plan"], played]),
        fill(own["look ahead"], pieces),
        planner["plan"],
        played,
    ]


def _texts_of(row: Algorithm | Policy, params: ParameterText, flags: set[str]) -> dict[str, str]:
    """Return the texts beside the kernel of an algorithm or a policy; raises UserError if there are none."""
    try:
        texts = sections(row.module, flags)
    except (FileNotFoundError, ModuleNotFoundError, ValueError) as error:  # no text, no package, none named
        raise UserError(f"there is no script for {row.id} yet") from error
    return {name: params.in_episode(text) for name, text in texts.items()}


def _tables(params: ParameterText, algorithm: dict[str, str], policy: dict[str, str]) -> str:
    """Return the tables: Q, and what the algorithm and the policy need besides."""
    lines = [_NEW_Q]
    if params.counts_visits:
        averages = params.sample_average and not params.algorithm.counts_updates
        step_size = "; the step size is 1/N" if averages else ""
        lines.append(f"N = new_table(0.0)  # how often each action was taken{step_size}")
    lines += [texts["tables"] for texts in (algorithm, policy) if texts.get("tables")]
    return "\n".join(lines)


def _known_rewards(params: ParameterText, space: FiniteSpace) -> tuple[list[str], str]:
    """Return what posterior sampling is told of the arms of a bandit: a flag, or a line with their noise."""
    from rl_tui.agents.policies.thompson import new_rule

    if not is_bandit(space):
        return [], ""
    rule = new_rule(space, params.hyperparameters)
    if rule.bernoulli:
        return ["bernoulli"], ""
    # A reward without noise settles the mean at once; the least variance spares a division by 0
    variances = [max(float(each), _LEAST_VARIANCE) for each in rule.variance]
    variance = repr(variances[0]) if len(set(variances)) == 1 else f"np.array({variances})"
    return [], f"VARIANCE = {variance}  # σ², the noise of the rewards, is told to this rule"


def _argmax(own: dict[str, str], parts: list[str]) -> list[str]:
    """Return the function that finds the best action, if any of ``parts`` calls it."""
    return [own["argmax"]] if any(" argmax(" in each or "[argmax(" in each for each in parts) else []


def _report(text: WorldText, params: ParameterText) -> str:
    """Return what prints the policy; values that a planner has worked out are equal but for rounding."""
    worked_out = "np.isclose(values, values.max(), rtol=0, atol=1e-6)"
    equals = worked_out if params.algorithm.planner else "values == values.max()"
    return fill(text.report, {**text.report_pieces, "equals": equals})
