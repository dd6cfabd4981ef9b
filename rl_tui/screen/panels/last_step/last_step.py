"""The last step, or a planner's last backup."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Final

import numpy as np
from rich.cells import cell_len
from textual.strip import Strip

from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, first_that_fits, length, spelled, strips_of
from rl_tui.screen.kit.blocks import Equation, Flow
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import keeps_back, passes_too_fast
from rl_tui.screen.panels.last_step.state_backup_text import ActionText, BackupText
from rl_tui.screen.panels.last_step.words import NOW, StepWords, equation, words_of
from rl_tui.screen.theme.look import Look

# The lines of a step


_GAP: Final = "   "
_INDENT: Final = 3
_BETWEEN: Final = " · "
_SURPRISE: Final = "surprise δ "
_ERROR: Final = 8  # cells of the number at the end of the bar
_LEAST_BAR: Final = 9
_MOST: Final = 20_000  # pairs: the range of more is not computed for each picture
_FULL: Final = 0.25  # share of the range of all estimates: an error that fills half of the bar
_MOST_ROWS: Final = 7
_LEAST_ROWS: Final = 4  # with fewer rows, words have no line of their own


class StepWriter:
    """Writes one step. ``cells``: previous widths, to keep the equation steady."""

    def __init__(self, words: StepWords, look: Look, width: int, cells: Sequence[int] = ()) -> None:
        self.words = words
        self.cells = cells
        self.width = width
        self._story = words.story
        self._last = words.story.last
        self._look = look
        self._dim = partial(Piece, style=look.palette.dim)
        self._plain = partial(Piece, style=look.palette.text)
        self._strong = partial(Piece, style=look.palette.strong)
        plain, strong = look.palette.text, look.palette.strong
        self._equation = equation(words, look, plain, plain, strong, "δ")
        self._error = Piece(words.update.error, self._equation.label.style)

    def tall(self, height: int) -> list[Line]:
        """Return the full story in ``height`` ≥ 4 rows."""
        if self.words.backup is not None:
            return self._state_backup(self.words.backup, height)
        happened, remark = self._happened(), self._remark()
        if not self.words.estimate:
            return [happened, remark, [self._dim(" "), self._waiting()]]
        if not self._story.has_equation:
            return [happened, remark, self._change(), self._why_no_equation()]
        height = min(height, _MOST_ROWS)
        start = [happened, remark] if height > _LEAST_ROWS else [happened]
        lines = self._steady().lines(self.width, self._look)
        room = max(2, height - len(start) - 1)
        if len(lines) > max(room, 3) and not remark[-1].text:  # the equation needs a second line
            start, room = [happened], height - 2
        if len(lines) > max(room, 3):
            lines = Flow(self._whole(), _INDENT).lines(self.width, self._look)
            lines = lines if len(lines) <= room and all(map(self._fits, lines)) else [self._result()]
        lines = [*start, *lines[:room]]
        return [*lines, *([[]] * (height - len(lines) - 1)), self._bar()]

    def short(self, height: int) -> list[Line]:
        """Return one to three lines."""
        if self.words.backup is not None:
            line = self._bellman(self.words.backup, (self.words.backup.kind, self._which_sweep))
            return [line] if height == 1 else [self._happened(), line]
        if height == 1:
            return [self._one_line()]
        if not self.words.estimate:
            return [self._happened(), [self._dim(" "), self._waiting()]]
        if not self._story.has_equation:
            return [self._happened(), self._change(), self._why_no_equation()]
        whole = self._whole()
        for remark in (*self._remarks(), ""):
            for label in (f"{_GAP}{_SURPRISE}", "  δ "):
                end = [self._dim(f"{_GAP}{remark}")] if remark else []
                groups = [*whole, [self._dim(label), self._error], end]
                lines = Flow(groups, _INDENT).lines(self.width, self._look)
                if len(lines) < height and all(map(self._fits, lines)):
                    return [self._happened(), *lines]
            if remark in self.words.endings:  # worth more than the equation
                break
        return [self._happened(), [*self._result(), self._dim("  δ "), self._error], self._remark()]

    def _one_line(self) -> Line:
        words = self.words
        error: Line = [self._dim("  δ "), self._error]
        whole, result = self._flat(), self._result()
        if not words.estimate:
            whole = result = [self._dim(" "), self._waiting()]
            error = []
        elif not self._story.has_equation:
            whole = result = self._change()
            error = [self._dim(f"  {each}") for each in words.why_no_equation[-1:]]
        gap = self._dim(" ")
        ends = [self._dim(f"  {each[-1]}") for each in (words.endings, words.choices, words.others) if each]
        happened, short = self._happened(), self._happened(is_short=True)
        forms = (
            [*start, gap, *middle, *error, *end]
            for middle in ((whole, result) if self._fits([*short, *whole]) else (result,))
            for end in (ends, ends[:1], [])
            for start in (happened, short)
        )
        return self._fitting(chain(forms, ([*whole, *error], [*result, *error], result)))

    def _steady(self) -> Equation:
        whole = self._equation
        terms = [whole.left, *whole.terms]
        needed = [max(cell_len(term.word), cell_len(term.number)) for term in terms]
        if len(self.cells) == len(terms):
            needed = list(map(max, needed, self.cells))
        if 1 + sum(needed) + sum(cell_len(term.operator) for term in terms) > self.width:
            self.cells = ()
            return whole
        self.cells = needed
        left, *right = (
            term._replace(word=term.word.ljust(cells)) for term, cells in zip(terms, needed, strict=True)
        )
        return Equation(left, right, whole.label)

    # Action and outcome

    def _happened(self, *, is_short: bool = False) -> Line:
        words = self.words
        if self._last.planned:
            return [self._plain(f" {self._which_sweep}")] if is_short else self._sweep()
        if self._story.world.is_bandit:
            line = [self._dim(" pulled "), self._strong(words.action)]
            line += [self._dim(f"{_GAP}reward "), self._strong(words.reward)]
            return self._fitting([[*line, self._dim(f"{_GAP}N {self._story.visits:,}")], line])
        done: Line = [self._strong(words.state), *self._way()]
        short = [*done, self._dim("  r "), self._strong(words.reward)]
        if is_short:
            return [self._dim(" "), *short]
        landmark = self._strong(words.landmark and f": {words.landmark}")
        chance = self._dim(words.chance and f"{_GAP}chance {words.chance}")
        told = [*done, landmark, self._dim(f"{_GAP}reward "), self._strong(words.reward)]
        forms = ([*told, chance], told, [*done, landmark, *short[-2:]], short)
        acted = [done[0], self._dim(" did "), self._strong(words.action), *short[-2:]]
        return self._fitting(
            chain(
                ([self._dim(" in "), *each] for each in forms),
                ([self._dim(" "), *each] for each in (short, done, acted)),
            )
        )

    def _way(self) -> Line:
        words = self.words
        way = [self._dim(" did "), self._strong(words.action)]
        if words.went and words.went != words.meant:
            way = [self._dim(" meant "), self._strong(words.meant), self._dim(" slipped ")]
            way.append(Piece(words.went, self._look.palette.bad))
        wind = [self._plain(f" {words.wind}")] if words.wind else []
        return [*way, *wind, self._dim(" to "), self._strong(words.next_state)]

    def _remark(self) -> Line:
        return self._fitting([self._dim(" "), self._dim(each)] for each in (*self._remarks(), ""))

    def _remarks(self) -> list[str]:
        endings, others = self.words.endings, self.words.others
        if self._last.planned and self._story.planning:
            return self._planning()
        if endings:
            return [f"{each}{_BETWEEN}{other}" for each in endings for other in others] + [*endings]
        is_idle = self.words.estimate and self._story.has_equation and self._last.td_error == 0.0
        if others or not is_idle:
            return [*others]
        return ["nothing to learn: target = estimate", "nothing to learn"]

    # The update

    def _whole(self) -> list[Line]:
        name = self._equation.left.word
        named = [] if name == NOW else [[self._dim(f"{name} = ")]]
        result = [self._plain(" = "), self._strong(self.words.update.after)]
        return [*named, *self._equation.numbers(self._look), result]

    def _flat(self) -> Line:
        return [self._dim(" "), *(piece for group in self._whole() for piece in group)]

    def _result(self) -> Line:
        return [self._dim(f" {self._equation.left.word} = "), self._strong(self.words.update.after)]

    def _bar(self) -> Line:
        glyphs, palette = self._look.glyphs, self._look.palette
        label, error = spelled([self._dim(f" {_SURPRISE}"), self._error], self._look)
        start = cell_len(label.text)
        cells = self.width - start - max(_ERROR, len(error.text)) - 1
        if cells < _LEAST_BAR:
            return self._fitting([self._dim(each), error] for each in (label.text, " δ ", " "))
        if not math.isfinite(self._last.td_error):
            return [label, error]
        half, last, q = cells // 2, self._last, self._story.before.agent.q
        known = float(np.ptp(q)) if len(q) <= _MOST and np.isfinite(q).all() else 0.0
        reach = _FULL * known or max(abs(last.before), abs(last.target)) or 1.0
        filled = min(half, max(1, round(abs(last.td_error) / reach * half))) if error.text != "0" else 0
        rest, bar = glyphs.thin * (half - filled), Piece(glyphs.bold * filled, error.style)
        sides: list[Line] = [[Piece(rest, palette.rule), bar], [Piece(glyphs.thin * half, palette.rule)]]
        if last.td_error > 0.0:
            sides = [sides[1], [bar, Piece(rest, palette.rule)]]
        middle = Piece(glyphs.thin_vertical, palette.dim)
        number = Piece(f"{error.text:>{self.width - start - 2 * half - 1}}", error.style)
        return [label, *sides[0], middle, *sides[1], number]

    def _change(self) -> Line:
        estimate, after = self._strong(self.words.estimate), self._strong(self.words.update.after)
        if self.words.changes_nothing:
            stays, starts = (
                [estimate, self._plain(" stays "), after],
                (" your program changed nothing: ", " "),
            )
            return self._fitting([self._dim(start), *stays] for start in starts)
        moved = [estimate, self._plain(f" from {self.words.update.before} to "), after]
        by = [self._plain(" ("), self._error, self._plain(")")]
        forms = ([self._dim(start), *moved, *by] for start in (" your program changed ", " "))
        return self._fitting([*forms, [self._dim(" "), *moved]])

    def _why_no_equation(self) -> Line:
        return self._fitting([self._dim(f" {each}")] for each in self.words.why_no_equation)

    def _waiting(self) -> Piece:
        return self._plain(self._story.terms.waiting)

    # A planner

    def _sweep(self) -> Line:
        sweep = self._plain(f" {self._which_sweep}{_GAP}")
        state, place = self._strong(self.words.state), self._dim(f"{_GAP}{self.words.place}")
        start = self._dim("backs up state ")
        return self._fitting([[sweep, start, state, place], [sweep, start, state], [sweep, state]])

    @property
    def _which_sweep(self) -> str:
        return "end of a sweep" if self._story.ends_episode else f"sweep {self._last.episode:,}"

    def _planning(self) -> list[str]:
        planning = self._story.planning
        if planning.startswith("sweep "):  # the line above shows its number
            planning = planning.partition(": ")[2]
        return [planning, planning.split(":")[0]]

    def _state_backup(self, backup: BackupText, height: int) -> list[Line]:
        law = self._fitting(
            [self._dim(start), self._plain(backup.law)] for start in (f" {backup.kind}{_GAP}", " ")
        )
        lines = [self._sweep(), *([law] if self._fits(law) else []), self._bellman(backup)]
        signs = max(len(each.sign) for each in backup.actions)
        if len(lines) + len(backup.actions) <= height and all(each.worked_out for each in backup.actions):
            lines[-1:-1] = [self._action_backup(each, signs) for each in backup.actions]
        if self._story.planning and len(lines) < height:
            lines.insert(1, self._remark())
        return lines

    def _action_backup(self, action: ActionText, signs: int) -> Line:
        write = self._plain if action.counts else self._dim
        result = self._strong(action.q) if action.counts else self._dim(action.q)
        sign = f"{_GAP}{action.sign:<{signs}}  "
        return self._fitting([[write(f"{sign}{action.worked_out} = "), result], [write(sign), result]])

    def _bellman(self, backup: BackupText, tail: Sequence[str] = ()) -> Line:
        start = self._dim(f" {backup.left} {self._look.glyphs.arrow_update} ")
        rights = [f"{each} = " for each in backup.right]
        result = self._strong(backup.result)
        forms: list[Line] = [[start, self._plain(each), result] for each in (*rights, "")]
        line = list(self._fitting([*forms, [self._dim(" "), result]]))
        for each in tail:
            if self._fits([*line, self._plain(f"  {each}")]):
                line.append(self._plain(f"  {each}"))
        return line

    def _fitting(self, forms: Iterable[Line]) -> Line:
        return first_that_fits(forms, self.width, self._look)

    def _fits(self, line: Line) -> bool:
        return length(spelled(line, self._look)) <= self.width


# The panel


NOTHING_YET: Final = "no step yet: s takes one"
NOTHING_EVER: Final = "your program took no step"
PREDICT_FIRST: Final = "no step yet: predict first"
OF_ANOTHER_WORLD: Final = "no step yet in this world: s takes one"


class LastStepPanel(Panel):
    """The last step in words and numbers."""

    _cells: Sequence[int] = ()

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the last step."""
        titles = (f"Last step · {each}" for each in _choices(snapshot, self.look))
        self.heading = self.fitting((*titles, *self.captioned("Last step"), "Last step"), width)
        writer = None if snapshot is None else _writer_of(snapshot, self.look, width, self._cells)
        lines = last_step_lines(snapshot, self.look, width, height, writer)
        is_running = snapshot is not None and snapshot.playback.phase is Phase.RUNNING
        self._cells = writer.cells if writer is not None and is_running else ()
        return strips_of(lines, width, height, self.look)


