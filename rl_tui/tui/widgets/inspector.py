"""The last step: what the agent chose and why, what the environment did, and the update with its numbers."""

from __future__ import annotations

from typing import Final

from rich.style import Style
from textual.strip import Strip

from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui.speeds import passes_too_fast
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets.loop_text import LoopText, loop_text, outcome_words
from rl_tui.tui.widgets.panel import Panel
from rl_tui.tui.widgets.pieces import Line, Piece, first_that_fits, length, spelled, strips_of
from rl_tui.worlds.drawing import Arms

NOTHING_YET: Final = "no step yet: s takes one"
_LABEL: Final = 13
_ROOM_FOR_LABELS: Final = 46
_GAP: Final = "   "
_COLON: Final = ": "
# Rows of agent, environment, target and δ (0: beside the target), longest form first; one more is the update
_ROWS: Final = ((2, 2, 2, 1), (2, 2, 1, 1), (1, 2, 1, 1), (1, 1, 1, 1), (1, 1, 1, 0))
_LEAST_ROWS: Final = 4  # below this the loop is not told in lines of its own


class Inspector(Panel):
    """The loop in five parts (state, action, reward, next state, update); in one row the update alone.

    It is drawn from the last step of the snapshot only, so that all its numbers belong together.
    """

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the picture of the last step of ``snapshot``."""
        self.heading = "Last step"
        self.footing = _which(snapshot)
        return strips_of(inspector_lines(snapshot, self.look, width, height), width, height, self.look)


def _which(snapshot: Snapshot | None) -> str:
    """Return which step it was; nothing while they pass too fast to tell, since a title redraws the panel."""
    if snapshot is None or snapshot.last is None or passes_too_fast(snapshot):
        return ""
    step, episode = snapshot.last.step, snapshot.last.episode
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    return f"pull {step:,}" if is_bandit else f"step {step:,} · episode {episode:,}"


def inspector_lines(snapshot: Snapshot | None, look: Look, width: int, height: int) -> list[Line]:
    """Return what the inspector says in ``height`` rows of ``width`` cells, at most so many lines."""
    palette = look.palette
    if snapshot is None or snapshot.last is None:
        return [[Piece(" ", palette.text), Piece(NOTHING_YET, palette.dim)]]
    writer = _Writer(snapshot, loop_text(snapshot, snapshot.last, look.glyphs), look, width)
    return (writer.tall(height) if height >= _LEAST_ROWS else writer.short(height))[:height]


class _Writer:
    """Writes the lines of one step."""

    def __init__(self, snapshot: Snapshot, text: LoopText, look: Look, width: int) -> None:
        self.text = text
        self.width = width
        self._look = look
        self._palette = look.palette
        glyphs = look.glyphs
        self._times = glyphs.times
        self._arrow = glyphs.arrow_update
        self._minus = glyphs.minus
        self._loose = f" {glyphs.times} "

    def tall(self, height: int) -> list[Line]:
        """Return the loop part by part, in the longest form that ``height`` rows (at least 4) hold."""
        if self.text.is_bandit:
            return self._bandit()
        form: list[Line] = []
        for agent, environment, target, delta in _ROWS:
            form = [
                *self._agent(agent),
                *self._environment(environment),
                *self._target(target, with_delta=delta == 0),
                *([self._delta()] if delta else []),
                self._assignment(),
            ]
            if len(form) <= height:
                break
        return form

    def short(self, height: int) -> list[Line]:
        """Return one to three lines: the update, and above it what led to it."""
        if height == 1:
            return [self._one_line()]
        lines: list[Line] = [self._summary(), self._shortened(self._assignment_in_full())]
        return lines if height == 2 else [*lines, self._delta()]

    def _agent(self, rows: int) -> list[Line]:
        text, palette = self.text, self._palette
        label = self._label("agent")
        states = [[self._symbol(each), Piece(text.state, palette.strong)] for each in ("state s = ", "s = ")]
        place = [Piece(f"{_GAP}{text.place}", palette.dim)] if text.place else []
        actions = [
            [Piece(f"{_GAP}{each}", palette.dim), Piece(text.action, palette.strong)]
            for each in ("action a = ", "a = ")
        ]
        both = list(zip(states, actions, strict=True))
        if rows == 1:
            choice = Piece(f"{_GAP}{text.brief_choice}", palette.text)
            forms = [[label, *s, *where, *a, choice] for where in (place, []) for s, a in both]
            return [first_that_fits(forms, self.width, self._look)]
        reasons = [
            [self._label(""), Piece(choice, palette.text), *action]
            for choice in (text.choice, text.brief_choice)
            for action in actions
        ]
        return [
            first_that_fits([[label, *state, *place] for state in states], self.width, self._look),
            first_that_fits(reasons, self.width, self._look),
        ]

    def _environment(self, rows: int) -> list[Line]:
        text, palette = self.text, self._palette
        label, words = self._label("environment"), outcome_words(text)
        happened = Piece(f"{words} (p {text.chance})", palette.text)
        results = [
            [
                self._symbol(reward),
                Piece(text.reward, palette.strong),
                self._symbol(f"{_GAP}{landing}"),
                Piece(text.next_state, palette.strong),
            ]
            for reward, landing in (("reward r = ", "next state s′ = "), ("r = ", "s′ = "))
        ]
        if rows == 1:
            gap = Piece(_GAP, palette.text)
            starts = [[label, happened, gap], [label, Piece(words, palette.text), gap], [label]]
        else:
            starts = [[self._label("")]]
        forms = [
            [*start, *result, *remark]
            for start in starts
            for remark in self._remarks(_COLON)
            for result in results
        ]
        line = first_that_fits(forms, self.width, self._look)
        return [line] if rows == 1 else [[label, happened], line]

    def _remarks(self, before: str) -> list[list[Piece]]:
        """Return what is to be said of the next state, longest form first; one empty form if nothing is."""
        texts = [
            ", ".join(filter(None, (self.text.landmark, ending))) for ending in self.text.endings or ("",)
        ]
        return [[Piece(before + text, self._palette.accent)] if text else [] for text in texts]

    def _target(self, rows: int, *, with_delta: bool = False) -> list[Line]:
        text, update, plain = self.text, self.text.update, self._palette.text
        label, target = self._label("update"), self._symbol("target = ")
        deltas = [self._delta_pieces(_GAP), self._brief_delta(_GAP)] if with_delta else [[]]
        if text.terminated:
            reward = [label, target, Piece(f"r = {update.target}", plain)]
            remark = Piece(" (terminal)", self._palette.dim)
            forms = [[*reward, *ending] for delta in deltas for ending in ([remark, *delta], delta)]
            return [first_that_fits(forms, self.width, self._look)]
        best = f"max Q({text.next_state},·)"
        worked = f"{update.reward} + {update.gamma}{self._loose}{in_brackets(update.bootstrap, self._minus)}"
        worked_out = f"{worked} = {update.target}"
        if rows == 2:
            symbols = Piece(f"r + γ{self._loose}{best}", plain)
            return [
                [label, target, symbols],
                [self._label(""), self._symbol("       = "), Piece(worked_out, plain)],
            ]
        mixed = f"{update.reward} + {update.gamma}{self._loose}{best}"
        texts = (f"{mixed} = {worked_out}", worked_out, update.target)
        forms = [[label, target, Piece(each, plain), *delta] for each in texts for delta in deltas]
        return [first_that_fits(forms, self.width, self._look)]

    def _delta_pieces(self, gap: str) -> list[Piece]:
        update = self.text.update
        before = in_brackets(update.before, self._minus)
        return [
            self._symbol(f"{gap}δ = "),
            Piece(f"{update.target} {self._minus} {before} = ", self._palette.text),
            Piece(update.error, self._error_style),
        ]

    def _brief_delta(self, gap: str) -> list[Piece]:
        return [self._symbol(f"{gap}δ = "), Piece(self.text.update.error, self._error_style)]

    def _delta(self, label: str = "") -> Line:
        forms = [[self._label(label), *delta] for delta in (self._delta_pieces(""), self._brief_delta(""))]
        return first_that_fits(forms, self.width, self._look)

    def _assignment(self) -> Line:
        update, palette = self.text.update, self._palette
        error = f"({update.error})"
        worked = f"{update.before} + {update.step_size}{self._loose}{error} = "
        equation = [
            self._symbol(f"   Q({self.text.pair}) {self._arrow} "),
            Piece(worked, palette.text),
            Piece(update.after, palette.strong),
        ]
        return self._shortened(equation)

    def _bandit(self) -> list[Line]:
        text, palette = self.text, self._palette
        return [
            [
                self._label("agent"),
                Piece("pulled ", palette.text),
                Piece(text.action, palette.strong),
                Piece(f"{_GAP}{text.choice}", palette.text),
            ],
            [
                self._label("environment"),
                self._symbol("reward r = "),
                Piece(text.reward, palette.strong),
                Piece(f"{_GAP}N = {text.visits:,}", palette.text),
            ],
            self._delta("update"),
            self._shortened(self._assignment_in_full(indent="   ")),
        ]

    def _one_line(self) -> Line:
        line = [*self._shortened(self._assignment_in_full())]
        for piece in (self._error(), *self._tail()):
            if length(spelled([*line, piece], self._look)) <= self.width:
                line.append(piece)
        return line

    def _shortened(self, equation: Line) -> Line:
        """Return ``equation``, or its result alone where the numbers would not fit."""
        return first_that_fits((equation, self._result_only()), self.width, self._look)

    def _assignment_in_full(self, indent: str = " ") -> list[Piece]:
        """Return ``Q(6,←) ← .36 + .10·(0 + .99·.56 − .36) = .38``."""
        text, update, palette = self.text, self.text.update, self._palette
        gain = update.reward
        if not text.terminated:
            gain += f" + {update.gamma}{self._times}{in_brackets(update.bootstrap, self._minus)}"
        before = in_brackets(update.before, self._minus)
        worked = f"{update.before} + {update.step_size}{self._times}({gain} {self._minus} {before}) = "
        return [
            self._symbol(f"{indent}Q({text.pair}) {self._arrow} "),
            Piece(worked, palette.text),
            Piece(update.after, palette.strong),
        ]

    def _result_only(self) -> list[Piece]:
        return [
            self._symbol(f" Q({self.text.pair}) {self._arrow} "),
            Piece(self.text.update.after, self._palette.strong),
        ]

    def _error(self) -> Piece:
        return Piece(f"  δ {self.text.update.error}", self._error_style)

    def _tail(self) -> list[Piece]:
        """Return what happened around the update, the most telling first."""
        text, palette = self.text, self._palette
        pieces = []
        if text.went:
            pieces.append(Piece(f"  meant {text.meant} went {text.went}", palette.text))
        pieces.append(Piece(f"  {text.brief_choice}", palette.text))
        if text.next_state and not text.went:
            pieces.append(Piece(f" → {text.next_state}", palette.text))
        return [*pieces, *self._remarks("  ")[-1]]

    def _summary(self) -> Line:
        text, palette = self.text, self._palette
        if text.is_bandit:
            return [Piece(f" pulled {text.action}  {text.choice}  r = {text.reward}", palette.text)]
        line = [
            Piece(" s = ", palette.dim),
            Piece(text.state, palette.strong),
            Piece("  a = ", palette.dim),
            Piece(text.action, palette.strong),
            Piece("  r = ", palette.dim),
            Piece(text.reward, palette.strong),
            Piece("  s′ = ", palette.dim),
            Piece(text.next_state, palette.strong),
        ]
        return [*line, *self._tail()]

    def _label(self, text: str) -> Piece:
        return Piece(f" {text:<{_LABEL}}" if self.width >= _ROOM_FOR_LABELS else " ", self._palette.dim)

    def _symbol(self, text: str) -> Piece:
        return Piece(text, self._palette.dim)

    @property
    def _error_style(self) -> Style:
        error = self.text.update.error
        if error.startswith("+"):
            return self._palette.good
        return self._palette.bad if error.startswith(self._minus) else self._palette.text


def in_brackets(number: str, minus: str) -> str:
    """Return ``number`` in brackets where it starts with a minus and follows an operator."""
    return f"({number})" if number.startswith(minus) else number
