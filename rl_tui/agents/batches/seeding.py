"""The random streams of many seeds at once: the PCG64 states that NumPy would create.

The hash of M. E. O'Neill, "Developing a seed_seq Alternative" (2015), as in NumPy's SeedSequence, and the
seeding of PCG64. NumPy's objects take 0.1 ms per seed, a third of the time for a thousand episodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.agents.kernels.compiled import compiled_for, for_kernels
from rl_tui.agents.kernels.machine_code import fastest
from rl_tui.common.streams import Streams, has_low_word_first, streams
from rl_tui.worlds.mdp.space import IntArray

WordArray = npt.NDArray[np.uint64]

STREAMS: Final = 2
MOST_SEED: Final = 2**63 - 1
"""Largest seed for the kernel. NumPy handles larger ones."""
# Words per generator: state, increment, and what NumPy's C code keeps (a pointer to them, and a half draw
# that is unused here)
WORDS: Final = 6
_MASK: Final = 0xFFFFFFFF
_POOL: Final = 4
_LIMBS: Final = 8
# 0x2360ED051FC65DA44385DF649FCCF645 in parts of 16 bits, low part first
_MULTIPLIER: Final = (0xF645, 0x9FCC, 0xDF64, 0x4385, 0x5DA4, 0x1FC6, 0xED05, 0x2360)


def streams_of(seeds: Sequence[int]) -> tuple[WordArray, WordArray]:
    """Return the streams of `seeds`: memory, [B, 2, 6] words, and addresses, [B, 2].

    World comes first, then learner. Addresses are valid as long as the memory exists.
    """
    memory = _aligned(len(seeds))
    seeded = np.array([min(seed, MOST_SEED) for seed in seeds], np.int64)
    fastest(seed_streams)(seeded, np.zeros(_POOL, np.int64), np.zeros((3, _LIMBS), np.int64), memory)
    _put_in_order(memory)
    for index, seed in enumerate(seeds):
        if seed > MOST_SEED:
            copy_streams(streams(seed), memory[index])
    places = memory.ctypes.data + np.arange(memory.size // WORDS, dtype=np.uint64) * np.uint64(8 * WORDS)
    memory.reshape(-1, WORDS)[:, 4] = places
    return memory, (places + np.uint64(32)).reshape(len(seeds), STREAMS)


def copy_streams(origin: Streams, memory: WordArray) -> None:
    """Copy state and increment of both streams into `memory`, [2, 6]."""
    for stream, generator in enumerate(origin):
        state = generator.bit_generator.state["state"]
        for place, number in ((0, state["state"]), (2, state["inc"])):
            memory[stream, place : place + 2] = number & (2**64 - 1), number >> 64
    _put_in_order(memory)


def _put_in_order(memory: WordArray) -> None:
    # [..., 6], from low word first to this NumPy's order
    if not has_low_word_first():
        memory[..., :4] = memory[..., [1, 0, 3, 2]]


def _aligned(seeds: int) -> WordArray:
    # Aligned to 16 bytes for 128-bit integers
    words = np.zeros(seeds * STREAMS * WORDS + 1, np.uint64)
    first = words.ctypes.data // 8 % 2
    return words[first : first + seeds * STREAMS * WORDS].reshape(seeds, STREAMS, WORDS)


def _one_seed() -> tuple[Any, ...]:
    return np.zeros(1, np.int64), np.zeros(_POOL, np.int64), np.zeros((3, _LIMBS), np.int64), _aligned(1)


@compiled_for(_one_seed)
def seed_streams(seeds: IntArray, pool: IntArray, limbs: IntArray, memory: WordArray) -> None:
    """Write state and increment of the streams of `seeds`, [B], into `memory`, low word first.

    `pool`, [4], and `limbs`, [3, 8], are scratch memory.
    """
    for index in range(len(seeds)):
        for stream in range(STREAMS):
            _mix(int(seeds[index]), stream, pool)
            _seed_pcg64(pool, limbs, memory[index, stream])


@for_kernels
def _mix(seed: int, stream: int, pool: IntArray) -> None:
    # Into `pool`, [4] numbers of 32 bits
    constant = 0x43B0D7E5
    for place in range(_POOL):
        word = (seed >> 32 * place) & _MASK if place < 2 else 0
        constant, pool[place] = _hashed(constant, word)
    for source in range(_POOL):
        for place in range(_POOL):
            if source != place:
                constant, word = _hashed(constant, int(pool[source]))
                pool[place] = _mixed(int(pool[place]), word)
    for place in range(_POOL):
        constant, word = _hashed(constant, stream)
        pool[place] = _mixed(int(pool[place]), word)


@for_kernels
def _hashed(constant: int, word: int) -> tuple[int, int]:
    following = constant * 0x931E8875 & _MASK
    hashed = (word ^ constant) * following & _MASK
    return following, hashed ^ hashed >> 16


@for_kernels
def _mixed(one: int, other: int) -> int:
    mixed = (0xCA01F9DD * one - 0x4973F715 * other) & _MASK
    return mixed ^ mixed >> 16


@for_kernels
def _seed_pcg64(pool: IntArray, limbs: IntArray, words: WordArray) -> None:
    state, increment, product = limbs[0], limbs[1], limbs[2]
    constant = 0x8B51F9DD
    for place in range(2 * _POOL):
        word = int(pool[place % _POOL]) ^ constant
        constant = constant * 0x58F38DED & _MASK
        word = word * constant & _MASK
        word ^= word >> 16
        # High 64 bits come first, but within 64 bits the low 32
        number = state if place < _POOL else increment
        first = (4 if place % _POOL < 2 else 0) + 2 * (place % 2)
        number[first], number[first + 1] = word & 0xFFFF, word >> 16
    # increment ← 2 increment + 1
    carry = 1
    for place in range(_LIMBS):
        doubled = 2 * increment[place] + carry
        increment[place], carry = doubled & 0xFFFF, doubled >> 16
    # state ← (state + increment) · multiplier + increment
    carry = 0
    for place in range(_LIMBS):
        total = state[place] + increment[place] + carry
        state[place], carry = total & 0xFFFF, total >> 16
    carry = 0
    for place in range(_LIMBS):
        total = increment[place] + carry
        for each in range(place + 1):
            total += state[each] * _MULTIPLIER[place - each]
        product[place], carry = total & 0xFFFF, total >> 16
    for word in range(2):
        words[word] = _joined(product, 4 * word)
        words[2 + word] = _joined(increment, 4 * word)


@for_kernels
def _joined(limbs: IntArray, first: int) -> int:
    low = limbs[first] | limbs[first + 1] << 16
    return np.uint64(low) | np.uint64(limbs[first + 2] | limbs[first + 3] << 16) << np.uint64(32)  # type: ignore[return-value]
