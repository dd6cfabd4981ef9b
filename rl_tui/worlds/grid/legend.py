"""What the characters of a ``[grid]`` map mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Final

from rl_tui.common.findings import Finding, shown
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.grid.moves import STEPS
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Number,
    TruthValue,
    is_plain,
    with_control_character,
)

KINDS: Final = tuple(kind.value for kind in CellKind)
_GOAL_REWARD: Final = 1.0


def is_character(value: object) -> bool:
    """Return whether a value can stand for a cell of a map."""
    return isinstance(value, str) and len(value) == 1 and is_plain(value)


def _are_moves(value: object) -> bool:
    return isinstance(value, list) and len(value) > 0 and all(each in tuple(STEPS) for each in value)


Character = Annotated[str, Expect("one character", is_character, with_control_character)]


class LegendEntry(FileSection):
    """What one character of a map stands for.

    ``reward`` is paid on entering or on leaving the cell, as the grid says (a goal pays 1 unless set
    otherwise). ``terminal`` ends the episode when the cell is entered, by default in goals and holes. With
    ``exit`` the cell can be entered, and its only action ends the episode and pays the reward. Every action
    from a cell with ``jump`` leads to the cell of that character. Entering a cell with ``back`` puts the
    agent at the start. In a cell with ``only`` the other moves stay put.
    """

    kind: Annotated[CellKind, Expect(f"one of {', '.join(KINDS)}", lambda value: value in KINDS)]
    reward: Number | None = None
    terminal: TruthValue | None = None
    exit: TruthValue = False
    jump: Character | None = None
    back: TruthValue = False
    only: Annotated[list[str], Expect(f"a list of moves, from {', '.join(STEPS)}", _are_moves)] | None = None

    @property
    def pays(self) -> float:
        """The reward of the cell."""
        if self.reward is not None:
            return self.reward
        return _GOAL_REWARD if self.kind is CellKind.GOAL else 0.0

    @property
    def ends(self) -> bool:
        """Whether entering the cell ends the episode."""
        if self.terminal is not None:
            return self.terminal
        return self.kind in (CellKind.GOAL, CellKind.HOLE) and not self.exit

    @property
    def is_wall(self) -> bool:
        """Whether the agent cannot be here."""
        return self.kind is CellKind.WALL


BUILT_IN: Final[Mapping[str, LegendEntry]] = {
    ".": LegendEntry(kind=CellKind.FLOOR),
    " ": LegendEntry(kind=CellKind.FLOOR),
    "S": LegendEntry(kind=CellKind.START),
    "G": LegendEntry(kind=CellKind.GOAL),
    "H": LegendEntry(kind=CellKind.HOLE),
    "#": LegendEntry(kind=CellKind.WALL),
    "<": LegendEntry(kind=CellKind.FLOOR, only=["left"]),
    ">": LegendEntry(kind=CellKind.FLOOR, only=["right"]),
    "^": LegendEntry(kind=CellKind.FLOOR, only=["up"]),
    "v": LegendEntry(kind=CellKind.FLOOR, only=["down"]),
}


def entry_findings(
    entry: LegendEntry, raw: Mapping[str, Any], moves: Sequence[str] | None
) -> Iterator[Finding]:
    """Yield what contradicts itself in one entry, located inside it."""
    if entry.is_wall:
        for key in raw:
            if key != "kind":
                yield Finding((key,), f"{key} in a wall", "nothing but the kind: nobody enters a wall")
        return
    if entry.kind is CellKind.START and entry.ends:
        yield Finding(("terminal",), "a start that is terminal", "a start in which something can be done")
    elif entry.ends:
        for key in ("exit", "jump", "only", "back"):
            if raw.get(key):
                yield Finding(
                    (key,), f"{key} in a terminal cell", f"no {key}, or a cell with terminal = false"
                )
    else:
        given = [key for key in ("exit", "jump", "only", "back") if raw.get(key)]
        if len(given) > 1:
            yield Finding((given[1],), f"{given[1]} beside {given[0]}", "one of the two")
    if entry.back and entry.kind is CellKind.START:
        yield Finding(("back",), "back in a start", "back in another cell")
    for name in entry.only or ():
        if moves is not None and name not in moves:
            yield Finding(("only",), shown(name), f"moves that the grid has: {', '.join(moves)}")
