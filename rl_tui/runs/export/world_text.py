"""A world as the text of a script: a map, an environment of Gymnasium, a bandit, or a table of outcomes."""

from __future__ import annotations

from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.runs.export.literals import WIDEST, literal, packed
from rl_tui.runs.export.template import FIELDS, NOISY_FIELDS, TEXTS, WorldText, environment, fill, sections
from rl_tui.runs.recipe import Recipe
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.sections.bandit_section import BERNOULLI, BanditSection
from rl_tui.worlds.world import World

MOST_OUTCOMES: Final = 2_000


def world_text(recipe: Recipe, world: World) -> WorldText:
    """Return the text of the world of ``recipe``. Raises UserError where it is too large to be read."""
    from rl_tui.runs.export.grid_text import grid_text
    from rl_tui.runs.export.gymnasium_text import gymnasium_text
    from rl_tui.worlds.grid.section import GridSection
    from rl_tui.worlds.gym.section import GymnasiumSection

    section = recipe.scenario.section
    if isinstance(section, GymnasiumSection):
        return gymnasium_text(section, world)
    if isinstance(section, GridSection):
        return grid_text(section, streams(recipe.seed).world)
    if world.prospects:
        raise UserError(
            f"no script for {recipe.scenario.id}: some of its states look alike, scripts have all"
        )
    if world.mdp is None:
        raise UserError(f"no script for {recipe.scenario.id}: nobody knows what its actions lead to")
    if isinstance(section, BanditSection):
        return _bandit_text(section, world.mdp)
    return _table_text(world.mdp)


# Bandits


def _bandit_text(section: BanditSection, mdp: TabularMDP) -> WorldText:
    """Return the text of the bandit of ``section`` with the arms of ``mdp``."""
    flags = {"bernoulli": section.rewards == BERNOULLI, "drift": bool(section.drift)}
    texts = sections(f"{__package__}.bandit", {name for name, is_set in flags.items() if is_set})
    means = [
        sum(float(mdp.probability[each] * mdp.reward[each]) for each in mdp.outcomes_of(arm))
        for arm in range(mdp.pairs)
    ]
    pieces = {
        "means": packed(map(repr, means), "MEANS = "),
        "std": repr(section.std),
        "drift": repr(section.drift),
    }
    return WorldText(
        setup=fill(texts["setup"], pieces),
        new_table=fill(TEXTS["array"], {"states": "1", "actions": "len(MEANS)"}),
        report=texts["report"],
        model=texts["model"],
        starts="[0]",
        remarks=("The means of the arms, which the agent has to find out, are written in this script.",),
    )


# Worlds whose states, actions and outcomes are written out


def _table_text(mdp: TabularMDP) -> WorldText:
    """Return the text of the world of ``mdp``; raises UserError where it would be too long to read."""
    if len(mdp.next_state) > MOST_OUTCOMES:
        raise UserError(
            f"this world has {len(mdp.next_state):,} outcomes, too many for a script that one can read: at "
            f"most {MOST_OUTCOMES:,}"
        )
    noisy = bool(mdp.reward_std.any())
    texts = sections(f"{__package__}.table", {"nowhere"} if _ends_nowhere(mdp) else ())
    pieces = {
        "noise_term": ", its noise" if noisy else "",
        "noise": ", noise" if noisy else "",
        "table": _table(mdp, noisy),
    }
    fields = NOISY_FIELDS if noisy else FIELDS
    start, starts = _start(mdp)
    world = environment(
        "len(STATES)", "max(map(len, WORLD.values()))", start, fields=fields, time_limit=mdp.time_limit
    )
    own_length = {"actions_of_state": "len(WORLD[name])", "state": "name", "states": "STATES"}
    return WorldText(
        setup=f"{fill(texts['setup'], pieces)}\n\n\n{world}",
        new_table=fill(TEXTS["ragged"], own_length),
        report=texts["report"],
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
