"""The last update, with the sources of its numbers (Sutton & Barto, 2nd ed., equation 3.8)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Final

from rich.style import Style

from rl_tui.agents.catalogue import Lookup, UpdateTerms
from rl_tui.live.last_step.step_report import StepStory, discounted_sum
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.screen.draw.canvas import Line, Piece, length, spelled
from rl_tui.screen.draw.precision import column_figure, comes_to, in_brackets, parsed
from rl_tui.screen.kit.blocks import Block, Flow, Labelled, Row, Section, Text
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.last_step.words import StepWords, equation, error_style
from rl_tui.screen.panels.program.words import fit_texts, open_text, update_texts
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

# The discounted return so far


RETURN_HEADING: Final = "Discounted return so far"
RETURN_ROWS: Final = 3
PLANNER: Final = "a planner takes no steps, so it earns nothing"
OPEN_DISCOUNT: Final = "the γ of your program is unknown: no step shows it yet"
_LEFT_OUT: Final = "…"
_START: Final = 6  # cells before the terms
_SUPERSCRIPTS: Final = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_FEWEST_DECIMALS: Final = 3  # decimals of a reward
_MOST_DECIMALS: Final = 6


def return_section(story: StepStory, look: Look) -> Section:
    """Return the return so far."""
    remarks = (f"t = {story.steps:,}",) if story.rewards and not story.last.planned else ()
    return Section(RETURN_HEADING, [*_return_blocks(story, look)], RETURN_ROWS, remarks)


def _return_blocks(story: StepStory, look: Look) -> Iterator[Block]:
    palette, rewards = look.palette, story.rewards
    if story.last.planned:
        yield Text(PLANNER, palette.dim)
        return
    if not rewards:
        yield Row([Piece(" no reward yet in this episode", palette.dim)])
        return
    is_known = len(rewards) == story.steps
    undiscounted = Piece(numbers.brief(sum(rewards), look.glyphs, decimals=4), palette.text)
    if story.program is not None and story.program.verdict.update.gamma is None:
        start = " " if is_known else f" of the last {len(rewards):,} steps, "
        yield Row([Piece(f"{start}undiscounted ", palette.dim), Piece(undiscounted.text, palette.strong)])
        declared, program = "", story.program
        if program is not None and program.gamma is not None and program.gamma_source == "declared":
            declared = f"; exact values are for {program.gamma:g}, read from your code"
        yield Text(f"{OPEN_DISCOUNT}{declared}", palette.dim)
        return
    total = Piece(numbers.brief(story.discounted_return, look.glyphs, decimals=4), palette.strong)
    if story.steps == 1:
        yield Row([Piece(" G₀ = ", palette.dim), total])
    else:
        terms = partial(terms_of, rewards, story.steps, story.last.gamma, look, total=total.text)
        yield Labelled("G₀ =", palette.dim, _START, Text(terms, palette.text, ""))
        result = [Piece("    = ", palette.dim), total]
        plain = [Piece("   undiscounted ", palette.dim), undiscounted] if is_known else []
        yield Row([*result, *plain], result)
    yield Text(_meaning(story), palette.dim)


def _meaning(story: StepStory) -> str:
    if story.world.is_bandit:
        return "each pull is an episode: its return is r"
    if not story.has_one_gamma:
        return "γ changed in this episode: each step uses its own γ"
    return "Gₜ = Rₜ₊₁ + γ Rₜ₊₂ + γ² Rₜ₊₃ + …"


def terms_of(rewards: Sequence[float], steps: int, gamma: float, look: Look, room: int, *, total: str) -> str:
    """Return all terms that fit ``room``, or the first and last ones.

    Their decimals add up to the printed ``total``. Rewards no longer known are skipped.
    """
    skipped = steps - len(rewards)
    rewards = _rounded(rewards, gamma, total, look, _FEWEST_DECIMALS if skipped else _MOST_DECIMALS)
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
    rounded: list[float] = []
    for decimals in range(_FEWEST_DECIMALS, most + 1):
        rounded = [round(reward, decimals) or reward for reward in rewards]
        if comes_to(discounted_sum(rounded, gamma), total, look.glyphs):
            break
    return rounded


def _fits(text: str, room: int, look: Look) -> bool:
    return length(spelled([Piece(text, look.palette.text)], look)) <= room


def _joined(terms: Sequence[str]) -> str:
    return " + ".join(terms)


def _term(rewards: Sequence[float], skipped: int, place: int, gamma: float, look: Look) -> str:
    reward = numbers.brief(rewards[place - skipped], look.glyphs)
    if place == 0:
        return reward
    reward = in_brackets(reward, look.glyphs)
    if gamma == 1.0:
        return reward
    return f"{power(gamma, place, look)}{look.glyphs.times}{reward}"


def power(base: float, exponent: int, look: Look) -> str:
    """Write ``.99²``, or ``.99^2`` in ASCII."""
    text = setting(base, look.glyphs)
    if exponent == 1:
        return text
    return (
        f"{text}^{exponent}" if look.glyphs.name == "ascii" else text + str(exponent).translate(_SUPERSCRIPTS)
    )


# The update


UPDATE_HEADING: Final = "The update"
TABLES: Final = "the table shows the mean of Q₁ and Q₂"
_LEAST_ROWS: Final = 5
_MOST_CELLS: Final = 6
_FEWEST: Final = 3  # decimals of weights and estimates
_MOST: Final = 9
_GAP: Final = "   "


def update_section(words: StepWords, look: Look) -> Section:
    """Return the update's numbers and their sources."""
    terms = words.story.terms
    if not words.estimate:
        return Section(UPDATE_HEADING, [Text(f"none: {terms.waiting}", look.palette.text)])
    blocks = _equation_blocks(words, look) if words.story.has_equation else _change_blocks(words, look)
    return Section(UPDATE_HEADING, blocks, update_rows(terms))


