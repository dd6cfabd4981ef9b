"""The parts of the text of a world, of every kind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

from rl_tui.lab.export.template import fill, sections

TEXTS: Final = sections(f"{__package__}.world")
FIELDS: Final = "probability, next_state, reward, terminated"
NOISY_FIELDS: Final = f"{FIELDS}, noise"


@dataclass(frozen=True, slots=True)
class WorldText:
    """A world in the words of a script.

    ``setup`` makes ``env``. ``outcomes(state, action)``, for those who plan, gives ``fields``; it is there
    already or comes with ``model``. ``starts`` is the expression of the states to start in, empty where
    there is no model. ``new_table`` makes a table of estimates. ``report`` prints the policy, once
    ``report_pieces`` and ``$equals``, which values are equally good, are filled in.
    ``truncates`` says whether episodes are cut off. ``imports`` are lines, ``remarks`` sentences for the head
    of the script.
    """

    setup: str
    new_table: str
    report: str
    model: str = ""
    starts: str = ""
    fields: str = FIELDS
    report_pieces: Mapping[str, str] = field(default_factory=dict)
    truncates: bool = False
    imports: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def environment(states: str, actions: str, start: str, *, fields: str = FIELDS, time_limit: int = 0) -> str:
    """Return the class that steps through ``outcomes``, and ``env``; the first three are expressions."""
    flags = {"noise"} if fields == NOISY_FIELDS else set()
    pieces = {"states": states, "actions": actions, "start": start, "fields": fields}
    text = sections(f"{__package__}.world", {*flags, "time limit"} if time_limit else flags)["environment"]
    return fill(text, {**pieces, "time_limit": str(time_limit)})


def between(arrows: Iterable[str]) -> str:
    """Return, as a literal, what stands between moves that are equally good: some are two characters."""
    return '""' if all(len(each) == 1 for each in arrows) else '"/"'


def arrow(step: tuple[int, int] | None, name: str) -> str:
    """Return a move as characters that every terminal has; another action by its first letter."""
    if step is None:
        return name[:1]
    down, right = step
    return {-1: "^", 0: "", 1: "v"}[down] + {-1: "<", 0: "", 1: ">"}[right] or "o"
