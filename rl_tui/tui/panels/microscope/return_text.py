"""The return of the episode so far with its discounted terms (Sutton & Barto, 2nd ed., equation 3.8)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.lab.last_step.story import StepStory, discounted_sum
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, length, spelled, wrapped
from rl_tui.tui.draw.precision import comes_to
from rl_tui.tui.panels.last_step.equation import in_brackets
from rl_tui.tui.panels.last_step.update_text import setting
from rl_tui.tui.panels.microscope.section import MicroscopeSection
from rl_tui.tui.theme.look import Look

RETURN_HEADING: Final = "Discounted return so far"
RETURN_ROWS: Final = 3
MEANING: Final = "Gₜ = Rₜ₊₁ + γ Rₜ₊₂ + γ² Rₜ₊₃ + …"
PLANNER: Final = "a planner takes no steps: nothing is earned"
OPEN_DISCOUNT: Final = "the γ of your program is open: no step has decided it yet"
_LEFT_OUT: Final = "…"
_SUPERSCRIPTS: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_FEWEST: Final = 3  # decimals of a reward
_MOST: Final = 6


def return_section(story: StepStory, look: Look, width: int) -> MicroscopeSection:
    """Return the return from the start of the episode, its first and last terms, and what it means."""
    palette, rewards = look.palette, story.rewards
    if story.last.planned:
        planner = wrapped(PLANNER, width, palette.dim, look, " ", " ")
        return MicroscopeSection(RETURN_HEADING, planner, RETURN_ROWS)
    if not rewards:
        nothing: Line = [Piece(" no reward yet in this episode", palette.dim)]
        return MicroscopeSection(RETURN_HEADING, [nothing], RETURN_ROWS)
    if has_open_discount(story):
        return _undiscounted(story, look, width)
    total = numbers.brief(story.discounted_return, look.glyphs, decimals=4)
    start: Line = [Piece(" G₀ = ", palette.dim)]
    result: Line = [Piece("    = ", palette.dim), Piece(total, palette.strong)]
    plain: Line = []
    if len(rewards) == story.steps:
        amount = numbers.brief(sum(rewards), look.glyphs, decimals=4)
        plain = [Piece("   undiscounted ", palette.dim), Piece(amount, palette.text)]
    lines: list[Line] = [[*start, Piece(total, palette.strong)]]
    if story.steps > 1:
        room = width - length(spelled(start, look))
        terms = terms_of(rewards, story.steps, story.last.gamma, look, room, total)
        lines = [
            [*start, Piece(terms, palette.text)],
            first_that_fits([[*result, *plain], result], width, look),
        ]
    lines += wrapped(_meaning(story), width, palette.dim, look, " ", " ")
    return MicroscopeSection(RETURN_HEADING, lines, RETURN_ROWS, (f"t = {story.steps:,}",))


def has_open_discount(story: StepStory) -> bool:
    """Return whether nobody knows the γ of a program: what its rewards come to, discounted, is open too."""
    return story.program is not None and story.program.verdict.update.gamma is None


def _undiscounted(story: StepStory, look: Look, width: int) -> MicroscopeSection:
    amount = numbers.brief(sum(story.rewards), look.glyphs, decimals=4)
    known = len(story.rewards) == story.steps
    start = "undiscounted " if known else f"of the last {len(story.rewards):,} steps, undiscounted "
    lines: list[Line] = [[Piece(f" {start}", look.palette.dim), Piece(amount, look.palette.strong)]]
    lines += wrapped(_open_discount(story), width, look.palette.dim, look, " ", " ")
    return MicroscopeSection(RETURN_HEADING, lines, RETURN_ROWS, (f"t = {story.steps:,}",))


def _open_discount(story: StepStory) -> str:
    """Return that no step has decided γ, and by which one the exact answers go meanwhile."""
    program = story.program
    if program is None or program.gamma is None or program.gamma_source != "declared":
        return OPEN_DISCOUNT
    return f"{OPEN_DISCOUNT}; exact answers are for {program.gamma:g}, read from your code"


def _meaning(story: StepStory) -> str:
    if story.is_bandit:
        return "every pull is an episode: its return is its reward"
    return MEANING if story.has_one_gamma else "γ was changed on the way: each step counts with its own"


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
        if comes_to(discounted_sum(rounded, gamma), total, look.glyphs):
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
    reward = in_brackets(reward, look)
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
