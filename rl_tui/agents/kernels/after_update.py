"""What every loop does after an update, whatever the algorithm, and what it records for people to look at."""

from __future__ import annotations

from dataclasses import fields
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import Experience, Update
from rl_tui.agents.kernels.compiled import compiled, inlined
from rl_tui.agents.kernels.position import DIVERGED, DONE, LARGEST_ESTIMATE
from rl_tui.agents.last_step import LastStep
from rl_tui.worlds.mdp.space import FloatArray, IntArray

TD_ERRORS_KEPT: Final = 256
# The fields of a last step, by kind and in its order, as they are recorded
_WHOLE: Final = [field.name for field in fields(LastStep) if field.type in ("int", "bool")]
_FLAGS: Final = [field.name for field in fields(LastStep) if field.type == "bool"]
_REAL: Final = [field.name for field in fields(LastStep) if field.type == "float"]


class StepRecord(NamedTuple):
    """What is recorded of the steps taken.

    Of the last one the ``whole`` fields of :class:`LastStep` and the ``real`` ones. Of the last
    updates the ``td_errors`` and the ``pairs`` that moved, [TD_ERRORS_KEPT] each: that of update k (from 0)
    at k modulo the room for them, ``updates[0]`` being how many there were.
    """

    whole: IntArray
    real: FloatArray
    td_errors: FloatArray
    pairs: IntArray
    updates: IntArray


def new_record() -> StepRecord:
    """Return the record of no step."""
    return StepRecord(
        np.zeros(len(_WHOLE), np.int64),
        np.zeros(len(_REAL)),
        np.zeros(TD_ERRORS_KEPT),
        np.zeros(TD_ERRORS_KEPT, np.int64),
        np.zeros(1, np.int64),
    )


@inlined
def after_update(record: StepRecord, update: Update) -> int:
    """Keep the TD error of ``update``, if there was one; return DIVERGED where an estimate ran away, else 0.

    It is called once a step, with the update that is told of. The further ones that traces, a model or the
    end of an episode bring in the same step have no TD error here. What is watched for needs the state in
    which the next step starts, so it is asked later: see :func:`rl_tui.agents.kernels.watch.watched`.
    """
    if update.pair >= 0:
        place = record.updates[0] % TD_ERRORS_KEPT
        target = update.gathered + update.discount * update.bootstrap
        record.td_errors[place] = target - update.before
        record.pairs[place] = update.pair
        record.updates[0] += 1
    # Written so that NaN is caught too
    return DONE if abs(update.extreme) <= LARGEST_ESTIMATE else DIVERGED


@compiled
def record_step(
    record: StepRecord,
    step: int,
    episode: int,
    episode_step: int,
    by_hand: bool,
    explored: bool,
    epsilon: float,
    outcome: int,
    gamma: float,
    experience: Experience,
    update: Update,
) -> None:
    """Record one step and what was learned from it; ``outcome`` is −1 where it is not known.

    It is called and not inlined, so that all loops share one.
    """
    whole, real = record.whole, record.real
    whole[0], whole[1], whole[2], whole[3] = step, episode, experience.state, experience.pair
    whole[4], whole[5], whole[6] = explored, outcome, experience.next_state
    whole[7], whole[8] = experience.terminated, experience.truncated
    whole[9], whole[10], whole[11] = update.pair, update.others, update.table
    whole[12], whole[13], whole[14] = episode_step, by_hand, update.bootstrap_state
    real[0], real[1], real[2], real[3] = epsilon, experience.reward, update.before, update.step_size
    real[4], real[5], real[6], real[7] = gamma, update.gathered, update.discount, update.bootstrap
    real[8] = update.after


def read_record(record: StepRecord) -> LastStep | None:
    """Return the recorded step, None before the first."""
    found = dict(zip((*_WHOLE, *_REAL), (*record.whole.tolist(), *record.real.tolist()), strict=True))
    found |= {name: bool(found[name]) for name in _FLAGS}
    return LastStep(**found) if found["step"] else None
