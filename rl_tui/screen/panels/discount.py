"""The panel of flip points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, ClassVar, Final, NamedTuple

from rich.cells import cell_len
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.flip_answer import FlipState, beyond
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.screen.draw.canvas import Line, Piece, kept, strips_of, wrapped
from rl_tui.screen.draw.names import action_name, state_name
from rl_tui.screen.draw.precision import fewest_decimals
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import Text
from rl_tui.screen.kit.panel import Legend, LegendSign, Panel, key_hints, legend_rows
from rl_tui.screen.kit.pointing import NOWHERE
from rl_tui.screen.kit.snapshot_facts import answer_key, is_secret, passes_too_fast
from rl_tui.screen.panels import discount_chart
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips import Flip, Turn


# The list of flip points


_LEAST_DECIMALS: Final = 3
_MOST_DECIMALS: Final = 12
_LARGE: Final = 1e7  # returns from here on have an exponent
_MOST_STATES: Final = 12
_SIGNS: Final = 3  # columns before γ
_GAP: Final = "  "


class FlipForm(NamedTuple):
    """Number formats of γ and returns."""

    gamma_decimals: int
    return_decimals: int
    verb: str

    def gamma(self, flip: Flip, look: Look) -> str:
        """Write γ."""
        return numbers.fixed(flip.gamma, self.gamma_decimals, look.glyphs, leading_zero=False)

    def returns(self, flip: Flip, look: Look) -> str:
        """Write the optimal returns around ``flip``."""
        known = [each for each in flip.expected_return if each is not None]
        is_equal = len(known) < 2 or abs(known[0] - known[1]) < numbers.NEGLIGIBLE
        decimals = self.return_decimals
        while not is_equal and decimals < _MOST_DECIMALS:
            if _return_text(known[0], decimals, look) != _return_text(known[1], decimals, look):
                break
            decimals += 1
        below, above = (_return_text(each, decimals, look) for each in flip.expected_return)
        return f"{self.verb}{below} below, {above} above"


_FORMS: Final = ((4, "earns "), (3, "earns "), (3, ""), (2, ""))  # decimals of returns, and the verb


def fitting_form(flips: Sequence[Flip], look: Look, width: int) -> FlipForm:
    """Return the longest fitting form of ``flips``. γ has three decimals, or more to distinguish them."""
    gammas = [flip.gamma for flip in flips]
    returns = [each for flip in flips for each in flip.expected_return if each is not None]
    least = fewest_decimals(
        _LEAST_DECIMALS,
        _MOST_DECIMALS,
        lambda decimals: len({round(gamma, decimals) for gamma in gammas}) == len(gammas),
    )
    for most, verb in _FORMS:
        form = FlipForm(_decimals_of(gammas, least), _decimals_of(returns, most), verb)
        texts = (f"{form.gamma(flip, look)}{_GAP}{form.returns(flip, look)}" for flip in flips)
        if all(_SIGNS + cell_len(look.glyphs.spelled(text)) <= width for text in texts):
            break
    return form


def _decimals_of(values: Sequence[float], most: int) -> int:
    return max((len(f"{value:.{most}f}".rstrip("0").partition(".")[2]) for value in values), default=most)


def _return_text(value: float | None, decimals: int, look: Look) -> str:
    if value is None:
        return "unknown"
    if not 10.0**-decimals <= abs(value) < _LARGE:
        return numbers.brief(value, look.glyphs, decimals=decimals)
    return numbers.fixed(value, decimals, look.glyphs, leading_zero=False)


def _flip_lines(
    flip: Flip, state: int, world: World, look: Look, width: int, form: FlipForm, *, is_chosen: bool
) -> list[Line]:
    palette, glyphs = look.palette, look.glyphs
    is_here = any(turn.state == state for turn in flip.turns)
    signs = discount_chart.flip_sign(flip, look) + (glyphs.change_mark if is_here else " ")
    style = palette.focus if is_chosen else palette.strong if is_here or flip.turns_the_way else palette.text
    lines: list[Line] = [
        [
            Piece(f" {signs}", discount_chart.flip_style(flip, look)),
            Piece(form.gamma(flip, look), style),
            Piece(f"{_GAP}{form.returns(flip, look)}", palette.text),
        ]
    ]
    for text in _turns_in_words(flip.turns, state, world, look):
        lines += wrapped(text, width, palette.text if is_here else palette.dim, look, "    ", "      ")
    return lines


def _turns_in_words(turns: Sequence[Turn], state: int, world: World, look: Look) -> Iterator[str]:

    def changes(turn: Turn) -> tuple[str, str]:
        return _actions(turn.before, world, look), _actions(turn.after, world, look)

    def order(turn: Turn) -> tuple[tuple[str, str], int]:
        return changes(turn), turn.state

    groups = [list(group) for _, group in groupby(sorted(turns, key=order), changes)]
    for group in sorted(
        groups, key=lambda group: (all(turn.state != state for turn in group), group[0].state)
    ):
        before, after = changes(group[0])
        names = [kept(state_name(world, turn.state, look.glyphs)) for turn in group]
        more = len(names) - _MOST_STATES
        listed = ", ".join(names[:_MOST_STATES]) + (f" and {more} more" if more > 0 else "")
        yield f"{'state' if len(group) == 1 else 'states'} {listed}: {kept(f'{before} to {after}')}"


def _actions(pairs: Sequence[int], world: World, look: Look) -> str:
    names = (
        action_name(world, int(world.space.pair_action[pair]), look.glyphs)
        for pair in shown_pairs(world, pairs)
    )
    return ", ".join(names)


# The panel


HIDDEN: Final = "flip points are hidden: "
PENDING: Final = "computing in the background …"
NO_FLIPS: Final = "no flip point: the same actions are optimal at every γ"
_TITLE: Final = "Flip points"
_CHART_SHARE: Final = 0.55  # share of the rows, if the list does not fit
_CHART_ROWS: Final = 10
_FEW_ROWS: Final = 6  # of a chart if rows are short
_LIST_ROWS: Final = 2  # least rows of the list, if a chart still fits
_RANKED: Final = "worst to best"


class _Drawn(NamedTuple):
    strips: list[Strip]
    free_rows: int
    listed: str


class DiscountPanel(Panel, can_focus=True):
    """A chart of Q*(γ) of one state above a list of flips.

    The state is under the cursor, else the agent's, or the start while steps pass too fast.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "choose(-1)", "discount.up", "The flip point at the next lower γ"),
        binding("down", "choose(1)", "discount.down", "The flip point at the next higher γ"),
        binding("v", "turn_layer", "discount.layer", "Q*, or how good each action is from worst to best"),
        binding("enter", "go_beyond", "discount.go_beyond", "Set γ on the other side of the flip point"),
    ]
    _pointed = NOWHERE
    _chosen: float | None = None  # γ of a flip
    _is_ranked = False
    _kept: tuple[object, _Drawn] | None = None

    @dataclass
    class GammaWanted(Message):
        """A person wants this γ."""

        gamma: float

    def point_at(self, pairs: range) -> None:
        """Show a state, by default the agent's."""
        if pairs != self._pointed:
            self._pointed = pairs
            self.redraw()

    def subject_in(self, snapshot: Snapshot) -> range:
        """Return the pairs of the drawn state."""
        return NOWHERE if _said_instead(snapshot) else snapshot.world.space.pairs_of(self._state(snapshot))

    @property
    def chosen(self) -> Flip | None:
        """The chosen flip, if any."""
        flips = () if self.snapshot is None else _shown_flips(self.snapshot)
        return next((flip for flip in flips if flip.gamma == self._chosen), None)

    def action_choose(self, by: int) -> None:
        """Choose the next flip, at first the nearest."""
        if self.snapshot is None or not (flips := _shown_flips(self.snapshot)):
            return
        gammas = [flip.gamma for flip in flips]
        if self._chosen in gammas:
            place = max(0, min(gammas.index(self._chosen) + by, len(gammas) - 1))
        else:
            place = _next_to(flips, self.snapshot)
        self._chosen = gammas[place]
        self.redraw()

    def action_turn_layer(self) -> None:
        """Switch between Q* and ranks of actions."""
        self._is_ranked = not self._is_ranked
        self.redraw()

    def action_go_beyond(self) -> None:
        """Request a γ beyond the chosen flip."""
        flip = self.chosen
        if flip is not None and self.snapshot is not None:
            is_below = self.snapshot.agent.hyperparameters.gamma <= flip.gamma
            gamma = beyond(self.snapshot.answers.flips, flip, is_above=is_below)
            self.post_message(self.GammaWanted(gamma))

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the signs of flips and lines."""
        if _said_instead(snapshot):
            return ()
        glyphs, palette = self.look.glyphs, self.look.palette
        signs = {
            True: LegendSign(glyphs.flip, "path", palette.best, "changes the optimal path"),
            False: LegendSign(glyphs.side_flip, "other", palette.dim, "other flip point"),
        }
        current = LegendSign(glyphs.thumb, "current γ", palette.press)
        there = {flip.turns_the_way for flip in _shown_flips(snapshot)}
        if not there:
            return (current,)
        return (
            *(sign for turns_the_way, sign in signs.items() if turns_the_way in there),
            LegendSign(glyphs.change_mark, "here", palette.strong, "in this state"),
            current,
        )

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw chart and list, or a reason."""
        self.heading, self.footing, self.free_rows = _TITLE, self.fitting(("esc: close",), width), 0
        palette = self.look.palette
        text = "" if snapshot is None else _said_instead(snapshot)
        if snapshot is None or text:
            lines = wrapped(text, width, palette.dim, self.look, " ", " ")
            self.free_rows = height - len(lines) - 1
            return strips_of(lines, width, height, self.look)
        state = self._state(snapshot)
        name = state_name(snapshot.world, state, self.look.glyphs)
        keys = _keys(
            snapshot.answers.flips.flips, is_ranked=self._is_ranked, may_set=snapshot.program is None
        )
        self.footing = self.fitting(keys, width)
        gamma, answer = snapshot.agent.hyperparameters.gamma, snapshot.answers.flips
        stance = self._chosen, self._is_ranked, self.is_explained
        what = answer, state, gamma, stance, self.look, width, height
        if self._kept is None or self._kept[0] != what:
            self._kept = what, self._drawn(snapshot, state, width, height)
        drawn = self._kept[1]
        self.heading, self.free_rows = (
            self.fitting(self._headings(name, drawn.listed), width),
            drawn.free_rows,
        )
        return list(drawn.strips)

    def _headings(self, name: str, listed: str) -> tuple[str, ...]:
        layer = f", {_RANKED}" if self._is_ranked else ""
        count = f" · {listed}" if listed else ""
        about = f"{_TITLE} · Q* of state {name}{layer}{count}"
        shorter = f"Q* of {name}{layer}"
        return (
            *self.captioned(about),
            *(about, f"{_TITLE} · Q* of {name}{count}", f"{shorter}{count}", f"{name}{layer}{count}"),
            *(f"Q* of {name}{count}", shorter, f"Q* of {name}", _TITLE),
        )

    def _drawn(self, snapshot: Snapshot, state: int, width: int, height: int) -> _Drawn:
        """Draw in milliseconds: first the chosen flip, then the legend, then other flips."""
        answer, look, chosen = snapshot.answers.flips, self.look, self.chosen
        assert answer.curves is not None
        blocks = _blocks(snapshot, state, chosen, look, width)
        signs = tuple(sign._replace(in_full="") for sign in self.legend(snapshot) if self.is_explained)
        explained = len(legend_rows(signs, width, len(signs), look))
        highest = max(map(len, blocks), default=0)
        head = Text(_in_short(answer.flips), look.palette.strong).lines(width, look)
        if blocks and len(head) + _FEW_ROWS + explained + highest > height:
            head = ()
        room = max(0, height - len(head))
        most = room - explained - highest
        least = min(_CHART_ROWS, max(discount_chart.LEAST_HEIGHT, min(_FEW_ROWS, room - _LIST_ROWS), most))
        needed = sum(map(len, blocks)) + explained
        rows = min(room, max(least, room - needed, min(most, round(_CHART_SHARE * room))))
        gamma = snapshot.agent.hyperparameters.gamma
        lines = discount_chart.action_lines(snapshot.world, answer.curves, state, look)
        lines = discount_chart.ranked(lines) if self._is_ranked else discount_chart.best_two(lines, look)
        chart = discount_chart.draw_values(
            lines, answer.curves.gamma, answer.flips, state, gamma, chosen, look, width, rows
        )
        strips, room = [*strips_of(head, width, len(head), look), *chart][:height], room - rows
        if rows < discount_chart.LEAST_HEIGHT:
            return _Drawn(strips, 0, "")
        if not blocks:
            return _Drawn([*strips, *strips_of((), width, room, look)], room, "")
        focused = _next_to(answer.flips, snapshot) if chosen is None else answer.flips.index(chosen)
        view = _in_view(blocks, focused, max(min(room, len(blocks[focused])), room - explained))
        listed = [line for block in blocks[view.start : view.stop] for line in block][:room]
        strips += strips_of(listed, width, room, look)
        return _Drawn(strips, room - len(listed), _range_in_words(view, len(blocks)))

    def _state(self, snapshot: Snapshot) -> int:
        space = snapshot.world.space
        if self._pointed and self._pointed.start < space.pairs:
            return space.state_of(self._pointed.start)
        here = snapshot.counters.state
        if not passes_too_fast(snapshot) and here < space.states and len(space.pairs_of(here)) > 1:
            return here
        mdp = snapshot.world.mdp
        assert mdp is not None
        return int(mdp.start_state[0])


