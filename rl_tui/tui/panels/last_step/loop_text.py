"""The five parts of the agent–environment loop (Sutton & Barto, Fig. 3.1) of the last step, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.update_terms import UpdateTerms
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import names, numbers
from rl_tui.tui.panels.last_step.update_text import UpdateText, setting, update_text
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

_TABLES = ("", "₁", "₂")


@dataclass(frozen=True, slots=True)
class LoopText:
    """The words of one step. Empty texts are left out.

    ``meant`` and ``went`` name actions; they are empty where the world does not slip or it is not known what
    happened. ``chance`` is the probability of the outcome, empty where it is not known. ``endings`` says
    how the episode ended, the longest form first; none if it goes on. ``estimate`` is what the update moved,
    ``Q(6,←)``, empty if nothing did, for which ``waiting`` gives the reason. ``gathered``, ``discount`` and
    ``bootstrap`` are the symbols of the target, the last empty where nothing is estimated. ``others`` tells
    of further updates of the same step, the longest form first. ``sweep`` is a planner's, from 1; 0 where the
    step was taken in the world. ``planning`` tells how that sweep is getting on.
    """

    state: str
    place: str
    choice: str
    brief_choice: str
    action: str
    meant: str
    went: str
    chance: str
    reward: str
    next_state: str
    landmark: str
    endings: tuple[str, ...]
    estimate: str
    waiting: str
    gathered: str
    discount: str
    bootstrap: str
    others: tuple[str, ...]
    update: UpdateText
    terminated: bool
    is_bandit: bool
    visits: int
    sweep: int
    planning: str


def loop_text(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> LoopText:
    """Return the words of ``last``, the last step of ``snapshot``."""
    algorithm, params = snapshot.agent.learned_by
    world, terms = snapshot.world, BY_ID[algorithm].update
    is_bandit = isinstance(world.drawing, Arms)
    bootstrap = _bootstrap(snapshot, last, terms, glyphs)
    update = update_text(last, _usual_step_size(params, last), glyphs, bootstraps=bool(bootstrap))
    choice, brief_choice = ("", "") if last.planned else choice_text(snapshot, last, glyphs)
    meant, went, chance = _environment(snapshot, last, glyphs)
    table = _TABLES[last.table]
    return LoopText(
        state=names.state_name(world, last.state, glyphs),
        place=names.place(world, last.state),
        choice=choice,
        brief_choice=brief_choice,
        action="" if last.planned else _action(snapshot, last, glyphs),
        meant=meant,
        went=went,
        chance=chance,
        reward=update.gathered
        if last.gathered == last.reward
        else numbers.brief(last.reward, glyphs, decimals=4),
        next_state="" if is_bandit else names.state_name(world, last.next_state, glyphs),
        landmark=names.landmark(world, last.next_state),
        endings=() if is_bandit or last.planned else _endings(last, bootstraps=bool(bootstrap)),
        estimate=f"Q{table}({names.pair_name(world, last.updated_pair, glyphs)})" if last.learned else "",
        waiting=terms.waiting,
        gathered=terms.gathered,
        discount=terms.discount,
        bootstrap=bootstrap,
        others=_others(last, terms),
        update=update,
        terminated=last.terminated,
        is_bandit=is_bandit,
        visits=0 if last.planned else int(snapshot.agent.visits[last.pair]),
        sweep=last.episode if last.planned else 0,
        planning=snapshot.agent.planning if last.planned and algorithm == snapshot.agent.algorithm else "",
    )


def outcome_words(text: LoopText) -> str:
    """Return what the environment made of the action: ``meant ←, slipped ↓``, elsewhere ``→ Pass``."""
    if not text.went:
        return f"→ {text.next_state}"
    return f"meant {text.meant}, {'went' if text.went == text.meant else 'slipped'} {text.went}"


def _action(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> str:
    return names.action_name(snapshot.world, int(snapshot.world.space.pair_action[last.pair]), glyphs)


def _environment(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> tuple[str, str, str]:
    """Return what was meant and what happened, both empty where the world does not slip, and the chance."""
    mdp = snapshot.world.mdp
    if mdp is None or last.outcome == UNKNOWN_ACTION:
        return "", "", ""
    chance = names.chance(float(mdp.probability[last.outcome]), glyphs)
    action, happened = int(mdp.pair_action[last.pair]), int(mdp.outcome_action[last.outcome])
    outcomes = mdp.outcomes_of(last.pair)
    slips = bool((mdp.outcome_action[outcomes.start : outcomes.stop] != action).any())
    if not slips or happened == UNKNOWN_ACTION:
        return "", "", chance
    meant, went = (names.action_name(snapshot.world, each, glyphs) for each in (action, happened))
    return meant, went, chance


def _bootstrap(snapshot: Snapshot, last: LastStep, terms: UpdateTerms, glyphs: Glyphs) -> str:
    """Return the estimate behind the reward in symbols; empty where there is none."""
    own_step = last.updated_pair == last.pair
    if not last.planned and last.terminated and (own_step or last.bootstrap == 0.0):
        return ""
    elsewhere = terms.remembered and not own_step
    return terms.bootstrap.format(
        next="s′" if elsewhere else names.state_name(snapshot.world, last.next_state, glyphs),
        own=_TABLES[last.table],
        other=_TABLES[3 - last.table] if last.table else "",
    )


def _usual_step_size(values: Hyperparameters, last: LastStep) -> float | str:
    """Return the step size that is no fraction 1/N: the one in force, which a schedule may move."""
    if values.sample_average:
        return SAMPLE_AVERAGE
    moves = values.step_size_schedule != "constant" and values.alpha_decay > 0.0
    return last.step_size if moves else values.alpha


def _endings(last: LastStep, *, bootstraps: bool) -> tuple[str, ...]:
    if last.terminated:
        return "the episode ends", "ends"
    if last.truncated and bootstraps:
        return "cut off by the time limit: still bootstraps", "cut off, still bootstraps", "time limit"
    if last.truncated:
        return "cut off by the time limit", "time limit"
    return ()


def _others(last: LastStep, terms: UpdateTerms) -> tuple[str, ...]:
    if not last.others:
        return ()
    count = f"{last.others:,}"
    return f"and {count} {terms.others}", f"and {count} more", f"+{count}"


def choice_text(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> tuple[str, str]:
    """Return how the action came about, in full and in short."""
    if last.by_hand:
        return "you chose it", "by you"
    _, params = snapshot.agent.learned_by
    rule = POLICY_BY_ID[params.policy]
    if rule.explores_by_epsilon:
        return _epsilon_greedy(snapshot, last, glyphs)
    in_force = {name: params.value(name) for name in rule.parameters if PARAMETERS[name].slide is not None}
    if "epsilon" in in_force:
        in_force["epsilon"] = last.epsilon  # a schedule may have moved it
    values = [f"{PARAMETERS[name].symbol} = {_value(value, glyphs)}" for name, value in in_force.items()]
    rule_text = f"{rule.name} ({', '.join(values)})" if values else rule.name
    if last.explored:
        return f"{rule_text}, not the greedy one", f"{rule.name}, not greedy"
    return f"{rule_text}, the greedy one", f"{rule.name}, greedy"


def _value(value: float | str, glyphs: Glyphs) -> str:
    return value if isinstance(value, str) else setting(value, glyphs)


def _epsilon_greedy(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> tuple[str, str]:
    best = _greedy_before(snapshot, last)
    epsilon = setting(last.epsilon, glyphs)
    if last.explored:
        luck = ", greedy by chance" if last.pair in best else ""
        return f"random (ε = {epsilon}){luck}", f"explored{luck}"
    if len(best) > 1:
        return f"greedy (ε = {epsilon}), one of {len(best)} equal", f"greedy, {len(best)} equal"
    return f"greedy (ε = {epsilon})", "greedy"


def _greedy_before(snapshot: Snapshot, last: LastStep) -> list[int]:
    """Return the pairs that were greedy when the action was chosen, that is before the update.

    None are known where the step changed more than one estimate, or one of two tables.
    """
    if last.others or last.table:
        return []
    pairs = snapshot.world.space.pairs_of(last.state)
    estimates = snapshot.agent.q[pairs.start : pairs.stop].copy()
    if last.updated_pair in pairs:
        estimates[last.updated_pair - pairs.start] = last.before
    best = [pairs.start + int(each) for each in np.flatnonzero(estimates == estimates.max())]
    return best if last.explored or last.pair in best else []  # chosen before the last update but one
