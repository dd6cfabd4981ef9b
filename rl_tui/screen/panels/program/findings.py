"""Findings in a watched program."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.programs.evidence.verdict import UNUSUAL_TARGETS, CodeFinding, Rule, step_number
from rl_tui.screen.draw.canvas import Piece, length, spelled, strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Block, Row, Text, lines_of
from rl_tui.screen.kit.panel import key_hints
from rl_tui.screen.kit.scrolling import ScrolledPanel, page_bindings
from rl_tui.screen.panels.program import words
from rl_tui.screen.panels.program.output import source_lines
from rl_tui.screen.theme.look import Look

NOTHING: Final = "nothing wrong found"
NO_JUDGEMENT: Final = "nothing can be judged yet"
WORTH_SAYING: Final = 100
"""Fewest steps for the statement that nothing is wrong."""
NO_STEP_YET: Final = "Nothing to examine yet. space runs your program."
EXAMINED: Final = (
    "Examined: the target, the ends of episodes, the table, which cells change, and the choice of actions."
)
EXAMINED_WITHOUT_RULE: Final = (
    "Examined: the table, which cells change, and the choice of actions, but not the target."
)
_INDENT: Final = "   "


class FindingsPanel(ScrolledPanel):
    """The findings, one of them in full."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings("findings"),
        binding("up", "choose(-1)", "findings.up", "The finding above"),
        binding("down", "choose(1)", "findings.down", "The finding below"),
        binding("enter", "go_to_step", "findings.go_to_step", "Go to the first step that shows it"),
    ]
    title = "Findings"
    _chosen = 0
    _has_moved = False  # then scroll to the finding under the cursor

    @property
    def _findings(self) -> list[CodeFinding]:
        program = None if self.snapshot is None else self.snapshot.program
        return [] if program is None else words.ranked(program.verdict.findings)

    @property
    def chosen(self) -> CodeFinding | None:
        """The finding under the cursor, if any."""
        findings = self._findings
        return findings[min(self._chosen, len(findings) - 1)] if findings else None

    def action_choose(self, by: int) -> None:
        """Choose the next finding, or scroll."""
        count = len(self._findings)
        place = min(self._chosen, count - 1) + by
        if 0 <= place < count:
            self._chosen, self._has_moved = place, True
            self.redraw()
        else:
            self._scroll(by)

    async def action_go_to_step(self) -> None:
        """Go to the finding's first step."""
        if self.chosen is not None:
            await self.run_action(f"screen.do('time.seek({step_number(self.chosen.step)})')")

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows."""
        program = None if snapshot is None else snapshot.program
        if snapshot is None or program is None:
            return []
        findings, chosen = words.ranked(program.verdict.findings), self.chosen
        dim, strong = self.look.palette.dim, self.look.palette.strong
        lines = [] if findings else lines_of(_nothing_found(snapshot, program, self.look), width, self.look)
        for finding in findings:
            if finding is chosen and self._has_moved:
                self._first, self._has_moved = len(lines), False
            blocks = _finding_blocks(finding, program, self.look, width, is_chosen=finding is chosen)
            lines += lines_of(blocks, width, self.look)
            if finding is chosen and finding is not findings[-1]:
                lines.append([])
        for text in words.exploration_texts(program.verdict.exploration, self.look.glyphs)[:1]:
            lines += lines_of((BLANK, Text(text, dim, _INDENT, _INDENT)), width, self.look)
        if notes := words.notes_of(program):
            said = (Text(note, dim, _INDENT, _INDENT) for note in notes)
            lines += lines_of((BLANK, Row([Piece(" Notes", strong)]), *said), width, self.look)
        return strips_of(lines, width, len(lines), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the keys."""
        go = ("enter: go to its step", "enter: its step", "enter: step") if self._findings else ()
        return [*key_hints(go, ("esc: close",))]


