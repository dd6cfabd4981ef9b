"""The uniform draw that nearly every step needs."""

from __future__ import annotations

from numpy.random import Generator

from rl_tui.agents.kernels.compiled import inlined


@inlined
def uniform(generator: Generator) -> float:
    """Return a draw from [0, 1). Machine code steps the PCG64 directly, with the same bits.

    A call of the generator would cost as much as the rest of a step; see
    :mod:`rl_tui.agents.compiling.native`.
    """
    return generator.random()
