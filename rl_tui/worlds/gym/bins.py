"""The ``[gymnasium.bins]`` table: it cuts a Box of real numbers into states.

This is state aggregation (Sutton & Barto, 2nd ed., section 9.3, there for values). Environments that are too
large are refused before memory is allocated.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Final

from rl_tui.common.findings import Finding, shown
from rl_tui.common.limits import MOST_ACTIONS, MOST_BINS, MOST_EDGES, MOST_PAIRS, MOST_PARTS, MOST_STATES
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Number,
    WorldRefusedError,
    is_number,
    number,
    sized,
    whole_number,
)

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from rl_tui.worlds.gym.states import BinStates


# Limits on size


_FAR_TOO_MANY: Final = 10**15


def combinations(sizes: Iterable[int]) -> int:
    """Return the product of `sizes`. Counting stops above 10^15."""
    product = 1
    for size in sizes:
        product *= size
        if product > _FAR_TOO_MANY:
            break
    return product


def check_sizes(name: str, states: int, actions: int, key: str) -> None:
    """Raise WorldRefusedError, naming `key` of the file, if an environment is too large."""
    for what, count, most in (
        ("states", states, MOST_STATES),
        ("actions", actions, MOST_ACTIONS),
        ("pairs of a state and an action", states * actions, MOST_PAIRS),
    ):
        if count > most:
            number = f"{count:,}" if count < _FAR_TOO_MANY else "more than 10^15"
            found = f"{number} {what} of {name}"
            raise WorldRefusedError((key,), found, f"at most {most:,}")


# The table


_MOST_TOLD: Final = 100
_MOST_DECIMALS: Final = 12
_USUAL_NAME: Final = " " * len("-0.055")
_FINEST: Final = 1e-14  # relative to the bounds; a double has 16 digits


def _is_list_of_edges(value: object) -> bool:
    # a long list gets one error, not one per entry
    return isinstance(value, list) and (
        len(value) <= _MOST_TOLD or (len(value) <= MOST_EDGES and all(map(is_number, value)))
    )


_IS_LIST: Final = sized(list, MOST_PARTS, 1)
_LIST: Final = Expect(f"a list with an entry for each dimension, at most {MOST_PARTS}", _IS_LIST)
Count = Annotated[int, whole_number(1, MOST_BINS)]
Edges = Annotated[list[Number], Expect(f"a list of at most {MOST_EDGES:,} numbers", _is_list_of_edges)]


class BinsSection(FileSection):
    """The bins of each dimension: `count` equal bins from `low` to `high`, or inner `edges`.

    Default bounds are those of the Box. Values outside fall into the outermost bins. A count of 1, or an
    empty list of edges, ignores a dimension.
    """

    low: Annotated[list[Number], _LIST] | None = None
    high: Annotated[list[Number], _LIST] | None = None
    count: Annotated[list[Count], _LIST] | None = None
    edges: Annotated[list[Edges], _LIST] | None = None

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield lists of different lengths, and empty bins."""
        if "edges" in raw:
            for key in ("low", "high", "count"):
                if key in raw:
                    yield Finding((key,), f"{key} and edges are both set; give edges, or low, high and count")
            yield from _edge_findings(raw["edges"])
            return
        if "count" not in raw:
            yield Finding(("count",), "nothing", "the number of bins of each dimension, or edges")
        yield from _length_findings(raw)
        low, high = raw.get("low"), raw.get("high")
        if isinstance(low, list) and isinstance(high, list):
            for dimension, (least, most) in enumerate(zip(low, high, strict=False)):
                if is_number(least) and is_number(most) and not least < most:
                    expected = f"more than low, which is {shown(least)}"
                    yield Finding(("high", dimension), shown(most), expected)

    @property
    def sizes(self) -> list[int]:
        """Number of bins of each dimension."""
        return self.count or [len(edges) + 1 for edges in self.edges or ()]

    def known_names(self) -> list[list[str]]:
        """Return the names of the bins, or blanks if the file has no bounds."""
        if self.edges is not None:
            return [_range_names(edges) for edges in self.edges]
        counts = self.count or []
        if self.low is None or self.high is None:
            return [[_USUAL_NAME] * count for count in counts]
        bounds = zip(self.low, self.high, counts, strict=False)
        return [_middle_names(low, (high - low) / count, count) for low, high, count in bounds]

    def states(self, name: str, space: Box) -> BinStates:
        """Return the states of a Box.

        Raises:
            WorldRefusedError: The bins do not fit the Box, or there are too many.
        """
        from rl_tui.worlds.gym.states import BinStates

        dimensions = math.prod(space.shape)
        key = "edges" if self.edges is not None else "count"
        given = len(self.edges or self.count or ())
        if given != dimensions:
            expected = f"{dimensions}, one for each dimension of {name}"
            raise WorldRefusedError(("bins", key), f"{given} entries", expected)
        check_sizes(name, combinations(self.sizes), 1, "bins")
        if self.edges is not None:
            return BinStates(self.edges, [_range_names(edges) for edges in self.edges])
        counts = self.count or []
        edges, names = [], []
        low = self.low or _bounds(name, "low", space.low, counts)
        high = self.high or _bounds(name, "high", space.high, counts)
        for dimension, count in enumerate(counts):
            least, most = low[dimension], high[dimension]
            if not least < most:
                expected = f"more than {least:g} in dimension {dimension}"
                raise WorldRefusedError(("bins", "high"), f"{most:g}", expected)
            width = (most - least) / count
            if width < _FINEST * max(abs(least), abs(most)) or width == 0.0:
                found = f"floating-point numbers cannot separate {count:,} bins from {least:g} to {most:g}"
                raise WorldRefusedError(("bins", "count", dimension), f"{found}; use fewer bins")
            edges.append([least + width * place for place in range(1, count)])
            names.append(_middle_names(least, width, count))
        return BinStates(edges, names)


