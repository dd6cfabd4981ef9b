"""The transition table of a world as plain Python: as Gymnasium's toy_text has it, and to draw from."""

from __future__ import annotations

from typing import NamedTuple

from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

Entry = tuple[float, int, float, bool]
"""probability, next state, mean reward, whether the episode ends: as in Gymnasium's toy_text."""


class PairRow(NamedTuple):
    """What may happen when one action is taken in one state.

    ``cumulative`` and ``reward_std`` are as long as ``entries``; ``pair`` is None where nothing can be done.
    """

    entries: list[Entry]
    cumulative: list[float]
    reward_std: list[float]
    pair: int | None


def rows_of(mdp: TabularMDP, state: int) -> list[PairRow]:
    """Return the row of each of the A actions in ``state``.

    An action that is not legal there does what the first legal one does. A state in which nothing can be done
    leads to itself for 0, and the episode stays over.
    """
    pairs = mdp.pairs_of(state)
    if not pairs:
        return [PairRow([(1.0, state, 0.0, True)], [1.0], [0.0], None)] * len(mdp.action_names)
    legal = {int(mdp.pair_action[pair]): _row(mdp, pair) for pair in pairs}
    first = next(iter(legal.values()))
    return [legal.get(action, first) for action in range(len(mdp.action_names))]


def table_of(mdp: TabularMDP) -> dict[int, dict[int, list[Entry]]]:
    """Return state → action → entries, for every state and action."""
    return {
        state: {action: list(row.entries) for action, row in enumerate(rows_of(mdp, state))}
        for state in range(mdp.states)
    }


def _row(mdp: TabularMDP, pair: int) -> PairRow:
    here = slice(int(mdp.first_outcome[pair]), int(mdp.first_outcome[pair + 1]))
    columns = (each[here].tolist() for each in (mdp.probability, mdp.next_state, mdp.reward, mdp.terminated))
    return PairRow(
        list(zip(*columns, strict=True)), mdp.cumulative[here].tolist(), mdp.reward_std[here].tolist(), pair
    )
