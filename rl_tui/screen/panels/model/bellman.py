"""The Bellman optimality equation of one pair in numbers (Sutton & Barto, 2nd ed., equation 3.20)."""

from __future__ import annotations

from typing import Final

from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_outcomes
from rl_tui.screen.draw.canvas import KEPT_BLANK as K
from rl_tui.screen.draw.canvas import Line, Piece, wrapped
from rl_tui.screen.draw.precision import column_figure, leading_zeros
from rl_tui.screen.kit.snapshot_facts import ANSWER_KEPT, answer_key, hides_means, is_secret, keeps_back
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

_DECIMALS: Final = 4
_EQUALS: Final = "   = "
_CONTINUED: Final = "     "
SECRET: Final = "hidden until h or the end of the budget"


def bellman_lines(snapshot: Snapshot, pair: int, look: Look, width: int) -> list[Line]:
    """Return Q*(s,a) = Σ p [r + γ max Q*(s′,·)] in symbols and in numbers, or why there are none."""
    palette = look.palette
    name = names.pair_name(snapshot.world, pair, look.glyphs)
    total = "sum of" if look.glyphs.name == "ascii" else "Σ"
    symbols = f"Q*({name}) = {total} p · [r{K}+{K}γ{K}·{K}max{K}Q*(s′,·)]"
    lines: list[Line] = [*wrapped(symbols, width, palette.strong, look, " ", _CONTINUED)]
    if is_secret(snapshot):
        hidden = means_key(snapshot)[0] if hides_means(snapshot) else answer_key(snapshot)
        return [*lines, *wrapped(hidden, width, palette.dim, look, f"{_EQUALS}··· ", _CONTINUED)]
    mdp = snapshot.world.mdp
    if snapshot.exact_answer.solution is None or mdp is None:
        why = snapshot.exact_answer.refused or "the exact answer is being computed"
        return [*lines, *wrapped(why, width, palette.dim, look, _CONTINUED, _CONTINUED)]
    decimals = decimals_of(mdp, snapshot.exact_answer.solution, pair)
    outcomes = shown_outcomes(snapshot.world, mdp, pair)
    terms = _terms(mdp, snapshot.exact_answer.solution, outcomes, look, decimals)
    text = "means as they are now" if mdp.drift_std else " + ".join(terms)
    result = column_figure(float(snapshot.exact_answer.solution.q[pair]), decimals, look.glyphs)
    return [
        *lines,
        *wrapped(text, width, palette.text, look, _EQUALS, _CONTINUED),
        [Piece(_EQUALS, palette.text), Piece(result, palette.strong)],
    ]


def means_key(snapshot: Snapshot) -> tuple[str, ...]:
    """Return what stands in place of what the true means of arms decide, the longest form first.

    None where they are not hidden.
    """
    if not hides_means(snapshot):
        return ()
    return (ANSWER_KEPT,) if keeps_back(snapshot, "answer") else (SECRET, "hidden until h")


def decimals_of(mdp: TabularMDP, exact: Solution, pair: int) -> int:
    """Return four decimals, more where all values are small: the sum is that of the printed terms."""
    values = [float(exact.v[mdp.next_state[outcome]]) for outcome in mdp.outcomes_of(pair)]
    return _DECIMALS + max(0, leading_zeros(float(exact.q[pair]), *values) - 1)


def _terms(mdp: TabularMDP, exact: Solution, outcomes: list[int], look: Look, decimals: int) -> list[str]:
    """Return ``1/3·[0 + .99·.5420]`` for each of ``outcomes``."""
    glyphs = look.glyphs
    terms = []
    for outcome in outcomes:
        reward = numbers.brief(float(mdp.reward[outcome]), glyphs, decimals=_DECIMALS)
        target = reward
        if not mdp.terminated[outcome]:
            value = column_figure(float(exact.v[mdp.next_state[outcome]]), decimals, glyphs)
            value = f"({value})" if value.startswith(glyphs.minus) else value
            target = f"{reward} + {setting(exact.gamma, glyphs)}{glyphs.times}{value}"
        chance = names.chance(float(mdp.probability[outcome]), glyphs)
        terms.append(f"{chance}{glyphs.times}[{target}]".replace(" ", K))
    return terms
