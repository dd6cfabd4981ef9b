"""Tables of algorithms and policies, without numba, so lists and help stay fast."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final, Literal

# The symbols of an update


class Lookup(Enum):
    """Estimates of the next state that an update uses."""

    BEST = auto()  # the greatest
    NEXT = auto()  # the next action's
    MEAN = auto()  # all, weighted by the policy
    OTHER = auto()  # the best action's, in the other of two tables
    POLICY = auto()  # of the planner's policy


@dataclass(frozen=True, slots=True)
class UpdateTerms:
    """Symbols of target = gathered + discount · bootstrap, by default those of Q-learning.

    Args:
        bootstrap: Empty without one. ``{next}`` is the next state, ``{own}`` and ``{other}`` are the two
            tables.
        others: Origin of further updates of the step, shown after their number.
        waiting: Why nothing was updated yet.
        one_step: True if `lookup` reads the state one step later.
    """

    gathered: str = "r"
    discount: str = "γ"
    bootstrap: str = "max Q({next},·)"
    others: str = "more"
    waiting: str = "nothing was updated"
    lookup: Lookup = Lookup.BEST
    one_step: bool = True


_STEP_SIZE: Final = ("alpha", "step_size_schedule", "alpha_min", "alpha_decay")
_TD: Final = (*_STEP_SIZE, "gamma", "policy", "initial_q")


@dataclass(frozen=True, slots=True)
class Algorithm:
    """Texts of an algorithm, and the module with its code.

    Args:
        parameters: In the order of the settings panel, without the policy's.
        planner: True if it backs up states with the model instead of taking steps.
        counts_updates: True if a sample average counts its own updates, which come later or in two tables.
        updates_own_pair: True if each step updates exactly its own pair, immediately and by one step.
        takes_orders: True if a user can order evaluation or improvement, by ``phase_of``, ``order`` and
            ``ordered`` of the module.
    """

    id: str
    name: str
    summary: str
    equation: str
    source: str
    module: str
    parameters: tuple[str, ...]
    planner: bool = False
    update: UpdateTerms = field(default_factory=UpdateTerms)
    counts_updates: bool = False
    updates_own_pair: bool = False
    takes_orders: bool = False


_ALGORITHMS: Final[tuple[Algorithm, ...]] = (
    Algorithm(
        id="q-learning",
        name="Q-learning",
        summary="off-policy TD control: learns the greedy policy's values while it explores",
        equation="Q(S,A) ← Q(S,A) + α [R + γ max Q(S′,·) − Q(S,A)]",
        source="equation 6.8, box on page 131",
        module="rl_tui.agents.algorithms.q_learning",
        parameters=_TD,
        updates_own_pair=True,
    ),
    Algorithm(
        id="sarsa",
        name="SARSA",
        summary="on-policy TD control: learns the values of the policy it follows, exploration included",
        equation="Q(S,A) ← Q(S,A) + α [R + γ Q(S′,A′) − Q(S,A)]",
        source="equation 6.7, box on page 130",
        module="rl_tui.agents.algorithms.sarsa",
        parameters=_TD,
        update=UpdateTerms(bootstrap="Q({next},a′)", lookup=Lookup.NEXT),
        updates_own_pair=True,
    ),
    Algorithm(
        id="expected-sarsa",
        name="Expected SARSA",
        summary="averages next actions: SARSA with their mean instead of the one taken",
        equation="Q(S,A) ← Q(S,A) + α [R + γ Σ π(a|S′) Q(S′,a) − Q(S,A)]",
        source="equation 6.9, section 6.6",
        module="rl_tui.agents.algorithms.expected_sarsa",
        parameters=_TD,
        update=UpdateTerms(bootstrap="Σ π Q({next},·)", lookup=Lookup.MEAN),
        updates_own_pair=True,
    ),
    Algorithm(
        id="double-q-learning",
        name="Double Q-learning",
        summary="two tables: each judges the best action of the other, so there is no maximization bias",
        equation="Q₁(S,A) ← Q₁(S,A) + α [R + γ Q₂(S′, argmax Q₁(S′,·)) − Q₁(S,A)]",
        source="equation 6.10, box on page 136",
        module="rl_tui.agents.algorithms.double_q_learning",
        parameters=_TD,
        update=UpdateTerms(bootstrap="Q{other}({next}, best of Q{own})", lookup=Lookup.OTHER),
        counts_updates=True,
        updates_own_pair=True,
    ),
    Algorithm(
        id="n-step-sarsa",
        name="n-step SARSA",
        summary="waits for n rewards, then updates: between SARSA and Monte Carlo",
        equation="Q(Sₜ,Aₜ) ← Q(Sₜ,Aₜ) + α [R + γR + … + γⁿ Q(Sₜ₊ₙ,Aₜ₊ₙ) − Q(Sₜ,Aₜ)]",
        source="equation 7.5, box on page 147",
        module="rl_tui.agents.algorithms.n_step_sarsa",
        parameters=(*_TD, "n"),
        update=UpdateTerms(
            gathered="G",
            discount="γⁿ",
            bootstrap="Q({next},a′)",
            others="more at the end of the episode",
            waiting="waits until n rewards are gathered",
            lookup=Lookup.NEXT,
            one_step=False,
        ),
        counts_updates=True,
    ),
    Algorithm(
        id="sarsa-lambda",
        name="SARSA(λ)",
        summary="eligibility traces: one step also updates earlier pairs, recent ones most",
        equation="Q ← Q + α δ e,  δ = R + γ Q(S′,A′) − Q(S,A),  e ← γλ e",
        source="section 12.7, box on page 305 for one feature a pair",
        module="rl_tui.agents.algorithms.sarsa_lambda",
        parameters=(*_TD, "lambda", "traces"),
        update=UpdateTerms(bootstrap="Q({next},a′)", others="more by their traces", lookup=Lookup.NEXT),
    ),
    Algorithm(
        id="q-lambda",
        name="Watkins's Q(λ)",
        summary="traces for Q-learning, cut wherever an action is not greedy",
        equation="Q ← Q + α δ e,  δ = R + γ max Q(S′,·) − Q(S,A),  e ← γλ e or 0",
        source="section 12.10",
        module="rl_tui.agents.algorithms.q_lambda",
        parameters=(*_TD, "lambda", "traces"),
        update=UpdateTerms(others="more by their traces"),
    ),
    Algorithm(
        id="dyna-q",
        name="Dyna-Q",
        summary="learns a model: Q-learning that also practises in its model between steps",
        equation="Model(S,A) ← R, S′;  n times: Q-learning on a remembered (S,A)",
        source="box on page 164",
        module="rl_tui.agents.algorithms.dyna_q",
        parameters=(*_TD, "planning_steps"),
        update=UpdateTerms(others="more from the model"),
    ),
    Algorithm(
        id="prioritized-sweeping",
        name="Prioritized sweeping",
        summary="plans backwards, from where values have just changed most",
        equation="P = |R + γ max Q(S′,·) − Q(S,A)|;  the largest P first, then what leads there",
        source="box on page 170",
        module="rl_tui.agents.algorithms.prioritized_sweeping",
        parameters=(*_TD, "planning_steps", "threshold"),
        update=UpdateTerms(others="more from the model", waiting="no change above θ: nothing to update"),
    ),
    Algorithm(
        id="monte-carlo",
        name="Monte Carlo",
        summary="every-visit control: waits for the end of the episode and learns from whole returns",
        equation="G ← γG + R,  Q(Sₜ,Aₜ) ← Q(Sₜ,Aₜ) + α [G − Q(Sₜ,Aₜ)]",
        source="section 5.4, after the box on page 101; unlike it, bootstraps at a time limit",
        module="rl_tui.agents.algorithms.monte_carlo",
        parameters=_TD,
        update=UpdateTerms(
            gathered="G",
            discount="γᵀ",
            bootstrap="Σ π Q({next},·)",
            others="more, back to its start",
            waiting="waits for the end of the episode",
            lookup=Lookup.MEAN,
            one_step=False,
        ),
        counts_updates=True,
    ),
    Algorithm(
        id="value-iteration",
        name="Value iteration",
        summary="a planner: sweeps over all states with the model and keeps the best value",
        equation="Q(s,a) ← Σ p(s′,r|s,a) [r + γ max Q(s′,·)]",
        source="equation 4.10, box on page 83",
        module="rl_tui.agents.algorithms.value_iteration",
        parameters=("gamma", "accuracy", "initial_q"),
        planner=True,
        update=UpdateTerms(gathered="Σ p r", bootstrap="Σ p max Q(s′,·)", others="more of this state"),
    ),
    Algorithm(
        id="policy-iteration",
        name="Policy iteration",
        summary="a planner: evaluates a policy in sweeps, then improves it, and again",
        equation="V(s) ← Σ p(s′,r|s,π(s)) [r + γ V(s′)],  then π(s) ← argmax",
        source="section 4.3, box on page 80",
        module="rl_tui.agents.algorithms.policy_iteration",
        parameters=("gamma", "accuracy", "initial_q", "ties"),
        planner=True,
        update=UpdateTerms(
            gathered="Σ p r", bootstrap="Σ p V(s′)", others="more of this state", lookup=Lookup.POLICY
        ),
        takes_orders=True,
    ),
)

BY_ID: Final = {algorithm.id: algorithm for algorithm in _ALGORITHMS}
"""All algorithms by id, in display order."""

OWN_PROGRAM: Final = Algorithm(
    id="own-program",
    name="your program",
    summary="learning by your own program, whose update is not known",
    equation="",
    source="",
    module="",
    parameters=(),
    update=UpdateTerms(bootstrap="", waiting="your program changed nothing"),
)
"""The row for a user's own program, which cannot be chosen as an algorithm."""


