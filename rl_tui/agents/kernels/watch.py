"""Watching the loops at full speed: stopping after exactly the step at which something happens."""

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
# The places of what was noticed
_REWARD, _POLICY, _CELL, _STATE, _PAIR = range(5)


@dataclass(frozen=True, slots=True)
class Watching:
    """What to stop after: any of these.

    * ``reward``: a step whose reward is not 0.
    * ``policy``: a change of the greedy policy in any state: of the actions that share the maximum, or where
      ties go to the first of them, of that one. Equality is exact, as the agent itself compares.
    * ``cell``: the estimate of this pair comes to ``threshold`` or past it, from the side it was on.
    * ``states``: the agent arrives in one of these, by a step or where an episode starts after another; a
      planner backs one up.
    * ``pairs``: one of these is taken; a planner updates one.
    """

    reward: bool = False
    policy: bool = False
    cell: int | None = None
    threshold: float = 0.0
    states: frozenset[int] = frozenset()
    pairs: frozenset[int] = frozenset()


class WatchedEvents(NamedTuple):
    """What happened in one step of what is watched for; ``state`` and ``pair`` are the marked ones."""

    reward: bool = False
    policy: bool = False
    cell: bool = False
    state: int | None = None
    pair: int | None = None


NOTHING_NOTICED = WatchedEvents()


class Watch(NamedTuple):
    """What the loops look for after a step; what is one number is an array of one.

    ``active`` says whether anything is watched, ``reward`` and ``policy`` whether these are. ``cell`` is a
    pair or −1, ``side`` the sign of its estimate less ``threshold``. ``states``, [S], and ``pairs``, [P],
    mark those watched; ``greedy``, [P], is the greedy policy as it was, 1 for each pair it may take; each is
    empty where it is not needed. ``noticed``, [5], is what the last step brought: reward, policy, cell (1 or
    0), state and pair (−1 for none). The loops write to ``side``, ``greedy`` and ``noticed``.
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
    """Return the watch for ``watching``, which starts from the estimates ``q``, [P], as they are.

    Raises ValueError where a state or a pair is not one of ``space``.
    """
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
    """Return what the last step brought of what is watched."""
    reward, policy, cell, state, pair = watch.noticed.tolist()
    return WatchedEvents(
        bool(reward),
        bool(policy),
        bool(cell),
        None if state == NONE else state,
        None if pair == NONE else pair,
    )


def forget(watch: Watch) -> None:
    """Forget what the last step brought."""
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
    """Return why to stop after a step that would have stopped for ``stop``, 0 for going on.

    ``watching`` is ``watch.active[0]``, read once before the loop. ``start`` is where the next step starts:
    another state than the step led to where an episode has ended; for a planner the state backed up. A stop
    for good is returned all the same, and so is a planner's end; the next call returns that the log is full.
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
    """Return True if a step brought anything that is watched, and note what; a call, to compile only once.

    Its pair is −1 where a planner backed up the state in which it landed.
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
        if pair < 0:  # a planner moves estimates of one state only
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
    """Return True if the cell has reached or passed its threshold since the step before."""
    before, now = watch.side[0], _side(estimate, watch.threshold[0])
    watch.side[0] = now
    return bool(before != now and before != 0)


@inlined
def _marked_pair(marked: BoolArray, tables: Tables, pair: int, state: int) -> int:
    """Return ``pair`` if it is marked, of a planner's ``state`` the first that is; −1 for none."""
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
    """Return True if states ``first_state`` .. ``last_state`` have other greedy pairs than ``greedy`` says.

    Brings ``greedy`` up to date.
    """
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
