"""Tools to edit bandits: means, and the number of arms."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.panels.draw_panel import WorldNumber
from rl_tui.screen.playground.modes.numbers import DRIFT, MEAN, SPREAD, SUCCESS
from rl_tui.screen.playground.modes.rules import Desk, Tool, Toolbox, ask_rules, fault_of, number_of
from rl_tui.screen.playground.modes.texts import number_in, number_text
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.world import World

_NO_RULES: Final = "arms that pay 1 or 0 have no spread and do not drift"

ARMS_TOOLS: Final = (
    Tool(
        "equals_sign",
        "mean…",
        "Type the mean of the arm.",
        lambda box, desk: box.ask_mean(desk),
        "=",
        is_of_number=True,
    ),
    *(
        Tool(
            key,
            label,
            f"Let the arm pay 0.1 {label} on average.",
            partial(lambda amount, box, desk: box.pay(amount, desk), amount),
            symbol,
            is_of_number=True,
            rank=1 if symbol == "[" else None,
            hint=("= [ ]", "mean"),
        )
        for key, symbol, label, amount in (
            ("left_square_bracket", "[", "less", -0.1),
            ("right_square_bracket", "]", "more", 0.1),
        )
    ),
    Tool("w i", "arm here", "Add an arm here.", lambda box, desk: box.resize(1, desk)),
    Tool("w d", "arm away", "Remove this arm.", lambda box, desk: box.resize(-1, desk)),
    Tool("w b", "arm last", "Add an arm at the end.", lambda box, desk: box.resize(1, desk, at_end=True)),
    Tool(
        "w r",
        "rules…",
        "Set how far rewards spread, and how means drift.",
        ask_rules,
        why_not=lambda _, desk: _NO_RULES if _arms_of(desk).is_bernoulli else "",
    ),
)


class ArmsTools(Toolbox):
    """Tools for the arms of a bandit."""

    tools = ARMS_TOOLS
    rest = "arms, rules, save"

    def __init__(self) -> None:
        self._added: tuple[int, int] | None = None  # number of arms including the new one, and its index

    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return the arm under the cursor, and its mean."""
        draft, arm = _arms_of(desk), _arm(desk)
        mean = number_text(draft.means[arm], 4)
        since = ", at first: means drift" if number_of(draft, DRIFT.name) else ""
        return (
            f"arm {arm} pays {mean} on average{since}",
            f"arm {arm}: {mean}",
        )

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return what the pointer does."""
        return "click: cursor · wheel: what an arm pays", "wheel: what an arm pays"

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return the mean of the arm, and the spread and drift of rewards."""
        draft = _arms_of(desk)
        mean = WorldNumber(SUCCESS if draft.is_bernoulli else MEAN, draft.means[_arm(desk)])
        if draft.is_bernoulli:
            return (mean,)
        return mean, *(WorldNumber(each, number_of(draft, each.name)) for each in (SPREAD, DRIFT))

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set the number ``name``."""
        if name == MEAN.name:
            return (self._edit(desk, _arm(desk), value),)
        edits = (Edit(name, (), repr(value)),)
        fault = fault_of(desk.draft, edits, name)
        if fault:
            raise ValueError(fault)
        return edits

    def turn(self, desk: Desk, place: int, amount: float) -> None:
        """Raise the mean of an arm by ``amount`` tenths."""
        desk.view.put_cursor(place)
        self.pay(amount / 10, desk)

    def pay(self, amount: float, desk: Desk) -> None:
        """Raise the mean of the arm under the cursor by ``amount``."""
        draft, arm = _arms_of(desk), _arm(desk)
        mean = round(draft.means[arm] + amount, 10)
        desk.draw((self._edit(desk, arm, min(max(mean, 0.0), 1.0) if draft.is_bernoulli else mean),))

    def ask_mean(self, desk: Desk) -> None:
        """Ask for the mean of the arm under the cursor."""
        draft, arm = _arms_of(desk), _arm(desk)
        hint = "A probability from 0 to 1." if draft.is_bernoulli else "What it pays on average."
        dialog = Prompt(f"Mean of arm {arm}", hint, repr(draft.means[arm]), partial(_mean, draft))
        desk.ask(dialog, lambda value: desk.draw((self._edit(desk, arm, float(value)),)))

    def place_added(self, world: World) -> int | None:
        """Return the added arm once it is in ``world``."""
        if self._added is None or self._added[0] != world.space.pairs:
            return None
        (_, place), self._added = self._added, None
        return place

    def resize(self, count: int, desk: Desk, *, at_end: bool = False) -> None:
        """Add an arm before the cursor or ``at_end``, or remove one."""
        arms = len(_arms_of(desk).means)
        at = arms if at_end else _arm(desk)
        if count > 0 and not at_end:
            self._added = arms + count, at
        desk.draw((Edit("arms", (), f"{count:+d}@{at}"),))

    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Move the cursor to the click, because arms are not painted."""
        desk.view.put_cursor(places[-1])

    def _edit(self, desk: Desk, arm: int, mean: float) -> Edit:
        return Edit("arm", (str(arm),), repr(mean))


def _arms_of(desk: Desk) -> ArmsDraft:
    draft = desk.draft
    assert isinstance(draft, ArmsDraft)
    return draft


def _arm(desk: Desk) -> int:
    return min(desk.view.cursor_place or 0, len(_arms_of(desk).means) - 1)


def _mean(draft: ArmsDraft, text: str) -> float:
    mean = number_in(text)
    if draft.is_bernoulli and not 0 <= mean <= 1:
        raise ValueError("expected a probability from 0 to 1")
    return mean
