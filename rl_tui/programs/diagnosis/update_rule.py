"""The update rule of a program, found from the changes of its table.

Expected SARSA has three unknowns: α, γ and ε. An unknown reward of the program's own cancels between two
visits to the same transition.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.common.words import counted
from rl_tui.programs.diagnosis.monte_carlo import AT_ENDS, monte_carlo_update
from rl_tui.programs.diagnosis.one_entry import one_entry_trial
from rl_tui.programs.diagnosis.sample import Sample, place_of, sample_of
from rl_tui.programs.diagnosis.trial import (
    FEWEST,
    FEWEST_INFORMATIVE,
    ROUGH,
    SHARE,
    Trial,
    by_episode,
    by_visits,
    clearest_of_each,
    constant_trial,
    drawn,
    most_frequent,
    plainest,
    solved_pairs,
)
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# Expected SARSA


_SINGULAR: Final = 1e-5


def _expected_trial(sample: Sample) -> Trial | None:
    inner = np.flatnonzero((sample.change != 0.0) & ~sample.ended)
    mean: FloatArray = sample.rows.mean(1)
    telling = inner[np.abs(sample.best - mean)[inner] > 100 * sample.slack[inner]]
    if len(telling) < FEWEST:
        return None
    triples = np.column_stack((drawn(telling, 2), drawn(telling, 3), drawn(inner, 4)))
    trials = []
    for a, gamma, epsilon in most_frequent(_solved(sample, mean, triples), sample.digits, 3):
        if 0.0 < epsilon <= 1.0 + 1e-6 and a != 0.0:
            trials.append(_with(sample, mean, (a, gamma, epsilon)))
    neighbours = np.column_stack((telling[:-2], telling[1:-1], telling[2:]))
    episode = sample.evidence.episode[sample.at]
    neighbours = neighbours[episode[neighbours[:, 0]] == episode[neighbours[:, 2]]]
    for a, gamma in most_frequent(_solved(sample, mean, neighbours)[:, :2], sample.digits, 2):
        if a != 0.0 and gamma != 0.0:
            trials.append(_with_own_epsilons(sample, mean, a, gamma))
    return min(trials, key=lambda trial: trial.unexplained, default=None)


def _solved(sample: Sample, mean: FloatArray, triples: IntArray) -> FloatArray:
    columns = np.stack((sample.unit, sample.best, mean - sample.best), axis=-1)
    matrix, change = columns[triples], sample.change[triples]
    size = np.abs(matrix).max(1, keepdims=True)
    matrix /= size
    good = np.flatnonzero(np.isfinite(matrix).all((1, 2)) & np.isfinite(change).all(1))
    good = good[np.abs(np.linalg.det(matrix[good])) > _SINGULAR]
    answer = np.linalg.solve(matrix[good], change[good][..., None])[..., 0] / size[good, 0]
    return np.column_stack((answer[:, 0], answer[:, 1] / answer[:, 0], answer[:, 2] / answer[:, 1]))


def _with(sample: Sample, mean: FloatArray, found: tuple[float, float, float]) -> Trial:
    def trial(alpha: float, gamma: float, epsilon: float) -> Trial:
        value = np.where(sample.ended, 0.0, sample.best + epsilon * (mean - sample.best))
        return Trial(sample, UpdateTarget.EXPECTED, sample.reward, value, alpha, gamma, epsilon=epsilon)

    as_found = trial(*found)
    plain = trial(*(plainest(each, sample.evidence, ROUGH) for each in found))
    return plain if plain.unexplained <= as_found.unexplained else as_found


def _with_own_epsilons(sample: Sample, mean: FloatArray, alpha: float, gamma: float) -> Trial:
    alpha, gamma = (plainest(each, sample.evidence, ROUGH) for each in (alpha, gamma))
    rest = sample.change / alpha - sample.reward + sample.old - gamma * sample.best
    epsilon = rest / (gamma * (mean - sample.best))
    weight = np.abs(alpha * gamma * (mean - sample.best)) / sample.slack
    weight[~((epsilon > -1e-6) & (epsilon < 1 + 1e-6)) | sample.ended] = 0.0
    own = clearest_of_each(sample.evidence.episode[sample.at], epsilon, weight)
    value = np.where(sample.ended, 0.0, sample.best + own * (mean - sample.best))
    trial = Trial(sample, UpdateTarget.EXPECTED, sample.reward, value, alpha, gamma)
    varied = len(np.unique(np.round(own[np.isfinite(own)], 6))) > 1
    return trial if varied else replace(trial, epsilon=float(own[0]))


# A reward of the program's own


def _own_reward_trial(sample: Sample, target: UpdateTarget) -> Trial | None:
    """Return the best trial with a reward that is a function of (s, a, s′, r), if any."""
    value = sample.next_value(target)
    group = _transitions(sample)
    order = np.argsort(group, kind="stable")
    same = np.flatnonzero(group[order][1:] == group[order][:-1])
    one, other = order[same], order[same + 1]
    old = sample.old[one] - sample.old[other]
    change = sample.change[other] - sample.change[one]
    slack = sample.slack[one] + sample.slack[other]
    clear = (np.abs(old) > 100 * slack) & (sample.change[one] != 0) & (sample.change[other] != 0)
    values = value[other] - value[one]
    values[np.abs(values) <= 100 * slack] = 0.0
    trials = []
    for a, b in solved_pairs(old[clear], values[clear], change[clear], sample.digits, 3):
        gamma = 0.0 if np.isnan(b) else plainest(b / a, sample.evidence, ROUGH)
        a = plainest(a, sample.evidence, ROUGH)
        reward = sample.change / a + sample.old - gamma * value
        middle, shared = _middles(group, reward)
        trial = Trial(sample, target, middle, value, a, gamma, own_reward=True)
        own = np.abs(middle - sample.reward) * abs(a) > 10 * sample.slack
        if np.sum(own & shared & trial.explained) >= FEWEST_INFORMATIVE and trial.explained[shared].any():
            trials.append(replace(trial, reward=np.where(shared, middle, np.nan)))
    return min(trials, key=lambda trial: trial.unexplained, default=None)


def _transitions(sample: Sample) -> IntArray:
    _, reward = np.unique(sample.reward, return_inverse=True)
    whole = (sample.cell * sample.evidence.states + sample.next_state) * 2 + sample.ended
    rewards = int(reward.max(initial=0)) + 1
    result: IntArray = np.unique(whole * rewards + reward.ravel(), return_inverse=True)[1].ravel()
    return result


def _middles(group: IntArray, numbers: FloatArray) -> tuple[FloatArray, BoolArray]:
    order = np.lexsort((numbers, group))
    begins = np.flatnonzero(np.diff(group[order], prepend=-1))
    lengths = np.diff(np.append(begins, len(order)))
    middles = numbers[order][begins + (lengths - 1) // 2]
    return middles[group], (lengths > 2)[group]


# The search for the rule


RULE_OF: Final = {
    UpdateTarget.BEST: Rule.Q_LEARNING,
    UpdateTarget.NEXT_ACTION: Rule.SARSA,
    UpdateTarget.EXPECTED: Rule.EXPECTED_SARSA,
    UpdateTarget.ALLOWED: Rule.Q_LEARNING,
    UpdateTarget.DRAWN: Rule.SARSA,
    UpdateTarget.COLUMN: Rule.Q_LEARNING,
    UpdateTarget.SAME_ACTION: Rule.SARSA,
    UpdateTarget.OWN_STATE: Rule.Q_LEARNING,
    UpdateTarget.INDEX: Rule.Q_LEARNING,
    UpdateTarget.BEST_BY_OTHER: Rule.DOUBLE_Q,
    UpdateTarget.OTHER_BEST: Rule.DOUBLE_Q,
    UpdateTarget.OTHERS_CHOICE: Rule.DOUBLE_Q,
}
_RIGHT: Final = (UpdateTarget.BEST, UpdateTarget.NEXT_ACTION)
_OF_TWO_TABLES: Final = (
    UpdateTarget.BEST_BY_OTHER,
    UpdateTarget.BEST,
    UpdateTarget.OTHER_BEST,
    UpdateTarget.OTHERS_CHOICE,
)
"""Targets of two tables that change in turn, the right one first."""
_GREEDY: Final = "Q-learning and SARSA cannot be distinguished yet: nearly all next actions were greedy."
_ALIKE: Final = "It is not known yet which table chooses the next action, and which one gives its value."
_WRONG: Final = (UpdateTarget.COLUMN, UpdateTarget.OWN_STATE, UpdateTarget.INDEX, UpdateTarget.SAME_ACTION)


@np.errstate(all="ignore")  # a failed division is NaN, and is no evidence
def update_of(evidence: Evidence) -> UpdateFound:
    """Find the update that explains a bounded choice of steps."""
    moved = evidence.changes_of > 0
    if not moved.any():
        return UpdateFound(reason="No number of the table has changed yet.")
    several = evidence.changes_of > 1
    inner = moved & ~evidence.ends
    if np.mean(evidence.ends[moved]) < AT_ENDS and np.mean(several[inner]) > 1 - SHARE:
        most = int(evidence.changes_of[inner].max())
        return UpdateFound(reason=f"One step changes up to {most} numbers, so this is not a one-step update.")
    if np.mean(several[moved]) > 1 - SHARE:
        by_returns = monte_carlo_update(evidence)
        if by_returns:
            return by_returns
    place = _place(evidence)
    if np.mean(several[moved]) > 1 - SHARE and place is not MovedCell.ONE_LATE:
        most = int(evidence.changes_of.max())
        return UpdateFound(
            reason=f"The end of an episode changes up to {most} numbers, so this is not a one-step update."
        )
    if place is None:
        return UpdateFound(
            reason="The changed number is not Q(s, a), the estimate of the state and action of the step."
        )
    sample = sample_of(evidence, place)
    trial = _best(sample)
    if trial is not None:
        return _found(trial)
    return monte_carlo_update(evidence) or UpdateFound(place=place, reason=_why_none(sample))


def _place(evidence: Evidence) -> MovedCell | None:
    moved = evidence.only_change[0]
    single = moved >= 0
    if not single.any():
        return None
    shares = {place: float(np.mean((moved == place_of(evidence, place))[single])) for place in MovedCell}
    place = max(MovedCell, key=lambda each: shares[each])  # the first of equal ones
    return place if shares[place] > SHARE else None


def _best(sample: Sample) -> Trial | None:
    held: list[Trial] = []
    stages = (_constant, _faulty, _varying, _one_entry)
    for stage in (_of_two_tables,) if sample.evidence.is_pair else stages:
        held += [trial for trial in stage(sample) if trial.holds]
        if held:
            fewest = min(map(_failures, held))
            best = next(trial for trial in held if _failures(trial) < fewest + FEWEST_INFORMATIVE)
            if best.unexplained < FEWEST_INFORMATIVE or stage is _faulty:
                return best
    return next(iter(sorted(held, key=_failures)), None)


def _failures(trial: Trial) -> float:
    looked_at = int(np.sum(~np.isnan(trial.predicted)))
    return trial.unexplained * len(trial.sample) / max(looked_at, 1)


def _constant(sample: Sample) -> Iterator[Trial]:
    for target in _RIGHT:
        trial = constant_trial(sample, target, sample.reward)
        if trial:
            yield trial
    if sample.place is not MovedCell.ONE_LATE:
        begins = sample.evidence.episode_step[sample.at] == 0
        within = np.where(begins, 0.0, sample.reward_before)  # where it is reset to 0 in each episode
        for before in (sample.reward_before, within):
            for target in _RIGHT:
                trial = constant_trial(sample, target, before, uses_reward_before=True)
                if trial:
                    yield trial


def _faulty(sample: Sample) -> Iterator[Trial]:
    for target in _RIGHT:
        trial = _own_reward_trial(sample, target)
        if trial:
            yield trial
    if sample.place is not MovedCell.ONE_LATE:
        for target in _WRONG:
            trial = constant_trial(sample, target, sample.reward)
            if trial and trial.tells_gamma and trial.gamma:
                yield trial


def _varying(sample: Sample) -> Iterator[Trial]:
    trial = _expected_trial(sample)
    if trial:
        yield trial
    for target in _RIGHT:
        trial = by_visits(sample, target) or by_episode(sample, target)
        if trial:
            yield trial


def _of_two_tables(sample: Sample) -> Iterator[Trial]:
    right = _OF_TWO_TABLES[0]
    trials = [constant_trial(sample, each, sample.reward) for each in _OF_TWO_TABLES]
    if not any(trial and trial.holds for trial in trials):
        trials = [find(sample, right) for find in (by_visits, by_episode, _own_reward_trial)]
    yield from (trial for trial in trials if trial)


def _one_entry(sample: Sample) -> Iterator[Trial]:
    trial = one_entry_trial(sample) if sample.place is MovedCell.TAKEN else None
    if trial:
        yield trial


def _found(trial: Trial) -> UpdateFound:
    reason = _undecided(trial)
    off = np.flatnonzero(trial.counted & ~trial.explained)
    return UpdateFound(
        rule=Rule.UNKNOWN if reason else _rule_of(trial),
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


def _rule_of(trial: Trial) -> Rule:
    """Return the rule. With two tables, a maximum is meant for Double Q-learning if the table is drawn."""
    evidence = trial.sample.evidence
    return Rule.DOUBLE_Q if evidence.is_pair and evidence.draws_table else RULE_OF[trial.target]


def _undecided(trial: Trial) -> str:
    if not trial.tells_gamma:
        return "γ is not known yet: the values of the next states were 0, or always the same."
    if trial.gamma == 0.0:
        return "γ is 0, so the next state does not count: Q-learning and SARSA are the same."
    is_pair = trial.sample.evidence.is_pair
    rivals = _OF_TWO_TABLES if is_pair else _RIGHT
    if trial.target not in rivals:
        return ""
    for rival in rivals:
        deciding = trial.differs_from(trial.sample.value(rival)) & trial.explained
        if rival is not trial.target and np.sum(deciding) < FEWEST_INFORMATIVE:
            return _ALIKE if is_pair else _GREEDY
    return ""


def _why_none(sample: Sample) -> str:
    if int(np.sum(sample.change != 0.0)) < FEWEST:
        moved = counted(int(np.sum(sample.evidence.changes_of > 0)), "step")
        rewards = counted(int(np.count_nonzero(sample.evidence.reward)), "reward")
        return f"Too few numbers of the table have changed so far: {moved} changed a number, after {rewards}."
    if np.all(sample.change[sample.change != 0.0] == 1.0):
        return "Each step adds 1 to one number: the table counts visits and is not a table of values."
    if sample.evidence.whole_numbers and sample.evidence.dtype.startswith(("int", "uint")):
        return "The table contains only whole numbers, so new estimates lose their decimals."
    return "Each step changes one number, but no known update explains the change."
