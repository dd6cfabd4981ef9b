"""The work of every loop after an update, and the record of steps."""

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
# Names of the recorded fields of LastStep by kind, in its order
_WHOLE: Final = [field.name for field in fields(LastStep) if field.type in ("int", "bool")]
_FLAGS: Final = [field.name for field in fields(LastStep) if field.type == "bool"]
_REAL: Final = [field.name for field in fields(LastStep) if field.type == "float"]


class StepRecord(NamedTuple):
    """The record of recent steps.

    The fields of the last :class:`LastStep` are in `whole` and `real`. Ring buffers are `td_errors` and
    `pairs`, [TD_ERRORS_KEPT]: update k (from 0) is at k modulo their size. All updates are counted in
    ``updates[0]``.
    """

    whole: IntArray
    real: FloatArray
    td_errors: FloatArray
    pairs: IntArray
    updates: IntArray


def new_record() -> StepRecord:
    """Return an empty record."""
    return StepRecord(
        np.zeros(len(_WHOLE), np.int64),
        np.zeros(len(_REAL)),
        np.zeros(TD_ERRORS_KEPT),
        np.zeros(TD_ERRORS_KEPT, np.int64),
        np.zeros(1, np.int64),
    )


@inlined
def after_update(record: StepRecord, update: Update) -> int:
    """Store the TD error of `update`, if any. Return DIVERGED if an estimate diverged, else 0.

    Further updates of the same step (traces, model, end of episode) store none.
    """
    if update.pair >= 0:
        place = record.updates[0] % TD_ERRORS_KEPT
        target = update.gathered + update.discount * update.bootstrap
        record.td_errors[place] = target - update.before
        record.pairs[place] = update.pair
        record.updates[0] += 1
    # this form also catches NaN
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
    """Record one step and its update (`outcome` −1: unknown). Not inlined, so that all loops share it."""
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
    """Return the recorded step, or None before the first."""
    found = dict(zip((*_WHOLE, *_REAL), (*record.whole.tolist(), *record.real.tolist()), strict=True))
    found |= {name: bool(found[name]) for name in _FLAGS}
    return LastStep(**found) if found["step"] else None
