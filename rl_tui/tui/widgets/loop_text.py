"""The five parts of the agent–environment loop (Sutton & Barto, Fig. 3.1) of the last step, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.agents.last_step import LastStep
from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.widgets import names
from rl_tui.tui.widgets.update_text import UpdateText, setting, update_text
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp import UNKNOWN_ACTION


@dataclass(frozen=True, slots=True)
class LoopText:
    """The words of one step. Empty texts are left out.

    ``meant`` and ``went`` name actions; they are empty where the world does not slip or it is not known what
    happened. ``chance`` is the probability of the outcome. ``endings`` says
    how the episode ended, the longest form first; none if it goes on.
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
    pair: str
    update: UpdateText
    terminated: bool
    is_bandit: bool
    visits: int


def loop_text(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> LoopText:
    """Return the words of ``last``, the last step of ``snapshot``."""
    world, mdp = snapshot.world, snapshot.world.space
    action = int(mdp.pair_action[last.pair])
    happened = int(mdp.outcome_action[last.outcome])
    outcomes = mdp.outcomes_of(last.pair)
    slips = bool((mdp.outcome_action[outcomes.start : outcomes.stop] != action).any())
    is_bandit = isinstance(world.drawing, Arms)
    update = update_text(last, snapshot.hyperparameters.alpha, glyphs)
    known = slips and happened != UNKNOWN_ACTION
    choice, brief_choice = _choice(snapshot, last, glyphs)
    probability = float(mdp.probability[last.outcome])
    return LoopText(
        state=names.state_name(world, last.state, glyphs),
        place=names.place(world, last.state),
        choice=choice,
        brief_choice=brief_choice,
        action=names.action_name(world, action, glyphs),
        meant=names.action_name(world, action, glyphs) if known else "",
        went=names.action_name(world, happened, glyphs) if known else "",
        chance=names.chance(probability, glyphs),
        reward=update.reward,
        next_state="" if is_bandit else names.state_name(world, last.next_state, glyphs),
        landmark=names.landmark(world, last.next_state),
        endings=() if is_bandit else _endings(last),
        pair=names.pair_name(world, last.updated_pair, glyphs),
        update=update,
        terminated=last.terminated,
        is_bandit=is_bandit,
        visits=int(snapshot.visits[last.pair]),
    )


def outcome_words(text: LoopText) -> str:
    """Return what the environment made of the action: ``meant ←, slipped ↓``, elsewhere ``→ Pass``."""
    if not text.went:
        return f"→ {text.next_state}"
    return f"meant {text.meant}, {'went' if text.went == text.meant else 'slipped'} {text.went}"


def _endings(last: LastStep) -> tuple[str, ...]:
    if last.terminated:
        return "the episode ends", "ends"
    if last.truncated:
        return "cut off by the time limit: still bootstraps", "cut off, still bootstraps", "time limit"
    return ()


def _choice(snapshot: Snapshot, last: LastStep, glyphs: Glyphs) -> tuple[str, str]:
    """Return how the action came about, in full and in short."""
    best = _greedy_before(snapshot, last)
    epsilon = setting(last.epsilon, glyphs)
    if last.explored:
        luck = ", greedy by chance" if last.pair in best else ""
        return f"random (ε = {epsilon}){luck}", f"explored{luck}"
    if len(best) > 1:
        return f"greedy (ε = {epsilon}), one of {len(best)} equal", f"greedy, {len(best)} equal"
    return f"greedy (ε = {epsilon})", "greedy"


def _greedy_before(snapshot: Snapshot, last: LastStep) -> list[int]:
    """Return the pairs that were greedy when the action was chosen, that is before the update."""
    pairs = snapshot.world.space.pairs_of(last.state)
    estimates = snapshot.q[pairs.start : pairs.stop].copy()
    if last.updated_pair in pairs:
        estimates[last.updated_pair - pairs.start] = last.before
    return [pairs.start + int(best) for best in np.flatnonzero(estimates == estimates.max())]