def _edge_findings(edges: object) -> Iterator[Finding]:
    for dimension, here in enumerate(edges if isinstance(edges, list) else []):
        numbers = here if isinstance(here, list) and all(is_number(each) for each in here) else []
        if any(not left < right for left, right in pairwise(numbers)):
            yield Finding(("edges", dimension), shown(here), "edges in increasing order")


def _length_findings(raw: Mapping[str, Any]) -> Iterator[Finding]:
    count = raw.get("count")
    for key in ("low", "high"):
        values = raw.get(key)
        if isinstance(count, list) and isinstance(values, list) and len(values) != len(count):
            expected = f"as many as there are counts ({len(count)})"
            yield Finding((key,), f"{len(values)} numbers", expected)


def _bounds(name: str, key: str, values: Any, counts: Sequence[int]) -> list[float]:
    # They matter only in dimensions with several bins
    bounds: list[float] = values.ravel().astype(float).tolist()
    for dimension, count in enumerate(counts):
        if count == 1:
            bounds[dimension] = 0.0 if key == "low" else 1.0
        elif not number().test(bounds[dimension]):
            found = f"dimension {dimension} has no bound, here or in {name}"
            raise WorldRefusedError(("bins", key), f"{found}; give a number for each dimension")
    return bounds


def _middle_names(low: float, width: float, count: int) -> list[str]:
    # As few digits as keep them distinct
    middles = [low + width * (place + 0.5) for place in range(count)]
    fewest = max(-math.floor(math.log10(width)) - 1, 0)
    if fewest > _MOST_DECIMALS:
        return [repr(middle) for middle in middles]
    for digits in range(fewest, fewest + 4):
        names = [f"{middle:.{digits}f}" for middle in middles]
        apart = len(set(names)) == count
        if apart and all(abs(float(n) - m) <= 0.1 * width for n, m in zip(names, middles, strict=True)):
            break
    return [name.replace("-0", "0") if float(name) == 0.0 else name for name in names]


def _range_names(edges: Sequence[float]) -> list[str]:
    # <a, a..b, >=b
    if not edges:
        return ["any"]
    for digits in range(6, 18):
        shown_edges = [f"{edge:.{digits}g}" for edge in edges]
        if len(set(shown_edges)) == len(edges):
            break
    between = [f"{low}..{high}" for low, high in pairwise(shown_edges)]
    return [f"<{shown_edges[0]}", *between, f">={shown_edges[-1]}"]
