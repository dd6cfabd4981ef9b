"""Where a run is to stop by itself: what a person waits for, and the breakpoints."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from rl_tui.common.errors import UserError
from rl_tui.worlds.mdp.space import FiniteSpace


class Event(StrEnum):
    """What a run may run until."""

    REWARD = "the next reward"  # a step whose reward is not 0
    EPISODE_END = "the end of the episode"
    POLICY_CHANGE = "the next change of the greedy policy"
    OPTIMAL = "the greedy policy is optimal"
    STEP = "a step"
    EPISODE = "an episode"
    VALUE = "a value"


@dataclass(frozen=True, slots=True)
class Until:
    """``event`` and what it needs: ``number`` is a step, or the episode (from 1) to begin with.

    With ``Event.EPISODE_END`` it is how many more episodes are to end after the one under way. With
    ``Event.VALUE`` it is the moment Q of ``pair`` reaches ``threshold``, from below or above.
    """

    event: Event
    number: int = 0
    pair: int = -1
    threshold: float = 0.0


@dataclass(frozen=True, slots=True)
class Breakpoints:
    """States on whose arrival, and state–action pairs after whose taking, a run pauses."""

    states: frozenset[int] = frozenset()
    pairs: frozenset[int] = frozenset()

    def toggled(self, *, state: int | None = None, pair: int | None = None) -> Breakpoints:
        """Return them with ``state`` or ``pair`` added, or taken away if it was there."""
        states = self.states if state is None else self.states ^ {state}
        pairs = self.pairs if pair is None else self.pairs ^ {pair}
        return Breakpoints(states, pairs)

    def check(self, space: FiniteSpace) -> None:
        """Raise UserError where one is on a state or a pair that ``space`` does not have."""
        for marked, count, what in ((self.states, space.states, "state"), (self.pairs, space.pairs, "pair")):
            unknown = next((each for each in sorted(marked) if not 0 <= each < count), None)
            if unknown is not None:
                raise UserError(f"there is no {what} {unknown} here: they are 0 to {count - 1:,}")

    def __bool__(self) -> bool:
        """Tell whether there are any."""
        return bool(self.states or self.pairs)
