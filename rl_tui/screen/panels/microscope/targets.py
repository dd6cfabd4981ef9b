"""The target of a sample beside the target that is expected, and what lies between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from rl_tui.agents.catalogue import Lookup
from rl_tui.live.last_step.backup import Backup
from rl_tui.live.last_step.step_report import StepStory
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.draw.precision import agrees, column_figure, leading_zeros, parsed
from rl_tui.screen.kit.blocks import Block, Flow, Labelled, Row, Text
from rl_tui.screen.panels.last_step.words import StepWords
from rl_tui.screen.theme.look import Look

_LABEL: Final = 12
_FEWEST: Final = 2
_MORE: Final = 6  # decimals beyond the fewest


def target_blocks(words: StepWords, backup: Backup, look: Look, *, secret: Sequence[str]) -> Iterator[Block]:
    """Yield the sampled target, the expected one and their difference, each where it is known.

    ``secret`` stands in place of the expected one, the longest form first; none where that may be seen.
    """
    dim, planned = look.palette.dim, words.story.last.planned
    if backup.sampled is None:
        yield Text(_no_sample(words), dim)
        return
    decimals = _decimals(backup.sampled, backup.expected, look)
    yield _target("target" if planned else "sampled", _symbols(words), backup.sampled, decimals, look)
    if secret:
        yield Labelled("expected", dim, _LABEL, Row(*([Piece(each, dim)] for each in secret)))
    elif backup.expected is None:
        yield Text(_not_known(words.story), dim)
    elif planned:
        yield Text("a planner takes the expectation itself: no luck in it", dim)
    else:
        symbols = "mean reward" if words.story.is_bandit else "Σ p (r + γ V(s′))"
        yield _target("expected", symbols, backup.expected, decimals, look)
        difference = backup.sampled - backup.expected
        reason = _drifted(words.story) or _after_end(words.story) or _reason(backup, difference)
        yield _difference(difference, reason, decimals, look)


def _target(label: str, symbols: str, target: float, decimals: int, look: Look) -> Block:
    """Return ``target`` behind its ``symbols``, or alone where they do not fit."""
    number = Piece(column_figure(target, decimals, look.glyphs), look.palette.strong)
    row = Row([Piece(f"{symbols} = ", look.palette.text), number], [number])
    return Labelled(label, look.palette.dim, _LABEL, row)


def _difference(difference: float, reason: str, decimals: int, look: Look) -> Block:
    palette = look.palette
    if abs(difference) < numbers.NEGLIGIBLE:
        shown, style = "0", palette.text
    else:
        shown = column_figure(difference, decimals, look.glyphs)
        shown, style = (shown, palette.bad) if difference < 0.0 else (f"+{shown}", palette.good)
    head = [Piece(f" {'difference':<{_LABEL - 1}}", palette.dim), Piece(shown, style)]
    first, *rest = reason.split(" ")
    words = (f"   {first}", *(f" {word}" for word in rest))
    return Flow([head, *([Piece(word, palette.dim)] for word in words)], _LABEL)


def _drifted(story: StepStory) -> str:
    """Return what else there is where the mean is that after the pull; empty elsewhere."""
    mdp = story.world.mdp
    return "luck, and how far the mean drifted since" if mdp is not None and mdp.drift_std else ""


def _after_end(story: StepStory) -> str:
    """Return that a program bootstraps where its episode is over; empty elsewhere."""
    return "it bootstraps after the end" if story.last.terminated and story.bootstraps else ""


def _reason(backup: Backup, difference: float) -> str:
    """Return what makes the difference between a sample and its expectation."""
    if not backup.is_current:
        return "luck, and what else this step updated"
    if backup.is_certain:
        return "which action came next" if backup.lookup is Lookup.NEXT else "one outcome, no luck"
    if abs(difference) < numbers.NEGLIGIBLE:
        targets = {leaf.reward + backup.gamma * (leaf.value or 0.0) for leaf in backup.leaves}
        return "all outcomes look alike as yet" if len(targets) == 1 else "just what was expected"
    return "luck of this sample and of A′" if backup.lookup is Lookup.NEXT else "luck of this sample"


def _no_sample(words: StepWords) -> str:
    if not words.estimate:
        return words.story.terms.waiting
    return "the target spans several steps: one step has no expected target to match it"


def _not_known(story: StepStory) -> str:
    if story.world.prospects:
        return "expected: there is none, what follows depends on how one came here"
    if story.world.mdp is None:
        return "expected: not known, this world is stepped and nobody wrote its table down"
    return "expected: not known, not all estimates that it needs are at hand"


def _symbols(words: StepWords) -> str:
    terms = words.story.terms
    return f"{terms.gathered} + {terms.discount}·{words.bootstrap}" if words.bootstrap else terms.gathered


def _decimals(sampled: float, expected: float | None, look: Look) -> int:
    """Return the fewest decimals with which the printed difference is that of the printed targets.

    Two at least, three where both are fractions, more where both are small.
    """
    known = [sampled] if expected is None else [sampled, expected]
    largest = max(map(abs, known))
    fewest = _FEWEST if largest >= 1.0 else _FEWEST + max(1, leading_zeros(*known))
    if expected is None or abs(sampled - expected) < numbers.NEGLIGIBLE:
        return fewest
    difference = sampled - expected
    for decimals in range(fewest, fewest + _MORE):
        first, second, printed = (
            column_figure(each, decimals, look.glyphs) for each in (sampled, expected, difference)
        )
        between = parsed(first, look.glyphs) - parsed(second, look.glyphs)
        if round(difference, decimals) and agrees(between, printed, look.glyphs, decimals, digits=0.5):
            return decimals
    return fewest + _MORE
