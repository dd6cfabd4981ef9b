"""The panel of a watched program."""

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
from rl_tui.screen.kit.blocks import Block, Row, Text, lines_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.panels.program import words as wording
from rl_tui.screen.panels.program.findings import NO_JUDGEMENT, WORTH_SAYING, nothing_wrong
from rl_tui.screen.theme.look import Look

LOOKED_FOR_LATER: Final = "its table is found while it learns"
NO_TABLE_YET: Final = "no table found yet"
NO_TABLE: Final = "no table found"
UNKNOWN: Final = "update not known"
_GAMMA_FROM: Final = {"declared": "read from your code", "usual": "a common value; yours is not known yet"}
_NEWS_ROWS: Final = 2
_ERROR_ROWS: Final = 3
_REASON_ROWS: Final = 2
_HINTS: Final = ("a f findings · a w output", "a f · a w")


class _Part(NamedTuple):
    """Some blocks, cut after ``most`` lines. High ``rank`` is dropped first.

    ``shorter``: forms that replace blocks of too many lines.
    """

    rank: int
    blocks: Sequence[Block]
    most: int = 99
    more: str = ""
    shorter: Sequence[Sequence[Block]] = ()


class ProgramPanel(Panel):
    """The main facts about a program."""

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the program."""
        program = None if snapshot is None else snapshot.program
        name = "Program" if program is None else f"Program · {wording.name_of(program)}"
        self.heading = self.fitting((*self.captioned(name), name, "Program"), width)
        self.footing = "" if program is None else self.fitting(_HINTS, width)
        parts = [] if snapshot is None or program is None else [*_parts(snapshot, program, self.look)]
        shown: dict[int, list[Line]] = {}
        for place in sorted(range(len(parts)), key=lambda place: parts[place].rank):
            part, room = parts[place], height - sum(map(len, shown.values()))
            forms = [lines_of(each, width, self.look) for each in (part.blocks, *part.shorter)]
            whole = next((lines for lines in forms if len(lines) <= min(part.most, room)), forms[0])
            lines = _cut(whole, part.most, self.look, width)
            shown[place] = _cut(lines, room, self.look, width, part.more)
        found = [line for place in range(len(parts)) for line in shown[place]]
        self.free_rows = height - len(found)
        return strips_of(found, width, height, self.look)


def _cut(lines: list[Line], rows: int, look: Look, width: int, more: str = "") -> list[Line]:
    if len(lines) <= rows or not rows:
        return lines[:rows]
    return [*lines[: rows - 1], _unfinished(lines[rows - 1], look, width, more)]


def _unfinished(line: Line, look: Look, width: int, more: str) -> Line:
    *whole, last = spelled(line, look)
    room = max(0, width - length(whole) - 1)
    ending = more if 2 * cell_len(more) < room else ""
    text = set_cell_size(last.text, min(cell_len(last.text), room - cell_len(ending))).rstrip()
    return [*whole, Piece(text + look.glyphs.ellipsis + ending, last.style)]


def _parts(snapshot: Snapshot, program: ProgramView, look: Look) -> Iterator[_Part]:
    palette, error, steps = look.palette, program.error, snapshot.counters.step

    def text(words: str, style: Style) -> Sequence[Block]:
        return [Text(words, style, rest="   ")]

    def row(forms: Iterable[str], style: Style) -> Sequence[Block]:
        lines = [[Piece(look.glyphs.separated(f" {form}"), style)] for form in forms]
        return [Row(*lines)] if lines else []

    if program.refused:
        yield _Part(
            0,
            text(f"{look.glyphs.stopped} {one_line(program.refused, wording.LONGEST_SENTENCE)}", palette.bad),
        )
        return
    if error is not None:
        place = wording.place_text(error.file, error.line, program)
        what = f"{one_line(error.type, wording.LONGEST_NAME)}{f' ({place})' if place else ''}"
        said = f"{look.glyphs.stopped} {what}: {one_line(error.text, wording.LONGEST_SENTENCE)}"
        yield _Part(0, text(said, palette.bad), _ERROR_ROWS)
    yield _Part(4, text(one_line(program.reloaded, wording.LONGEST_SENTENCE), palette.strong), _NEWS_ROWS)
    yield _Part(5, row(_table(program, steps), palette.text))
    looked = "; ".join(one_line(each, wording.LONGEST_SENTENCE) for each in program.looked_for)
    if looked and steps and program.table is None:
        yield _Part(6, text(f"searched for: {looked}", palette.dim))
    update = program.verdict.update
    if texts := wording.update_texts(update, look.glyphs):
        yield _Part(2, row(texts, palette.strong), _REASON_ROWS)
    elif program.table is not None:
        reason = wording.clause(update.reason)
        known = wording.fitting_numbers(update, look.glyphs)
        start = f"update known in part, {known}" if known else UNKNOWN if reason else f"{UNKNOWN} yet"
        forms = [f"{start}: {form}" if form else start for form in (reason, wording.in_brief(reason))]
        whole, brief = (text(form, palette.text) for form in forms)
        yield _Part(2, whole, _REASON_ROWS, shorter=[brief])
    is_open, fits = wording.open_text(update, look.glyphs), wording.fit_texts(update)
    forms = [" · ".join(filter(None, (each, is_open))) for each in fits]
    yield _Part(6, row([*forms, *fits], palette.dim))
    exploration = program.verdict.exploration
    rank = 3 if exploration is not None and exploration.departs else 7
    yield _Part(rank, row(wording.exploration_texts(exploration, look.glyphs), palette.dim))
    if program.verdict.findings:
        yield _Part(1, [_findings(program, look)])
    elif steps >= WORTH_SAYING and program.table is not None:
        yield _Part(3, row(_nothing_wrong(program, steps), palette.dim))
    if program.gamma is not None and program.gamma_source in _GAMMA_FROM:
        gamma = f"for γ {wording.number_text(program.gamma, look.glyphs)}"
        source = f"{gamma}: {_GAMMA_FROM[program.gamma_source]}"
        forms = [f"exact values are {source}", f"exact {source}", f"exact values {gamma}"]
        yield _Part(7, row(forms, palette.dim))
    if program.table is not None and (others := program.table.others):
        listed = ", ".join(one_line(each, wording.LONGEST_NAME) for each in others[:4])
        forms = [f"a b chooses another table: {listed}", f"a b: another table ({len(others):,})"]
        yield _Part(7, row(forms, palette.dim))
    if notes := wording.notes_of(program):
        count = f"note 1 of {len(notes):,}: " if len(notes) > 1 else "note: "
        brief = text(f"{count}{wording.in_brief(notes[0])}   a f shows it", palette.dim)
        yield _Part(8, text(f"{count}{notes[0]}", palette.dim), more=" a f shows it", shorter=[brief])


def _table(program: ProgramView, steps: int) -> Sequence[str]:
    environment = one_line(program.environment, wording.LONGEST_NAME)
    if program.table is not None:
        tables = wording.table_texts(program.table)
        return *(f"{environment} · {each}" for each in tables[:2]), *tables
    if not steps and not program.ended:
        return f"{environment} · {LOOKED_FOR_LATER}", LOOKED_FOR_LATER, NO_TABLE_YET
    if program.wanted:
        wanted = f"{NO_TABLE} named {one_line(program.wanted, wording.LONGEST_NAME)}"
        return f"{wanted} where env.step was called", wanted, NO_TABLE
    start = f"{environment} · {NO_TABLE}" if environment else NO_TABLE
    hint = [f"{start}: a f shows the search"] if program.looked_for else []
    return *hint, start, NO_TABLE


def _findings(program: ProgramView, look: Look) -> Row:
    findings = wording.ranked(program.verdict.findings)
    worst = findings[0]
    place, said = wording.place_text(worst.file, worst.line, program), wording.IN_SHORT[worst.fault]
    count = f" {look.glyphs.breakpoint} {wording.counted(findings)}"
    style = look.palette.bad if worst.kind == "fault" else look.palette.strong
    hint = Piece("   a f shows it" if len(findings) == 1 else "   a f shows them", look.palette.dim)
    texts = (f"{count}: {said}{f' ({place})' if place else ''}", f"{count}: {said}", count)
    return Row([Piece(texts[0], style), hint], *([Piece(text, style)] for text in texts))


def _nothing_wrong(program: ProgramView, steps: int) -> Sequence[str]:
    update = program.verdict.update
    if wording.is_early(update):
        return f"{NO_JUDGEMENT}   a f shows what was examined", NO_JUDGEMENT
    found = f"{nothing_wrong(program)} in {steps:,} steps"
    if update.rule is Rule.UNKNOWN:
        known = f"{found}, but the update is not known"
        return f"{known}   a f shows what was examined", known, found
    return f"{found}   a f shows what was examined", found, nothing_wrong(program)
