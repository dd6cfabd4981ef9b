"""The dialog "run until": conditions and breakpoints."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar, Final

from textual.binding import Binding, BindingType

from rl_tui.live.commands import ToggleBreakpoint
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.dialogs.form import Candidate, Form, Prompt
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.names import breakpoint_names, estimate_name
from rl_tui.screen.kit.snapshot_facts import episode_shown, episodes_begun, is_secret
from rl_tui.screen.theme.glyphs import Glyphs

# The conditions


_LARGEST = 10**15
_VALUE_COLUMNS = 8


class Kind(Enum):
    """Kinds of learner."""

    AGENT = "step", "episode"
    BANDIT = "pull", "episode"
    PLANNER = "backup", "sweep"

    def __init__(self, step: str, episode: str) -> None:
        self.step = step
        self.episode = episode


@dataclass(frozen=True, slots=True)
class UntilOption:
    """A condition, with the ``pair`` of a value or −1."""

    id: str
    event: Event
    name: str
    hint: str
    refused: str = ""
    pair: int = -1

    @property
    def asks(self) -> bool:
        """True if it needs a number."""
        return self.event in (Event.STEP, Event.EPISODE, Event.VALUE)

    def until(self, number: float = 0.0) -> Until:
        """Return the player's stop condition."""
        if self.event is Event.VALUE:
            return Until(self.event, pair=self.pair, threshold=number)
        return Until(self.event, number=int(number)) if self.asks else Until(self.event)


def kind_of(snapshot: Snapshot) -> Kind:
    """Return the kind of learner."""
    if snapshot.agent.row.planner:
        return Kind.PLANNER
    return Kind.BANDIT if snapshot.world.is_bandit else Kind.AGENT


def until_options(snapshot: Snapshot, cursor: int | None, glyphs: Glyphs) -> tuple[UntilOption, ...]:
    """Return all conditions for the cursor's pair, if any."""
    kind, refused = kind_of(snapshot), snapshot.exact_answer.refused
    step, episode, plans = kind.step, kind.episode, kind is Kind.PLANNER
    rewards = "a planner takes no steps in the world, so there are no rewards" if plans else ""
    unknown = f"no exact values: {refused}" if refused else ""
    reward = UntilOption(
        "reward", Event.REWARD, "the next reward", f"A {step} whose reward is not 0.", rewards
    )
    number = UntilOption("step", Event.STEP, f"a {step} by its number …", f"Asks for the {step}.")
    if kind is Kind.BANDIT:
        change = "The arm with the highest estimate changes, or several tie."
        optimal = "Compares with the true means without showing them."
        found = [
            reward,
            UntilOption("policy", Event.POLICY_CHANGE, "another greedy arm", change),
            UntilOption("optimal", Event.OPTIMAL, "the greedy arm is the best one", optimal, unknown),
            number,
        ]
    else:
        end = "Every state has been updated once more." if plans else "A terminal state, or the time limit."
        change = "In some state, the actions with the highest estimate change."
        optimal = "The greedy policy is optimal from the start, for the current γ."
        if is_secret(snapshot):
            optimal = "Compares with the exact values without showing them."
        name = f"{'a' if plans else 'an'} {episode} by its number …"
        begins = f"Asks for the {episode}, and stops where it begins."
        found = [
            reward,
            UntilOption("end", Event.EPISODE_END, f"the end of the {episode}", end),
            UntilOption("policy", Event.POLICY_CHANGE, "the next change of the greedy policy", change),
            UntilOption("optimal", Event.OPTIMAL, "the greedy policy is optimal", optimal, unknown),
            number,
            UntilOption("episode", Event.EPISODE, name, begins),
        ]
    return (*found, *_values(snapshot, cursor, glyphs))


def _values(snapshot: Snapshot, cursor: int | None, glyphs: Glyphs) -> list[UntilOption]:
    step = snapshot.counters.last_step
    last = step.updated_pair if step is not None and step.learned else None
    found = []
    for id, pair, where in (("cursor", cursor, "under the cursor"), ("last", last, "updated last")):  # noqa: A001
        if pair is not None and (id == "cursor" or pair != cursor):
            name = f"{estimate_name(snapshot.world, pair, glyphs)} reaches a value …"
            now = f" It is {_value(snapshot, pair, glyphs)} now." if snapshot.agent.holds(pair) else ""
            hint = f"The estimate {where}. Asks for the value.{now}"
            found.append(UntilOption(f"value {id}", Event.VALUE, name, hint, pair=pair))
    if found:
        return found
    refused = "no cell is chosen. tab: the table, arrows: a cell"
    return [UntilOption("value cursor", Event.VALUE, "an estimate reaches a value …", "", refused)]


