"""Breakpoints: the loops stop after exactly the step with an event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.agents.algorithms.family import Experience, Update
from rl_tui.agents.kernels.compiled import compiled, compiled_for, inlined
from rl_tui.agents.kernels.machine_code import fastest
from rl_tui.agents.kernels.position import DONE, EPISODES_FULL, NOTICED
from rl_tui.agents.kernels.tables import Tables, pairs_of, state_of, tables_of
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import smallest_mdp

NONE = -1
# Indices into Watch.noticed
_REWARD, _POLICY, _CELL, _STATE, _PAIR = range(5)


@dataclass(frozen=True, slots=True)
class Watching:
    """Events to stop after.

    Args:
        reward: A step with a non-zero reward.
        policy: A change of the greedy policy in any state: its tied best actions, or the first one if ties
            take the first. Only equal floats tie.
        cell: The estimate of this pair reaches or crosses `threshold`.
        states: The agent enters one, by a step or at the start of a later episode. A planner backs one up.
        pairs: One of these is taken. A planner updates one.
    """

    reward: bool = False
    policy: bool = False
    cell: int | None = None
    threshold: float = 0.0
    states: frozenset[int] = frozenset()
    pairs: frozenset[int] = frozenset()


class WatchedEvents(NamedTuple):
    """Watched events of one step, with the marked `state` and `pair`, if any."""

    reward: bool = False
    policy: bool = False
    cell: bool = False
    state: int | None = None
    pair: int | None = None


NOTHING_NOTICED = WatchedEvents()


class Watch(NamedTuple):
    """Watched events for the loops. Single values are arrays of one element.

    Args:
        cell: Watched pair, or −1.
        side: Sign of its estimate minus the threshold, changed by the loops.
        states: [S], or empty.
        pairs: [P], or empty.
        greedy: 1 for each pair of the former greedy policy, [P], or empty, changed by the loops.
        noticed: Events of the last step, [5]: reward, policy, cell (1 or 0), state and pair (−1 for none).
    """

    active: BoolArray
    reward: BoolArray
    policy: BoolArray
    cell: IntArray
    threshold: FloatArray
    side: IntArray
    states: BoolArray
    pairs: BoolArray
    greedy: npt.NDArray[np.uint8]
    noticed: IntArray


def new_watch(
    watching: Watching, space: FiniteSpace, tables: Tables, q: FloatArray, random_ties: bool
) -> Watch:
    """Return the watch for `watching`, from estimates `q`, [P], or raise ValueError."""
    cell = NONE if watching.cell is None else watching.cell
    if not -1 <= cell < space.pairs:
        raise ValueError(f"watched cell {cell}; expected a pair in 0..{space.pairs - 1}")
    watch = Watch(
        active=np.array([watching != Watching(threshold=watching.threshold)]),
        reward=np.array([watching.reward]),
        policy=np.array([watching.policy]),
        cell=np.array([cell], dtype=np.int64),
        threshold=np.array([watching.threshold], dtype=np.float64),
        side=np.array([0 if cell == NONE else _side(float(q[cell]), watching.threshold)], dtype=np.int64),
        states=_marks("state", watching.states, space.states),
        pairs=_marks("pair", watching.pairs, space.pairs),
        greedy=np.zeros(space.pairs if watching.policy else 0, dtype=np.uint8),
        noticed=np.array([0, 0, 0, NONE, NONE], dtype=np.int64),
    )
    if watching.policy:
        fastest(policy_changed)(watch.greedy, q, tables, random_ties, 0, space.states)
    return watch


def _marks(what: str, marked: frozenset[int], count: int) -> BoolArray:
    unknown = [each for each in sorted(marked) if not 0 <= each < count]
    if unknown:
        raise ValueError(f"watched {what} {unknown[0]}; expected one in 0..{count - 1}")
    marks = np.zeros(count if marked else 0, dtype=np.bool_)
    marks[list(marked)] = True
    return marks


def noticed_by(watch: Watch) -> WatchedEvents:
    """Return the watched events of the last step."""
    reward, policy, cell, state, pair = watch.noticed.tolist()
    return WatchedEvents(
        bool(reward),
        bool(policy),
        bool(cell),
        None if state == NONE else state,
        None if pair == NONE else pair,
    )


def forget(watch: Watch) -> None:
    """Clear the events of the last step."""
    watch.noticed[:] = (0, 0, 0, NONE, NONE)


@inlined
def watched(
    watching: bool,
    watch: Watch,
    q: FloatArray,
    random_ties: bool,
    tables: Tables,
    experience: Experience,
    update: Update,
    start: int,
    stop: int,
) -> int:
    """Return the reason to stop after a step that would have stopped for `stop` (0: continue).

    The flag `watching` is ``watch.active[0]``, read once before the loop. The start of the next step is
    `start`: after an episode the new start, for a planner the state backed up. A final stop and the end of a
    planner have priority.
    """
    if watching and notice(watch, q, random_ties, tables, experience, update, start):
        return NOTICED if stop in (DONE, EPISODES_FULL) else stop
    return stop


@compiled
def notice(
    watch: Watch,
    q: FloatArray,
    random_ties: bool,
    tables: Tables,
    experience: Experience,
    update: Update,
    start: int,
) -> bool:
    """Store the watched events of a step, and return True if there are any. Not inlined, to compile only
    once.

    For a planner that backed up the state where it landed, the pair is −1.
    """
    seen, pair, landed = watch.noticed, experience.pair, experience.next_state
    seen[_REWARD] = watch.reward[0] and experience.reward != 0.0
    seen[_CELL] = watch.cell[0] >= 0 and _reached(watch, q[watch.cell[0]])
    seen[_STATE] = NONE
    if len(watch.states) > 0 and watch.states[landed]:
        seen[_STATE] = landed
    elif len(watch.states) > 0 and watch.states[start]:
        seen[_STATE] = start
    seen[_PAIR] = _marked_pair(watch.pairs, tables, pair, landed)
    seen[_POLICY] = False
    if watch.policy[0]:
        first, last = 0, 0
        if pair < 0:  # a planner changes only one state
            first, last = landed, landed + 1
        elif update.others > 0:
            first, last = 0, len(tables.first_pair) - 1
        elif update.pair >= 0:
            first = state_of(tables, update.pair)
            last = first + 1
        seen[_POLICY] = policy_changed(watch.greedy, q, tables, random_ties, first, last)
    marked = seen[_STATE] >= 0 or seen[_PAIR] >= 0
    return bool(marked or seen[_REWARD] + seen[_POLICY] + seen[_CELL] > 0)


@inlined
def _side(estimate: float, threshold: float) -> int:
    if estimate == threshold:
        return 0
    return 1 if estimate > threshold else -1


@inlined
def _reached(watch: Watch, estimate: float) -> bool:
    before, now = watch.side[0], _side(estimate, watch.threshold[0])
    watch.side[0] = now
    return bool(before != now and before != 0)


@inlined
def _marked_pair(marked: BoolArray, tables: Tables, pair: int, state: int) -> int:
    # The first marked pair for a planner's `state`
    if len(marked) == 0:
        return NONE
    first, last = pair, pair + 1
    if pair < 0:
        first, last = pairs_of(tables, state)
    for each in range(first, last):
        if marked[each]:
            return each
    return NONE


def _no_change() -> tuple[Any, ...]:
    space = smallest_mdp()
    return np.zeros(space.pairs, np.uint8), np.zeros(space.pairs), tables_of(space), True, 0, space.states


@compiled_for(_no_change)
def policy_changed(
    greedy: npt.NDArray[np.uint8],
    q: FloatArray,
    tables: Tables,
    random_ties: bool,
    first_state: int,
    last_state: int,
) -> bool:
    """Return True if the greedy pairs of a range of states differ from `greedy`, and update it."""
    changed = False
    for state in range(first_state, last_state):
        first, last = pairs_of(tables, state)
        highest = -np.inf
        for pair in range(first, last):
            if q[pair] > highest:
                highest = q[pair]
        found = False
        for pair in range(first, last):
            best = q[pair] == highest and (random_ties or not found)
            found = found or best
            changed = changed or best != (greedy[pair] == 1)
            greedy[pair] = best
    return changed
