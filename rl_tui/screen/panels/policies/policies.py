"""What policies are worth: each in a row, and what exploring costs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from typing import ClassVar, Final, NamedTuple

from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PENDING, TOO_MANY, WHILE_RUNNING, PolicyAnswer
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece, strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import Column, Columns, Table, Text, laid
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import shown_by
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.policies.studied import POLICY_NAMES, is_kept_back
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms

# The table


class PolicyColumn(NamedTuple):
    """A figure of every policy; ``rank``: those of the greatest are left out first."""

    id: str
    head: str
    rank: int
    has_sign: bool = False


RETURN: Final = PolicyColumn("expected_return", "return", 0, has_sign=True)
REWARD: Final = PolicyColumn("expected_return", "a pull", 0, has_sign=True)  # of a bandit
VALUE: Final = PolicyColumn("value_at_start", "at start", 1, has_sign=True)
STEPS: Final = PolicyColumn("steps", "length", 2)
ENDS: Final = PolicyColumn("ends", "ending", 3)
FIGURES: Final = (RETURN, REWARD, VALUE, STEPS, ENDS)
_LEAST_NAME: Final = 8  # cells of a name with the mark before it


def policy_table(snapshot: Snapshot, look: Look) -> Table:
    """Return a row for each policy, that which is studied with the cursor."""
    known = known_answers(snapshot)
    figures = _figures(snapshot, known)
    found = [getattr(each, figure.id) for each in known for figure in figures if figure.id != ENDS.id]
    needed = max((len(amount(each, look)) for each in found if each is not None), default=0)

    names = [_names(snapshot, look, is_short=is_short) for is_short in (False, True)]
    column = cache(partial(_column, snapshot, look))

    def forms() -> Iterator[Columns]:
        # short names come before numbers that are cut, and these before figures that are left out
        ways = product(range(len(figures)), (False, True), names, (WIDEST, WIDEST - 1, WIDEST - 2))
        for left_out, is_cut, named, cells in ways:
            if (cells < needed) is is_cut:
                shown = (each for each in figures if each.rank < len(figures) - left_out)
                yield named, *(column(each, cells) for each in shown)
        yield names[-1]._replace(least=_LEAST_NAME), column(figures[0], WIDEST - 2)

    return Table(forms(), margin=1)


def _figures(snapshot: Snapshot, known: Sequence[PolicyAnswer]) -> list[PolicyColumn]:
    if isinstance(snapshot.world.drawing, Arms):
        return [REWARD]
    if may_not_end(known):
        return [RETURN, VALUE, STEPS._replace(rank=ENDS.rank), ENDS._replace(rank=STEPS.rank)]
    return [RETURN, VALUE, STEPS]


def _names(snapshot: Snapshot, look: Look, *, is_short: bool) -> Column:
    names = {kind: name.line if is_short else name.row for kind, name in POLICY_NAMES.items()}
    cells = [
        Piece(f"{look.glyphs.cursor}{name}", look.palette.focus)
        if kind is snapshot.answers.studied
        else f" {name}"
        for kind, name in names.items()
    ]
    return Column("", cells, look.palette.text, right=False, gap=0)


def _column(snapshot: Snapshot, look: Look, figure: PolicyColumn, cells: int) -> Column:
    width = max(cells - (not figure.has_sign), len(figure.head))
    texts = [_said(snapshot, kind, figure, width, look) for kind in POLICY_NAMES]
    return Column(
        figure.head, texts, look.palette.strong if figure.rank == 0 else look.palette.text, width=width
    )


def _said(snapshot: Snapshot, kind: PolicyKind, figure: PolicyColumn, cells: int, look: Look) -> str:
    """Return a figure; in its place a dash where there is none, … while it is worked out, ? where hidden."""
    if is_kept_back(snapshot, kind):
        return "?"
    answer = answer_of(snapshot, kind)
    if not answer.is_known and not answer.refused:
        return look.glyphs.ellipsis
    x: float | None = getattr(answer, figure.id)
    if x is None:
        return numbers.missing(look.glyphs)
    return numbers.percent(x) if figure.id == ENDS.id else amount(x, look, cells)


# The panel


TITLE: Final = "Policies"
WAITING: Final = "they are being worked out"
_NOT_KNOWN: Final = f"what they are worth cannot be told: {NO_TABLE}"
_CHOOSE: Final = "screen.do('policies.choose({})')"


_KEYS: Final = (
    "↑ ↓: which · enter: keep it in view · esc: back to V",
    "↑ ↓: which · enter: keep · esc: back",
    "↑ ↓ · enter: keep · esc: back",
    "enter: keep · esc: back",
    "esc: back",
)

# Arms show their bars all the time: there is no V to go back to
_KEYS_OF_ARMS: Final = (
    "↑ ↓: which · enter: keep it in view · esc: close",
    "↑ ↓: which · enter: keep · esc: close",
    "↑ ↓ · enter: keep · esc: close",
    "enter: keep · esc: close",
    "esc: close",
)

_KEYS_ELSEWHERE: Final = (
    "click or tab here to choose · esc: close",
    "tab here to choose · esc: close",
    "esc: close",
)


@dataclass
class PolicyChosen(Message):
    """A person chose the policy ``kind`` with the mouse."""

    kind: PolicyKind


class Policies(Panel, can_focus=True):
    """A row a policy; the one under the cursor is studied: the world shows its values and actions."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", _CHOOSE.format(-1), "policies.up", "The policy above"),
        binding("down", _CHOOSE.format(1), "policies.down", "The policy below"),
        binding("home", _CHOOSE.format(-9), "policies.first", "The first policy"),
        binding("end", _CHOOSE.format(9), "policies.last", "The last policy"),
        binding("enter", "screen.do('policies.keep')", "policies.keep", "Keep it on screen"),
    ]
    _places: Sequence[int] = ()  # the row of the picture in which each policy stands

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the table and the notes, of which the last ones are left out where there is no room."""
        self.heading = self.fitting(self._headings(snapshot), width)
        is_bandit = snapshot is not None and isinstance(snapshot.world.drawing, Arms)
        keys = _KEYS_OF_ARMS if is_bandit else _KEYS
        self.footing = self.fitting(keys if self.has_focus else _KEYS_ELSEWHERE, width)
        self._places = ()
        if snapshot is None or snapshot.answers.studied is None:
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        if snapshot.world.mdp is None:
            # rows and explanations of figures would be about nothing
            self.footing = self.fitting(_KEYS[-1:], width)
            why = Text(_NOT_KNOWN, self.look.palette.dim).lines(width, self.look)
            self.free_rows = height - len(why)
            return strips_of(why, width, height, self.look)
        palette = self.look.palette
        texts = (
            Text(note, palette.text if is_plain else palette.dim, rest="   ")
            for note, is_plain in notes(snapshot, self.look)
        )
        table, cursor = policy_table(snapshot, self.look), list(POLICY_NAMES).index(snapshot.answers.studied)
        lines, self._places, self.free_rows = laid(table, cursor, texts, width, height, self.look)
        return strips_of(lines, width, height, self.look)

    def _headings(self, snapshot: Snapshot | None) -> tuple[str, ...]:
        plain = (*self.captioned(TITLE), TITLE)
        if snapshot is None or not snapshot.run_group.lanes:
            return plain
        lane = self._lane(snapshot)
        named = f"{lane} {snapshot.run_group.lanes[snapshot.run_group.shown].name}"
        return (*(f"{named} · {each}" for each in plain), f"{lane} · {TITLE}", lane)

    def _lane(self, snapshot: Snapshot) -> str:
        return f"{self.look.glyphs.cursor}{snapshot.run_group.shown + 1}"

    def watch_has_focus(self, has_focus: bool) -> None:
        """Tell the keys that choose only where they do."""
        super().watch_has_focus(has_focus)
        self.redraw()

    def on_click(self, event: events.Click) -> None:
        """Choose the policy under the pointer."""
        offset = event.get_content_offset(self)
        if offset is not None and offset.y in self._places:
            kind = list(POLICY_NAMES)[list(self._places).index(offset.y)]
            self.post_message(PolicyChosen(kind))


# The notes below the table


OF_MEANS_NOW: Final = "of the means as they are now"
WITHOUT_LIMIT: Final = "as if without a limit"
AS_MUCH_AS_OPTIMAL: Final = "greedy earns as much as optimal"
SHORT_OF_OPTIMAL: Final = "short of optimal"
_GAMMA_BEST: Final = "best for this γ (γ-best)"
_NO_ENDING: Final = 0.9995  # from there on it is written as 100 %
WIDEST: Final = 8  # cells of the widest number
Note = tuple[str, bool]


def notes(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    """Yield the notes, those that matter most first, and of each whether it is about figures."""
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    if is_bandit and is_kept_back(snapshot, PolicyKind.UNIFORM):
        yield f"what they earn tells of the true means: {shown_by(snapshot, 'them')}", False
        return
    yield from _gaps(snapshot, look)
    yield from _reasons(snapshot)
    if is_bandit:
        mdp = snapshot.world.mdp
        drifted = f", {OF_MEANS_NOW}" if mdp is not None and mdp.drift_std else ""
        yield f"a pull: the reward it brings on average{drifted}, exact", False
        yield "optimal: the best arm", False
        return
    limit, gamma = snapshot.world.space.time_limit, snapshot.agent.hyperparameters.gamma
    within = f" within {limit:,} steps" if limit else ""
    if may_not_end(known_answers(snapshot)):
        yield f"ending: the chance that an episode ends{within}", False
    yield f"return: expected, undiscounted,{within or ' without a limit'}", False
    as_if = f", {WITHOUT_LIMIT}" if limit else ""
    yield f"at start: V there, γ {numbers.brief(gamma, look.glyphs)}{as_if}", False
    if not is_kept_back(snapshot, PolicyKind.OPTIMAL):
        yield f"optimal: {_GAMMA_BEST}", False


def amount(x: float, look: Look, width: int = WIDEST) -> str:
    """Return an exact figure in ``width`` cells."""
    return numbers.figure(x, width, look.glyphs)


def answer_of(snapshot: Snapshot, kind: PolicyKind) -> PolicyAnswer:
    """Return what is known of a policy."""
    return snapshot.answers.policies.get(kind, PENDING)


def known_answers(snapshot: Snapshot) -> list[PolicyAnswer]:
    """Return what is known of the policies that may be seen."""
    return [answer_of(snapshot, kind) for kind in POLICY_NAMES if not is_kept_back(snapshot, kind)]


def may_not_end(known: Iterable[PolicyAnswer]) -> bool:
    """Return whether an episode of any of these policies may go on; then a column says how likely it ends.

    That matters more than how long episodes are.
    """
    return any(each.ends is not None and each.ends < _NO_ENDING for each in known)


def _gaps(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    acts, greedy, best = (
        None if is_kept_back(snapshot, kind) else answer_of(snapshot, kind).expected_return
        for kind in (PolicyKind.BEHAVIOUR, PolicyKind.GREEDY, PolicyKind.OPTIMAL)
    )
    what = "a pull" if isinstance(snapshot.world.drawing, Arms) else "an episode"
    if greedy is not None and acts is not None:
        yield _exploring(greedy - acts, what, snapshot, look), True
    if greedy is not None and best is not None:
        gap = best - greedy
        if not _amount(gap, look):
            yield AS_MUCH_AS_OPTIMAL, True
        elif gap > 0.0:
            yield f"greedy is {_amount(gap, look)} {what} {SHORT_OF_OPTIMAL}", True
        else:
            yield f"greedy earns {_amount(-gap, look)} {what} more than optimal", True


def _exploring(cost: float, what: str, snapshot: Snapshot, look: Look) -> str:
    """Return what exploring costs, with the ε in force, or brings where greedy earns less."""
    values = snapshot.agent.hyperparameters
    rate = ""
    if POLICY_BY_ID[values.policy].explores_by_epsilon:
        epsilon = round(values.epsilon_at(snapshot.counters.episodes), 3)
        rate = f" (ε {setting(epsilon, look.glyphs)})"
    verb, size = "brings" if cost <= -numbers.NEGLIGIBLE else "costs", _amount(abs(cost), look)
    return f"exploring{rate} {verb} {size} {what}" if size else f"exploring{rate} {verb} nothing"


def _amount(x: float, look: Look) -> str:
    """Return an amount, empty for none."""
    return "" if abs(x) < numbers.NEGLIGIBLE else amount(x, look)


def _reasons(snapshot: Snapshot) -> Iterator[Note]:
    said = set[str]()
    if not snapshot.answers.drawn.choices and answer_of(snapshot, PolicyKind.DRAWN).is_known:
        yield "nothing drawn: at random; w p draws", False
    for kind, name in POLICY_NAMES.items():
        if is_kept_back(snapshot, kind):
            which = f" {_GAMMA_BEST}," if kind is PolicyKind.OPTIMAL else ""
            yield f"{name.line}:{which} hidden, {shown_by(snapshot)}", False
        elif (refused := answer_of(snapshot, kind).refused) and refused not in said:
            said.add(refused)
            is_of_all = refused in (TOO_MANY, WHILE_RUNNING)
            yield refused if is_of_all else f"{name.line}: {refused}", False
        elif answer_of(snapshot, kind).is_known and answer_of(snapshot, kind).expected_return is None:
            ends = answer_of(snapshot, kind).ends
            if ends is not None:
                share = f"ends in {numbers.percent(ends)}" if ends else "never ends"
                yield f"{name.line}: {share}, so it has no return", False
