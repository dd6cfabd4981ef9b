"""The update that a program makes, found from how its table moves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from rl_tui.common.words import counted
from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.updates.expected_sarsa import expected_trial
from rl_tui.lab.detective.updates.monte_carlo import AT_ENDS, monte_carlo_update
from rl_tui.lab.detective.updates.own_reward import own_reward_trial
from rl_tui.lab.detective.updates.sample import Sample, place_of, sample_of
from rl_tui.lab.detective.updates.step_sizes import by_episode, by_visits
from rl_tui.lab.detective.updates.trial import FEWEST, FEWEST_INFORMATIVE, SHARE, Trial, constant_trial
from rl_tui.lab.detective.verdict import MovedCell, Rule, UpdateFound, UpdateTarget

RULE_OF: Final = {
    UpdateTarget.BEST: Rule.Q_LEARNING,
    UpdateTarget.NEXT_ACTION: Rule.SARSA,
    UpdateTarget.EXPECTED: Rule.EXPECTED_SARSA,
    UpdateTarget.COLUMN: Rule.Q_LEARNING,
    UpdateTarget.SAME_ACTION: Rule.SARSA,
    UpdateTarget.OWN_STATE: Rule.Q_LEARNING,
    UpdateTarget.INDEX: Rule.Q_LEARNING,
}
"""Which rule a target is meant to be."""
_RIGHT: Final = (UpdateTarget.BEST, UpdateTarget.NEXT_ACTION)
_WRONG: Final = (UpdateTarget.COLUMN, UpdateTarget.OWN_STATE, UpdateTarget.INDEX, UpdateTarget.SAME_ACTION)


@np.errstate(all="ignore")  # what cannot be divided is NaN, and counts for nothing
def update_of(evidence: Evidence, numbers: Mapping[str, float], dtype: str = "") -> UpdateFound:
    """Return the update that explains ``evidence``; ``numbers`` are those that the code holds, by name.

    ``dtype`` is the table's, empty where that is not known.

    It is found on a bounded choice of steps: of a long run ``departs_at`` and ``informative`` are of these.
    """
    moved = evidence.changes_of > 0
    if not moved.any():
        return UpdateFound(reason="No number of the table has moved yet.")
    ends = evidence.terminated | evidence.truncated
    several = evidence.changes_of > 1
    inner = moved & ~ends
    if np.mean(ends[moved]) < AT_ENDS and np.mean(several[inner]) > 1 - SHARE:
        most = int(evidence.changes_of[inner].max())
        return UpdateFound(reason=f"A step moves several numbers, up to {most}: no one-step update fits.")
    if np.mean(several[moved]) > 1 - SHARE:
        by_returns = monte_carlo_update(evidence, numbers)
        if by_returns:
            return by_returns
    place = _place(evidence)
    if np.mean(several[moved]) > 1 - SHARE and place is not MovedCell.ONE_LATE:
        most = int(evidence.changes_of.max())
        return UpdateFound(
            reason=f"The end of an episode moves several numbers, up to {most}: no one-step update fits."
        )
    if place is None:
        return UpdateFound(
            reason="What moves is not Q(s, a), the number of the state and the action of the step."
        )
    sample = sample_of(evidence, place)
    trial = _best(sample, numbers)
    if trial is not None:
        return _found(trial)
    return monte_carlo_update(evidence, numbers) or UpdateFound(place=place, reason=_why_none(sample, dtype))


def _place(evidence: Evidence) -> MovedCell | None:
    """Return which cell moves with a step, None if it is none of those known."""
    moved = evidence.only_change[0]
    single = moved >= 0
    if not single.any():
        return None
    shares = {place: float(np.mean((moved == place_of(evidence, place))[single])) for place in MovedCell}
    place = max(MovedCell, key=lambda each: shares[each])  # the first of equals
    return place if shares[place] > SHARE else None


def _best(sample: Sample, numbers: Mapping[str, float]) -> Trial | None:
    """Return the trial that explains ``sample`` best, if one explains enough of it."""
    held: list[Trial] = []
    for stage in (_constant, _faulty, _varying):
        held += [trial for trial in stage(sample, numbers) if trial.holds]
        if held:
            fewest = min(map(_failures, held))
            best = next(trial for trial in held if _failures(trial) < fewest + FEWEST_INFORMATIVE)
            if best.unexplained < FEWEST_INFORMATIVE or stage is _faulty:
                return best
    return next(iter(sorted(held, key=_failures)), None)


def _failures(trial: Trial) -> float:
    """Return how many steps of its sample the trial would not explain, if it looked at all of them."""
    looked_at = int(np.sum(~np.isnan(trial.predicted)))
    return trial.unexplained * len(trial.sample) / max(looked_at, 1)


def _constant(sample: Sample, numbers: Mapping[str, float]) -> Iterator[Trial]:
    """Yield the right targets with a constant step size, then the same with the reward of the step before."""
    for target in _RIGHT:
        trial = constant_trial(sample, target, sample.reward, numbers)
        if trial:
            yield trial
    if sample.place is not MovedCell.ONE_LATE:
        begins = sample.evidence.episode_step[sample.at] == 0
        within = np.where(begins, 0.0, sample.reward_before)  # where it is set to 0 for each episode
        for before in (sample.reward_before, within):
            for target in _RIGHT:
                trial = constant_trial(sample, target, before, numbers, uses_reward_before=True)
                if trial:
                    yield trial


def _faulty(sample: Sample, numbers: Mapping[str, float]) -> Iterator[Trial]:
    """Yield another reward, then targets that are wrong."""
    for target in _RIGHT:
        trial = own_reward_trial(sample, target, numbers)
        if trial:
            yield trial
    if sample.place is not MovedCell.ONE_LATE:
        for target in _WRONG:
            trial = constant_trial(sample, target, sample.reward, numbers)
            if trial and trial.tells_gamma and trial.gamma:
                yield trial


def _varying(sample: Sample, numbers: Mapping[str, float]) -> Iterator[Trial]:
    """Yield Expected SARSA, then step sizes that change."""
    trial = expected_trial(sample, numbers)
    if trial:
        yield trial
    for target in _RIGHT:
        trial = by_visits(sample, target, numbers) or by_episode(sample, target, numbers)
        if trial:
            yield trial


def _found(trial: Trial) -> UpdateFound:
    """Return what is to be said of the update that ``trial`` is."""
    reason = _undecided(trial)
    off = np.flatnonzero(trial.counted & ~trial.explained)
    return UpdateFound(
        rule=Rule.UNKNOWN if reason else RULE_OF[trial.target],
        alpha=trial.alpha if isinstance(trial.alpha, float) else None,
        alpha_schedule=trial.schedule,
        gamma=trial.gamma if trial.tells_gamma else None,
        epsilon=trial.epsilon,
        reward="own" if trial.own_reward else "environment",
        fits=None if reason else trial.share,
        informative=int(np.sum(trial.informative)),
        departs_at=int(trial.sample.evidence.number[trial.sample.at[off[0]]]) if len(off) else None,
        target=trial.target,
        place=trial.sample.place,
        uses_reward_before=trial.uses_reward_before,
        reason=reason,
    )


def _undecided(trial: Trial) -> str:
    """Return why ``trial`` does not tell the rule, empty if it does."""
    if not trial.tells_gamma:
        return "No step yet tells γ: the values of the next states were 0, or always the same."
    if trial.gamma == 0.0:
        return "With γ 0 no value of a next state counts: Q-learning and SARSA are the same then."
    if trial.target not in _RIGHT:
        return ""
    rival = _RIGHT[1 - _RIGHT.index(trial.target)]
    deciding = trial.differs_from(trial.sample.value(rival)) & trial.explained
    if np.sum(deciding) < FEWEST_INFORMATIVE:
        return "No step yet tells Q-learning from SARSA: next actions were greedy, or nearly all were."
    return ""


def _why_none(sample: Sample, dtype: str) -> str:
    """Return why no update explains ``sample``, of a table of ``dtype``."""
    if int(np.sum(sample.change != 0.0)) < FEWEST:
        moved = counted(int(np.sum(sample.evidence.changes_of > 0)), "step")
        rewards = counted(int(np.count_nonzero(sample.evidence.reward)), "reward")
        return f"Too few numbers of the table have moved yet: {moved} moved one, {rewards} came."
    if np.all(sample.change[sample.change != 0.0] == 1.0):
        return "Each step adds 1 to one number: the table counts visits, it is not one of values."
    if sample.evidence.whole_numbers and dtype.startswith(("int", "uint")):
        return "The table holds whole numbers only: what is put into it is cut off."
    return "Each step moves one number, but no update that is known explains by how much."
