"""Drawing bandits: what arms pay, arms more and arms less."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rl_tui.tui.panels.drawing.sheet import WorldNumber
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.screens.playground.actions.modes.editing.numbers import DRIFT, MEAN, SPREAD, SUCCESS
from rl_tui.tui.screens.playground.actions.modes.editing.rules import ask_rules, fault_of, number_of
from rl_tui.tui.screens.playground.actions.modes.editing.texts import number_in
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Hand, Tool, Toolbox
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.world import World


class ArmsTools(Toolbox):
    """Draws the arms of a bandit. It remembers which it has added."""

    def __init__(self) -> None:
        self._added: tuple[int, int] | None = None  # how many there are with it, and its number

    def about(self, hand: Hand) -> tuple[str, ...]:
        """Return the arm under the cursor, and its mean."""
        draft, arm = _arms_of(hand), _arm(hand)
        return f"arm {arm} pays {draft.means[arm]:.4g} on average", f"arm {arm}: {draft.means[arm]:.4g}"

    def advice(self, hand: Hand) -> tuple[str, ...]:
        """Return what the pointer does."""
        return "click: cursor · wheel: what an arm pays", "wheel: what an arm pays"

    def numbers(self, hand: Hand) -> tuple[WorldNumber, ...]:
        """Return the mean of the arm under the cursor, and how rewards spread and drift."""
        draft = _arms_of(hand)
        mean = WorldNumber(SUCCESS if draft.is_bernoulli else MEAN, draft.means[_arm(hand)])
        if draft.is_bernoulli:
            return (mean,)
        return mean, *(WorldNumber(each, number_of(draft, each.name)) for each in (SPREAD, DRIFT))

    def number_edits(self, hand: Hand, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set one of them. Raises ValueError, in words, where it cannot be that."""
        if name == MEAN.name:
            return (self._edit(hand, _arm(hand), value),)
        edits = (Edit(name, (), repr(value)),)
        fault = fault_of(hand.draft, edits, name)
        if fault:
            raise ValueError(fault)
        return edits

    def turn(self, hand: Hand, place: int, amount: float) -> None:
        """Let an arm pay so many tenths more on average."""
        hand.view.put_cursor(place)
        self.pay(amount / 10, hand)

    def pay(self, amount: float, hand: Hand) -> None:
        """Let the arm under the cursor pay so much more on average."""
        draft, arm = _arms_of(hand), _arm(hand)
        mean = round(draft.means[arm] + amount, 10)
        hand.draw((self._edit(hand, arm, min(max(mean, 0.0), 1.0) if draft.is_bernoulli else mean),))

    def ask_mean(self, hand: Hand) -> None:
        """Type the mean of the arm under the cursor."""
        draft, arm = _arms_of(hand), _arm(hand)
        hint = "A probability from 0 to 1." if draft.is_bernoulli else "What it pays on average."
        dialog = Prompt(f"Mean of arm {arm}", hint, repr(draft.means[arm]), partial(_mean, draft))
        hand.ask(dialog, lambda value: hand.draw((self._edit(hand, arm, float(value)),)))

    def place_added(self, world: World) -> int | None:
        """Return the arm that was added, once it is there."""
        if self._added is None or self._added[0] != world.space.pairs:
            return None
        (_, place), self._added = self._added, None
        return place

    def resize(self, count: int, hand: Hand, *, at_end: bool = False) -> None:
        """Add an arm before the cursor, or ``at_end``, or take away the one under it."""
        arms = len(_arms_of(hand).means)
        at = arms if at_end else _arm(hand)
        if count > 0 and not at_end:
            self._added = arms + count, at
        hand.draw((Edit("arms", (), f"{count:+d}@{at}"),))

    def paint(self, hand: Hand, places: Sequence[int]) -> None:
        """Put the cursor where it was clicked: there is nothing to paint."""
        hand.view.put_cursor(places[-1])

    def _edit(self, hand: Hand, arm: int, mean: float) -> Edit:
        return Edit("arm", (str(arm),), repr(mean))

    tools = (
        Tool(
            "plus",
            "+",
            "more",
            "Let the arm pay 0.1 more on average.",
            lambda box, hand: box.pay(0.1, hand),
            0,
        ),
        Tool(
            "minus",
            "−",
            "less",
            "Let the arm pay 0.1 less on average.",
            lambda box, hand: box.pay(-0.1, hand),
            1,
        ),
        Tool("equals_sign", "=", "mean", "Type the mean of the arm.", ask_mean, 2),
        Tool("i", "i", "arm +", "Add an arm here.", lambda box, hand: box.resize(1, hand), 3),
        Tool("u", "u", "arm −", "Take this arm away.", lambda box, hand: box.resize(-1, hand), 4),
        Tool(
            "R",
            "R",
            "arm last",
            "Add an arm behind all others.",
            lambda box, hand: box.resize(1, hand, at_end=True),
            6,
        ),
        Tool("o", "o", "rules", "The rules of the bandit: spread and drift.", ask_rules, 5),
    )


def _arms_of(hand: Hand) -> ArmsDraft:
    draft = hand.draft
    assert isinstance(draft, ArmsDraft)
    return draft


def _arm(hand: Hand) -> int:
    return min(hand.view.cursor_place or 0, len(_arms_of(hand).means) - 1)


def _mean(draft: ArmsDraft, text: str) -> float:
    mean = number_in(text)
    if draft.is_bernoulli and not 0 <= mean <= 1:
        raise ValueError("expected a probability from 0 to 1")
    return mean