def _equation_blocks(words: StepWords, look: Look) -> list[Block]:
    story, palette = words.story, look.palette
    source = palette.source if story.sources else palette.strong
    whole = [] if words.backup is None else words.backup.lines(look.glyphs.arrow_update)[0].split(" ")
    remarks = ([TABLES] if story.last.table else []) + [*words.others[:1]]
    return [
        equation(words, look, palette.updated, source, palette.updated, "δ"),
        Flow(_terms(words, look, source)),
        Flow(_mixture(words, look, source), 4),
        *_gathered(words, look),
        Flow([[Piece(f" {each}", palette.text)] for each in whole], 4),
        *(Flow([[Piece(f" {remark}", palette.dim)]]) for remark in remarks),
        *_evidence(story, look),
    ]


def update_rows(terms: UpdateTerms) -> int:
    """Count the usual rows of an update."""
    return _LEAST_ROWS + (terms.lookup in (Lookup.MEAN, Lookup.OTHER) or not terms.one_step)


def _change_blocks(words: StepWords, look: Look) -> list[Block]:
    palette, update = look.palette, words.update
    moved: list[Line] = [
        [Piece(" your program changed", palette.dim)],
        [Piece(f" {words.estimate}", palette.strong)],
        [Piece(" from ", palette.dim), Piece(update.before, palette.updated)],
        [Piece(" to ", palette.dim), Piece(update.after, palette.updated)],
        [Piece(" (", palette.dim), Piece(update.error, error_style(words, look)), Piece(")", palette.dim)],
    ]
    if words.changes_nothing:
        moved = [
            [Piece(" your program changed nothing:", palette.dim)],
            [Piece(f" {words.estimate} stays ", palette.text), Piece(update.after, palette.updated)],
        ]
    why = [Text(words.why_no_equation[0], palette.text)] if words.why_no_equation else []
    return [Flow(moved), *why, *_evidence(words.story, look)]


