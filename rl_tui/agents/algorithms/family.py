"""What every algorithm brings: a memory, how it acts and how it learns."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

from numpy.random import Generator

from rl_tui.agents.kernels.compiled import inlined, inlined_by_type
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import choose

# In place of the state that an update bootstrapped from, where there is none
NO_STATE: Final = -1


class Experience(NamedTuple):
    """One step in the environment: the pair taken in ``state``, its reward, and where it led."""

    state: int
    pair: int
    reward: float
    next_state: int
    terminated: bool
    truncated: bool


class Update(NamedTuple):
    """What learning changed: ``pair`` moved from ``before`` to ``after`` by ``step_size``; −1: no pair did.

    The target is ``gathered`` + ``discount``·``bootstrap``, the bootstrap being an estimate as it was before
    the update. One step gathers its reward and discounts by γ; n steps gather a discounted sum and discount
    by γⁿ; after = before + step_size·(target − before) always. ``bootstrap_state`` is the state whose
    estimates the bootstrap was read from; −1 for none, as after the end of an episode, and for a planner,
    which reads those of all that may follow. ``others`` is how many further updates the same step made
    (traces, planning), ``extreme`` which of all new estimates is furthest from 0, so that none runs away
    unseen. ``table`` is 1 or 2 where there are two tables of estimates, 0 where there is one.
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
    """Return the update of a step after which nothing was learned yet."""
    return Update(-1, 0.0, 0.0, 0.0, 0.0, 0.0, NO_STATE, 0.0, 0, 0.0, 0)


@inlined
def with_others(update: Update, others: int, extreme: float) -> Update:
    """Return ``update`` as that of a step with ``others`` besides it, the largest estimate ``extreme``."""
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
    """Return the estimate that is further from 0; NaN counts as further than all."""
    return estimate if not abs(estimate) <= abs(extreme) else extreme


@inlined_by_type
def act(memory: Any, rule: Any, tables: Tables, state: int, generator: Generator) -> tuple[int, bool]:
    """Choose the pair to take in ``state``; the second value is True if it was drawn to explore.

    Most algorithms choose A from S using the policy derived from Q. Those that have chosen already, when they
    arrived, bring a member of their own.
    """
    first, last = pairs_of(tables, state)
    return choose(rule, memory.q, memory.visits, first, last, generator)


@inlined_by_type
def on_override(memory: Any, tables: Tables, state: int, pair: int) -> None:
    """Note that a person takes ``pair`` in ``state`` in place of the agent.

    Called in place of :func:`act`, before the step. Most algorithms need do nothing: they learn from the pair
    taken, and a pair that they chose on arrival is replaced by the next one they choose.
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
    """Update the memory with the experience of one step.

    After a terminated step nothing follows: the bootstrap is 0. A truncated one still bootstraps, but
    what an algorithm remembers of the episode ends there as well.
    """
    raise NotImplementedError


@inlined_by_type
def has_room(memory: Any) -> bool:
    """Return True if the memory can take another step of this episode."""
    return True


@inlined_by_type
def back_up(memory: Any, params: KernelParameters, tables: Tables, state: int, sweep: int) -> Update:
    """Take a planner's next step: back up ``state`` in ``sweep``, counted from 0.

    The update is that of the best pair; ``others`` counts those of the state that moved besides it.
    """
    raise NotImplementedError


@inlined_by_type
def has_converged(memory: Any, params: KernelParameters) -> bool:
    """Return True, at the end of a sweep, if the planner is done."""
    raise NotImplementedError