def _finding_blocks(
    finding: CodeFinding, program: ProgramView, look: Look, width: int, *, is_chosen: bool
) -> Iterator[Block]:
    palette = look.palette
    place = words.place_text(finding.file, finding.line, program)
    style = palette.bad if finding.kind == "fault" else palette.strong
    named = f"{look.glyphs.cursor if is_chosen else ' '} {finding.noun}: {words.IN_SHORT[finding.fault]}"
    name, where = Piece(f" {named}", style), Piece(f"   {place}" if place else "", palette.text)
    yield Row([name, where], [name], instead=[Text(named, style, rest=_INDENT)] if is_chosen else ())
    if not is_chosen:
        return
    said = words.sentence(finding.text)
    if place and length(spelled([name, where], look)) > width:  # its place did not fit above
        said = f"{place}: {said}"
    yield Text(said, palette.text, _INDENT, _INDENT)
    yield Text(_evidence_text(finding), palette.dim, _INDENT, _INDENT)
    code = source_lines(*words.code_around(finding.file, finding.line, program), look, width)
    yield from (BLANK, *map(Row, code), BLANK) if code else ()
    if finding.correction:
        correction = f"Fix: {one_line(finding.correction, words.LONGEST_SENTENCE)}"
        yield Text(correction, palette.text, _INDENT, _INDENT)


def nothing_wrong(program: ProgramView) -> str:
    """Say that nothing is wrong, or that only notes tell of a target of no rule."""
    notes = words.notes_of(program)
    is_usual = not notes or program.verdict.update.target not in UNUSUAL_TARGETS
    return NOTHING if is_usual else f"{counted(len(notes), 'note')}, no bug proved"


def _evidence_text(finding: CodeFinding) -> str:
    if finding.certainty == "declared":
        certain = "Declared: this relies on a value read from your code"
    elif finding.kind == "risk":
        certain = "A risk: with good luck it does no harm"
    else:
        certain = "Proven"
    steps = ""
    if finding.steps_for:
        against = f"{finding.steps_against:,}" if finding.steps_against else "none"
        steps = f"; {counted(finding.steps_for, 'step')} for it, {against} against"
    return f"{certain}{steps}; first at step {step_number(finding.step):,}."


def _nothing_found(snapshot: Snapshot, program: ProgramView, look: Look) -> Iterator[Block]:
    counters, update, style = snapshot.counters, program.verdict.update, look.palette.text
    if not counters.step and not program.ended:
        yield Text(NO_STEP_YET, style, _INDENT, _INDENT)
        return
    if program.table is None:
        wanted = f" named {one_line(program.wanted, words.LONGEST_NAME)}" if program.wanted else ""
        said = f"No table{wanted} was found in your program, so nothing was examined."
        yield Text(said, style, _INDENT, _INDENT)
        if program.looked_for:
            yield Text("Searched for:", style, _INDENT, _INDENT)
        for each in program.looked_for:
            yield Text(one_line(each, words.LONGEST_SENTENCE), style, f"{_INDENT}- ", f"{_INDENT}  ")
        return
    is_open = update.rule is Rule.UNKNOWN
    is_too_early = words.is_early(update) or (is_open and counters.step < WORTH_SAYING)
    head = f"{NO_JUDGEMENT}: no bug was seen" if is_too_early else nothing_wrong(program)
    text = f"{head} in {counters.step:,} steps and {counters.episodes:,} ends of episodes."
    if is_open:
        reason = f": {words.clause(update.reason)}" if update.reason else ""
        text += f" The update is not known{reason}. {EXAMINED_WITHOUT_RULE}"
    elif update.rule is Rule.MONTE_CARLO:
        text += f" {EXAMINED_WITHOUT_RULE}"
    else:
        text += (
            f" {EXAMINED} Only {update.informative:,} steps reveal γ: on these the value of the next state "
            "is not 0."
        )
    yield Text(text, style, _INDENT, _INDENT)
