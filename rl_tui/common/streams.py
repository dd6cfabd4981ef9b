"""Where all randomness comes from: two independent streams for each seed."""

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
    """Return fresh streams for ``seed`` (an integer, 0 or more).

    A world that is itself drawn at random (the arms of a bandit) takes its draws from the world's stream
    first; the run then goes on with that same stream, so that reward noise never repeats the draws of the
    arms.
    """
    from numpy.random import PCG64, Generator, SeedSequence

    world, learner = SeedSequence(seed).spawn(2)
    return Streams(Generator(PCG64(world)), Generator(PCG64(learner)))


@cache
def has_low_word_first() -> bool:
    """Return whether NumPy keeps the state of a PCG64 as whole numbers of 128 bits, low word first.

    Where its compiler has no such numbers, as on Windows, it keeps the high word first.
    """
    import ctypes

    from numpy.random import PCG64

    bits: Any = PCG64(1)
    known = bits.state["state"]
    address = ctypes.c_void_p.from_address(bits.ctypes.state_address).value
    words = (ctypes.c_uint64 * 4).from_address(address) if address else ()
    word = 2**64 - 1
    return list(words) == [known[name] >> shift & word for name in ("state", "inc") for shift in (0, 64)]
