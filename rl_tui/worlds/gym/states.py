"""Conversion of observations to states numbered from 0."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, overload

import numpy as np

from rl_tui.common.limits import MOST_PARTS
from rl_tui.worlds.mdp.space import NumberNames

if TYPE_CHECKING:
    from gymnasium import Space

Reader = Callable[[Any], Iterable[Any]]


class OutsideError(Exception):
    """An observation outside its space."""


class ObservationPart(NamedTuple):
    """A discrete part with the values first .. first + size − 1."""

    first: int
    size: int


class ProductNames(Sequence[str]):
    """Names of all combinations of named parts, the last part changing fastest.

    Each is made on access. Parts with a single value are left out.
    """

    def __init__(self, parts: Sequence[Sequence[str]]) -> None:
        self._parts = tuple(parts)
        self._shown = tuple(len(part) > 1 for part in self._parts)
        self._length = math.prod(len(part) for part in self._parts)

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, index: int) -> str: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[str]: ...

    def __getitem__(self, index: int | slice) -> str | Sequence[str]:
        """Return the name of a state."""
        if isinstance(index, slice):
            return tuple(self[each] for each in range(*index.indices(self._length)))
        left = range(self._length)[index]
        names = []
        for part, is_shown in zip(reversed(self._parts), reversed(self._shown), strict=True):
            left, place = divmod(left, len(part))
            if is_shown:
                names.append(part[place])
        return ", ".join(reversed(names)) or self._parts[-1][0]


class States(Protocol):
    """The conversion of observations, with ``sizes[i]`` values of part i, to states."""

    sizes: Sequence[int]

    @property
    def part_names(self) -> Sequence[Sequence[str]]:
        """Names of the values of each part."""
        ...

    def state_of(self, observation: Any) -> int:
        """Return the state of an observation.

        Raises:
            OutsideError: The observation is outside the space. TypeError and ValueError mean the same.
        """


class DiscreteStates:
    """All combinations of the discrete parts of a space."""

    def __init__(self, parts: Sequence[ObservationPart], read: Reader) -> None:
        self.sizes: Sequence[int] = [part.size for part in parts]
        self._parts = tuple(parts)
        self._read = read

    @property
    def part_names(self) -> Sequence[Sequence[str]]:
        """Numbers of each part, eight bytes each. Check the sizes first."""
        return [NumberNames(np.arange(first, first + size)) for first, size in self._parts]

    def state_of(self, observation: Any) -> int:
        """Return the number of this combination, or raise OutsideError."""
        state = 0
        for value, (first, size) in zip(self._read(observation), self._parts, strict=True):
            place = int(value) - first
            if place + first != value or not 0 <= place < size:
                raise OutsideError
            state = state * size + place
        return state


class BinStates:
    """All combinations of bins, with rising inner `edges` per dimension."""

    def __init__(self, edges: Sequence[Sequence[float]], names: Sequence[Sequence[str]]) -> None:
        self.part_names = names
        self.sizes: Sequence[int] = [len(part) for part in names]
        self._bins = [(each, len(each) + 1) for each in edges]

    @property
    def middles(self) -> tuple[tuple[float, ...], ...]:
        """Middle of each bin, or NaN for fewer than two edges."""
        return tuple(_middles(edges) for edges, _ in self._bins)

    def state_of(self, observation: Any) -> int:
        """Return the state of an observation. NaN raises OutsideError, and an edge belongs above."""
        state = 0
        numbers = np.ravel(observation).tolist()
        for value, (edges, count) in zip(numbers, self._bins, strict=True):
            if value != value:
                raise OutsideError
            state = state * count + bisect_right(edges, value)
        return state


def _middles(edges: Sequence[float]) -> tuple[float, ...]:
    # Outer bins are as wide as their neighbours. Without neighbours the middle is NaN
    if len(edges) < 2:
        return (math.nan,) * (len(edges) + 1)
    low, high = 2 * edges[0] - edges[1], 2 * edges[-1] - edges[-2]
    return tuple((left + right) / 2 for left, right in pairwise((low, *edges, high)))


def discrete_states(space: Space[Any]) -> DiscreteStates | None:
    """Return the states of a space, or None if it is not discrete."""
    found = _parts_of(space)
    return None if found is None else DiscreteStates(*found)


def _parts_of(space: Space[Any]) -> tuple[list[ObservationPart], Reader] | None:
    from gymnasium import spaces

    if isinstance(space, spaces.Discrete):
        return [ObservationPart(int(space.start), int(space.n))], lambda observation: (observation,)
    if isinstance(space, spaces.MultiDiscrete):
        numbers = zip(np.ravel(space.start).tolist(), np.ravel(space.nvec).tolist(), strict=True)
        return [ObservationPart(first, size) for first, size in numbers], _flat
    if isinstance(space, spaces.MultiBinary):
        # more parts are too many states anyway
        return [ObservationPart(0, 2)] * min(math.prod(space.shape), MOST_PARTS), _flat
    if isinstance(space, spaces.Tuple):
        return _together([_parts_of(each) for each in space.spaces], lambda observation: observation)
    if isinstance(space, spaces.Dict):
        keys = list(space.spaces)
        inner = [_parts_of(each) for each in space.spaces.values()]
        return _together(inner, lambda observation: [observation[key] for key in keys])
    return None


def _flat(observation: Any) -> list[Any]:
    numbers: list[Any] = np.ravel(observation).tolist()
    return numbers


def _together(
    inner: Sequence[tuple[list[ObservationPart], Reader] | None], split: Callable[[Any], Sequence[Any]]
) -> tuple[list[ObservationPart], Reader] | None:
    # `split` divides an observation among the spaces
    known = [each for each in inner if each is not None]
    if len(known) < len(inner) or not known:
        return None
    readers = [read for _, read in known]

    def read_all(observation: Any) -> list[Any]:
        pieces = zip(readers, split(observation), strict=True)
        return [value for read, piece in pieces for value in read(piece)]

    return [part for parts, _ in known for part in parts], read_all
