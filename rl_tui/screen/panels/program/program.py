"""The program that is watched, where the sliders of an agent stand: table, update, findings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len, set_cell_size
from rich.style import Style
from textual.strip import Strip

from rl_tui.common.findings import one_line
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.programs.evidence.verdict import Rule
from rl_tui.screen.draw.canvas import Line, Piece, length, spelled, strips_of
from rl_tui.screen.draw.to_ascii import separated
from rl_tui.screen.kit.blocks import Block, Row, Text, lines_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.panels.program.findings import NO_JUDGEMENT, WORTH_SAYING
from rl_tui.screen.panels.program.words import (
    IN_SHORT,
    LONGEST_NAME,
    LONGEST_SENTENCE,
    clause,
    counted,
    fit_texts,
    fitting_numbers,
    is_early,
    name_of,
    notes_of,
    number_text,
    open_text,
    place_text,
    ranked,
    table_texts,
    update_texts,
)
from rl_tui.screen.theme.look import Look

LOOKED_FOR_LATER: Final = "its table is looked for as it learns"
NO_TABLE: Final = "no table found"
UNKNOWN: Final = "update not known"
_GAMMA_FROM: Final = {"declared": "read from your code", "usual": "a common value; yours is not known yet"}
_NEWS_ROWS: Final = 2
_ERROR_ROWS: Final = 3
_REASON_ROWS: Final = 2
_HINTS: Final = ("a f findings · a w output", "a f · a w")


class _Part(NamedTuple):
    """Some blocks; where there is no room for all parts, those of the highest ``rank`` are left out.

    They are cut off after ``most`` lines, and behind that stands where there is ``more``.
    """

    rank: int
    blocks: Sequence[Block]
    most: int = 99
    more: str = ""


class ProgramPanel(Panel):
    """What there is to know of a program in a few lines, the most important where there is little room."""

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the picture of the program of ``snapshot``."""
        program = None if snapshot is None else snapshot.program
        name = "Program" if program is None else f"Program · {name_of(program)}"
        self.heading = self.fitting((*self.captioned(name), name, "Program"), width)
        self.footing = "" if program is None else self.fitting(_HINTS, width)
        lines: list[Line] = []
        if snapshot is not None and program is not None:
            lines = program_lines(snapshot, program, self.look, width, height)
        self.free_rows = height - len(lines)
        return strips_of(lines, width, height, self.look)


def program_lines(
    snapshot: Snapshot, program: ProgramView, look: Look, width: int, height: int
) -> list[Line]:
    """Return what the panel says in ``height`` rows of ``width`` cells, at most so many lines."""
    parts = list(_Writer(snapshot, program, look).parts())
    shown: dict[int, list[Line]] = {}
    for place in sorted(range(len(parts)), key=lambda place: parts[place].rank):
        part, room = parts[place], height - sum(map(len, shown.values()))
        lines = _cut(lines_of(part.blocks, width, look), part.most, look, width)
        shown[place] = _cut(lines, room, look, width, part.more)
    return [line for place in range(len(parts)) for line in shown[place]]


def _cut(lines: list[Line], rows: int, look: Look, width: int, more: str = "") -> list[Line]:
    if len(lines) <= rows or not rows:
        return lines[:rows]
    return [*lines[: rows - 1], _unfinished(lines[rows - 1], look, width, more)]


def _unfinished(line: Line, look: Look, width: int, more: str) -> Line:
    *whole, last = spelled(line, look)
    room = max(0, width - length(whole) - 1)
    if 2 * cell_len(more) < room:
        text = set_cell_size(last.text, min(cell_len(last.text), room - cell_len(more))).rstrip()
        return [*whole, Piece(text + look.glyphs.ellipsis + more, last.style)]
    text = set_cell_size(last.text, min(cell_len(last.text), room)).rstrip()
    return [*whole, Piece(text + look.glyphs.ellipsis, last.style)]


