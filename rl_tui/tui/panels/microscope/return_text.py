"""The return of the episode so far with its discounted terms (Sutton & Barto, 2nd ed., equation 3.8)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.last_step import LastStep
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, length, spelled, wrapped
from rl_tui.tui.draw.precision import comes_to
from rl_tui.tui.panels.last_step.step_lines import in_brackets
from rl_tui.tui.panels.last_step.update_text import setting
from rl_tui.tui.panels.microscope.section import MicroscopeSection
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

RETURN_HEADING: Final = "The return so far"
RETURN_ROWS: Final = 3
MEANING: Final = "Gₜ = Rₜ₊₁ + γ Rₜ₊₂ + γ² Rₜ₊₃ + …"
PLANNER: Final = "a planner takes no steps: nothing is earned"
_LEFT_OUT: Final = "…"
_SUPERSCRIPTS: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_FEWEST: Final = 3  # decimals of a reward
_MOST: Final = 6
_TOLERANCE: Final = 1e-6


def return_section(snapshot: Snapshot, last: LastStep, look: Look, width: int) -> MicroscopeSection:
    """Return the return from the start of the episode, its first and last terms, and what it means."""
    palette = look.palette
    if last.planned:
        return MicroscopeSection(
            RETURN_HEADING, wrapped(PLANNER, width, palette.dim, look, " ", " "), RETURN_ROWS
        )
    rewards = snapshot.counters.rewards.tolist()
    if not rewards:
        return MicroscopeSection(
            RETURN_HEADING, [[Piece(" no reward yet in this episode", palette.dim)]], RETURN_ROWS
        )
    steps = max(last.episode_step, len(rewards))
    total = numbers.brief(snapshot.counters.discounted_return, look.glyphs, decimals=4)
    start: Line = [Piece(" G₀ = ", palette.dim)]
    terms = terms_of(rewards, steps, last.gamma, look, width - length(spelled(start, look)), total)
    result: Line = [Piece("    = ", palette.dim), Piece(total, palette.strong)]
    plain: Line = []
    if len(rewards) == steps:
        amount = numbers.brief(sum(rewards), look.glyphs, decimals=4)
        plain = [Piece("   undiscounted ", palette.dim), Piece(amount, palette.text)]
    lines: list[Line] = [[*start, Piece(total, palette.strong)]]
    if steps > 1:
        lines = [
            [*start, Piece(terms, palette.text)],
            first_that_fits([[*result, *plain], result], width, look),
        ]
    lines += wrapped(_meaning(snapshot, rewards, steps, last.gamma), width, palette.dim, look, " ", " ")
    return MicroscopeSection(RETURN_HEADING, lines, RETURN_ROWS, (f"t = {steps:,}",))


def _meaning(snapshot: Snapshot, rewards: Sequence[float], steps: int, gamma: float) -> str:
    if isinstance(snapshot.world.drawing, Arms):
        return "every pull is an episode: its return is its reward"
    worked = sum(reward * gamma**place for place, reward in enumerate(rewards))
    if len(rewards) == steps and abs(worked - snapshot.counters.discounted_return) > _TOLERANCE * max(
        1.0, abs(worked)
    ):
        return "γ was changed on the way: each step counts with its own"
    return MEANING


def gathered_rewards(snapshot: Snapshot, last: LastStep) -> list[float]:
    """Return the rewards, oldest first, whose discounted sum is the target of several steps.

    Nothing for methods of one step, and where they are not known any more.
    """
    algorithm, params = snapshot.agent.learned_by
    row = BY_ID[algorithm]
    if row.update.one_step or not last.learned or not len(snapshot.counters.rewards):
        return []
    ended = last.terminated or last.truncated
    count = last.episode_step if "n" not in row.parameters else 1 if ended else params.n
    rewards: list[float] = snapshot.counters.rewards[-count:].tolist()
    worked = sum(reward * last.gamma**place for place, reward in enumerate(rewards))
    is_whole = len(rewards) == count and abs(worked - last.gathered) <= _TOLERANCE * max(1.0, abs(worked))
    return rewards if is_whole and count > 1 else []


def terms_of(rewards: Sequence[float], steps: int, gamma: float, look: Look, room: int, total: str) -> str:
    """Return as many terms as ``room`` holds: all, or the first and the last with an ellipsis between.

    They have as many decimals as let them come out at the printed ``total``. Of an episode of more steps than
    there are rewards the first ones are not known any more; the rest has three.
    """
    skipped = steps - len(rewards)
    rewards = _rounded(rewards, gamma, total, look, _FEWEST if skipped else _MOST)
    if not skipped:
        whole = _joined([_term(rewards, skipped, place, gamma, look) for place in range(min(steps, room))])
        if steps <= room and _fits(whole, room, look):
            return whole
    best = _LEFT_OUT
    for count in range(1, len(rewards)):
        ahead = 0 if skipped else count // 2
        first = [_term(rewards, skipped, place, gamma, look) for place in range(ahead)]
        end = [_term(rewards, skipped, steps - back, gamma, look) for back in range(count - ahead, 0, -1)]
        shown = _joined([*first, _LEFT_OUT, *end])
        if not _fits(shown, room, look):
            break
        best = shown
    return best


def _rounded(rewards: Sequence[float], gamma: float, total: str, look: Look, most: int) -> list[float]:
    """Return ``rewards`` with the fewest decimals, three to ``most``, with which they add up to ``total``."""
    rounded: list[float] = []
    for decimals in range(_FEWEST, most + 1):
        rounded = [round(reward, decimals) or reward for reward in rewards]
        worked_out = sum(reward * gamma**place for place, reward in enumerate(rounded))
        if comes_to(worked_out, total, look.glyphs):
            break
    return rounded


def _fits(text: str, room: int, look: Look) -> bool:
    return length(spelled([Piece(text, look.palette.text)], look)) <= room


def _joined(terms: Sequence[str]) -> str:
    return " + ".join(terms)


def _term(rewards: Sequence[float], skipped: int, place: int, gamma: float, look: Look) -> str:
    """Return ``.99²·1``, the reward of step ``place`` (from 0) as it counts at the start."""
    reward = numbers.brief(rewards[place - skipped], look.glyphs)
    if place == 0:
        return reward
    reward = in_brackets(reward, look.glyphs.minus)
    if gamma == 1.0:
        return reward
    return f"{power(gamma, place, look)}{look.glyphs.times}{reward}"


def power(base: float, exponent: int, look: Look) -> str:
    """Return ``.99²``, in ASCII ``.99^2``."""
    text = setting(base, look.glyphs)
    if exponent == 1:
        return text
    return (
        f"{text}^{exponent}" if look.glyphs.name == "ascii" else text + str(exponent).translate(_SUPERSCRIPTS)
    )
