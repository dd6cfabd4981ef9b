"""The dialog "run until": every condition that can stop a run, in words that fit its agent.

A bandit speaks of pulls and a planner of sweeps. The dialog also shows and clears the breakpoints.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.live.pace.until import Event, Until
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.dialogs.dialog import Dialog, Prompt
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.names import estimate_name
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.snapshot_facts import episode_shown, episodes_begun, is_secret
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms

# The conditions


_LARGEST = 10**15
_VALUE_COLUMNS = 8


class Kind(Enum):
    """Whether an agent, a bandit or a planner is on screen, and what its steps and episodes are called."""

    AGENT = "step", "episode"
    BANDIT = "pull", "episode"
    PLANNER = "backup", "sweep"

    def __init__(self, step: str, episode: str) -> None:
        self.step = step
        self.episode = episode


@dataclass(frozen=True, slots=True)
class UntilOption:
    """Something to run until: ``name`` in the list, ``hint`` a sentence about it.

    ``id`` is the same for what is alike in other runs. ``refused`` says why it is not possible here, empty
    if it is. ``pair`` is that of a value, −1 otherwise.
    """

    id: str
    event: Event
    name: str
    hint: str
    refused: str = ""
    pair: int = -1

    @property
    def asks(self) -> bool:
        """Whether a number has to be asked for."""
        return self.event in (Event.STEP, Event.EPISODE, Event.VALUE)

    def until(self, number: float = 0.0) -> Until:
        """Return the stop condition for the player, with the ``number`` that was asked for."""
        if self.event is Event.VALUE:
            return Until(self.event, pair=self.pair, threshold=number)
        return Until(self.event, number=int(number)) if self.asks else Until(self.event)


def kind_of(snapshot: Snapshot) -> Kind:
    """Return what is learning, or planning, in ``snapshot``."""
    if snapshot.agent.row.planner:
        return Kind.PLANNER
    return Kind.BANDIT if isinstance(snapshot.world.drawing, Arms) else Kind.AGENT


def until_options(snapshot: Snapshot, cursor: int | None, glyphs: Glyphs) -> tuple[UntilOption, ...]:
    """Return all that a run can be run until; ``cursor`` is the pair under a cursor, None without one."""
    kind = kind_of(snapshot)
    rewards = "A planner takes no steps in the world: nothing pays." if kind is Kind.PLANNER else ""
    whose = f"A {kind.step} whose reward is not 0."
    found = [
        UntilOption("reward", Event.REWARD, "the next reward", whose, rewards),
        *([] if kind is Kind.BANDIT else [_end(kind)]),
        UntilOption(
            "policy",
            Event.POLICY_CHANGE,
            "another greedy arm" if kind is Kind.BANDIT else "the next change of the greedy policy",
            "Another arm has the highest estimate, or one more has."
            if kind is Kind.BANDIT
            else "In some state other actions have the highest estimate than before.",
        ),
        _optimal(snapshot, kind),
        UntilOption("step", Event.STEP, f"a {kind.step} by its number …", f"Asks for the {kind.step}."),
    ]
    if kind is not Kind.BANDIT:
        name = f"{'a' if kind is Kind.PLANNER else 'an'} {kind.episode} by its number …"
        hint = f"Asks for the {kind.episode}, and stops where it begins."
        found.append(UntilOption("episode", Event.EPISODE, name, hint))
    return (*found, *_values(snapshot, cursor, glyphs))


def _end(kind: Kind) -> UntilOption:
    backed_up, ended = "Every state was backed up once more.", "A terminal state, or the time limit."
    hint = backed_up if kind is Kind.PLANNER else ended
    return UntilOption("end", Event.EPISODE_END, f"the end of the {kind.episode}", hint)


def _optimal(snapshot: Snapshot, kind: Kind) -> UntilOption:
    if kind is Kind.BANDIT:
        name = "the greedy arm is the best one"
        hint = "Compares with the true means without showing them."
    else:
        name = "the greedy policy is optimal"
        hint = "No policy has a larger discounted return from the start on, for the γ in force."
        if is_secret(snapshot):
            hint = "Compares with the exact answer without showing it."
    refused = f"No exact answer: {snapshot.exact_answer.refused}." if snapshot.exact_answer.refused else ""
    return UntilOption("optimal", Event.OPTIMAL, name, hint, refused)


def _values(snapshot: Snapshot, cursor: int | None, glyphs: Glyphs) -> list[UntilOption]:
    """Return the options on values: that under the cursor, and the one updated last."""
    step = snapshot.counters.last_step
    last = step.updated_pair if step is not None and step.learned else None
    found = []
    for id, pair, where in (("cursor", cursor, "under the cursor"), ("last", last, "updated last")):  # noqa: A001
        if pair is not None and (id == "cursor" or pair != cursor):
            name = f"{estimate_name(snapshot.world, pair, glyphs)} reaches a value …"
            now = f" It is {_value(snapshot, pair, glyphs)} now." if snapshot.agent.holds(pair) else ""
            hint = f"The estimate {where}; asks for the value.{now}"
            found.append(UntilOption(f"value {id}", Event.VALUE, name, hint, pair=pair))
    if found:
        return found
    refused = "No cell is chosen: tab goes to the table, the arrows to a cell."
    return [UntilOption("value cursor", Event.VALUE, "an estimate reaches a value …", "", refused)]


def ask_number(option: UntilOption, snapshot: Snapshot, glyphs: Glyphs) -> Prompt:
    """Return the prompt for the number of ``option``, one of the options that ask."""
    if option.event is Event.VALUE:
        return _ask_value(option, snapshot, glyphs)
    kind, step = kind_of(snapshot), snapshot.counters.step
    if option.event is Event.STEP:
        noun, now, least, example = kind.step, f"after {kind.step} {step:,}", step + 1, step + 1_000
    else:
        noun, now = kind.episode, f"in {kind.episode} {episode_shown(snapshot):,}"
        least = episodes_begun(snapshot) + 1
        example = snapshot.counters.episodes + 100
    bandit = snapshot.results.bandit
    most = bandit.budget if kind is Kind.BANDIT and bandit is not None else _LARGEST
    expected = f"type a whole number, {least:,} or more"
    if most < _LARGEST:
        expected = f"type a whole number from {least:,} to {most:,}"

    def read(text: str) -> int:
        digits = text.strip().replace(",", "")
        if not (digits.isascii() and digits.isdigit() and least <= int(digits) <= most):
            raise ValueError(expected)
        return int(digits)

    hint = f"now {now}; the run goes as fast as it can and pauses there"
    return Prompt(f"Run until {noun}", hint, str(min(example, most)), read)


def _ask_value(option: UntilOption, snapshot: Snapshot, glyphs: Glyphs) -> Prompt:
    pair, now = option.pair, _value(snapshot, option.pair, glyphs)

    def read(text: str) -> float:
        try:
            number = float(text.replace("−", "-"))
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise ValueError("type a number, such as 0.5")
        if snapshot.agent.holds(pair) and number == float(snapshot.agent.q[pair]):
            raise ValueError("that is what it is now: type another number")
        return number

    hint = f"it is {now} now; the run pauses when it gets there, or past it"
    title = f"Run until {estimate_name(snapshot.world, pair, glyphs)} reaches"
    return Prompt(to_ascii(title, glyphs), to_ascii(hint, glyphs), "", read)


def _value(snapshot: Snapshot, pair: int, glyphs: Glyphs) -> str:
    return numbers.value(float(snapshot.agent.q[pair]), _VALUE_COLUMNS, glyphs)


# The dialog


NO_BREAKPOINTS = "Breakpoints: none; k sets one where the cursor is."


class UntilChoice(Dialog[UntilOption]):
    """A list of ``options``, a sentence about the one under the cursor, and the ``breakpoints`` in words.

    The cursor starts on the option whose id is ``remembered``, if it is there. ``clear`` is asked to take the
    breakpoints away. Answers the chosen option.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("u,q", "cancel", "back", id="close_until", tooltip="Close without running."),
        Binding("K", "clear", "no breakpoints", id="until.clear", tooltip="Take all breakpoints away."),
    ]

    def __init__(
        self,
        options: tuple[UntilOption, ...],
        remembered: str,
        breakpoints: str,
        clear: Callable[[], None],
        glyphs: Glyphs,
    ) -> None:
        super().__init__()
        self._clear = clear
        self._options = {each.id: each for each in options}
        self._remembered = remembered
        self._breakpoints = breakpoints
        self._glyphs = glyphs

    def compose(self) -> ComposeResult:
        """Yield the list, the sentence and the breakpoints."""
        with self.box("Run until", "enter: run   esc: close"):
            yield OptionList(*(Option(self._row(each), id=each.id) for each in self._options.values()))
            yield Static(classes="hint", id="about", markup=False)
            yield Static(self._about_breakpoints(), classes="hint", id="breakpoints", markup=False)

    def on_mount(self) -> None:
        """Start on the one that was chosen last."""
        choices = self.query_one(OptionList)
        ids = list(self._options)
        choices.highlighted = ids.index(self._remembered) if self._remembered in ids else 0
        choices.focus()

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Describe the option under the cursor, or say why it is not possible here."""
        option = self._options[str(event.option_id)]
        text = f"Not here. {option.refused}" if option.refused else option.hint
        self.query_one("#about", Static).update(to_ascii(text, self._glyphs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the chosen option, unless it is not possible here."""
        option = self._options[str(event.option_id)]
        if option.refused:
            self.app.bell()
        else:
            self.dismiss(option)

    def action_clear(self) -> None:
        """Take the breakpoints away; the list stays open."""
        self._clear()
        self._breakpoints = ""
        self.query_one("#breakpoints", Static).update(self._about_breakpoints())

    def _row(self, option: UntilOption) -> Text:
        return Text(to_ascii(option.name, self._glyphs), "dim" if option.refused else "bold")

    def _about_breakpoints(self) -> str:
        text = (
            f"Breakpoints: {self._breakpoints}. K takes them away." if self._breakpoints else NO_BREAKPOINTS
        )
        return to_ascii(text, self._glyphs)
