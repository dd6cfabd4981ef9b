"""The tools for bandits: what arms pay, arms more and arms less."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.screens.playground.actions.modes.editing.rules import ask_rules
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Hand, Tool, Toolbox
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.edit import Edit


class ArmsTools(Toolbox):
    """Draws the arms of a bandit."""

    def about(self, hand: Hand) -> tuple[str, ...]:
        """Return the arm under the cursor, and its mean."""
        draft, arm = _arms_of(hand), _arm(hand)
        return f"arm {arm} pays {draft.means[arm]:.4g} on average", f"arm {arm}: {draft.means[arm]:.4g}"

    def turn(self, hand: Hand, place: int, amount: float) -> None:
        """Let an arm pay so many tenths more on average."""
        self._set(hand, place, _arms_of(hand).means[place] + amount / 10)

    def pay(self, amount: float, hand: Hand) -> None:
        """Let the arm under the cursor pay so much more on average."""
        arm = _arm(hand)
        self._set(hand, arm, _arms_of(hand).means[arm] + amount)

    def ask_mean(self, hand: Hand) -> None:
        """Type the mean of the arm under the cursor."""
        draft, arm = _arms_of(hand), _arm(hand)
        hint = "A probability from 0 to 1." if draft.is_bernoulli else "What it pays on average."
        dialog = Prompt(f"Mean of arm {arm}", hint, repr(draft.means[arm]), partial(_mean, draft))
        hand.ask(dialog, lambda value: self._set(hand, arm, float(value)))

    def resize(self, count: int, hand: Hand) -> None:
        """Add an arm before the cursor, or take away the one under it."""
        hand.draw((Edit("arms", (), f"{count:+d}@{_arm(hand)}"),))

    def paint(self, hand: Hand, places: Sequence[int]) -> None:
        """Put the cursor where it was clicked: there is nothing to paint."""
        hand.view.put_cursor(places[-1])

    def _set(self, hand: Hand, arm: int, mean: float) -> None:
        mean = round(mean, 10)
        if _arms_of(hand).is_bernoulli:
            mean = min(max(mean, 0.0), 1.0)
        hand.draw((Edit("arm", (str(arm),), repr(mean)),))

    tools = (
        Tool(
            "plus",
            "+",
            "more",
            "Let the arm pay 0.1 more on average.",
            partial(lambda box, hand: box.pay(0.1, hand)),
            0,
        ),
        Tool(
            "minus",
            "−",
            "less",
            "Let the arm pay 0.1 less on average.",
            partial(lambda box, hand: box.pay(-0.1, hand)),
            1,
        ),
        Tool("equals_sign", "=", "mean", "Type the mean of the arm.", ask_mean, 2),
        Tool("i", "i", "arm +", "Add an arm here.", lambda box, hand: box.resize(1, hand), 3),
        Tool("u", "u", "arm −", "Take this arm away.", lambda box, hand: box.resize(-1, hand), 4),
        Tool("o", "o", "rules", "The rules of the bandit: spread and drift.", ask_rules, 5),
    )


def _arms_of(hand: Hand) -> ArmsDraft:
    draft = hand.draft
    assert isinstance(draft, ArmsDraft)
    return draft


def _arm(hand: Hand) -> int:
    return min(hand.view.cursor_place or 0, len(_arms_of(hand).means) - 1)


def _mean(draft: ArmsDraft, text: str) -> float:
    try:
        mean = float(text.replace("−", "-"))
    except ValueError:
        raise ValueError("expected a number, such as 0.5") from None
    if draft.is_bernoulli and not 0 <= mean <= 1:
        raise ValueError("expected a probability from 0 to 1")
    return mean
