"""Exact returns of policies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache, partial
from itertools import product
from typing import ClassVar, Final, NamedTuple

import numpy as np
from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PENDING, TOO_MANY, WHILE_RUNNING, PolicyAnswer
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece, strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Column, Columns, Table, Text, laid
from rl_tui.screen.kit.charts import Bar, axis_of
from rl_tui.screen.kit.panel import MAY_NEVER_END, Panel, key_hints
from rl_tui.screen.kit.snapshot_facts import is_kept_back, shown_by, studied_answer
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.policies.studied import POLICY_NAMES, policy_ink
from rl_tui.screen.theme.look import Look

# The table


class PolicyColumn(NamedTuple):
    """A number of every policy."""

    id: str
    head: str
    has_sign: bool = False


RETURN: Final = PolicyColumn("expected_return", "return", has_sign=True)
REWARD: Final = PolicyColumn("expected_return", "a pull", has_sign=True)  # of a bandit
VALUE: Final = PolicyColumn("value_at_start", "at start", has_sign=True)
STEPS: Final = PolicyColumn("steps", "length")
ENDS: Final = PolicyColumn("ends", "ending")
FIGURES: Final = (RETURN, REWARD, VALUE, STEPS, ENDS)


def _policy_tables(snapshot: Snapshot, look: Look) -> Iterator[Table]:
    known = _known_answers(snapshot)
    figures = _figures(snapshot, known)
    found = [getattr(each, figure.id) for each in known for figure in figures if figure is not ENDS]
    needed = max((len(amount(each, look)) for each in found if each is not None), default=0)
    names = [
        Piece(f"{look.glyphs.cursor}{name}", look.palette.focus)
        if kind is snapshot.answers.studied
        else Piece(f" {name}", policy_ink(kind, look.palette))
        for kind, name in POLICY_NAMES.items()
    ]
    named = Column("", names, look.palette.text, right=False, gap=0)
    column = cache(partial(_column, snapshot, look, 1 if len(figures) > _MOST_APART else 2))
    most = min(WIDEST, max(WIDEST - 2, needed))
    # numbers are shortened before the last columns are dropped
    forms: list[Columns] = [
        (named, *(column(each, cells) for each in figures if each in _first(figures, left)))
        for left, cells in product(range(len(figures), 0, -1), range(most, WIDEST - 3, -1))
    ]
    forms.append((named, column(figures[0], WIDEST - 2)))
    gap = dict.fromkeys(range(len(names) - 1), (BLANK,))
    bars = _bars(snapshot, look)
    yield Table(forms, margin=1, charts=bars, below=gap)
    yield Table(forms, margin=1, charts=bars)
    yield Table(forms, margin=1)


def _bars(snapshot: Snapshot, look: Look) -> dict[int, Bar]:
    returns = {
        kind: None if is_kept_back(snapshot, kind) else answer_of(snapshot, kind).expected_return
        for kind in POLICY_NAMES
    }
    axis = axis_of(each for each in returns.values() if each is not None)
    return {
        place: Bar(each, axis, policy_ink(kind, look.palette))
        for place, (kind, each) in enumerate(returns.items())
        if each is not None
    }


def _figures(snapshot: Snapshot, known: Sequence[PolicyAnswer]) -> list[PolicyColumn]:
    if snapshot.world.is_bandit:
        return [REWARD]
    return [RETURN, VALUE, STEPS, *([ENDS] if _may_not_end(known) else [])]


def _first(figures: Sequence[PolicyColumn], count: int) -> Sequence[PolicyColumn]:
    return sorted(figures, key=(RETURN, REWARD, VALUE, ENDS, STEPS).index)[:count]


def _column(snapshot: Snapshot, look: Look, gap: int, figure: PolicyColumn, cells: int) -> Column:
    width = max(cells - (not figure.has_sign), len(figure.head))
    texts = [_said(snapshot, kind, figure, width, look) for kind in POLICY_NAMES]
    style = look.palette.strong if figure.id == RETURN.id else look.palette.text
    return Column(figure.head, texts, style, gap=gap, width=width)


def _said(snapshot: Snapshot, kind: PolicyKind, figure: PolicyColumn, cells: int, look: Look) -> str:
    if is_kept_back(snapshot, kind):
        return "?"
    answer = answer_of(snapshot, kind)
    if not answer.is_known and not answer.refused:
        return look.glyphs.ellipsis
    x: float | None = getattr(answer, figure.id)
    if x is None:
        return numbers.missing(look.glyphs)
    return numbers.percent(x) if figure is ENDS else amount(x, look, cells)


# The panel


TITLE: Final = "Policies"
WAITING: Final = "computing in the background …"
_CHOOSE: Final = "screen.do('policies.choose({})')"


class Policies(Panel, can_focus=True):
    """One row per policy. The world shows the one under the cursor."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", _CHOOSE.format(-1), "policies.up", "The policy above"),
        binding("down", _CHOOSE.format(1), "policies.down", "The policy below"),
        binding("home", _CHOOSE.format(-9), "policies.first", "The first policy"),
        binding("end", _CHOOSE.format(9), "policies.last", "The last policy"),
        binding("enter", "screen.do('policies.keep')", "policies.keep", "Keep it on screen"),
    ]
    _places: Sequence[int] = ()  # the picture row of each policy

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw answer, table and notes."""
        self.heading = self.fitting(self._headings(snapshot), width)
        self._places = ()
        palette = self.look.palette
        if snapshot is None or snapshot.answers.studied is None or snapshot.world.mdp is None:
            self.footing = "esc: close"
            is_known = snapshot is not None and snapshot.world.mdp is None
            why = Text(f"no exact returns: {NO_TABLE}" if is_known else WAITING, palette.dim)
            lines = why.lines(width, self.look)
            self.free_rows = height - len(lines)
            return strips_of(lines, width, height, self.look)
        self.footing = self.fitting(self._hints(snapshot), width)
        lines, self._places, self.free_rows = laid(
            _policy_tables(snapshot, self.look),
            list(POLICY_NAMES).index(snapshot.answers.studied),
            [Text(gap, palette.strong, rest="   ") for gap in gaps(snapshot, self.look)],
            [Text(note, palette.dim, rest="   ") for note in notes(snapshot, self.look)],
            (width, height),
            self.look,
        )
        return strips_of(lines, width, height, self.look)

    def _hints(self, snapshot: Snapshot) -> Iterator[str]:
        if not self.has_focus:
            return key_hints(("click or tab here to choose", "tab here to choose"), ("esc: close",))
        # arms always show their bars, so there is no V to return to
        leave = "esc: close" if snapshot.world.is_bandit else "esc: back to V"
        return key_hints(
            ("↑ ↓: which", "↑ ↓"),
            ("enter: keep it in view", "enter: keep"),
            (leave, leave.removesuffix(" to V")),
        )

    def _headings(self, snapshot: Snapshot | None) -> tuple[str, ...]:
        plain = (*self.captioned(TITLE), TITLE)
        if snapshot is None or not snapshot.run_group.lanes:
            return plain
        group = snapshot.run_group
        run = f"{self.look.glyphs.cursor}{group.shown + 1}"
        named = (f"{run} {group.lanes[group.shown].name} · {each}" for each in plain)
        return *named, f"{run} · {TITLE}", run

    def on_click(self, event: events.Click) -> None:
        """Choose the clicked policy."""
        offset = event.get_content_offset(self)
        if offset is not None and offset.y in self._places:
            kind = list(POLICY_NAMES)[list(self._places).index(offset.y)]
            self.call_later(self.run_action, f"screen.do('policies.study(\"{kind}\")')")


# The notes below the table


OF_MEANS_NOW: Final = "of the current means"
NEVER_FROM_THERE: Final = f"no colour: it {MAY_NEVER_END} from there"
WITHOUT_LIMIT: Final = "no time limit"
AS_MUCH_AS_OPTIMAL: Final = "greedy earns as much as optimal"
THAN_OPTIMAL: Final = "than optimal"
_NO_ENDING: Final = 0.9995  # probabilities from here on are written as 100 %
_MOST_APART: Final = 3  # columns with two blanks between them
WIDEST: Final = 8  # cells of the widest number


def notes(snapshot: Snapshot, look: Look) -> Iterator[str]:
    """Yield the notes, most important first."""
    is_bandit = snapshot.world.is_bandit
    if is_bandit and is_kept_back(snapshot, PolicyKind.UNIFORM):
        yield f"hidden, since returns reveal the arms: {shown_by(snapshot, 'them')}"
        return
    studied = studied_answer(snapshot)
    if studied is not None and studied.v is not None and np.isnan(studied.v).any():
        yield f"{numbers.missing(look.glyphs)} or {NEVER_FROM_THERE}"
    yield from _reasons(snapshot)
    if is_bandit:
        mdp = snapshot.world.mdp
        drifted = f", {OF_MEANS_NOW}" if mdp is not None and mdp.drift_std else ""
        yield f"a pull: its mean reward{drifted}; optimal: the best arm"
        return
    limit, gamma = snapshot.world.space.time_limit, snapshot.agent.hyperparameters.gamma
    within, as_if = (f"within {limit:,} steps", f", {WITHOUT_LIMIT}") if limit else ("of an episode", "")
    yield f"return: mean {within}"
    yield f"at start: V for γ {numbers.brief(gamma, look.glyphs)}{as_if}"
    if _may_not_end(_known_answers(snapshot)):
        yield "ending: chance that an episode ends"


def amount(x: float, look: Look, width: int = WIDEST) -> str:
    """Write an exact number in ``width`` cells."""
    return numbers.figure(x, width, look.glyphs)


def answer_of(snapshot: Snapshot, kind: PolicyKind) -> PolicyAnswer:
    """Return the known answer for ``kind``."""
    return snapshot.answers.policies.get(kind, PENDING)


def _known_answers(snapshot: Snapshot) -> list[PolicyAnswer]:
    return [answer_of(snapshot, kind) for kind in POLICY_NAMES if not is_kept_back(snapshot, kind)]


def _may_not_end(known: Iterable[PolicyAnswer]) -> bool:
    return any(each.ends is not None and each.ends < _NO_ENDING for each in known)


def gaps(snapshot: Snapshot, look: Look) -> Iterator[str]:
    """Yield the distance from optimal, and the cost of exploring."""
    acts, greedy, best = (
        None if is_kept_back(snapshot, kind) else answer_of(snapshot, kind).expected_return
        for kind in (PolicyKind.BEHAVIOUR, PolicyKind.GREEDY, PolicyKind.OPTIMAL)
    )
    what = "a pull" if snapshot.world.is_bandit else "an episode"
    if greedy is not None and best is not None:
        gap = best - greedy
        way = "less" if gap > 0.0 else "more"
        earns = f"greedy earns {amount(abs(gap), look)} {way} {THAN_OPTIMAL}"
        yield AS_MUCH_AS_OPTIMAL if abs(gap) < numbers.NEGLIGIBLE else earns
    if greedy is not None and acts is not None:
        yield _exploring(greedy - acts, what, snapshot, look)


def _exploring(cost: float, what: str, snapshot: Snapshot, look: Look) -> str:
    values = snapshot.agent.hyperparameters
    rate = ""
    if POLICY_BY_ID[values.policy].explores_by_epsilon:
        epsilon = round(values.epsilon_at(snapshot.counters.episodes), 3)
        rate = f" (ε {setting(epsilon, look.glyphs)})"
    if abs(cost) < numbers.NEGLIGIBLE:
        return f"exploring{rate} costs nothing"
    verb = "costs" if cost > 0.0 else "gains"
    return f"exploring{rate} {verb} {amount(abs(cost), look)} {what}"


def _reasons(snapshot: Snapshot) -> Iterator[str]:
    said = set[str]()
    if not snapshot.answers.drawn.choices and answer_of(snapshot, PolicyKind.DRAWN).is_known:
        yield "drawn: random until you draw it (w p)"
    for kind, name in POLICY_NAMES.items():
        answer = answer_of(snapshot, kind)
        if is_kept_back(snapshot, kind):
            yield f"{name}: hidden, {shown_by(snapshot)}"
        elif answer.refused and answer.refused not in said:
            said.add(answer.refused)
            is_of_all = answer.refused in (TOO_MANY, WHILE_RUNNING)
            yield answer.refused if is_of_all else f"{name}: {answer.refused}"
        elif answer.is_known and answer.expected_return is None and answer.ends is not None:
            share = f"ends in {numbers.percent(answer.ends)}" if answer.ends else "never ends"
            yield f"{name}: {share}, so it has no return"