def _evidence(story: StepStory, look: Look) -> list[Block]:
    if story.program is None:
        return []
    update, dim = story.program.verdict.update, look.palette.dim
    equations = update_texts(update, look.glyphs)[:-1]  # without the bare rule, which is shown below
    if not equations:
        return []
    is_open, texts = open_text(update, look.glyphs), fit_texts(update)
    fits = [" " + " · ".join(filter(None, (each, is_open))) for each in texts or ("",)]
    in_full = ([Piece(f" {each}", dim)] for each in equations)
    return [
        Row(*in_full, instead=[Text(equations[1], dim, rest="    ")]),
        Row(*([Piece(look.glyphs.separated(each), dim)] for each in fits)),
    ]


def _terms(words: StepWords, look: Look, source: Style) -> Iterator[Line]:
    story, update, palette = words.story, words.update, look.palette
    yield [Piece(" δ = ", palette.dim), Piece(update.error, error_style(words, look))]
    if "/" in update.step_size:
        yield [Piece(f"{_GAP}N = ", palette.dim), Piece(update.step_size[2:], palette.text)]
    if story.has_trace:
        yield [Piece(f"{_GAP}e is the trace of {words.estimate}", palette.dim)]
    if words.bootstrap:
        looked_up = Piece(f" is {_looked_up(words, look)}", palette.dim)
        yield [Piece(_GAP, palette.text), Piece(update.bootstrap, source), looked_up]
    elif story.last.terminated and not story.world.is_bandit:
        yield [Piece(f"{_GAP}terminal: nothing is added for the next state", palette.dim)]


def _mixture(words: StepWords, look: Look, source: Style) -> Iterator[Line]:
    story, palette, glyphs = words.story, look.palette, look.glyphs
    is_mean = words.bootstrap and story.terms.lookup is Lookup.MEAN
    if not is_mean or not 1 < len(story.sources) <= _MOST_CELLS:
        return
    yield [Piece(" ", palette.text), Piece(words.update.bootstrap, source), Piece(" =", palette.text)]
    for number, (weight, estimate) in enumerate(_mixed(words, glyphs)):
        factor = f"{' + ' if number else ' '}{weight}{glyphs.times}"
        yield [Piece(factor, palette.text), Piece(in_brackets(estimate, glyphs), palette.source)]


def _mixed(words: StepWords, glyphs: Glyphs) -> list[tuple[str, str]]:
    mixed = dict(zip(words.story.sources, words.story.looked_up, strict=True))
    shown: list[tuple[str, str]] = []
    for decimals in range(_FEWEST, _MOST + 1):
        shown = [
            (numbers.brief(weight, glyphs, decimals=decimals), column_figure(estimate, decimals, glyphs))
            for weight, estimate in map(mixed.__getitem__, shown_pairs(words.story.world, mixed))
        ]
        worked_out = sum(parsed(weight, glyphs) * parsed(each, glyphs) for weight, each in shown)
        if comes_to(worked_out, words.update.bootstrap, glyphs):
            break
    return shown


def _gathered(words: StepWords, look: Look) -> Iterator[Block]:
    """Yield the rewards of a multi-step target, ``.3 = 0 + .9·0 + .9²·.37``."""
    rewards, total = words.story.gathered_rewards, words.update.gathered
    if rewards:
        terms = partial(terms_of, rewards, len(rewards), words.story.last.gamma, look, total=total)
        text = Text(terms, look.palette.text, "")
        yield Labelled(f"{total} =", look.palette.text, len(f" {total} = "), text)


def _looked_up(words: StepWords, look: Look) -> str:
    story, pairs = words.story, list(words.story.sources)
    if story.last.planned or story.terms.lookup is Lookup.MEAN or not pairs:
        return words.bootstrap
    name = names.action_name(story.world, int(story.world.space.pair_action[pairs[0]]), look.glyphs)
    return f"{words.bootstrap}: {name if len(pairs) == 1 else f'one of {len(pairs)} tied'}"
