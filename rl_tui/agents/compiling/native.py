"""Replacements for some inlined functions in machine code, mainly PCG64.

M. E. O'Neill, *PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
Generation* (2014): a 128-bit linear congruential generator with XSL-RR output. NumPy's generator keeps the
state.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.random import Generator

from rl_tui.agents.batches.rows import generator_at, row
from rl_tui.agents.kernels.draws import uniform
from rl_tui.common.streams import has_low_word_first

# PCG64


MULTIPLIER: Final = 0x2360ED051FC65DA44385DF649FCCF645
_BITS: Final = types.NumPyRandomBitGeneratorType("bit_generator")
_I64, _I128 = ir.IntType(64), ir.IntType(128)


def _next_uniform(context: Any, generator: Any) -> Any:
    # The upper 53 bits of the output, as a number in [0, 1)
    def generate(target: Any, builder: Any, signature: Any, args: Any) -> Any:
        struct = cgutils.create_struct_proxy(generator)(target, builder, value=args[0])
        bits = cgutils.create_struct_proxy(_BITS)(target, builder, value=struct.bit_generator)
        pointer = builder.load(builder.inttoptr(bits.state, _I64.as_pointer()))
        place = builder.inttoptr(pointer, _I128.as_pointer())
        before = builder.load(place, align=8)
        increment = builder.load(builder.gep(place, [ir.Constant(_I64, 1)]), align=8)
        state = builder.add(builder.mul(before, ir.Constant(_I128, MULTIPLIER)), increment)
        builder.store(state, place, align=8)
        high = builder.trunc(builder.lshr(state, ir.Constant(_I128, 64)), _I64)
        folded = builder.xor(high, builder.trunc(state, _I64))
        turn = builder.lshr(high, ir.Constant(_I64, 58))
        back = builder.and_(builder.sub(ir.Constant(_I64, 64), turn), ir.Constant(_I64, 63))
        output = builder.or_(builder.lshr(folded, turn), builder.shl(folded, back))
        fraction = builder.uitofp(builder.lshr(output, ir.Constant(_I64, 11)), ir.DoubleType())
        return builder.fmul(fraction, ir.Constant(ir.DoubleType(), 1.0 / 2**53))

    return types.float64(generator), generate


def _with_state_at(context: Any, generator: Any, address: Any) -> Any:
    def generate(target: Any, builder: Any, signature: Any, args: Any) -> Any:
        struct = cgutils.create_struct_proxy(generator)(target, builder, value=args[0])
        bits = cgutils.create_struct_proxy(_BITS)(target, builder, value=struct.bit_generator)
        bits.state = bits.state_address = args[1]
        struct.bit_generator = bits._getvalue()
        return struct._getvalue()

    return generator(generator, types.uint64), generate


next_uniform: Callable[..., Any] = intrinsic(_next_uniform)
with_state_at: Callable[..., Any] = intrinsic(_with_state_at)


# The functions that are replaced


Implementation = Callable[..., Any]


def _uniform(generator: Generator) -> float:
    return next_uniform(generator)  # type: ignore[no-any-return]


def _generator_at(generator: Generator, address: int) -> Generator:
    return with_state_at(generator, address)  # type: ignore[no-any-return]


def _row_of(stack: Any, _: Any) -> Implementation:
    # Generated field by field
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
    """Return a chooser that ignores types."""
    return lambda *_: implementation


NATIVE: Final[dict[Implementation, Callable[..., Implementation]]] = {
    row: _row_of,
    generator_at: always(_generator_at),
} | ({uniform: always(_uniform)} if has_low_word_first() else {})
"""Chooser of the implementation by argument types, for each replaced function."""
