"""The update of the last step, every number tied to the cell of the table that it came from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rich.style import Style

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.update_terms import Lookup
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import names, numbers
from rl_tui.tui.draw.pieces import Line, Piece
from rl_tui.tui.draw.precision import column_figure, comes_to, parsed
from rl_tui.tui.panels.last_step.loop_text import LoopText
from rl_tui.tui.panels.last_step.step_lines import in_brackets
from rl_tui.tui.panels.microscope.return_text import gathered_rewards, terms_of
from rl_tui.tui.panels.microscope.section import MicroscopeSection, columns_of, flowed
from rl_tui.tui.theme.look import Look

UPDATE_HEADING: Final = "The update"
_LEAST_ROWS: Final = 5
TABLES: Final = "the table shows the mean of Q₁ and Q₂"
_MOST_CELLS: Final = 6
_FEWEST: Final = 3  # decimals of weights and estimates
_MOST: Final = 9
_GAP: Final = "   "


def update_section(
    snapshot: Snapshot,
    last: LastStep,
    text: LoopText,
    sources: Mapping[int, float],
    look: Look,
    width: int,
) -> MicroscopeSection:
    """Return the update in numbers and where each comes from; ``sources`` are the pairs looked up."""
    if not text.estimate:
        waiting = flowed([[Piece(f" {text.waiting}", look.palette.text)]], width, look)
        return MicroscopeSection(UPDATE_HEADING, waiting, update_rows(snapshot))
    writer = _Writer(snapshot, last, text, sources, look)
    groups = ((writer.equation(), 4), (writer.terms(), 1), (writer.mixture(), 4), (writer.gathered(width), 4))
    lines = [line for group, indent in groups for line in flowed(group, width, look, indent)]
    if last.table:
        lines += flowed([[Piece(f" {TABLES}", look.palette.dim)]], width, look)
    if text.others:
        lines += flowed([[Piece(f" {text.others[0]}", look.palette.dim)]], width, look)
    return MicroscopeSection(UPDATE_HEADING, lines, update_rows(snapshot))


def update_rows(snapshot: Snapshot) -> int:
    """Return how many rows the update of the algorithm mostly takes."""
    terms = BY_ID[snapshot.agent.learned_by[0]].update
    return _LEAST_ROWS + (terms.lookup in (Lookup.MEAN, Lookup.OTHER) or not terms.one_step)


class _Writer:
    def __init__(
        self, snapshot: Snapshot, last: LastStep, text: LoopText, sources: Mapping[int, float], look: Look
    ) -> None:
        self._snapshot = snapshot
        self._last = last
        self._text = text
        self._sources = sources
        self._look = look
        self._palette = look.palette

    def equation(self) -> list[Line]:
        """Return ``Q(6,←) ← .36 + .10·(0 + .99·.62 − .36) = .39  δ = +.25``."""
        text, update, glyphs = self._text, self._text.update, self._look.glyphs
        gain: list[Line] = [[self._plain(update.gathered)]]
        if text.bootstrap:
            gain.append(
                [self._plain(f" + {update.discount}{glyphs.times}"), *self._bootstrap(update.bootstrap)]
            )
        start: Line = [Piece(f" {text.estimate} {glyphs.arrow_update} ", self._palette.dim)]
        end: list[Line] = [[self._plain(" = "), Piece(update.after, self._palette.updated)]]
        error: Line = [Piece(f"{_GAP}δ = ", self._palette.dim), Piece(update.error, self._error_style)]
        if text.sweep:
            return [[*start, *gain[0]], *gain[1:], *end, error]
        before = Piece(update.before, self._palette.updated)
        factor = self._plain(f" + {update.step_size}{glyphs.times}(")
        subtracted: Line = [self._plain(f" {glyphs.minus} "), *self._in_brackets(before), self._plain(")")]
        return [[*start, before], [factor, *gain[0]], *gain[1:], subtracted, *end, error]

    def terms(self) -> list[Line]:
        """Return which number is what."""
        text, update = self._text, self._text.update
        found: list[Line] = []
        if not text.sweep:
            found.append([Piece(update.before, self._palette.updated), self._dim(f" {text.estimate} before")])
            found.append([self._plain(f"{_GAP}{update.step_size}"), self._dim(f" {self._step_size()}")])
        gathered = {"r": "reward", "G": "rewards gathered"}.get(text.gathered, text.gathered)
        found.append([self._plain(f"{_GAP}{update.gathered}"), self._dim(f" {gathered}")])
        if not text.bootstrap:
            if text.terminated and not text.is_bandit:
                found.append([self._dim(f"{_GAP}after the end nothing is added")])
            return found
        found.append([self._plain(f"{_GAP}{update.discount}"), self._dim(f" {text.discount}")])
        number = Piece(update.bootstrap, self._bootstrap_style)
        found.append([self._plain(_GAP), number, self._dim(f" {self._looked_up()}")])
        return found

    def _step_size(self) -> str:
        """Return what the step size is: α, the fraction 1/N, or α times the trace of the pair."""
        algorithm, params = self._snapshot.agent.learned_by
        text = self._text.update.step_size
        if "/" in text:
            return f"α, N = {text[2:]}"
        has_trace = "traces" in BY_ID[algorithm].parameters and self._last.step_size != params.alpha
        return "α e, e its trace" if has_trace else "α"

    def mixture(self) -> list[Line]:
        """Return the cells of a weighted mean in their order, ``.58 = .925·.62 + .025·.31``; else none."""
        lookup = BY_ID[self._snapshot.agent.learned_by[0]].update.lookup
        if not self._text.bootstrap or lookup is not Lookup.MEAN or not 1 < len(self._sources) <= _MOST_CELLS:
            return []
        groups: list[Line] = [
            [self._plain(" "), Piece(self._text.update.bootstrap, self._bootstrap_style), self._plain(" =")]
        ]
        for number, (weight, estimate) in enumerate(self._mixed()):
            sign = " " if number == 0 else " + "
            factor = self._plain(f"{sign}{weight}{self._look.glyphs.times}")
            groups.append([factor, *self._in_brackets(Piece(estimate, self._palette.source))])
        return groups

    def _mixed(self) -> list[tuple[str, str]]:
        """Return weights and estimates with the fewest decimals that give the bootstrap as it is printed."""
        glyphs, bootstrap, last = self._look.glyphs, self._text.update.bootstrap, self._last
        cells = [
            (weight, last.before if pair == last.updated_pair else float(self._snapshot.agent.q[pair]))
            for pair, weight in self._sources.items()
        ]
        shown: list[tuple[str, str]] = []
        for decimals in range(_FEWEST, _MOST + 1):
            shown = [
                (numbers.brief(weight, glyphs, decimals=decimals), column_figure(estimate, decimals, glyphs))
                for weight, estimate in cells
            ]
            worked_out = sum(parsed(weight, glyphs) * parsed(each, glyphs) for weight, each in shown)
            if comes_to(worked_out, bootstrap, glyphs):
                break
        return shown

    def gathered(self, width: int) -> list[Line]:
        """Return the rewards of a target of several steps, ``.3 = 0 + .9·0 + .9²·.37``; nothing elsewhere."""
        rewards = gathered_rewards(self._snapshot, self._last)
        if not rewards:
            return []
        start = self._plain(f" {self._text.update.gathered} = ")
        room = width - columns_of(start.text, self._look)
        total = self._text.update.gathered
        terms = terms_of(rewards, len(rewards), self._last.gamma, self._look, room, total)
        return [[start, self._plain(terms)]]

    def _looked_up(self) -> str:
        """Return what the bootstrap is, with the cell it was read from where that is known."""
        text, world, glyphs = self._text, self._snapshot.world, self._look.glyphs
        actions = [
            names.action_name(world, int(world.space.pair_action[pair]), glyphs) for pair in self._sources
        ]
        lookup = BY_ID[self._snapshot.agent.learned_by[0]].update.lookup
        if self._last.planned or lookup is Lookup.MEAN or not actions:
            return text.bootstrap
        if len(actions) == 1:
            return f"{text.bootstrap}: {actions[0]}"
        return f"{text.bootstrap}: one of {len(actions)} equal"

    def _bootstrap(self, number: str) -> list[Piece]:
        return self._in_brackets(Piece(number, self._bootstrap_style))

    @property
    def _bootstrap_style(self) -> Style:
        return self._palette.source if self._sources else self._palette.strong

    def _in_brackets(self, number: Piece) -> list[Piece]:
        """Return ``number`` in brackets where it starts with a minus and follows an operator."""
        if in_brackets(number.text, self._look.glyphs.minus) == number.text:
            return [number]
        return [self._plain("("), number, self._plain(")")]

    def _plain(self, text: str) -> Piece:
        return Piece(text, self._palette.text)

    def _dim(self, text: str) -> Piece:
        return Piece(text, self._palette.dim)

    @property
    def _error_style(self) -> Style:
        error = self._text.update.error
        if error.startswith("+"):
            return self._palette.good
        return self._palette.bad if error.startswith(self._look.glyphs.minus) else self._palette.text