def _choices(snapshot: Snapshot | None, look: Look) -> Sequence[str]:
    story = None if snapshot is None or passes_too_fast(snapshot) else story_of(snapshot)
    return () if story is None else words_of(story, look.glyphs).choices


def nothing_yet(snapshot: Snapshot | None) -> str:
    """Explain why there is no last step."""
    if snapshot is not None and snapshot.program is not None and snapshot.counters.step:
        return "this step is not in the transition table"
    if snapshot is not None and snapshot.program is not None and snapshot.playback.phase is Phase.SPENT:
        return NOTHING_EVER
    if snapshot is None or snapshot.counters.step == 0:
        return NOTHING_YET if snapshot is None or not keeps_back(snapshot, "run") else PREDICT_FIRST
    changes = snapshot.world_changes
    if changes and changes[-1].step == snapshot.counters.step:
        return OF_ANOTHER_WORLD
    return "the last step appears once it is replayed"


def last_step_lines(
    snapshot: Snapshot | None, look: Look, width: int, height: int, writer: StepWriter | None = None
) -> list[Line]:
    """Return up to ``height`` lines."""
    if snapshot is not None:
        writer = writer or _writer_of(snapshot, look, width)
    if writer is None:
        return [[Piece(" ", look.palette.text), Piece(nothing_yet(snapshot), look.palette.dim)]]
    return (writer.tall(height) if height >= _LEAST_ROWS else writer.short(height))[:height]


def _writer_of(snapshot: Snapshot, look: Look, width: int, cells: Sequence[int] = ()) -> StepWriter | None:
    story = story_of(snapshot)
    if story is None:
        return None
    if keeps_back(snapshot, "model"):
        story = replace(story, chance=None)
    return StepWriter(words_of(story, look.glyphs), look, width, cells)