def why_empty(snapshot: Snapshot) -> str:
    """Explain why the panel will stay empty."""
    from rl_tui.runs.answers.flip_answers import at_once

    answer, mdp = snapshot.answers.flips, snapshot.world.mdp
    if answer.state is FlipState.NOT_ASKED and mdp is not None:
        answer = at_once(mdp) or answer
    if answer.is_idle:
        step = "pull" if snapshot.world.is_bandit else "step"
        return f"each {step} ends its episode: γ changes nothing"
    return answer.reason if answer.state is FlipState.REFUSED else ""


def _said_instead(snapshot: Snapshot) -> str:
    answer = snapshot.answers.flips
    if reason := why_empty(snapshot):
        return reason
    if is_secret(snapshot):
        return HIDDEN + answer_key(snapshot)
    return "" if answer.state is FlipState.KNOWN else answer.reason or PENDING


def _shown_flips(snapshot: Snapshot) -> tuple[Flip, ...]:
    return () if is_secret(snapshot) else snapshot.answers.flips.flips


def _next_to(flips: Sequence[Flip], snapshot: Snapshot) -> int:
    gamma = snapshot.agent.hyperparameters.gamma
    return min(range(len(flips)), key=lambda place: abs(flips[place].gamma - gamma))


def _in_short(flips: Sequence[Flip]) -> str:
    on_path = sum(flip.turns_the_way for flip in flips)
    changes = f"{on_path or 'none'} {'change' if on_path > 1 else 'changes'} the optimal path"
    return f"{counted(len(flips), 'flip point')}, {changes}" if flips else NO_FLIPS


