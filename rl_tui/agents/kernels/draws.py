"""The one draw that nearly every step needs, uniform on [0, 1)."""

from __future__ import annotations

from numpy.random import Generator

from rl_tui.agents.kernels.compiled import inlined


@inlined
def uniform(generator: Generator) -> float:
    """Return a draw from [0, 1); machine code steps the PCG64 of ``generator`` in place, with the same bits.

    See :mod:`rl_tui.agents.compiling.native`: a call to the generator costs as much as all else in a step.
    """
    return generator.random()
