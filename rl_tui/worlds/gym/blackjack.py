"""The exact transition table of Gymnasium's Blackjack (Sutton & Barto, 2nd ed., example 5.1).

Cards come from an infinite deck. The dealer draws up to 17, including a soft 17, and shows one card.
Gymnasium does not observe a natural (21 with two cards), which pays differently, so it is a separate state
here.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any, Final, NamedTuple

from rl_tui.worlds.drawing import Axes, CellKind, Grid, Title
from rl_tui.worlds.mdp.tabular_mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.world import World

CARDS: Final[Mapping[int, float]] = {**dict.fromkeys(range(1, 10), 1 / 13), 10: 4 / 13}
DEALER_STANDS: Final = 17
BEST: Final = 21
WON, DREW, LOST = "won", "drew", "lost"
STICK, HIT = 0, 1
_CARD_LABELS: Final = ("A", *map(str, range(2, 10)), "T")
_RIGHT: Final = len(_CARD_LABELS) + 1  # first column of the hands with a usable ace
_SUMS: Final = tuple(map(str, range(BEST, 3, -1)))


def _axes(rows: tuple[str, ...], ends: Iterable[Title]) -> Axes:
    across = len(_CARD_LABELS)
    halves = Title(-1, 0, across, "no usable ace"), Title(-1, _RIGHT, across, "usable ace")
    return Axes(rows, (*_CARD_LABELS, "", *_CARD_LABELS), (*halves, *ends))


_ENDS: Final = {_RIGHT + 2: WON, _RIGHT + 5: DREW, _RIGHT + 8: LOST}
_BUST_ROW: Final = _SUMS.index("10")  # below the hands with a usable ace, its name beside it
TABLE_AXES: Final = _axes(
    ("nat", *_SUMS), (Title(len(_SUMS) - 1, column - 1, 3, name) for column, name in _ENDS.items())
)
OBSERVED_AXES: Final = _axes(_SUMS, [Title(_BUST_ROW, _RIGHT, 5, "bust")])
OBSERVED_PARTS: Final = (32, 11, 2)
"""Number of sums, dealer's cards and ace values that Gymnasium observes."""
TABLE_LEGEND: Final = "sum ↓, dealer →"
_NAME_PARTS: Final = ("sum, dealer, ace", "sum, card, ace", "sum,card,ace")


class Hand(NamedTuple):
    """A sum, whether an ace counts 11, and whether it is a natural."""

    sum: int
    usable_ace: bool
    natural: bool = False

    def with_card(self, card: int) -> Hand:
        """Add a card. A sum above 21 is a bust."""
        if self.usable_ace:
            total = self.sum + card
            return Hand(total, True) if total <= BEST else Hand(total - 10, False)
        total = self.sum + card
        return Hand(total + 10, True) if card == 1 and total + 10 <= BEST else Hand(total, False)


class BlackjackRules(NamedTuple):
    """Arguments of the environment.

    With `sab` a natural beats everything except a natural, as in the book. Otherwise it is a normal 21, with
    the reward 1.5 instead of 1 if `natural` is true.
    """

    sab: bool
    natural: bool


def is_blackjack(environment: Any) -> bool:
    """Return True if the unwrapped environment is Gymnasium's Blackjack."""
    return type(environment).__name__ == "BlackjackEnv"


def blackjack_world(environment: Any, time_limit: int) -> World:
    """Return the world of an unwrapped environment (time limit 0: none)."""
    rules = BlackjackRules(bool(environment.sab), bool(environment.natural))
    hands = _player_hands()
    states = [(hand, showing) for hand in hands for showing in CARDS]
    number = {state: index for index, state in enumerate(states)}
    end = {name: len(states) + place for place, name in enumerate((WON, DREW, LOST))}
    mdp = tabular_mdp(
        [*(_name(hand, showing) for hand, showing in states), *end],
        ("stick", "hit"),
        _transitions(rules, number, end),
        _start(number),
        time_limit,
    )
    return World(mdp, _table_drawing(states))


def _player_hands() -> list[Hand]:
    hard = [Hand(total, False) for total in range(4, BEST + 1)]
    soft = [Hand(total, True) for total in range(12, BEST + 1)]
    return [*hard, *soft, Hand(BEST, True, natural=True)]


def _name(hand: Hand, showing: int) -> str:
    kind = "natural" if hand.natural else "yes" if hand.usable_ace else "no"
    return f"{hand.sum}, {showing}, {kind}"


def _first_two(first: int, second: int) -> Hand:
    dealt = Hand(0, False).with_card(first).with_card(second)
    return dealt._replace(natural=dealt.sum == BEST)


