"""The world of a script."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from keyword import iskeyword
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.runs.export.literals import WIDEST, listed, literal, packed, table
from rl_tui.runs.export.template import (
    FIELDS,
    NOISY_FIELDS,
    TEXTS,
    WorldText,
    arrow,
    between,
    environment,
    fill,
    sections,
)
from rl_tui.runs.recipe import Recipe
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.grid.map import LegendEntry, lines_of
from rl_tui.worlds.grid.moves import MOVES, STEPS
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.gym.registered import made, time_limit_of
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.sections.bandit_section import BERNOULLI, BanditSection
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from gymnasium import Env
    from numpy.random import Generator

    from rl_tui.worlds.gym.bins import BinsSection


def world_text(recipe: Recipe, world: World) -> WorldText:
    """Return the world of `recipe` as text. Raises UserError."""
    section = recipe.scenario.section
    if isinstance(section, GymnasiumSection):
        return _gymnasium_text(section, world)
    if isinstance(section, GridSection):
        return _grid_text(section, streams(recipe.seed).world)
    if world.prospects:
        raise UserError(f"no script for {recipe.scenario.id}: the agent cannot tell some of its states apart")
    if world.mdp is None:
        raise UserError(f"no script for {recipe.scenario.id}: its transitions are unknown")
    if isinstance(section, BanditSection):
        return _bandit_text(section, world.mdp)
    return _table_text(world.mdp)


# Maps: a table of all outcomes is up to thirty times longer, and readers could not edit the map


MOST_ROWS: Final = 60
MOST_COLUMNS: Final = 90


def _grid_text(section: GridSection, generator: Generator) -> WorldText:
    _check_size(section)
    cells = section.cells(generator)
    rows = ["".join(cells.characters[code] for code in row) for row in cells.codes]
    meaning = dict(zip(cells.characters, cells.entries, strict=True))
    there = {each: meaning[each] for each in sorted(set("".join(rows)))}
    starts = _characters(there, lambda entry: entry.kind is CellKind.START)
    moves = {name: STEPS[name] for name in MOVES[section.moves]}
    arrows = [arrow(step, name) for name, step in moves.items()]
    rules = _rules(section, there)
    flags = {name for name, value in rules.items() if value}
    if section.gusts and flags & {"wind", "wind_rows"}:
        flags.add("gusts")
    pieces = {
        **{name: literal(value) for name, value in rules.items()},
        "map": "\n".join(["MAP = [", *(f"    {literal(row)}," for row in rows), "]"]),
        "moves": table(moves, "MOVES = "),
        "arrows": literal(arrows),
        "starts": literal(starts),
        "when": section.rewards,
        "reward": _reward(section, flags),
        "next_state": "next_state" if "back" in flags else "entered",
        "is_end": "at(entered) in ENDS" if "ends" in flags else "False",
        "land": _landing(flags),
    }
    states, actions = "ROWS * COLUMNS", "len(NAMES)"
    one_start = sum(row.count(each) for row in rows for each in starts) == 1
    start = "STARTS[0]" if one_start else "int(self.np_random.choice(STARTS))"
    world = environment(states, actions, start, time_limit=section.time_limit)
    if "exits" in flags:
        sizes = {"state": "s", "states": f"range({states})"}
        sizes["actions_of_state"] = f"1 if at(s) in EXITS else {actions}"
    else:
        sizes = {"states": states, "actions": actions}
    shown = rules["walls"] + rules["ends"] + rules["exits"]
    return WorldText(
        setup=f"{fill(sections(f'{__package__}.grid', flags)['setup'], pieces)}\n\n\n{world}",
        new_table=fill(TEXTS["ragged" if "exits" in flags else "array"], sizes),
        report=TEXTS["arrows on a map"],
        report_pieces={"shown": literal(shown), "between": between(arrows)},
        starts="STARTS",
        truncates=section.time_limit > 0,
        remarks=("The map was drawn for this seed.",) if section.random else (),
    )


def _check_size(section: GridSection) -> None:
    if section.random is not None:
        rows, columns = section.random.rows, section.random.columns
    else:
        lines = lines_of(section.map)
        rows, columns = len(lines), len(lines[0])
    if rows > MOST_ROWS or columns > MOST_COLUMNS:
        raise UserError(
            f"this map has {rows:,} × {columns:,} cells, too many for a readable script: at most "
            f"{MOST_ROWS} × {MOST_COLUMNS}"
        )


def _characters(there: Mapping[str, LegendEntry], quality: Callable[[LegendEntry], bool]) -> str:
    return "".join(each for each, entry in there.items() if quality(entry))


def _rules(section: GridSection, there: Mapping[str, LegendEntry]) -> dict[str, Any]:
    turns = [(slip.turn, slip.probability) for slip in section.slips]
    paying = {each: entry for each, entry in there.items() if not entry.is_wall and entry.pays}
    return {
        "walls": _characters(there, lambda entry: entry.is_wall),
        "ends": _characters(there, lambda entry: not entry.is_wall and entry.ends),
        "exits": _characters(there, lambda entry: entry.exit),
        "jumps": {each: entry.jump for each, entry in there.items() if entry.jump is not None},
        "back": _characters(there, lambda entry: entry.back),
        "only": {each: list(entry.only) for each, entry in there.items() if entry.only is not None},
        "pays": {each: float(entry.pays) for each, entry in paying.items()},
        "step_reward": section.step_reward,
        "bump_reward": section.bump_reward,
        "turns": turns if len(turns) > 1 else [],
        "wind": section.wind if any(section.wind) else [],
        "wind_rows": section.wind_rows if any(section.wind_rows) else [],
    }


def _reward(section: GridSection, flags: set[str]) -> str:
    cell = "state" if section.rewards == "leaving" else "entered"
    paid = f"REWARD.get(at({cell}), 0.0)" if "pays" in flags else ""
    if paid and cell == "entered" and "exits" in flags:
        paid = f"(0.0 if at(entered) in EXITS else {paid})"
    step = "STEP_REWARD" if "step_reward" in flags else ""
    return " + ".join(filter(None, (paid, step))) or "0.0"


def _landing(flags: set[str]) -> str:
    name = "NAMES[(action + turn) % len(NAMES)]" if "turns" in flags else "NAMES[action]"
    gusts = ", gust, side_gust" if "gusts" in flags else ""
    return f"{'*' if 'bump_reward' in flags else ''}land(state, {name}{gusts})"


# Environments of Gymnasium


_GYMNASIUM_TEXTS: Final = sections(f"{__package__}.gymnasium")
_LETTERS: Final = {
    CellKind.START: "S",
    CellKind.FLOOR: ".",
    CellKind.GOAL: "G",
    CellKind.HOLE: "H",
    CellKind.WALL: "#",
    CellKind.CLIFF: "C",
}
_NATURALS: Final = "A dealt 21 (a natural) is the same state here as any other 21 with a usable ace."
_LOOKUP_IMPORT: Final = "from collections import defaultdict"


def _gymnasium_text(section: GymnasiumSection, world: World) -> WorldText:
    with closing(made(section.id, section.kwargs)) as environment:
        has_table = world.mdp is not None and hasattr(environment.unwrapped, "P")
        if int(environment.action_space.start) != 0:
            raise UserError(f"no script for {section.id}: its actions are not numbered from 0")
        make = _make(section)
        truncates = time_limit_of(environment) > 0
        if has_table:
            return _tabular(world, make, truncates)
        setup, imports = _observed(section, environment, make)
    names = listed(map(literal, world.space.action_names), before="NAMES = ")
    return WorldText(
        setup=f"{setup}\n{names}",
        new_table=fill(TEXTS["lookup"], {"actions": "len(NAMES)"}),
        report=TEXTS["state by state"],
        report_pieces={"states": "sorted(Q)"},
        truncates=truncates,
        imports=(*imports, _LOOKUP_IMPORT),
        remarks=(_NATURALS,) if world.mdp is not None else (),
    )


def _make(section: GymnasiumSection) -> str:
    plain = {key: value for key, value in section.kwargs.items() if key.isidentifier() and not iskeyword(key)}
    others = {key: value for key, value in section.kwargs.items() if key not in plain}
    given = [f"{key}={literal(value)}" for key, value in plain.items()]
    rest = [f"**{literal(others)}"] if others else []
    return listed([literal(section.id), *given, *rest], "(", ")", "gym.make")


def _tabular(world: World, make: str, truncates: bool) -> WorldText:
    setup = [f"env = {make}"]
    grid = world.drawing
    report, pieces = TEXTS["state by state"], {"states": "range(len(Q))"}
    if isinstance(grid, Grid) and grid.cell_of_state == tuple(range(len(grid.kinds))):
        arrows = list(map(arrow, grid.directions, world.space.action_names))
        setup += _map(grid, world.space.action_names, arrows)
        report, pieces = TEXTS["arrows on a map"], {"shown": '"HGC#"', "between": between(arrows)}
    else:
        setup.append(listed(map(literal, world.space.action_names), before="NAMES = "))
    sizes = {"states": "env.observation_space.n", "actions": "env.action_space.n"}
    return WorldText(
        setup="\n".join(setup),
        new_table=fill(TEXTS["array"], sizes),
        report=report,
        report_pieces=pieces,
        model=_GYMNASIUM_TEXTS["model"],
        starts="np.flatnonzero(env.unwrapped.initial_state_distrib).tolist()",
        truncates=truncates,
    )


def _map(grid: Grid, action_names: Sequence[str], arrows: Sequence[str]) -> list[str]:
    letters = "".join(_LETTERS[kind] for kind in grid.kinds)
    rows = [letters[first : first + grid.columns] for first in range(0, len(letters), grid.columns)]
    return [
        f"# The actions 0, 1, ...: {', '.join(action_names)}",
        listed(map(literal, arrows), before="ARROWS = "),
        "MAP = [  # only to draw the policy",
        *(f"    {literal(row)}," for row in rows),
        "]",
    ]


def _observed(
    section: GymnasiumSection, environment: Env[Any, Any], make: str
) -> tuple[str, tuple[str, ...]]:
    from gymnasium import spaces

    space = environment.observation_space
    if section.bins is not None and isinstance(space, spaces.Box):
        edges = listed(_edges(section.bins, space), before="EDGES = ")
        return fill(_GYMNASIUM_TEXTS["bins"], {"edges": edges, "made": make}), ("from bisect import bisect",)
    if isinstance(space, spaces.MultiDiscrete | spaces.MultiBinary):
        return fill(_GYMNASIUM_TEXTS["numbers"], {"made": make}), ()
    flat = isinstance(space, spaces.Tuple) and all(isinstance(each, spaces.Discrete) for each in space.spaces)
    if flat or isinstance(space, spaces.Discrete):
        return f"env = {make}", ()
    raise UserError(
        f"no script for {section.id}: its observations are {type(space).__name__}, which have several parts"
    )


def _edges(bins: BinsSection, space: Any) -> list[str]:
    if bins.edges is not None:
        return [literal([float(edge) for edge in inner]) for inner in bins.edges]
    low, high = bins.low or space.low.ravel().tolist(), bins.high or space.high.ravel().tolist()
    return [
        "[]" if count == 1 else f"np.linspace({least:.8g}, {most:.8g}, {count + 1})[1:-1]"
        for least, most, count in zip(low, high, bins.count or (), strict=True)
        if not (count > 1 and math.isinf(least))
    ]


# Bandits


def _bandit_text(section: BanditSection, mdp: TabularMDP) -> WorldText:
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


# Worlds written as tables of outcomes


MOST_OUTCOMES: Final = 2_000


def _table_text(mdp: TabularMDP) -> WorldText:
    if len(mdp.next_state) > MOST_OUTCOMES:
        raise UserError(
            f"this world has {len(mdp.next_state):,} outcomes, too many for a readable script: at "
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
    """Return True if episodes may end in nonterminal states."""
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
    names = [literal(mdp.state_names[int(state)]) for state in mdp.start_state]
    places = [f"STATES.index({name})" for name in names]
    if len(places) == 1:
        return places[0], f"[{places[0]}]"
    chances = ", ".join(repr(float(each)) for each in mdp.start_probability)
    starts = f"[STATES.index(name) for name in [{', '.join(names)}]]"
    return f"int(self.np_random.choice({starts}, p=[{chances}]))", starts
