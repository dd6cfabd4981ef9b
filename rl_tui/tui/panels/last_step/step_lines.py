"""The lines that tell one step of an agent, or one backup of a planner, in any room."""

from __future__ import annotations

from typing import Final

from rich.style import Style

from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, length, spelled
from rl_tui.tui.panels.last_step.loop_text import LoopText, outcome_words
from rl_tui.tui.theme.look import Look

_LABEL: Final = 13
_ROOM_FOR_LABELS: Final = 46
_GAP: Final = "   "
_COLON: Final = ": "
# Rows of agent, environment, target and δ (0: beside the target), longest form first; one more is the update
_ROWS: Final = ((2, 2, 2, 1), (2, 2, 1, 1), (1, 2, 1, 1), (1, 1, 1, 1), (1, 1, 1, 0))


class StepWriter:
    """Writes the lines of one step."""

    def __init__(self, text: LoopText, look: Look, width: int) -> None:
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
        text = self.text
        if text.is_bandit and not text.sweep:
            return self._bandit()
        form: list[Line] = []
        for agent, environment, target, delta in _ROWS:
            form = [
                *([self._sweep()] if text.sweep else self._agent(agent)),
                *([] if text.sweep else self._environment(environment)),
                *self._update(target, delta),
            ]
            if len(form) <= height:
                break
        if text.planning and len(form) < height:
            form[1:1] = [self._progress()]
        return self._with_others(form, height)

    def short(self, height: int) -> list[Line]:
        """Return one to three lines: the update, and above it what led to it."""
        if height == 1:
            return [self._one_line()]
        summary = self._sweep() if self.text.sweep else self._summary()
        if not self.text.estimate:
            return [summary, self._waiting(" ")]
        lines: list[Line] = [summary, self._shortened(self._assignment_in_full())]
        return self._with_others(lines if height == 2 else [*lines, self._delta()], height)

    def _update(self, target: int, delta: int) -> list[Line]:
        """Return target, δ in ``delta`` rows (0: beside the target) and the new estimate."""
        if not self.text.estimate:
            return [self._waiting()]
        return [
            *self._target(target, with_delta=delta == 0),
            *([self._delta()] if delta else []),
            self._assignment(),
        ]

    def _with_others(self, lines: list[Line], height: int) -> list[Line]:
        """Return ``lines`` that also tell of further updates: behind the last line, or below it."""
        others = self.text.others
        if not others:
            return lines
        forms = [[*lines[-1], Piece(f"   {each}", self._palette.dim)] for each in others]
        best = first_that_fits(forms, self.width, self._look)
        if length(spelled(best, self._look)) <= self.width and (best is forms[0] or len(lines) >= height):
            return [*lines[:-1], best]
        return [*lines, [Piece(f"   {others[0]}", self._palette.dim)]] if len(lines) < height else lines

    def _waiting(self, label: str = "") -> Line:
        text = Piece(self.text.waiting, self._palette.text)
        return [Piece(" ", self._palette.dim), text] if label else [self._label("update"), text]

    def _sweep(self) -> Line:
        """Return which state a planner backed up."""
        text, palette = self.text, self._palette
        start = [self._label("planner"), Piece(f"sweep {text.sweep:,}", palette.text)]
        state = Piece(text.state, palette.strong)
        place = [Piece(f"{_GAP}{text.place}", palette.dim)] if text.place else []
        words = [[self._symbol(each), state] for each in (f"{_GAP}backs up state s = ", f"{_GAP}s = ")]
        forms = [[*start, *each, *where] for where in (place, []) for each in words]
        return first_that_fits(forms, self.width, self._look)

    def _progress(self) -> Line:
        """Return how the sweep is getting on, in full or its first part."""
        words = (self.text.planning, self.text.planning.split(":")[0])
        forms = [[self._label(""), Piece(each, self._palette.text)] for each in words]
        return first_that_fits(forms, self.width, self._look)

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
        happened = Piece(f"{words} (p {text.chance})" if text.chance else words, palette.text)
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
        if not text.bootstrap:
            reward = [label, target, Piece(f"{text.gathered} = {update.target}", plain)]
            remark = [Piece(" (terminal)", self._palette.dim)] if text.terminated else []
            forms = [[*reward, *ending] for delta in deltas for ending in ([*remark, *delta], delta)]
            return [first_that_fits(forms, self.width, self._look)]
        best = text.bootstrap
        bootstrap = in_brackets(update.bootstrap, self._minus)
        worked = f"{update.gathered} + {update.discount}{self._loose}{bootstrap}"
        worked_out = f"{worked} = {update.target}"
        if rows == 2:
            symbols = Piece(f"{text.gathered} + {text.discount}{self._loose}{best}", plain)
            return [
                [label, target, symbols],
                [self._label(""), self._symbol("       = "), Piece(worked_out, plain)],
            ]
        mixed = f"{update.gathered} + {update.discount}{self._loose}{best}"
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
        worked = "" if self.text.sweep else f"{update.before} + {update.step_size}{self._loose}{error} = "
        equation = [
            self._symbol(f"   {self.text.estimate} {self._arrow} "),
            Piece(worked, palette.text),
            Piece(update.after, palette.strong),
        ]
        return self._shortened(equation)

    def _bandit(self) -> list[Line]:
        text, palette = self.text, self._palette
        update = (
            [self._delta("update"), self._shortened(self._assignment_in_full(indent="   "))]
            if text.estimate
            else [self._waiting()]
        )
        pulled = [self._label("agent"), Piece("pulled ", palette.text), Piece(text.action, palette.strong)]
        agents = [
            [*pulled, Piece(f"{_GAP}{choice}", palette.text)] for choice in (text.choice, text.brief_choice)
        ]
        return [
            first_that_fits(agents, self.width, self._look),
            [
                self._label("environment"),
                self._symbol("reward r = "),
                Piece(text.reward, palette.strong),
                Piece(f"{_GAP}N = {text.visits:,}", palette.text),
            ],
            *update,
        ]

    def _one_line(self) -> Line:
        line = [*(self._shortened(self._assignment_in_full()) if self.text.estimate else self._waiting(" "))]
        for piece in ([self._error()] if self.text.estimate else []) + self._tail():
            if length(spelled([*line, piece], self._look)) <= self.width:
                line.append(piece)
        return line

    def _shortened(self, equation: Line) -> Line:
        """Return ``equation``, or its result alone where the numbers would not fit."""
        return first_that_fits((equation, self._result_only()), self.width, self._look)

    def _assignment_in_full(self, indent: str = " ") -> list[Piece]:
        """Return ``Q(6,←) ← .36 + .10·(0 + .99·.56 − .36) = .38``."""
        text, update, palette = self.text, self.text.update, self._palette
        gain = update.gathered
        if text.bootstrap:
            gain += f" + {update.discount}{self._times}{in_brackets(update.bootstrap, self._minus)}"
        before = in_brackets(update.before, self._minus)
        worked = f"{update.before} + {update.step_size}{self._times}({gain} {self._minus} {before}) = "
        if text.sweep:
            worked = f"{gain} = "
        return [
            self._symbol(f"{indent}{text.estimate} {self._arrow} "),
            Piece(worked, palette.text),
            Piece(update.after, palette.strong),
        ]

    def _result_only(self) -> list[Piece]:
        return [
            self._symbol(f" {self.text.estimate} {self._arrow} "),
            Piece(self.text.update.after, self._palette.strong),
        ]

    def _error(self) -> Piece:
        return Piece(f"  δ {self.text.update.error}", self._error_style)

    def _tail(self) -> list[Piece]:
        """Return what happened around the update, the most telling first."""
        text, palette = self.text, self._palette
        if text.sweep:
            return [*self._others_in_short(), Piece(f"  sweep {text.sweep:,}", palette.text)]
        pieces = []
        if text.went:
            pieces.append(Piece(f"  meant {text.meant} went {text.went}", palette.text))
        pieces += [Piece(f"  {text.brief_choice}", palette.text), *self._others_in_short()]
        if text.next_state and not text.went:
            pieces.append(Piece(f" → {text.next_state}", palette.text))
        return [*pieces, *self._remarks("  ")[-1]]

    def _others_in_short(self) -> list[Piece]:
        return [Piece(f"  {self.text.others[-1]}", self._palette.dim)] if self.text.others else []

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
