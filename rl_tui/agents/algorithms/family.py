"""The interface of all algorithms: memory, acting and learning."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

from numpy.random import Generator

from rl_tui.agents.kernels.compiled import inlined, inlined_by_type
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import choose

# The state of an update that did not bootstrap
NO_STATE: Final = -1


class Experience(NamedTuple):
    """One step in the environment."""

    state: int
    pair: int
    reward: float
    next_state: int
    terminated: bool
    truncated: bool


class Update(NamedTuple):
    """The result of learning from one step: `pair` moved from `before` to `after`.

    The target is `gathered` + `discount` · `bootstrap`, and after = before + step_size · (target − before). A
    one-step method gathers the reward and discounts by γ. An n-step method gathers a discounted sum and
    discounts by γⁿ.

    Args:
        pair: −1 if nothing was updated.
        bootstrap_state: −1 for none, and for planners, which read several.
        others: Number of further updates of the step (traces, planning).
        extreme: The new estimate with the largest magnitude, to detect divergence.
        table: 1 or 2 for algorithms with two tables, else 0.
    """

    pair: int
    before: float
    step_size: float
    gathered: float
    discount: float
    bootstrap: float
    bootstrap_state: int
    after: float
    others: int
    extreme: float
    table: int


@inlined
def one_update(
    pair: int,
    before: float,
    step_size: float,
    gathered: float,
    discount: float,
    bootstrap: float,
    bootstrap_state: int,
    after: float,
) -> Update:
    """Return the update of a step that changed one estimate."""
    return Update(pair, before, step_size, gathered, discount, bootstrap, bootstrap_state, after, 0, after, 0)


@inlined
def no_update() -> Update:
    """Return the update of a step that changed nothing."""
    return Update(-1, 0.0, 0.0, 0.0, 0.0, 0.0, NO_STATE, 0.0, 0, 0.0, 0)


@inlined
def with_others(update: Update, others: int, extreme: float) -> Update:
    """Add the other updates of a step, and their `extreme`."""
    return Update(
        update.pair,
        update.before,
        update.step_size,
        update.gathered,
        update.discount,
        update.bootstrap,
        update.bootstrap_state,
        update.after,
        others,
        extreme,
        update.table,
    )


@inlined
def further(extreme: float, estimate: float) -> float:
    """Return the number with the larger magnitude. NaN counts as the largest."""
    return estimate if not abs(estimate) <= abs(extreme) else extreme


@inlined_by_type
def act(memory: Any, rule: Any, tables: Tables, state: int, generator: Generator) -> tuple[int, bool]:
    """Choose the pair to take in `state`. Return it, and True if it was drawn to explore.

    Algorithms that chose on arrival have their own member.
    """
    first, last = pairs_of(tables, state)
    return choose(rule, memory.q, memory.visits, first, last, generator)


@inlined_by_type
def on_override(memory: Any, tables: Tables, state: int, pair: int) -> None:
    """Note, before the step, that a person takes `pair` instead of :func:`act`.

    Most algorithms do nothing: the next choice replaces the one made on arrival.
    """
    return


@inlined_by_type
def learn(
    memory: Any,
    rule: Any,
    params: KernelParameters,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> Update:
    """Update the memory in place with one step.

    After a terminated step the bootstrap is 0. After a truncated one the algorithm still bootstraps, but its
    memory of the episode ends too.
    """
    raise NotImplementedError


@inlined_by_type
def has_room(memory: Any) -> bool:
    """Return True if the memory can hold another step of this episode."""
    return True


@inlined_by_type
def back_up(memory: Any, params: KernelParameters, tables: Tables, state: int, sweep: int) -> Update:
    """Back up `state` in a sweep, from 0, and return the update of its best pair.

    Other pairs that moved count as ``others``.
    """
    raise NotImplementedError


@inlined_by_type
def has_converged(memory: Any, params: KernelParameters) -> bool:
    """Return True, after a sweep, if the planner is finished."""
    raise NotImplementedError
