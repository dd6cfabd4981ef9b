"""Where all randomness comes from: two independent streams for each seed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

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
