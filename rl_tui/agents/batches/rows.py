"""NamedTuples stacked into one, with one row per run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar, cast

import numpy as np
from numpy.random import Generator

from rl_tui.agents.kernels.compiled import inlined

Part = TypeVar("Part")


def stacked(parts: Sequence[Part], counts: Sequence[int]) -> Part:
    """Return one NamedTuple with ``counts[i]`` rows of ``parts[i]``, in order, [B, …].

    Numbers become arrays of one dimension. Read-only arrays stay read-only.
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
    """Return row `run` of a stacked NamedTuple as views."""
    return type(stack)(*(row(each, run) if isinstance(each, tuple) else each[run] for each in stack))


@inlined
def generator_at(generator: Generator, address: int) -> Generator:
    """Return a generator with its state at `address`, in machine code only.

    See :func:`rl_tui.agents.batches.seeding.streams_of`.
    """
    raise NotImplementedError