class _Writer:
    def __init__(self, snapshot: Snapshot, program: ProgramView, look: Look) -> None:
        self._steps = snapshot.counters.step
        self._program = program
        self._look = look
        self._palette = look.palette

    def parts(self) -> Iterator[_Part]:
        """Yield the parts in the order in which they stand below one another."""
        program = self._program
        if program.refused:
            refused = f"{self._look.glyphs.stopped} {one_line(program.refused, LONGEST_SENTENCE)}"
            yield _Part(0, [self._text(refused, self._palette.bad)])
            return
        yield _Part(0, self._error(), _ERROR_ROWS)
        news = self._text(one_line(program.reloaded, LONGEST_SENTENCE), self._palette.strong)
        yield _Part(4, [news], _NEWS_ROWS)
        yield _Part(5, self._table())
        yield _Part(6, self._looked_for())
        yield _Part(2, self._update(), _REASON_ROWS)
        yield _Part(6, self._fit())
        yield _Part(1 if program.verdict.findings else 3, self._findings())
        yield _Part(7, self._gamma())
        yield _Part(7, self._choices())
        yield _Part(8, self._notes(), more=" a f shows it")

    def _error(self) -> Sequence[Block]:
        error = self._program.error
        if error is None:
            return []
        place = place_text(error.file, error.line, self._program)
        at = f" ({place})" if place else ""
        text = one_line(error.text, LONGEST_SENTENCE)
        what = f"{self._look.glyphs.stopped} {one_line(error.type, LONGEST_NAME)}{at}: {text}"
        return [self._text(what, self._palette.bad)]

    def _table(self) -> Sequence[Block]:
        program = self._program
        environment = one_line(program.environment, LONGEST_NAME)
        if program.table is None and not self._steps:
            later = (f" {environment} · {LOOKED_FOR_LATER}", f" {LOOKED_FOR_LATER}")
            return [self._row(later, self._palette.text)]
        if program.table is None:
            start = f" {environment} · {NO_TABLE}" if environment else f" {NO_TABLE}"
            looked = f"{start}: a f says what was looked for" if program.looked_for else start
            return [self._row((looked, start, f" {NO_TABLE}"), self._palette.text)]
        tables = table_texts(program.table)
        forms = (*(f" {environment} · {each}" for each in tables[:2]), *(f" {each}" for each in tables))
        return [self._row(forms, self._palette.text)]

    def _looked_for(self) -> Sequence[Block]:
        looked = "; ".join(one_line(each, LONGEST_SENTENCE) for each in self._program.looked_for)
        if not looked or not self._steps or self._program.table is not None:
            return []
        return [self._text(f"looked for: {looked}", self._palette.dim)]

    def _update(self) -> Sequence[Block]:
        update = self._program.verdict.update
        texts = update_texts(update, self._look.glyphs)
        if texts:
            return [self._row([f" {each}" for each in texts], self._palette.strong)]
        if self._program.table is None:
            return []
        reason = f": {clause(update.reason)}" if update.reason else ""
        numbers = fitting_numbers(update, self._look.glyphs)
        known = f"update known in part, {numbers}" if numbers else UNKNOWN if reason else f"{UNKNOWN} yet"
        return [self._text(f"{known}{reason}", self._palette.text)]

    def _fit(self) -> Sequence[Block]:
        update = self._program.verdict.update
        is_open, texts = open_text(update, self._look.glyphs), fit_texts(update)
        forms = [" · ".join(filter(None, (each, is_open))) for each in texts] + list(texts)
        return [self._row([f" {each}" for each in forms], self._palette.dim)] if forms else []

    def _gamma(self) -> Sequence[Block]:
        """Return which γ the exact answers are for, where it is not the one that the steps have told."""
        program = self._program
        if program.gamma is None or program.gamma_source not in _GAMMA_FROM:
            return []
        source = _GAMMA_FROM[program.gamma_source]
        gamma = number_text(program.gamma, self._look.glyphs)
        forms = (f" exact answers are for γ {gamma}: {source}", f" exact for γ {gamma}: {source}")
        return [self._row(forms, self._palette.dim)]

    def _findings(self) -> Sequence[Block]:
        program, findings = self._program, ranked(self._program.verdict.findings)
        if not findings:
            return self._nothing_wrong()
        worst = findings[0]
        place = place_text(worst.file, worst.line, program)
        said = IN_SHORT[worst.fault]
        at = f" ({place})" if place else ""
        count = f" {self._look.glyphs.breakpoint} {counted(findings)}: "
        style = self._palette.bad if worst.kind == "fault" else self._palette.strong
        hint = Piece("   a f shows it" if len(findings) == 1 else "   a f shows them", self._palette.dim)
        texts = (f"{count}{said}{at}", f"{count}{said}", count.rstrip(": "))
        return [Row([Piece(texts[0], style), hint], *([Piece(text, style)] for text in texts))]

    def _nothing_wrong(self) -> Sequence[Block]:
        if self._steps < WORTH_SAYING or self._program.table is None:
            return []
        if is_early(self._program.verdict.update):
            early = f" {NO_JUDGEMENT}"
            return [self._row((f"{early}   a f says what was examined", early), self._palette.dim)]
        found = f" nothing wrong found in {self._steps:,} steps"
        is_open = self._program.verdict.update.rule is Rule.UNKNOWN
        if is_open:
            in_part = f"{found}, as far as can be told"
            return [self._row((f"{in_part}   a f says how far", in_part, found), self._palette.dim)]
        return [self._row((f"{found}   a f says what was examined", found), self._palette.dim)]

    def _choices(self) -> Sequence[Block]:
        table = self._program.table
        if table is None or not table.others:
            return []
        names = ", ".join(one_line(each, LONGEST_NAME) for each in table.others[:4])
        forms = (f" a b chooses another table: {names}", f" a b: another table ({len(table.others):,})")
        return [self._row(forms, self._palette.dim)]

    def _notes(self) -> Sequence[Block]:
        notes = notes_of(self._program)
        if not notes:
            return []
        count = f"note 1 of {len(notes):,}: " if len(notes) > 1 else "note: "
        return [self._text(f"{count}{notes[0]}", self._palette.dim)]

    def _text(self, text: str, style: Style) -> Text:
        return Text(text, style, rest="   ")

    def _row(self, forms: Iterable[str], style: Style) -> Row:
        return Row(*([Piece(separated(form, self._look.glyphs), style)] for form in forms))
