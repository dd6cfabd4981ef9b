"""Many of the NamedTuples that a kernel takes as one whose arrays have a row for each run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar, cast

import numpy as np
from numpy.random import Generator

from rl_tui.agents.kernels.compiled import inlined

Part = TypeVar("Part")


def stacked(parts: Sequence[Part], counts: Sequence[int]) -> Part:
    """Return one NamedTuple with ``counts[i]`` rows of ``parts[i]``, one after the other, [B, …] each.

    What is a number in ``parts`` is an array of one dimension in it. What cannot be written to stays so.
    """
    first: Any = parts[0]
    if isinstance(first, tuple):
        columns: Any = zip(*cast("Sequence[tuple[Any, ...]]", parts), strict=True)
        make: Any = type(first)
        return cast("Part", make(*(stacked(column, counts) for column in columns)))
    rows: Any = np.repeat(np.stack([np.asarray(part) for part in parts]), counts, axis=0)
    rows.flags.writeable = not isinstance(first, np.ndarray) or first.flags.writeable
    return cast("Part", rows)


@inlined
def row(stack: Any, run: int) -> Any:
    """Return row ``run`` of what :func:`stacked` returned, as a view: what the kernels of one run take."""
    return type(stack)(*(row(each, run) if isinstance(each, tuple) else each[run] for each in stack))


@inlined
def generator_at(generator: Generator, address: int) -> Generator:
    """Return a generator that works as ``generator`` does with the memory at ``address``.

    It is for machine code alone: see :func:`rl_tui.agents.batches.seeding.streams_of`.
    """
    raise NotImplementedError
