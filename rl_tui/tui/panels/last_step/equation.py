"""The update of a step as one equation with its numbers, in groups between which a line may be broken."""

from __future__ import annotations

from rich.style import Style

from rl_tui.tui.draw.pieces import Line, Piece
from rl_tui.tui.panels.last_step.words import StepWords
from rl_tui.tui.theme.look import Look


def equation(words: StepWords, look: Look, before: Style, bootstrap: Style, after: Style) -> list[Line]:
    """Return ``Q(6,←) ← .36 + .10·(0 + .99·.62 − .36) = .39``, three of its numbers in styles of their own.

    A planner's has neither the estimate before nor a step size.
    """
    update, glyphs, plain = words.update, look.glyphs, look.palette.text
    start = Piece(f" {words.estimate} {glyphs.arrow_update} ", look.palette.dim)
    gain: list[Line] = [[Piece(update.gathered, plain)]]
    if words.bootstrap:
        factor = Piece(f" + {update.discount}{glyphs.times}", plain)
        gain.append([factor, *bracketed(update.bootstrap, bootstrap, look)])
    end: Line = [Piece(" = ", plain), Piece(update.after, after)]
    if words.story.last.planned:
        return [[start, *gain[0]], *gain[1:], end]
    opened = Piece(f" + {update.step_size}{glyphs.times}(", plain)
    subtracted = [
        Piece(f" {glyphs.minus} ", plain),
        *bracketed(update.before, before, look),
        Piece(")", plain),
    ]
    return [[start, Piece(update.before, before)], [opened, *gain[0]], *gain[1:], subtracted, end]


def bracketed(number: str, style: Style, look: Look) -> list[Piece]:
    """Return ``number`` in brackets where it starts with a minus and follows an operator."""
    if not number.startswith(look.glyphs.minus):
        return [Piece(number, style)]
    return [Piece("(", look.palette.text), Piece(number, style), Piece(")", look.palette.text)]


def in_brackets(number: str, look: Look) -> str:
    """Return the same as a text."""
    return "".join(piece.text for piece in bracketed(number, look.palette.text, look))


def error_piece(words: StepWords, look: Look) -> Piece:
    """Return δ in the colour of its sign."""
    error = words.update.error
    falls = look.palette.bad if error.startswith(look.glyphs.minus) else look.palette.text
    return Piece(error, look.palette.good if error.startswith("+") else falls)
