"""A world whose states, actions and outcomes are written out, as the text of a script."""

from __future__ import annotations

from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.lab.export.literals import WIDEST, literal
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds.text import (
    ENVIRONMENT,
    FIELDS,
    NOISE,
    NOISY_FIELDS,
    RAGGED,
    WorldText,
    limited,
)
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_OUTCOMES: Final = 2_000

SETUP: Final = """
# State: action: [(probability, next state, reward$noise_term), ...]
# A state without actions is an end$no_state
$table
STATES = list(WORLD)  # a state is a number: its place in this list; so is an action, in its state


def outcomes(state, action):
    # All that may happen: (probability, next state, reward, whether the episode ends$noise_too)
    possible = list(WORLD[STATES[state]].values())[action]
    return [
        $each
        for $fields in possible
    ]
"""
PLAIN: Final = "(p, STATES.index(to), reward, not WORLD[to]$noise)"
WITH_NO_STATE: Final = "(p, state if to is None else STATES.index(to), reward, not WORLD.get(to)$noise)"

REPORT: Final = """
for name, values in zip(STATES, Q):
    if len(values):
        actions = list(WORLD[name])
        best = np.flatnonzero($equals)
        print(f"{name}: {', '.join(actions[a] for a in best)}")
"""


def table_text(mdp: TabularMDP) -> WorldText:
    """Return the text of the world of ``mdp``; raises UserError where it would be too long to read."""
    if len(mdp.next_state) > MOST_OUTCOMES:
        raise UserError(
            f"this world has {len(mdp.next_state):,} outcomes, too many for a script that one can read: at "
            f"most {MOST_OUTCOMES:,}"
        )
    noisy = bool(mdp.reward_std.any())
    nowhere = _ends_nowhere(mdp)
    noise = {"noise": ", noise" if noisy else ""}
    pieces = {
        "noise_term": ", its noise" if noisy else "",
        "noise_too": ", noise" if noisy else "",
        "no_state": "; None is the end as well" if nowhere else "",
        "table": _table(mdp, noisy),
        "each": fill(WITH_NO_STATE if nowhere else PLAIN, noise),
        "fields": "p, to, reward, noise" if noisy else "p, to, reward",
    }
    fields = NOISY_FIELDS if noisy else FIELDS
    start, starts = _start(mdp)
    environment = fill(
        ENVIRONMENT,
        {
            "states": "len(STATES)",
            "actions": "max(map(len, WORLD.values()))",
            "start": start,
            "fields": fields,
            "noise": NOISE if noisy else "",
            "environment": limited(mdp.time_limit),
        },
    )
    return WorldText(
        setup=f"{fill(SETUP, pieces)}\n\n\n{environment}",
        new_table=fill(RAGGED, {"actions_of_state": "len(WORLD[name])", "state": "name", "states": "STATES"}),
        report=REPORT.strip("\n"),
        starts=starts,
        fields=fields,
        truncates=mdp.time_limit > 0,
    )


def _ends_nowhere(mdp: TabularMDP) -> bool:
    """Return whether an episode may end in a state in which one could go on."""
    owned = mdp.first_pair[1:] > mdp.first_pair[:-1]
    return bool((mdp.terminated & owned[mdp.next_state]).any())


def _table(mdp: TabularMDP, noisy: bool) -> str:
    used = {*mdp.start_state.tolist(), *mdp.next_state.tolist(), *mdp.pair_state.tolist()}
    lines = ["WORLD = {"]
    for state in sorted(used):
        pairs = mdp.pairs_of(state)
        name = literal(mdp.state_names[state])
        if not pairs:
            lines.append(f"    {name}: {{}},")
            continue
        lines.append(f"    {name}: {{")
        for pair in pairs:
            lines += _action(mdp, pair, noisy)
        lines.append("    },")
    return "\n".join([*lines, "}"])


def _action(mdp: TabularMDP, pair: int, noisy: bool) -> list[str]:
    action = literal(mdp.action_names[int(mdp.pair_action[pair])])
    outcomes = [_outcome(mdp, each, noisy) for each in mdp.outcomes_of(pair)]
    line = f"        {action}: [{', '.join(outcomes)}],"
    if len(line) <= WIDEST:
        return [line]
    return [f"        {action}: [", *(f"            {each}," for each in outcomes), "        ],"]


def _outcome(mdp: TabularMDP, outcome: int, noisy: bool) -> str:
    next_state = int(mdp.next_state[outcome])
    nowhere = bool(mdp.terminated[outcome]) and bool(mdp.pairs_of(next_state))
    parts: list[object] = [
        float(mdp.probability[outcome]),
        None if nowhere else mdp.state_names[next_state],
        float(mdp.reward[outcome]),
    ]
    if noisy:
        parts.append(float(mdp.reward_std[outcome]))
    return literal(tuple(parts))


def _start(mdp: TabularMDP) -> tuple[str, str]:
    """Return the expressions of one start and of all of them."""
    names = [literal(mdp.state_names[int(state)]) for state in mdp.start_state]
    places = [f"STATES.index({name})" for name in names]
    if len(places) == 1:
        return places[0], f"[{places[0]}]"
    chances = ", ".join(repr(float(each)) for each in mdp.start_probability)
    starts = f"[STATES.index(name) for name in [{', '.join(names)}]]"
    return f"int(self.np_random.choice({starts}, p=[{chances}]))", starts
