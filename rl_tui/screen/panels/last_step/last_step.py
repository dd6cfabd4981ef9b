"""The last step: the agent's choice, the answer of the environment, and the update in numbers.

A planner takes no steps: its last backup is shown instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from textual.strip import Strip

from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, first_that_fits, length, spelled, strips_of
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.panel import Legend, LegendSign, Panel
from rl_tui.screen.kit.snapshot_facts import keeps_back, passes_too_fast
from rl_tui.screen.panels.last_step.state_backup_text import ActionText, BackupText
from rl_tui.screen.panels.last_step.update_text import subtracts
from rl_tui.screen.panels.last_step.words import StepWords, equation, error_piece, in_brackets, words_of
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms

# The lines of a step


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
        self._dim = partial(Piece, style=look.palette.dim)
        self._plain = partial(Piece, style=look.palette.text)
        self._strong = partial(Piece, style=look.palette.strong)
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
        return [[Piece(before + text, self._look.palette.strong)] if text else [] for text in texts]

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

    def _fitting(self, forms: Iterable[Line]) -> Line:
        return first_that_fits(forms, self.width, self._look)

    def _fits(self, line: Sequence[Piece]) -> bool:
        return length(spelled(line, self._look)) <= self.width


# The panel


NOTHING_YET: Final = "no step yet: s takes one"
ENDED: Final = "ended its episode"
ENDED_SWEEP: Final = "ended its sweep"
NOT_REPLAYED_YET: Final = "the last step is told once it is replayed"
OF_ANOTHER_WORLD: Final = "no step yet in this world: s takes one"
NOT_OF_THE_TABLE: Final = "this step is none that the world's table has"
_USUAL_ROWS: Final = 8  # of the longest form
_ROOM_ON_BORDER: Final = 76
_LEAST_ROWS: Final = 4  # below this the loop has no lines of its own


class LastStepPanel(Panel):
    """The loop in five parts (state, action, reward, next state, update); in one row the update alone.

    It is drawn from the last step of the snapshot only, so that all its numbers belong together.
    """

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the picture of the last step of ``snapshot``."""
        self.heading = self.fitting((*self.captioned("Last step"), "Last step"), width)
        self.footing = _which(snapshot)
        lines = last_step_lines(snapshot, self.look, width, height)
        self.free_rows = height - max(len(lines), _USUAL_ROWS)
        return strips_of(lines, width, height, self.look)

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the signs of an update and of what the environment did."""
        palette, is_bandit = self.look.palette, isinstance(snapshot.world.drawing, Arms)
        delta, plans = to_ascii("δ", self.look.glyphs), snapshot.agent.row.planner
        tells_chances = snapshot.world.mdp is not None and not (
            is_bandit or plans or keeps_back(snapshot, "model")
        )
        story = story_of(snapshot)
        if story is not None and story.state_backup is not None:
            chance = LegendSign("p", "probability", palette.strong)
            keeps = snapshot.agent.row.takes_orders
            policy = LegendSign(to_ascii("π", self.look.glyphs), "policy", palette.strong)
            return (policy, chance) if keeps else (chance,)
        has_delta = story is None or story.has_equation
        # beside the numbers on the border it would come and go with their digits
        has_room = self.free_rows > 0 or self.size.width >= _ROOM_ON_BORDER
        return (
            *([LegendSign(delta, "TD error", palette.strong)] if has_delta else []),
            *([LegendSign("p", "probability", palette.strong)] if tells_chances and has_room else []),
        )


def _which(snapshot: Snapshot | None) -> str:
    """Return which step it was; nothing while they pass too fast to tell, since a title redraws the panel.

    One number of an episode is on screen at a time, that on the top line: where the next one begins, the one
    that ended is not numbered any more.
    """
    story = None if snapshot is None or passes_too_fast(snapshot) else story_of(snapshot)
    if story is None:
        return ""
    last, ended = story.last, story.ends_episode
    if last.planned:
        return f"step {last.step:,} · {ENDED_SWEEP if ended else f'sweep {last.episode:,}'}"
    if story.is_bandit:
        return f"pull {last.step:,}"
    return f"step {last.step:,} · {ENDED if ended else f'episode {last.episode:,}'}"


def nothing_yet(snapshot: Snapshot | None) -> str:
    """Return why there is no last step to tell of."""
    if snapshot is not None and snapshot.program is not None and snapshot.counters.step:
        return NOT_OF_THE_TABLE
    if snapshot is None or snapshot.counters.step == 0:
        return NOTHING_YET
    changes = snapshot.world_changes
    return OF_ANOTHER_WORLD if changes and changes[-1].step == snapshot.counters.step else NOT_REPLAYED_YET


def last_step_lines(snapshot: Snapshot | None, look: Look, width: int, height: int) -> list[Line]:
    """Return what the panel says in ``height`` rows of ``width`` cells, at most so many lines."""
    story = None if snapshot is None else story_of(snapshot)
    if snapshot is None or story is None:
        return [[Piece(" ", look.palette.text), Piece(nothing_yet(snapshot), look.palette.dim)]]
    if keeps_back(snapshot, "model"):
        story = replace(story, chance=None)
    writer = StepWriter(words_of(story, look.glyphs), look, width)
    return (writer.tall(height) if height >= _LEAST_ROWS else writer.short(height))[:height]
