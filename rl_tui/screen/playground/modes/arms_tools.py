"""Tools to edit bandits."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.panels.draw_panel import WorldNumber
from rl_tui.screen.playground.modes import rules
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.world import World

_NO_RULES: Final = "arms that pay 1 or 0 have no spread and do not drift"


class ArmsTools(rules.Toolbox[ArmsDraft]):
    """Tools for the arms of a bandit."""

    rest = "arms, rules, save"

    def __init__(self) -> None:
        self._added: tuple[int, int] | None = None  # number of arms including the new one, and its index

    def about(self, desk: rules.Desk[ArmsDraft]) -> tuple[str, ...]:
        """Describe the arm under the cursor."""
        draft, arm = desk.draft, _arm(desk)
        mean = rules.number_text(draft.means[arm], 4)
        since = ", at first: means drift" if rules.number_of(draft, rules.DRIFT.name) else ""
        return (f"arm {arm} pays {mean} on average{since}", f"arm {arm}: {mean}")

    def advice(self, desk: rules.Desk[ArmsDraft]) -> tuple[str, ...]:
        """Describe what the pointer does."""
        return "click: cursor · wheel: what an arm pays", "wheel: what an arm pays"

    def numbers(self, desk: rules.Desk[ArmsDraft]) -> tuple[WorldNumber, ...]:
        """Return the mean, and the rewards' spread and drift."""
        draft = desk.draft
        mean = WorldNumber(rules.SUCCESS if draft.is_bernoulli else rules.MEAN, draft.means[_arm(desk)])
        if draft.is_bernoulli:
            return (mean,)
        return mean, *(
            WorldNumber(each, rules.number_of(draft, each.name)) for each in (rules.SPREAD, rules.DRIFT)
        )

    def number_edits(self, desk: rules.Desk[ArmsDraft], name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set a number."""
        if name == rules.MEAN.name:
            return (self._edit(desk, _arm(desk), value),)
        return rules.checked(desk.draft, Edit(name, (), repr(value)))

    def turn(self, desk: rules.Desk[ArmsDraft], place: int, amount: float) -> None:
        """Raise an arm's mean by ``amount`` tenths."""
        desk.view.put_cursor(place)
        self.pay(desk, amount / 10)

    def pay(self, desk: rules.Desk[ArmsDraft], amount: float) -> None:
        """Raise the arm's mean."""
        draft, arm = desk.draft, _arm(desk)
        mean = round(draft.means[arm] + amount, 10)
        desk.draw((self._edit(desk, arm, min(max(mean, 0.0), 1.0) if draft.is_bernoulli else mean),))

    def ask_mean(self, desk: rules.Desk[ArmsDraft]) -> None:
        """Ask for the arm's mean."""
        draft, arm = desk.draft, _arm(desk)
        hint = "A probability from 0 to 1." if draft.is_bernoulli else "What it pays on average."
        dialog = Prompt(f"Mean of arm {arm}", hint, repr(draft.means[arm]), partial(_mean, draft))
        desk.ask(dialog, lambda value: desk.draw((self._edit(desk, arm, float(value)),)))

    def place_added(self, world: World) -> int | None:
        """Return the added arm, once in ``world``."""
        if self._added is None or self._added[0] != world.space.pairs:
            return None
        (_, place), self._added = self._added, None
        return place

    def resize(self, desk: rules.Desk[ArmsDraft], count: int, *, at_end: bool = False) -> None:
        """Add an arm here or ``at_end``, or remove one."""
        arms = len(desk.draft.means)
        at = arms if at_end else _arm(desk)
        if count > 0 and not at_end:
            self._added = arms + count, at
        desk.draw((Edit("arms", (), f"{count:+d}@{at}"),))

    def paint(self, desk: rules.Desk[ArmsDraft], places: Sequence[int]) -> None:
        """Move the cursor: arms are not painted."""
        desk.view.put_cursor(places[-1])

    def _edit(self, desk: rules.Desk[ArmsDraft], arm: int, mean: float) -> Edit:
        return Edit("arm", (str(arm),), repr(mean))


def _arm(desk: rules.Desk[ArmsDraft]) -> int:
    return min(desk.view.cursor_place or 0, len(desk.draft.means) - 1)


def _mean(draft: ArmsDraft, text: str) -> float:
    mean = rules.number_in(text)
    if draft.is_bernoulli and not 0 <= mean <= 1:
        raise ValueError("type a probability from 0 to 1")
    return mean


# The tools, one row each


ArmsTools.tools = (
    rules.Tool("equals_sign", "mean…", "Type the mean of the arm.", ArmsTools.ask_mean).also(
        symbol="=", is_of_number=True
    ),
    *(
        rules.Tool(
            key, label, f"Make the arm pay 0.1 {label} on average.", partial(ArmsTools.pay, amount=amount)
        ).also(symbol=symbol, is_of_number=True, rank=1 if symbol == "[" else None, hint=("= [ ]", "mean"))
        for key, symbol, label, amount in (
            ("left_square_bracket", "[", "less", -0.1),
            ("right_square_bracket", "]", "more", 0.1),
        )
    ),
    rules.Tool("w i", "arm here", "Add an arm here.", partial(ArmsTools.resize, count=1)),
    rules.Tool("w d", "remove arm", "Remove this arm.", partial(ArmsTools.resize, count=-1)),
    rules.Tool(
        "w b", "append arm", "Add an arm at the end.", partial(ArmsTools.resize, count=1, at_end=True)
    ),
    rules.Tool("w r", "rules…", "Set how far rewards spread, and how means drift.", rules.ask_rules).also(
        why_not=lambda _, desk: _NO_RULES if desk.draft.is_bernoulli else ""
    ),
)
