"""Events and breakpoints at which a run stops."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from rl_tui.common.errors import UserError
from rl_tui.worlds.mdp.space import FiniteSpace


class Event(StrEnum):
    """An event to run until."""

    REWARD = "the next reward"  # a step with a reward other than 0
    EPISODE_END = "the end of the episode"
    POLICY_CHANGE = "the next change of the greedy policy"
    OPTIMAL = "the greedy policy is optimal"
    STEP = "a step"
    EPISODE = "an episode"
    VALUE = "a value"


@dataclass(frozen=True, slots=True)
class Until:
    """An event with its details.

    Attributes:
        number: Step, or episode (from 1). For `EPISODE_END`, the number of further episodes after this one.
        threshold: Value of Q that ends `VALUE`, from below or above.
    """

    event: Event
    number: int = 0
    pair: int = -1
    threshold: float = 0.0


@dataclass(frozen=True, slots=True)
class Breakpoints:
    """States and pairs after which a run pauses."""

    states: frozenset[int] = frozenset()
    pairs: frozenset[int] = frozenset()

    def toggled(self, *, state: int | None = None, pair: int | None = None) -> Breakpoints:
        """Add `state` or `pair`, or remove it if present."""
        states = self.states if state is None else self.states ^ {state}
        pairs = self.pairs if pair is None else self.pairs ^ {pair}
        return Breakpoints(states, pairs)

    def check(self, space: FiniteSpace) -> None:
        """Raise UserError for what `space` does not have."""
        for marked, count, what in ((self.states, space.states, "state"), (self.pairs, space.pairs, "pair")):
            unknown = next((each for each in sorted(marked) if not 0 <= each < count), None)
            if unknown is not None:
                raise UserError(f"there is no {what} {unknown}: choose 0 to {count - 1:,}")

    def __bool__(self) -> bool:
        """Return True if there are any."""
        return bool(self.states or self.pairs)
