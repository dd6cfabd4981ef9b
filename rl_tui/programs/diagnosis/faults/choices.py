"""Choices of actions that may prevent any reward, and steps after the end."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.first_update import first_wait
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.programs.diagnosis.faults.cells import Proof, step_text
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.code_places import ProgramCode
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_world import world_of_program

MOST_LUCK: Final = 1e-4
"""Probability of bad luck below which a risk is reported."""
_FEWEST: Final = 200
_DEVIATIONS: Final = 10.0
"""Deviation of a share, in standard deviations, that rules out chance."""


class Risk(NamedTuple):
    """A risk, with the probability `luck` that random choices among equal values do no better."""

    proof: Proof
    luck: float


def risk_of_choices(evidence: Evidence, log: ProgramLog, names: CodeNames) -> Risk | None:
    """Return the risk of preferring an action before learning."""
    if evidence.changes.step.size or evidence.initial.any():
        return None  # a dict filled with zeros has learned nothing
    if not len(evidence) or evidence.reward.any():
        return None
    taken = np.bincount(evidence.action, minlength=evidence.actions)
    favourite, total = int(taken.argmax()), int(taken.sum())
    even = total / evidence.actions
    if total < _FEWEST or taken[favourite] - even < _DEVIATIONS * math.sqrt(even):
        return None
    episodes = int(evidence.episode[-1] - evidence.episode[0])
    chance = _chance_at_random(log, episodes)
    return None if chance is None else Risk(_proof(evidence, favourite, episodes, names), 1.0 - chance)


def proof_of_risk(evidence: Evidence, log: ProgramLog, names: CodeNames) -> Proof | None:
    """Return the risk if random choices would almost surely have found a reward."""
    risk = risk_of_choices(evidence, log, names)
    if risk is None or risk.luck >= MOST_LUCK:
        return None
    sure = f" Random actions would have found a reward with a probability above {1.0 - MOST_LUCK}."
    return replace(risk.proof, text=risk.proof.text + sure)


def _chance_at_random(log: ProgramLog, episodes: int) -> float | None:
    if len(log.environments) != 1:
        return None
    try:
        mdp = world_of_program(log.environments[0]).world.mdp
        if mdp is None:
            return None
        chance = first_wait(mdp, "q-learning", Hyperparameters(ties="random", initial_q=0.0)).chance
    except (NoExactAnswer, UserError):
        return None
    return 1.0 if chance >= 1.0 else -math.expm1(episodes * math.log1p(-chance))


def _proof(evidence: Evidence, favourite: int, episodes: int, names: CodeNames) -> Proof:
    chosen = np.flatnonzero(evidence.action == favourite)
    others = len(evidence) - len(chosen)
    the_last = "the last " if evidence.recording.first else ""
    without = f"No reward was seen in {the_last}{episodes:,} episodes, and nothing was learned."
    if others:
        fault, were = CodeFault.FIRST_OF_TIES, f"of {len(evidence):,} choices between equal values were"
        fix = f"choose at random among the best actions: {names.random_tie()}"
    else:
        fault, were = CodeFault.NEVER_EXPLORES, "actions were"
        random = f"{names.action} = random.randrange({evidence.actions})"
        fix = f"take a random action with probability ε, otherwise one of the best: {random}"
    text = f"{'' if others else 'All '}{len(chosen):,} {were} action {favourite}. {without}"
    return Proof(fault, evidence.number[chosen], others, text, fix, ProgramCode.choice_line)


# Steps after the end


_UNDEFINED: Final = re.compile(r"(FrozenLake(8x8)?|CliffWalking(Slippery)?|Taxi|Blackjack)-v\d+")
"""Ids of environments without a meaning for steps after the end."""


def proof_of_steps_after_end(evidence: Evidence, log: ProgramLog, names: CodeNames) -> Proof | None:
    """Prove that `env.step` is called in a terminal state of Gymnasium's own environments.

    Elsewhere an end may be a limit, or the next episode may begin automatically.
    """
    undefined = [each.number for each in log.environments if _UNDEFINED.fullmatch(each.id)]
    order = np.lexsort((evidence.number, evidence.episode))
    before, after = order[:-1], order[1:]
    goes_on = (evidence.episode[before] == evidence.episode[after]) & evidence.terminated[before]
    goes_on &= evidence.state[after] == evidence.next_state[before]  # it may have been set
    goes_on &= np.isin(evidence.environment[after], undefined)
    if not goes_on.any():
        return None
    first = before[goes_on][np.argmin(after[goes_on])]
    steps = evidence.number[np.sort(after[goes_on])]
    return Proof(
        CodeFault.STEPS_AFTER_END,
        steps,
        0,
        f"At {step_text(evidence.number[first])} the episode ended in a terminal state, but "
        f"{step_text(steps[0])} was taken there without a reset. Such a step has no meaning.",
        f"begin the next episode when {names.terminated} or truncated is true: "
        f"{names.state}, info = {names.environment}.reset()",
        ProgramCode.call_line,
    )
