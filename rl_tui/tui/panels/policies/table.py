"""The figures of policies as a table: a row a policy, as many columns as there is room for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len

from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.answers.policy_values import PENDING, PolicyAnswer
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.pieces import Line, Piece
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.policies.names import POLICY_NAMES
from rl_tui.tui.panels.policies.studied import is_kept_back
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

_NUMBER: Final = 7  # cells of the widest number
_LEAST_NAME: Final = 7
_NO_ENDING: Final = 0.9995  # from there on it is written as 100 %


class Column(NamedTuple):
    """A figure of every policy; ``rank``: the columns of the greatest are left out first."""

    id: str
    head: str
    rank: int


RETURN: Final = Column("expected_return", "return", 0)
REWARD: Final = Column("expected_return", "a pull", 0)  # of a bandit
VALUE: Final = Column("value_at_start", "at start", 1)
STEPS: Final = Column("steps", "length", 2)
ENDS: Final = Column("ends", "ending", 3)
COLUMNS: Final = (RETURN, REWARD, VALUE, STEPS, ENDS)


class TableForm(NamedTuple):
    """The columns there is room for, and the cells of names and numbers."""

    columns: Sequence[Column]
    name: int
    is_short: bool
    number: int


def amount(x: float, look: Look) -> str:
    """Return an exact figure: fractions with three decimals, what is larger with fewer."""
    size = abs(x)
    decimals = 3 if size < 1.0 else 2 if size < 100.0 else 1 if size < 1_000.0 else 0
    text = numbers.fixed(x, decimals, look.glyphs, leading_zero=False)
    if len(text) < _NUMBER and (numbers.has_digits(text) or size < numbers.NEGLIGIBLE):
        return text if numbers.has_digits(text) else "0"
    return numbers.value(x, _NUMBER - 1, look.glyphs)


def answer_of(snapshot: Snapshot, kind: PolicyKind) -> PolicyAnswer:
    """Return what is known of a policy."""
    return snapshot.answers.policies.get(kind, PENDING)


def has_row(snapshot: Snapshot, kind: PolicyKind) -> bool:
    """Return whether there is such a policy: one that was drawn is there once something was."""
    return kind is not PolicyKind.DRAWN or bool(snapshot.answers.drawn.choices)


def table_form(snapshot: Snapshot, width: int, look: Look) -> TableForm:
    """Return the form of the table in ``width`` cells."""
    known = [
        answer_of(snapshot, kind)
        for kind in POLICY_NAMES
        if has_row(snapshot, kind) and not is_kept_back(snapshot, kind)
    ]
    columns = _columns(snapshot, known)
    longest, short = (max(_cells(name, look) for name in names) for names in _names())
    for number in (_NUMBER + 2, _NUMBER):
        for left_out in range(len(columns)):
            shown = [each for each in columns if each.rank < len(columns) - left_out]
            cells = [max(number, len(each.head) + 1) for each in shown]
            for name, is_short in ((longest, False), (short, True)):
                if 1 + name + sum(cells) <= width and (number > _NUMBER) <= (not left_out and not is_short):
                    return TableForm(shown, name, is_short, number)
    return TableForm(columns[:1], max(_LEAST_NAME, min(short, width - 1 - _NUMBER)), True, _NUMBER)


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


def _columns(snapshot: Snapshot, known: Sequence[PolicyAnswer]) -> list[Column]:
    if isinstance(snapshot.world.drawing, Arms):
        return [REWARD]
    may_not_end = any(each.ends is not None and each.ends < _NO_ENDING for each in known)
    return [RETURN, VALUE, STEPS, *([ENDS] if may_not_end else [])]


def _figure(answer: PolicyAnswer, column: Column) -> float | None:
    figure: float | None = getattr(answer, column.id)
    return figure


def _said(snapshot: Snapshot, kind: PolicyKind, column: Column, form: TableForm, look: Look) -> str:
    """Return a figure; in its place a dot where there is none, … while it is worked out, ? where hidden."""
    glyphs = look.glyphs
    if is_kept_back(snapshot, kind):
        return "?"
    if not has_row(snapshot, kind):
        return glyphs.stay
    answer = answer_of(snapshot, kind)
    if not answer.is_known:
        return glyphs.stay if answer.refused else glyphs.ellipsis
    figure = _figure(answer, column)
    if figure is None:
        return "none"
    if column is ENDS:
        return numbers.percent(figure)
    return amount(figure, look)


def _width(form: TableForm, column: Column) -> int:
    return max(form.number, len(column.head) + 1)


def _names() -> tuple[list[str], list[str]]:
    return ([_name(kind, False) for kind in POLICY_NAMES], [_name(kind, True) for kind in POLICY_NAMES])


def _name(kind: PolicyKind, is_short: bool) -> str:
    names = POLICY_NAMES[kind]
    return names.line if is_short else names.row


def _cells(text: str, look: Look) -> int:
    return cell_len(to_ascii(text, look.glyphs))
