"""Random number streams: two independent ones per seed."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from numpy.random import Generator


class Streams(NamedTuple):
    """The world's stream (arms, outcomes, reward noise) and the learner's (exploration, ties)."""

    world: Generator
    learner: Generator


def streams(seed: int) -> Streams:
    """Return new streams for `seed`, 0 or more.

    A random world is drawn first from the world's stream. The run continues with it, so reward noise never
    repeats these draws.
    """
    from numpy.random import PCG64, Generator, SeedSequence

    world, learner = SeedSequence(seed).spawn(2)
    return Streams(Generator(PCG64(world)), Generator(PCG64(learner)))


@cache
def has_low_word_first() -> bool:
    """Return True if NumPy stores PCG64 state as 128-bit integers, low word first.

    Where the compiler lacks such integers, as on Windows, the high word comes first.
    """
    import ctypes

    from numpy.random import PCG64

    bits: Any = PCG64(1)
    known = bits.state["state"]
    address = ctypes.c_void_p.from_address(bits.ctypes.state_address).value
    words = (ctypes.c_uint64 * 4).from_address(address) if address else ()
    word = 2**64 - 1
    return list(words) == [known[name] >> shift & word for name in ("state", "inc") for shift in (0, 64)]