def ask_number(option: UntilOption, snapshot: Snapshot, glyphs: Glyphs) -> Prompt:
    """Ask for the number of ``option``."""
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
    expected = f"type a whole number, {least:,} or more. m g: go back"
    if most < _LARGEST:
        expected = f"type a whole number from {least:,} to {most:,}"

    def read(text: str) -> int:
        digits = text.strip().replace(",", "")
        if not (digits.isascii() and digits.isdigit() and least <= int(digits) <= most):
            raise ValueError(expected)
        return int(digits)

    hint = f"now {now}. The run goes on at full speed, and pauses at your number"
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
            raise ValueError("this is its value now: type another number")
        return number

    hint = f"it is {now} now. The run pauses when it reaches or passes your value"
    title = f"Run until {estimate_name(snapshot.world, pair, glyphs)} reaches"
    return Prompt(glyphs.spelled(title), glyphs.spelled(hint), "", read)


def _value(snapshot: Snapshot, pair: int, glyphs: Glyphs) -> str:
    return numbers.value(float(snapshot.agent.q[pair]), _VALUE_COLUMNS, glyphs)


# The dialog


NO_BREAKPOINTS: Final = "No breakpoints. t b sets one at the cursor."
_KEYS: Final = "del: remove"


class UntilChoice(Form):
    """Conditions and breakpoints. The answer is a condition."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("u", "cancel", "back", id="close_until", tooltip="Close without running."),
        Binding(
            "delete,backspace", "remove", "take away", id="until.remove", tooltip="Remove the breakpoint."
        ),
    ]

    def __init__(
        self,
        snapshot: Snapshot,
        cursor: int | None,
        place: ToggleBreakpoint | None,
        remembered: str,
        toggle: Callable[[ToggleBreakpoint], None],
        glyphs: Glyphs,
    ) -> None:
        self.options = {each.id: each for each in until_options(snapshot, cursor, glyphs)}
        self._place = place
        self._toggle = toggle
        self._snapshot = snapshot
        self._breakpoints: dict[str, ToggleBreakpoint] = {}
        super().__init__("Run until", self._rows(snapshot, glyphs), "", glyphs, keys=_KEYS, start=remembered)

    def show(self, snapshot: Snapshot) -> None:
        """Show the newest breakpoints."""
        if snapshot.playback.breakpoints != self._snapshot.playback.breakpoints:
            self._snapshot = snapshot
            self.set_rows(self._rows(snapshot, self.glyphs))

    def choose(self, id: str) -> None:  # noqa: A002
        """Answer the condition, or change the breakpoint."""
        if id in self.options:
            self.dismiss(self.options[id])
        elif id in self._breakpoints:
            self._toggle(self._breakpoints[id])
        elif self._place is not None:
            self._toggle(self._place)

    def action_remove(self) -> None:
        """Remove the breakpoint under the cursor."""
        if self.at in self._breakpoints:
            self._toggle(self._breakpoints[self.at])

    def _rows(self, snapshot: Snapshot, glyphs: Glyphs) -> list[Candidate]:
        set_now = snapshot.playback.breakpoints
        self._breakpoints = {
            **{f"state {state}": ToggleBreakpoint(state=state) for state in sorted(set_now.states)},
            **{f"pair {pair}": ToggleBreakpoint(pair=pair) for pair in sorted(set_now.pairs)},
        }
        rows = [Candidate(each.id, each.name, (each.hint,), each.refused) for each in self.options.values()]
        events = sum(not each.asks for each in self.options.values())
        rows.insert(events, self._switch(snapshot, glyphs))
        if not self._breakpoints:
            return [*rows, Candidate("", NO_BREAKPOINTS)]
        names = breakpoint_names(snapshot.world, set_now, glyphs)
        rows.append(Candidate("", "Breakpoints"))
        for key, name in zip(self._breakpoints, names, strict=True):
            rows.append(Candidate(key, name, ("The run pauses here each time.",)))
        return rows

    def _switch(self, snapshot: Snapshot, glyphs: Glyphs) -> Candidate:
        place = self._place
        if place is None:
            return Candidate(_SWITCH, "breakpoint at the cursor", refused="no cell is chosen")
        one = Breakpoints().toggled(state=place.state, pair=place.pair)
        (name,) = breakpoint_names(snapshot.world, one, glyphs)
        is_set = "on" if place in self._breakpoints.values() else "off"
        about = "The run pauses here each time. enter sets or removes the breakpoint."
        return Candidate(_SWITCH, f"breakpoint at {name}: {is_set}", (about,))


_SWITCH: Final = "switch"
