"""The ``[mdp]`` table: states, actions, probabilities and rewards written out."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeVar

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from rl_tui.common.findings import Finding, shown
from rl_tui.common.limits import (
    LARGEST_PLACE,
    LARGEST_STD,
    LONGEST_TIME_LIMIT,
    MOST_STATES_WRITTEN,
    MOST_TRANSITIONS,
)
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.mdp.tolerance import PROBABILITY_TOLERANCE
from rl_tui.worlds.sections.mdp_connections import connection_findings
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Name,
    Number,
    Probability,
    is_number,
    is_table,
    number,
    refused,
    sized,
    whole_number,
)
from rl_tui.worlds.sections.world_section import WorldSection
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator

    from rl_tui.worlds.mdp.tabular_mdp import Outcome

_AT_MOST: Final = f", at most {MOST_STATES_WRITTEN:,}"
PLACE_FORM: Final = f"[column, row], whole numbers from 0 to {LARGEST_PLACE}"
"""Where a state can stand in the drawing."""
_COLUMN_OR_ROW: Final = whole_number(0, LARGEST_PLACE)
_STATES: Final = sized(dict, MOST_STATES_WRITTEN)

Deviation = Annotated[float, number(0, LARGEST_STD)]


class Destination(FileSection):
    """Where a transition may lead: a probability, and a reward and its noise if they differ from the rest."""

    p: Probability
    reward: Number | None = None
    std: Deviation | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_number(cls, value: object) -> object:
        if is_table(value):
            return value
        if is_number(value) and 0 <= value <= 1:  # type: ignore[operator]
            return {"p": value}
        raise refused(shown(value), "a probability from 0 to 1, or { p = …, reward = …, std = … }")


Share = TypeVar("Share", float, Destination)


def _certain(value: object) -> object:
    return {value: 1.0} if isinstance(value, str) else value


def _sums_to_one(distribution: dict[str, Share]) -> dict[str, Share]:
    chances = (each.p if isinstance(each, Destination) else each for each in distribution.values())
    total = math.fsum(chances)
    if not abs(total - 1.0) <= PROBABILITY_TOLERANCE:
        raise refused(f"{total:.12g}", "probabilities that sum to 1 (±1e-9)")
    return distribution


def is_place(value: object) -> bool:
    """Return whether a state can stand at ``value``, as a file has it."""
    return isinstance(value, list) and len(value) == 2 and all(map(_COLUMN_OR_ROW.test, value))


class TransitionEntry(FileSection):
    """What an action does in a state: one ``[[mdp.transition]]``.

    ``std`` is the standard deviation of Gaussian noise on the reward.
    """

    state: Name
    action: Name
    reward: Number | None = None
    std: Deviation = 0.0
    to: Annotated[
        dict[Name, Destination],
        AfterValidator(_sums_to_one),
        Expect(f"a table of states and probabilities{_AT_MOST}", _STATES),
        BeforeValidator(_certain),
    ]

    def outcomes(self, index: Mapping[str, int], action: int) -> list[Outcome]:
        """Return what may happen; nothing but the action itself does."""
        from rl_tui.worlds.mdp.tabular_mdp import Outcome

        return [
            Outcome(
                probability=destination.p,
                next_state=index[state],
                reward=next(each for each in (destination.reward, self.reward) if each is not None),
                terminated=False,
                reward_std=self.std if destination.std is None else destination.std,
                action=action,
            )
            for state, destination in self.to.items()
        ]


class MDPSection(WorldSection):
    """The whole table. States without transitions are terminal.

    ``seen_as`` says what the agent sees in place of a state. Where two states look alike there is no table of
    what it sees: then the world is stepped.
    """

    start: Annotated[
        dict[Name, Probability],
        AfterValidator(_sums_to_one),
        Expect(f"the name of a state, or a table of states and probabilities{_AT_MOST}", _STATES),
        BeforeValidator(_certain),
    ]
    time_limit: Annotated[int, whole_number(0, LONGEST_TIME_LIMIT)] = 0
    place: Annotated[
        dict[
            Name,
            Annotated[
                tuple[int, int],
                Expect(PLACE_FORM, is_place),
            ],
        ],
        Expect(f"a table of states and their [column, row]{_AT_MOST}", _STATES),
    ] = Field(default_factory=dict)
    seen_as: Annotated[
        dict[Name, Name], Expect(f"a table of states and what they are seen as{_AT_MOST}", _STATES)
    ] = Field(default_factory=dict)
    transition: Annotated[
        list[TransitionEntry],
        Expect(f"1 to {MOST_TRANSITIONS:,} tables [[mdp.transition]]", sized(list, MOST_TRANSITIONS, 1)),
    ]

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield what does not fit together between entries."""
        return connection_findings(raw)

    def sketch(self) -> Graph:
        """Return that the world is drawn as a graph."""
        return Graph(())

    def build(self, generator: Generator) -> World:
        """Return the world; ``generator`` is not touched."""
        from rl_tui.worlds.mdp.tabular_mdp import Transition, tabular_mdp

        mentioned = [name for each in self.transition for name in (each.state, *each.to)]
        seen = _in_order(map(self._look, [*self.place, *mentioned]))
        states = _in_order(sorted(mentioned, key=lambda name: seen[self._look(name)]))
        actions = _in_order(each.action for each in self.transition)
        names = [self._look(name) for name in states]
        is_plain = len(seen) == len(states)
        mdp = tabular_mdp(
            names if is_plain else list(states),
            list(actions),
            (
                Transition(
                    states[each.state], actions[each.action], each.outcomes(states, actions[each.action])
                )
                for each in self.transition
            ),
            {states[name]: probability for name, probability in self.start.items()},
            self.time_limit,
        )
        if is_plain:
            return World(mdp, Graph(self._places(names)))
        from rl_tui.worlds.sections.mdp_observed import observed_world

        return observed_world(mdp, list(seen), [seen[name] for name in names], Graph(self._places(seen)))

    def _look(self, name: str) -> str:
        return self.seen_as.get(name, name)

    def _places(self, states: Iterable[str]) -> tuple[tuple[int, int], ...]:
        """Return (column, row) of each state as it is seen; those without one fill rows below the others."""
        states = list(states)
        place = {self._look(name): at for name, at in reversed(self.place.items())}
        place |= {name: at for name, at in self.place.items() if name in states}
        width = max(1, round(len(states) ** 0.5))
        below = 1 + max((row for _, row in place.values()), default=-1)
        unplaced = [state for state in states if state not in place]
        free = {state: (i % width, below + i // width) for i, state in enumerate(unplaced)}
        return tuple(place.get(state) or free[state] for state in states)


def _in_order(names: Iterable[str]) -> dict[str, int]:
    """Return each name once, in the order of first mention, with its index."""
    return {name: index for index, name in enumerate(dict.fromkeys(names))}
