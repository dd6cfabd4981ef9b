"""What machine code has in place of the Python of some inlined functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from numba import types
from numpy.random import Generator

from rl_tui.agents.batches.rows import generator_at, row
from rl_tui.agents.compiling.pcg64 import next_uniform, with_state_at
from rl_tui.agents.kernels.draws import uniform
from rl_tui.common.streams import has_low_word_first

Implementation = Callable[..., Any]


def _uniform(generator: Generator) -> float:
    return next_uniform(generator)  # type: ignore[no-any-return]


def _generator_at(generator: Generator, address: int) -> Generator:
    return with_state_at(generator, address)  # type: ignore[no-any-return]


def _row_of(stack: Any, _: Any) -> Implementation:
    """Return what takes a row of a NamedTuple of this type, written out field by field."""
    names = list(stack.instance_class._fields)
    parts = [
        f"row(stack.{name}, run)" if isinstance(part, types.BaseNamedTuple) else f"stack.{name}[run]"
        for name, part in zip(names, stack.types, strict=True)
    ]
    found: dict[str, Any] = {"row": row, "kind": stack.instance_class}
    exec(f"def row_of(stack, run):\n    return kind({', '.join(parts)})\n", found)
    implementation: Implementation = found["row_of"]
    return implementation


def always(implementation: Implementation) -> Callable[..., Implementation]:
    """Return what chooses ``implementation`` whatever the types are."""
    return lambda *_: implementation


NATIVE: Final[dict[Implementation, Callable[..., Implementation]]] = {
    row: _row_of,
    generator_at: always(_generator_at),
} | ({uniform: always(_uniform)} if has_low_word_first() else {})
"""For each function what chooses its implementation by the types of its arguments."""
