"""The lines that tell one step of an agent, or one backup of a planner, in any room."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, length, spelled
from rl_tui.tui.panels.last_step.equation import equation, error_piece, in_brackets
from rl_tui.tui.panels.last_step.state_backup_text import ActionText, BackupText
from rl_tui.tui.panels.last_step.update_text import subtracts
from rl_tui.tui.panels.last_step.words import StepWords
from rl_tui.tui.theme.look import Look

_LABEL: Final = 13
_ROOM_FOR_LABELS: Final = 46
_GAP: Final = "   "
_COLON: Final = ": "
# Rows of agent, environment, target and δ (0: beside the target), longest form first; one more is the update
_ROWS: Final = ((2, 2, 2, 1), (2, 2, 1, 1), (1, 2, 1, 1), (1, 1, 1, 1), (1, 1, 1, 0))


class StepWriter:
    """Writes the lines of one step."""

    def __init__(self, words: StepWords, look: Look, width: int) -> None:
        self.words = words
        self.width = width
        self._story = words.story
        self._last = words.story.last
        self._look = look
        self._minus = look.glyphs.minus
        self._times = f" {look.glyphs.times} "

    def tall(self, height: int) -> list[Line]:
        """Return the loop part by part, in the longest form that ``height`` rows (at least 4) hold."""
        if self._story.is_bandit and not self._last.planned:
            return self._bandit()
        if self.words.backup is not None:
            return self._state_backup(self.words.backup, height)
        form: list[Line] = []
        for agent, environment, target, delta in _ROWS:
            form = [
                *([self._sweep()] if self._last.planned else self._agent(agent)),
                *([] if self._last.planned else self._environment(environment)),
                *self._update(target, delta),
            ]
            if len(form) <= height:
                break
        if self._story.planning and len(form) < height:
            form[1:1] = [self._progress()]
        return self._with_others(form, height)

    def short(self, height: int) -> list[Line]:
        """Return one to three lines: the update, and above it what led to it."""
        if self.words.backup is not None:
            line = self._bellman(self.words.backup, "", self._kind_of_sweep(self.words.backup))
            return [line] if height == 1 else [self._sweep(), line]
        if height == 1:
            return [self._one_line()]
        summary = self._sweep() if self._last.planned else self._summary()
        if not self.words.estimate:
            return [summary, [self._dim(" "), self._waiting()]]
        if not self._story.has_equation:
            return [summary, self._change(self._dim(" ")), self._why_no_equation(self._dim(" "))][:height]
        lines = [summary, self._equation()]
        return self._with_others(lines if height == 2 else [*lines, self._delta()], height)

    def _update(self, target: int, delta: int) -> list[Line]:
        """Return target, δ in ``delta`` rows (0: beside the target) and the new estimate."""
        if not self.words.estimate:
            return [[self._label("update"), self._waiting()]]
        if not self._story.has_equation:
            return [self._change(self._label("update")), self._why_no_equation(self._label(""))]
        return [
            *self._target(target, with_delta=delta == 0),
            *([self._delta()] if delta else []),
            self._assignment(),
        ]

    def _with_others(self, lines: list[Line], height: int) -> list[Line]:
        """Return ``lines`` that also tell of further updates: behind the last line, or below it."""
        others = self.words.others
        if not others:
            return lines
        forms = [[*lines[-1], self._dim(f"{_GAP}{each}")] for each in others]
        best = self._fitting(forms)
        if self._fits(best) and (best is forms[0] or len(lines) >= height):
            return [*lines[:-1], best]
        return [*lines, [self._dim(f"{_GAP}{others[0]}")]] if len(lines) < height else lines

    def _change(self, start: Piece) -> Line:
        """Return what moved and by how much, where nothing else is known of the update."""
        update, to = self.words.update, "to" if self.width >= _ROOM_FOR_LABELS else "→"
        if self.words.changes_nothing:
            stays = [self._strong(self.words.estimate), self._plain(" stays "), self._strong(update.after)]
            return self._fitting(
                [[start, self._dim("your program changed nothing: "), *stays], [start, *stays]]
            )
        moved = [
            self._strong(self.words.estimate),
            self._plain(f" from {update.before} {to} "),
            self._strong(update.after),
            *([self._plain(" ("), error_piece(self.words, self._look), self._plain(")")]),
        ]
        whole = self._dim("your program moved ")
        return self._fitting([[start, whole, *moved], [start, *moved], [start, *moved[:3]]])

    def _why_no_equation(self, start: Piece) -> Line:
        return self._fitting([start, self._dim(each)] for each in self.words.why_no_equation)

    def _sweep(self) -> Line:
        """Return which state a planner backed up."""
        start = [self._label("planner"), self._plain(self._which_sweep)]
        state = self._strong(self.words.state)
        symbols = (f"{_GAP}backs up state s = ", f"{_GAP}s = ")
        forms = [[*start, self._dim(each), state, *place] for place in self._places() for each in symbols]
        return self._fitting(forms)

    @property
    def _which_sweep(self) -> str:
        return "end of a sweep" if self._story.ends_episode else f"sweep {self._last.episode:,}"

    def _progress(self) -> Line:
        """Return how the sweep is getting on, in full or its first part."""
        planning = self._story.planning
        if planning.startswith("sweep "):  # which one it is stands above
            planning = planning.partition(": ")[2]
        return self._fitting(
            [self._label(""), self._plain(each)] for each in (planning, planning.split(":")[0])
        )

    def _state_backup(self, backup: BackupText, height: int) -> list[Line]:
        """Return the Bellman equation in symbols, for each action where there is room, and in numbers."""
        law = self._fitting(
            [each, self._plain(backup.law)] for each in (self._label(backup.kind), self._dim(" "))
        )
        lines = [self._sweep(), *([law] if self._fits(law) else []), self._bellman(backup, _GAP)]
        signs = max(len(each.sign) for each in backup.actions)
        if len(lines) + len(backup.actions) <= height and all(each.worked_out for each in backup.actions):
            lines[-1:-1] = [self._action_backup(each, signs) for each in backup.actions]
        if self._story.planning and len(lines) < height:
            lines.insert(1, self._progress())
        return lines

    def _action_backup(self, action: ActionText, signs: int) -> Line:
        """Return ``→  0 + .99·.34 = .34``, dim where it makes no part of the result."""
        write = self._plain if action.counts else self._dim
        result = self._strong(action.q) if action.counts else self._dim(action.q)
        sign = f"{action.sign:<{signs}}  "
        worked_out = write(f"{sign}{action.worked_out} = ")
        return self._fitting([self._label(""), each, result] for each in (worked_out, write(sign)))

    def _bellman(self, backup: BackupText, indent: str, tail: Sequence[str] = ()) -> Line:
        """Return ``V(6) ← max{↑0 →.06 ↓.34 ←.06} = .34``, behind it as much of ``tail`` as fits."""
        start = self._dim(f"{indent} {backup.left} {self._look.glyphs.arrow_update} ")
        rights = [f"{each} = " for each in backup.right]
        result = self._strong(backup.result)
        forms: list[Line] = [[start, self._plain(each), result] for each in (*rights, "")]
        forms.append([self._dim(" "), result])
        line = list(self._fitting(forms))
        for each in tail:
            if self._fits([*line, self._plain(f"  {each}")]):
                line.append(self._plain(f"  {each}"))
        return line

    def _kind_of_sweep(self, backup: BackupText) -> Sequence[str]:
        return backup.kind, self._which_sweep

    def _places(self) -> list[list[Piece]]:
        """Return where the state is on a grid, if it is on one, or nothing."""
        return [[self._dim(f"{_GAP}{self.words.place}")] if self.words.place else [], []]

    def _agent(self, rows: int) -> list[Line]:
        words, label = self.words, self._label("agent")
        states = [[self._dim(each), self._strong(words.state)] for each in ("state s = ", "s = ")]
        actions = [
            [self._dim(f"{_GAP}{each}"), self._strong(words.action)] for each in ("action a = ", "a = ")
        ]
        if rows == 1:
            choice = self._plain(f"{_GAP}{words.choices[-1]}")
            both = list(zip(states, actions, strict=True))
            forms = [[label, *s, *place, *a, choice] for place in self._places() for s, a in both]
            return [self._fitting(forms)]
        return [
            self._fitting([label, *state, *self._places()[0]] for state in states),
            self._fitting(
                [self._label(""), self._plain(each), *action] for each in words.choices for action in actions
            ),
        ]

    def _environment(self, rows: int) -> list[Line]:
        words, label = self.words, self._label("environment")
        outcome = self._plain(words.outcome)
        happened = self._plain(f"{words.outcome} (p {words.chance})") if words.chance else outcome
        results = [
            [
                self._dim(reward),
                self._strong(words.reward),
                self._dim(f"{_GAP}{landing}"),
                self._strong(words.next_state),
            ]
            for reward, landing in (("reward r = ", "next state s′ = "), ("r = ", "s′ = "))
        ]
        gap = self._plain(_GAP)
        starts = (
            [[label, happened, gap], [label, outcome, gap], [label]] if rows == 1 else [[self._label("")]]
        )
        line = self._fitting(
            [*start, *result, *remark]
            for start in starts
            for remark in self._remarks(_COLON)
            for result in results
        )
        return [line] if rows == 1 else [[label, happened], line]

    def _remarks(self, before: str) -> list[list[Piece]]:
        """Return what is to be said of the next state, longest form first; one empty form if nothing is."""
        texts = [
            ", ".join(filter(None, (self.words.landmark, ending))) for ending in self.words.endings or ("",)
        ]
        return [[Piece(before + text, self._look.palette.accent)] if text else [] for text in texts]

    def _target(self, rows: int, *, with_delta: bool) -> list[Line]:
        words, update, terms = self.words, self.words.update, self._story.terms
        start = [self._label("update"), self._dim("target = ")]
        deltas = self._deltas(_GAP) if with_delta else [[]]
        if not words.bootstrap:
            reward = [*start, self._plain(f"{terms.gathered} = {update.target}")]
            remark = [self._dim(" (terminal)")] if self._last.terminated else []
            return [self._fitting([*reward, *end] for delta in deltas for end in ([*remark, *delta], delta))]
        bootstrap = in_brackets(update.bootstrap, self._look)
        worked_out = f"{update.gathered} + {update.discount}{self._times}{bootstrap} = {update.target}"
        if rows == 2:
            symbols = f"{terms.gathered} + {terms.discount}{self._times}{words.bootstrap}"
            return [
                [*start, self._plain(symbols)],
                [self._label(""), self._dim("       = "), self._plain(worked_out)],
            ]
        mixed = f"{update.gathered} + {update.discount}{self._times}{words.bootstrap}"
        texts = (f"{mixed} = {worked_out}", worked_out, update.target)
        return [self._fitting([*start, self._plain(each), *delta] for each in texts for delta in deltas)]

    def _deltas(self, gap: str = "") -> list[list[Piece]]:
        """Return δ as a difference, and δ alone."""
        symbol, error = self._dim(f"{gap}δ = "), error_piece(self.words, self._look)
        before = in_brackets(self.words.update.before, self._look)
        equals = "=" if subtracts(self.words.update, self._look.glyphs) else "≈"
        difference = self._plain(f"{self.words.update.target} {self._minus} {before} {equals} ")
        return [[symbol, difference, error], [symbol, error]]

    def _delta(self, label: str = "") -> Line:
        return self._fitting([self._label(label), *delta] for delta in self._deltas())

    def _assignment(self) -> Line:
        update = self.words.update
        if self._last.td_error == 0.0 and not self._last.planned:
            return self._nothing_learned()
        worked = f"{update.before} + {update.step_size}{self._times}({update.error}) = "
        return self._or_result(
            [
                self._dim(f"{_GAP}{self.words.estimate} {self._look.glyphs.arrow_update} "),
                self._plain("" if self._last.planned else worked),
                self._strong(update.after),
            ]
        )

    def _nothing_learned(self) -> Line:
        """Return that the estimate stays: a product with 0 would only ask to be worked out."""
        stays = [
            self._dim(f"{_GAP}{self.words.estimate} stays "),
            self._strong(self.words.update.after),
        ]
        remarks = (": nothing to learn, the target is the estimate", ": nothing to learn")
        return self._fitting([*([*stays, self._plain(each)] for each in remarks), stays])

    def _bandit(self) -> list[Line]:
        words = self.words
        update: list[Line] = [[self._label("update"), self._waiting()]]
        if words.estimate:
            update = [self._delta("update"), self._equation(indent="  ")]
        pulled = [self._label("agent"), self._plain("pulled "), self._strong(words.action)]
        return [
            self._fitting([*pulled, self._plain(f"{_GAP}{choice}")] for choice in words.choices),
            [
                self._label("environment"),
                self._dim("reward r = "),
                self._strong(words.reward),
                self._plain(f"{_GAP}N = {self._story.visits:,}"),
            ],
            *update,
        ]

    def _one_line(self) -> Line:
        line, tail = [self._dim(" "), self._waiting()], self._tail()
        if self.words.estimate and not self._story.has_equation:
            why = [self._dim(f"  {each}") for each in self.words.why_no_equation[-1:]]
            line, tail = [*self._change(self._dim(" "))], [*why, *tail]
        elif self.words.estimate:
            error = error_piece(self.words, self._look)
            line, tail = [*self._equation()], [Piece(f"  δ {error.text}", error.style), *tail]
        least = len(line)
        for piece in tail:
            if self._fits([*line, piece]):
                line.append(piece)
        return self._with_ellipsis(line, least) if len(line) < least + len(tail) else line

    def _with_ellipsis(self, line: Line, least: int) -> Line:
        """Return ``line`` with a sign that there is more, for which its last parts but ``least`` may go."""
        for end in range(len(line), least - 1, -1):
            ends_in_word = line[end - 1].text[-1:].isalpha()  # behind a number it would be one more digit
            for gap in (" ", "") if ends_in_word else (" ",):
                form = [*line[:end], self._dim(gap + self._look.glyphs.ellipsis)]
                if self._fits(form):
                    return form
        return line

    def _equation(self, indent: str = "") -> Line:
        """Return ``Q(6,←) ← .36 + .10·(0 + .99·.56 − .36) = .38``."""
        plain, strong = self._look.palette.text, self._look.palette.strong
        groups = equation(self.words, self._look, plain, plain, strong)
        return self._or_result([self._dim(indent), *(piece for group in groups for piece in group)])

    def _or_result(self, line: Line) -> Line:
        """Return ``line``, or the new estimate alone where the numbers would not fit."""
        symbol = self._dim(f" {self.words.estimate} {self._look.glyphs.arrow_update} ")
        return self._fitting((line, [symbol, self._strong(self.words.update.after)]))

    def _tail(self) -> list[Piece]:
        """Return what happened around the update, the most telling first."""
        words = self.words
        others = [self._dim(f"  {words.others[-1]}")] if words.others else []
        if self._last.planned:
            return [*others, self._plain(f"  {self._which_sweep}")]
        choice = self._plain(f"  {words.choices[-1]}")
        remarks = self._remarks("  ")[-1]
        wind = [self._plain(f"  {words.wind}")] if words.wind else []
        if words.went:
            return [self._plain(f"  meant {words.meant} went {words.went}"), *wind, choice, *others, *remarks]
        landing = [self._plain(f" → {words.next_state}")] if words.next_state else []
        return [*wind, choice, *others, *landing, *remarks]

    def _summary(self) -> Line:
        words = self.words
        if self._story.is_bandit:
            return [self._plain(f" pulled {words.action}  {words.choices[0]}  r = {words.reward}")]
        parts = {
            " s = ": words.state,
            "  a = ": words.action,
            "  r = ": words.reward,
            "  s′ = ": words.next_state,
        }
        line = [piece for each, value in parts.items() for piece in (self._dim(each), self._strong(value))]
        return [*line, *self._tail()]

    def _waiting(self) -> Piece:
        return self._plain(self._story.terms.waiting)

    def _label(self, text: str) -> Piece:
        return self._dim(f" {text:<{_LABEL}}" if self.width >= _ROOM_FOR_LABELS else " ")

    def _dim(self, text: str) -> Piece:
        return Piece(text, self._look.palette.dim)

    def _plain(self, text: str) -> Piece:
        return Piece(text, self._look.palette.text)

    def _strong(self, text: str) -> Piece:
        return Piece(text, self._look.palette.strong)

    def _fitting(self, forms: Iterable[Line]) -> Line:
        return first_that_fits(forms, self.width, self._look)

    def _fits(self, line: Sequence[Piece]) -> bool:
        return length(spelled(line, self._look)) <= self.width
