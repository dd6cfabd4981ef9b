"""The update of somebody's own program: what moved, and what is known of all its updates together."""

from __future__ import annotations

from rl_tui.lab.last_step.story import StepStory
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, wrapped
from rl_tui.tui.draw.to_ascii import separated
from rl_tui.tui.panels.last_step.equation import error_piece
from rl_tui.tui.panels.last_step.words import StepWords
from rl_tui.tui.panels.microscope.section import flowed
from rl_tui.tui.panels.program.words import fit_texts, open_text, update_texts
from rl_tui.tui.theme.look import Look


def change_lines(words: StepWords, look: Look, width: int) -> list[Line]:
    """Return which cell moved from what to what, why nothing else is said, and what fits other steps."""
    palette, update = look.palette, words.update
    moved: list[Line] = [
        [Piece(" your program moved", palette.dim)],
        [Piece(f" {words.estimate}", palette.strong)],
        [Piece(" from ", palette.dim), Piece(update.before, palette.updated)],
        [Piece(" to ", palette.dim), Piece(update.after, palette.updated)],
        [Piece(" (", palette.dim), error_piece(words, look), Piece(")", palette.dim)],
    ]
    if words.changes_nothing:
        moved = [
            [Piece(" your program changed nothing:", palette.dim)],
            [Piece(f" {words.estimate} stays ", palette.text), Piece(update.after, palette.updated)],
        ]
    lines = flowed(moved, width, look)
    if words.why_no_equation:
        lines += wrapped(words.why_no_equation[0], width, palette.text, look, " ", " ")
    return [*lines, *evidence_lines(words.story, look, width)]


def evidence_lines(story: StepStory, look: Look, width: int) -> list[Line]:
    """Return the update that fits a program, its α and γ, and the share of steps; nothing for ours."""
    if story.program is None:
        return []
    update, palette = story.program.verdict.update, look.palette
    equations = update_texts(update, look.glyphs)
    if not equations:
        return []
    is_open, texts = open_text(update, look.glyphs), fit_texts(update)
    fits = [" " + " · ".join(filter(None, (each, is_open))) for each in texts or ("",)]
    return [
        first_that_fits([[Piece(f" {each}", palette.dim)] for each in equations], width, look),
        first_that_fits([[Piece(separated(each, look.glyphs), palette.dim)] for each in fits], width, look),
    ]
