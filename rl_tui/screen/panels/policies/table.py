"""The table that compares policies: one row per policy, with notes below.

Columns are returns, values at the start, and the length and ending of episodes, as many as fit. The
notes state the cost of exploring, the gap to the optimal policy, and why a number is missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PENDING, TOO_MANY, WHILE_RUNNING, PolicyAnswer
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, shortened
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.snapshot_facts import shown_by
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.policies.names import POLICY_NAMES
from rl_tui.screen.panels.policies.studied import is_kept_back
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms

# Rows and columns


WIDEST: Final = 8  # cells of the widest number
_NUMBERS: Final = (WIDEST + 1, WIDEST, WIDEST - 1)  # cells of a column, with the blank before its number
_LEAST_NAME: Final = 7
_NO_ENDING: Final = 0.9995  # from there on it is written as 100 %


class PolicyColumn(NamedTuple):
    """A figure of every policy; ``rank``: the columns of the greatest are left out first."""

    id: str
    head: str
    rank: int
    has_sign: bool = False


RETURN: Final = PolicyColumn("expected_return", "return", 0, has_sign=True)
REWARD: Final = PolicyColumn("expected_return", "a pull", 0, has_sign=True)  # of a bandit
VALUE: Final = PolicyColumn("value_at_start", "at start", 1, has_sign=True)
STEPS: Final = PolicyColumn("steps", "length", 2)
ENDS: Final = PolicyColumn("ends", "ending", 3)
COLUMNS: Final = (RETURN, REWARD, VALUE, STEPS, ENDS)


class TableForm(NamedTuple):
    """The columns there is room for, and the cells of names and numbers."""

    columns: Sequence[PolicyColumn]
    name: int
    is_short: bool
    number: int


def amount(x: float, look: Look, width: int = WIDEST) -> str:
    """Return an exact figure in ``width`` cells."""
    return numbers.figure(x, width, look.glyphs)


def answer_of(snapshot: Snapshot, kind: PolicyKind) -> PolicyAnswer:
    """Return what is known of a policy."""
    return snapshot.answers.policies.get(kind, PENDING)


def table_form(snapshot: Snapshot, width: int, look: Look) -> TableForm:
    """Return the form of the table in ``width`` cells."""
    known = [answer_of(snapshot, kind) for kind in POLICY_NAMES if not is_kept_back(snapshot, kind)]
    columns = _columns(snapshot, known)
    longest, short = (max(_cells(name, look) for name in names) for names in _names())
    found = [_figure(each, column) for each in known for column in columns if column.id != ENDS.id]
    needed = max((len(amount(each, look)) for each in found if each is not None), default=0)
    for name, is_short, number, left_out in _choices(longest, short, len(columns), needed):
        shown = [each for each in columns if each.rank < len(columns) - left_out]
        form = TableForm(shown, name, is_short, number)
        if 1 + name + sum(_width(form, each) for each in shown) < width:
            return form
    name = max(_LEAST_NAME, min(short, width - 1 - _NUMBERS[-1]))
    return TableForm(columns[:1], name, True, _NUMBERS[-1])


def _choices(longest: int, short: int, columns: int, needed: int) -> Iterator[tuple[int, bool, int, int]]:
    """Yield cells of names, whether they are short, cells of numbers and columns left out, the best first.

    Short names come before numbers in short, of which the widest has ``needed`` cells, and these before
    columns that are left out.
    """
    names = ((longest, False), (short, True))
    for out in range(columns):
        for fits in (True, False):
            yield from ((*name, each, out) for name in names for each in _NUMBERS if (needed < each) is fits)


def head_line(form: TableForm, look: Look) -> Line:
    """Return what stands above the columns."""
    pieces = [Piece(" " * (1 + form.name), look.palette.dim)]
    return [*pieces, *(Piece(each.head.rjust(_width(form, each)), look.palette.dim) for each in form.columns)]


def row_lines(snapshot: Snapshot, form: TableForm, look: Look) -> list[Line]:
    """Return a row for each policy, that which is studied with the cursor."""
    palette, glyphs = look.palette, look.glyphs
    lines: list[Line] = []
    for kind in POLICY_NAMES:
        is_studied = kind is snapshot.answers.studied
        name = to_ascii(_name(kind, form.is_short), glyphs)
        mark = glyphs.cursor if is_studied else " "
        style = palette.focus if is_studied else palette.text
        text = f"{mark}{shortened(name, form.name, glyphs.ellipsis):<{form.name}}"
        pieces = [Piece(text, style)]
        for column in form.columns:
            said = _said(snapshot, kind, column, form, look)
            number = palette.strong if column.rank == 0 else palette.text
            pieces.append(Piece(said.rjust(_width(form, column)), number))
        lines.append(pieces)
    return lines


def _columns(snapshot: Snapshot, known: Sequence[PolicyAnswer]) -> list[PolicyColumn]:
    if isinstance(snapshot.world.drawing, Arms):
        return [REWARD]
    if may_not_end(known):
        return [RETURN, VALUE, STEPS._replace(rank=ENDS.rank), ENDS._replace(rank=STEPS.rank)]
    return [RETURN, VALUE, STEPS]


def may_not_end(known: Iterable[PolicyAnswer]) -> bool:
    """Return whether an episode of any of these policies may go on; then a column says how likely it ends.

    That matters more than how long episodes are.
    """
    return any(each.ends is not None and each.ends < _NO_ENDING for each in known)


def _figure(answer: PolicyAnswer, column: PolicyColumn) -> float | None:
    figure: float | None = getattr(answer, column.id)
    return figure


def _said(snapshot: Snapshot, kind: PolicyKind, column: PolicyColumn, form: TableForm, look: Look) -> str:
    """Return a figure; in its place a dash where there is none, … while it is worked out, ? where hidden."""
    if is_kept_back(snapshot, kind):
        return "?"
    answer = answer_of(snapshot, kind)
    if not answer.is_known and not answer.refused:
        return look.glyphs.ellipsis
    figure = _figure(answer, column)
    if figure is None:
        return numbers.missing(look.glyphs)
    if column.id == ENDS.id:
        return numbers.percent(figure)
    return amount(figure, look, _width(form, column) - 1)


def _width(form: TableForm, column: PolicyColumn) -> int:
    return max(form.number - (not column.has_sign), len(column.head) + 1)


def _names() -> tuple[list[str], list[str]]:
    return ([_name(kind, False) for kind in POLICY_NAMES], [_name(kind, True) for kind in POLICY_NAMES])


def _name(kind: PolicyKind, is_short: bool) -> str:
    names = POLICY_NAMES[kind]
    return names.line if is_short else names.row


def _cells(text: str, look: Look) -> int:
    return cell_len(to_ascii(text, look.glyphs))


# Notes below the table


OF_MEANS_NOW: Final = "of the means as they are now"
WITHOUT_LIMIT: Final = "as if without a limit"
AS_MUCH_AS_OPTIMAL: Final = "greedy earns as much as optimal"
SHORT_OF_OPTIMAL: Final = "short of optimal"
_GAMMA_BEST: Final = "best for this γ (γ-best)"
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
        yield f"a pull: the reward it brings on average{_as_means_are(snapshot)}, exact", False
        yield "optimal: the best arm", False
        return
    limit, gamma = snapshot.world.space.time_limit, snapshot.agent.hyperparameters.gamma
    within = f" within {limit:,} steps" if limit else ""
    known = [answer_of(snapshot, kind) for kind in POLICY_NAMES if not is_kept_back(snapshot, kind)]
    if may_not_end(known):
        yield f"ending: the chance that an episode ends{within}", False
    yield f"return: expected, undiscounted,{within or ' without a limit'}", False
    as_if = f", {WITHOUT_LIMIT}" if limit else ""
    yield f"at start: V there, γ {numbers.brief(gamma, look.glyphs)}{as_if}", False
    if not is_kept_back(snapshot, PolicyKind.OPTIMAL):
        yield f"optimal: {_GAMMA_BEST}", False


def _as_means_are(snapshot: Snapshot) -> str:
    """Return which means of the arms the figures are of, where these drift; else nothing."""
    mdp = snapshot.world.mdp
    return f", {OF_MEANS_NOW}" if mdp is not None and mdp.drift_std else ""


def return_of(snapshot: Snapshot, kind: PolicyKind) -> float | None:
    """Return the exact return of a policy; None where it is not known or not to be seen."""
    return None if is_kept_back(snapshot, kind) else answer_of(snapshot, kind).expected_return


def _gaps(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    """Yield what lies between acting and greedy, and between greedy and the best."""
    acts, greedy, best = (
        return_of(snapshot, kind) for kind in (PolicyKind.BEHAVIOUR, PolicyKind.GREEDY, PolicyKind.OPTIMAL)
    )
    what = "a pull" if isinstance(snapshot.world.drawing, Arms) else "an episode"
    if greedy is not None and acts is not None:
        yield exploring(greedy - acts, what, snapshot, look), True
    if greedy is not None and best is not None:
        gap = best - greedy
        if not _amount(gap, look):
            yield AS_MUCH_AS_OPTIMAL, True
        elif gap > 0.0:
            yield f"greedy is {_amount(gap, look)} {what} {SHORT_OF_OPTIMAL}", True
        else:
            yield f"greedy earns {_amount(-gap, look)} {what} more than optimal", True


def exploring(cost: float, what: str, snapshot: Snapshot, look: Look) -> str:
    """Return what exploring costs, with the ε in force, or brings where greedy earns less.

    ``what`` it costs that is an episode or a pull.
    """
    size = _amount(abs(cost), look)
    said, _ = cost_of_exploring(cost, size or "nothing", snapshot, look.glyphs)
    return f"{said} {what}" if size else said


def cost_of_exploring(cost: float, size: str, snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, str]:
    """Return what exploring costs, or brings where greedy earns less: with the ε in force, and without it.

    ``size`` is that of ``cost`` as it is written.
    """
    values = snapshot.agent.hyperparameters
    rate = ""
    if POLICY_BY_ID[values.policy].explores_by_epsilon:
        epsilon = round(values.epsilon_at(snapshot.counters.episodes), 3)
        rate = f" (ε {setting(epsilon, glyphs)})"
    said = f"{'brings' if cost <= -numbers.NEGLIGIBLE else 'costs'} {size}"
    return f"exploring{rate} {said}", f"exploring {said}"


def _amount(x: float, look: Look) -> str:
    """Return an amount, empty for none."""
    return "" if abs(x) < numbers.NEGLIGIBLE else amount(x, look)


def _reasons(snapshot: Snapshot) -> Iterator[Note]:
    """Yield why figures are lacking, a reason once."""
    said = set[str]()
    if not snapshot.answers.drawn.choices and answer_of(snapshot, PolicyKind.DRAWN).is_known:
        yield "nothing drawn: at random; D draws", False
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