def _start(number: Mapping[tuple[Hand, int], int]) -> dict[int, float]:
    start: defaultdict[int, float] = defaultdict(float)
    for first, p_first in CARDS.items():
        for second, p_second in CARDS.items():
            for showing, p_showing in CARDS.items():
                start[number[_first_two(first, second), showing]] += p_first * p_second * p_showing
    return dict(start)


@cache
def _dealer_from(hand: Hand) -> Mapping[Hand, float]:
    if hand.sum >= DEALER_STANDS:
        return {hand: 1.0}
    ends: defaultdict[Hand, float] = defaultdict(float)
    for card, p_card in CARDS.items():
        for end, p_end in _dealer_from(hand.with_card(card)).items():
            ends[end] += p_card * p_end
    return dict(ends)


@cache
def dealer_showing(showing: int) -> Mapping[Hand, float]:
    """Return final hand → probability for a dealer."""
    ends: defaultdict[Hand, float] = defaultdict(float)
    for hidden, p_hidden in CARDS.items():
        for end, p_end in _dealer_from(_first_two(showing, hidden)).items():
            ends[end] += p_hidden * p_end
    return dict(ends)


def _reward(rules: BlackjackRules, player: Hand, dealer: Hand) -> float:
    of_dealer = dealer.sum if dealer.sum <= BEST else 0
    reward = float((player.sum > of_dealer) - (player.sum < of_dealer))
    if rules.sab and player.natural and not dealer.natural:
        return 1.0
    if not rules.sab and rules.natural and player.natural and reward == 1.0:
        return 1.5
    return reward


def _transitions(
    rules: BlackjackRules, number: Mapping[tuple[Hand, int], int], end: Mapping[str, int]
) -> Iterator[Transition]:
    for (hand, showing), state in number.items():
        rewards: defaultdict[float, float] = defaultdict(float)
        for dealer, probability in dealer_showing(showing).items():
            rewards[_reward(rules, hand, dealer)] += probability
        stick = [
            Outcome(probability, end[WON if reward > 0.0 else DREW if reward == 0.0 else LOST], reward, True)
            for reward, probability in sorted(rewards.items(), reverse=True)
        ]
        yield Transition(state, STICK, stick)
        reached: defaultdict[int, float] = defaultdict(float)
        for card, probability in CARDS.items():
            drawn = hand.with_card(card)
            reached[number[drawn, showing] if drawn.sum <= BEST else end[LOST]] += probability
        hit = [
            Outcome(probability, after, -1.0 if after == end[LOST] else 0.0, after == end[LOST])
            for after, probability in reached.items()
        ]
        yield Transition(state, HIT, hit)


def _table_drawing(states: list[tuple[Hand, int]]) -> Grid:
    # Sums go down, the dealer's cards across, usable aces on the right
    cells = [
        _cell(0 if hand.natural else BEST + 1 - hand.sum, showing, usable_ace=hand.usable_ace)
        for hand, showing in states
    ]
    above_names = (len(TABLE_AXES.rows) - 3) * len(TABLE_AXES.columns)
    ends = [above_names + column for column in _ENDS]
    kinds = dict.fromkeys(cells, CellKind.FLOOR)
    kinds |= dict(zip(ends, (CellKind.GOAL, CellKind.FLOOR, CellKind.HOLE), strict=True))
    return _drawn(TABLE_AXES, kinds, (*cells, *ends))


def observed_drawing() -> Grid:
    """Return the drawing of all observations. Impossible ones share a cell with busts."""
    sums, cards, aces = map(range, OBSERVED_PARTS)
    bust = _BUST_ROW * len(OBSERVED_AXES.columns) + _RIGHT
    cells = []
    for total, card, ace in product(sums, cards, aces):
        comes_up = card and (12 if ace else 4) <= total <= BEST
        cells.append(_cell(BEST - total, card, usable_ace=bool(ace)) if comes_up else bust)
    return replace(_drawn(OBSERVED_AXES, dict.fromkeys(cells, CellKind.FLOOR), tuple(cells)), idle_cell=bust)


def _cell(row: int, showing: int, *, usable_ace: bool) -> int:
    return row * len(TABLE_AXES.columns) + showing - 1 + (_RIGHT if usable_ace else 0)


def _drawn(axes: Axes, kinds: Mapping[int, CellKind], cells: tuple[int, ...]) -> Grid:
    rows, columns = len(axes.rows), len(axes.columns)
    all_kinds = tuple(kinds.get(cell, CellKind.WALL) for cell in range(rows * columns))
    names = _NAME_PARTS
    return Grid(rows, columns, all_kinds, cells, (None, None), TABLE_LEGEND, axes=axes, name_parts=names)