def _blocks(snapshot: Snapshot, state: int, chosen: Flip | None, look: Look, width: int) -> list[list[Line]]:
    flips: Sequence[Flip] = snapshot.answers.flips.flips
    form = fitting_form(flips, look, width)
    return [
        _flip_lines(flip, state, snapshot.world, look, width, form, is_chosen=flip is chosen)
        for flip in flips
    ]


def _in_view(blocks: Sequence[Sequence[Line]], focused: int, rows: int) -> range:
    first, behind = focused, focused + 1
    free = rows - len(blocks[focused])
    grows = True
    while grows:
        grows = False
        for place in (behind, first - 1):
            if 0 <= place < len(blocks) and len(blocks[place]) <= free:
                first, behind = min(first, place), max(behind, place + 1)
                free -= len(blocks[place])
                grows = True
    return range(first, behind)


def _range_in_words(view: range, all_of_them: int) -> str:
    if len(view) == all_of_them:
        return ""
    first = view.start + 1
    return f"{first if first == view.stop else f'{first}–{view.stop}'} of {all_of_them}"


def _keys(flips: Sequence[Flip], *, is_ranked: bool, may_set: bool) -> Iterator[str]:
    return key_hints(
        ("↑ ↓: flip point", "↑ ↓: flip") if flips else (),
        ("enter: γ beyond it", "enter: beyond", "enter: γ") if flips and may_set else (),
        ("v: Q*",) if is_ranked else (f"v: {_RANKED}", "v: ranks"),
        ("esc: close",),
    )
