"""What is said of a step of somebody's own program: how it chose, what moved, and what is not known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from rl_tui.agents.last_step import LastStep
from rl_tui.lab.detective.verdict import Rule
from rl_tui.lab.last_step.story import StepStory
from rl_tui.tui.draw.precision import agrees, figure, leading_zeros, parsed
from rl_tui.tui.panels.last_step.update_text import UpdateText
from rl_tui.tui.panels.program.words import clause
from rl_tui.tui.theme.glyphs import Glyphs

NOT_KNOWN_YET: Final = "the update is not known yet"
_FEWEST: Final = 2  # decimals of an estimate
_MORE: Final = 6  # decimals beyond those that show its first digit


def choice_texts(pair: int, best: Sequence[int]) -> Sequence[str]:
    """Return how a program chose ``pair``, in full and in short; ``best`` are greedy, none if not known.

    How it explores nobody knows, so an action that is not greedy is not called a random one.
    """
    if not best:
        return "your program chose it", "your choice"
    if pair not in best:
        return "your program chose it: not greedy", "not greedy"
    if len(best) > 1:
        return f"your program chose it: greedy, one of {len(best)} equal", f"greedy, {len(best)} equal"
    return "your program chose it: greedy", "greedy"


def change_text(last: LastStep, glyphs: Glyphs) -> UpdateText:
    """Write the estimate before and after ``last`` and their difference, and nothing that is not known.

    There are as many decimals as show the change, and let the printed difference come out.
    """
    before = 0.0 if math.isnan(last.before) else last.before
    difference, first = last.after - before, _FEWEST + leading_zeros(before, last.after)
    texts = ["", "", ""]
    for decimals in range(first, first + _MORE):
        texts = [figure(each, decimals, glyphs) for each in (before, last.after, difference)]
        between = parsed(texts[1], glyphs) - parsed(texts[0], glyphs)
        shows = texts[0] != texts[1] or not difference
        if shows and agrees(between, texts[2], glyphs, decimals, digits=0.5):
            break
    sign = "+" if difference > 0.0 else ""
    return UpdateText(texts[0], "", "", "", "", "", sign + texts[2], texts[1])


def why_no_equation(story: StepStory) -> Sequence[str]:
    """Return why no more is said of the update of a program, the longest form first."""
    last, program = story.last, story.program
    if last.others:
        cells = f"{last.others + 1:,} cells"
        return (
            f"this step moved {cells}: which update that is, no equation of one cell says",
            f"moved {cells}",
        )
    update = None if program is None else program.verdict.update
    if update is None or update.rule is Rule.UNKNOWN:
        reason = "" if update is None else clause(update.reason)
        forms = (f"{NOT_KNOWN_YET}: {reason}", reason) if reason else ()
        return (*forms, NOT_KNOWN_YET, "not known yet")
    if update.rule is Rule.MONTE_CARLO:
        return (
            "Monte Carlo: at the end of an episode, from the return of its steps",
            "at the end, from returns",
        )
    return "this step departs from the update that fits the others", "departs from its update", "departs"
