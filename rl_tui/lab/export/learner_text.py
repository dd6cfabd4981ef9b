"""The part of a script that learns."""

from __future__ import annotations

from typing import Any, Final

from rl_tui.lab.export.pieces import BEGIN_WORLD, argmax, report, template
from rl_tui.lab.export.settings_text import Told
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds.text import WorldText
from rl_tui.worlds.mdp.space import FiniteSpace

_END_OF_TIME: Final = "# An episode that is only cut off would have gone on: it is not worth 0 from here"
_CUT_OFF: Final = "G = 0.0 if terminated else expected_value(state)  # what is cut off would have gone on"
_PRINTED: Final = """
print(f"mean return of the last {len(returns[-100:])} episodes: {np.mean(returns[-100:]):.3f}")

$report
"""
_LEAST_VARIANCE: Final = 1e-12


def learner_text(told: Told, text: WorldText, space: FiniteSpace) -> list[str]:
    """Return the parts that make the world, choose actions, learn, and print what was learned."""
    algorithm, rule = template("algorithms", told.algorithm), template("rules", told.values.policy)
    loop = fill(algorithm.TEXT, _pieces(told, text, algorithm, rule))
    functions = _functions(told, rule, space, expects="expected_value" in loop)
    needs_argmax = any(" argmax(" in each or "[argmax(" in each for each in [loop, *functions])
    return [
        text.setup,
        BEGIN_WORLD,
        text.new_table,
        _tables(told, algorithm, rule),
        *([argmax(told)] if needs_argmax else []),
        *functions,
        loop,
        fill(_PRINTED, {"report": report(text, told)}),
    ]


def _tables(told: Told, algorithm: Any, rule: Any) -> str:
    """Return what remembers: Q, and what the algorithm and the rule need besides."""
    lines = ["Q = new_table(INITIAL_Q)"]
    if told.counts_visits:
        step_size = "; the step size is 1/N" if told.sample_average and not told.counts_updates else ""
        lines.append(f"N = new_table(0.0)  # how often each action was taken{step_size}")
    counts = {"update_counts": algorithm.COUNTS if told.counts_updates else ""}
    own = fill(algorithm.TABLES, counts) if hasattr(algorithm, "TABLES") else ""
    of_rule = rule.TABLES.strip("\n") if hasattr(rule, "TABLES") else ""
    return "\n".join([*lines, *(each for each in (own, of_rule) if each)])


def _pieces(told: Told, text: WorldText, algorithm: Any, rule: Any) -> dict[str, str]:
    """Return what the loop of an algorithm leaves open."""
    state, action = getattr(algorithm, "UPDATED", ("state", "action"))
    counts = "updates" if told.counts_updates else "N"
    accumulates = told.values.traces == "accumulating"
    visits = "N[state][action] += 1" if told.counts_visits else ""
    return {
        "begin": told.begin(),
        "note": "\n".join(each for each in (visits, _note(told, rule)) if each),
        "alpha": told.alpha(state, action, counts),
        "count_update": getattr(algorithm, "COUNT_UPDATE", "") if told.counts_updates else "",
        "end_of_time": _END_OF_TIME if text.truncates else "",
        "trace": "trace.get((state, action), 0.0) + 1.0" if accumulates else "1.0",
        "first_return": _CUT_OFF if text.truncates else "G = 0.0",
    }


def _note(told: Told, rule: Any) -> str:
    """Return what an action rule learns from a step; most learn nothing."""
    if not hasattr(rule, "NOTE"):
        return ""
    pieces = {"rule_alpha": told.alpha("state", "action", "N")}
    if hasattr(rule, "BASELINE"):
        with_baseline = told.values.baseline == "mean"
        pieces["baseline"] = rule.BASELINE if with_baseline else rule.NO_BASELINE
        pieces["mean"] = rule.MEAN if with_baseline else ""
    return fill(rule.NOTE, pieces)


def _functions(told: Told, rule: Any, space: FiniteSpace, *, expects: bool) -> list[str]:
    """Return the functions of the action rule, and what they need to know of the world."""
    pieces = {"epsilon": told.epsilon}
    if hasattr(rule, "AMONG_EQUALS"):
        first = told.values.ties == "first"
        pieces["among_highest"] = rule.FIRST_OF_EQUALS if first else rule.AMONG_EQUALS
    parts = [fill(rule.TEXT, pieces)] if hasattr(rule, "TEXT") else _posterior(rule, told, space)
    return [*parts, fill(rule.EXPECTED, pieces)] if expects else parts


def _posterior(rule: Any, told: Told, space: FiniteSpace) -> list[str]:
    from rl_tui.agents.policies.thompson import new_rule

    known = new_rule(space, told.values)
    if known.bernoulli:
        return [rule.BERNOULLI.strip("\n")]
    # A reward without noise settles the mean at once; the least variance spares a division by 0
    variances = [max(float(each), _LEAST_VARIANCE) for each in known.variance]
    variance = repr(variances[0]) if len(set(variances)) == 1 else f"np.array({variances})"
    told_to = f"VARIANCE = {variance}  # σ², the noise of the rewards, is told to this rule"
    return [told_to, rule.GAUSSIAN.strip("\n")]