def algorithm_row(algorithm: str) -> Algorithm:
    """Return the row of an algorithm, or of a user's program."""
    return OWN_PROGRAM if algorithm == OWN_PROGRAM.id else BY_ID[algorithm]


@dataclass(frozen=True, slots=True)
class Policy:
    """Texts of a policy, and the module with its code.

    Args:
        bandits_only: True if it works in a single state only.
        explores_by_epsilon: True if it acts greedily, except with probability ε.
        needs_step_size: True if it cannot use the sample average.
        counts_visits: True if it reads N(s, a).
    """

    id: str
    name: str
    summary: str
    equation: str
    source: str
    module: str
    parameters: tuple[str, ...]
    bandits_only: bool = False
    explores_by_epsilon: bool = False
    needs_step_size: bool = False
    counts_visits: bool = False


_POLICIES: Final[tuple[Policy, ...]] = (
    Policy(
        id="epsilon-greedy",
        name="ε-greedy",
        summary="the best action, but with probability ε a random action; ε = 0 is greedy",
        equation="A ← argmax Q(S,·), or with probability ε a random action",
        source="section 2.2",
        module="rl_tui.agents.policies.epsilon_greedy",
        parameters=("epsilon", "epsilon_schedule", "epsilon_min", "epsilon_decay", "ties"),
        explores_by_epsilon=True,
    ),
    Policy(
        id="softmax",
        name="softmax",
        summary="better actions more often; τ sets by how much",
        equation="π(a|S) = exp(Q(S,a)/τ) / Σ exp(Q(S,b)/τ)",
        source="section 13.1, exercise 2.9",
        module="rl_tui.agents.policies.softmax",
        parameters=("temperature",),
    ),
    Policy(
        id="ucb",
        name="UCB",
        summary="highest upper bound: an action that was good so far, or rarely tried",
        equation="A ← argmax [Q(S,a) + c √(ln N(S) / N(S,a))]",
        source="equation 2.10, section 2.7",
        module="rl_tui.agents.policies.ucb",
        parameters=("confidence", "ties"),
        counts_visits=True,
    ),
    Policy(
        id="gradient",
        name="gradient bandit",
        summary="learns preferences, not values: a reward above the baseline raises the preference",
        equation="H(A) ← H(A) + α (R − R̄)(1 − π(A)),  H(a) ← H(a) − α (R − R̄) π(a)",
        source="equation 2.12, section 2.8",
        module="rl_tui.agents.policies.gradient",
        parameters=("baseline",),
        bandits_only=True,
        needs_step_size=True,
    ),
    Policy(
        id="thompson",
        name="Thompson sampling",
        summary="draws a possible mean for each arm from its posterior, and takes the best",
        equation="A ← argmax of a draw from each arm's posterior",
        source="section 2.10, posterior sampling",
        module="rl_tui.agents.policies.thompson",
        parameters=("ties",),
        bandits_only=True,
    ),
)

POLICY_BY_ID: Final = {policy.id: policy for policy in _POLICIES}
"""All policies by id, in display order."""


def algorithm_of(algorithm: str) -> Algorithm:
    """Return an algorithm, or raise ValueError with all ids."""
    if algorithm not in BY_ID:
        raise ValueError(f"there is no algorithm {algorithm}; expected one of {', '.join(BY_ID)}")
    return BY_ID[algorithm]


def parameters_of(algorithm: str, policy: str) -> tuple[str, ...]:
    """Return all hyperparameters in the order of the settings panel."""
    own = algorithm_row(algorithm).parameters
    if "policy" not in own:
        return own
    place = own.index("policy") + 1
    return (*own[:place], *POLICY_BY_ID[policy].parameters, *own[place:])


# The sweeps of policy iteration


SweepPhase = Literal["evaluation", "improvement"]

SWEEP_PHASES: Final[tuple[SweepPhase, ...]] = ("evaluation", "improvement")
"""All phases. Kernels use their indices."""
