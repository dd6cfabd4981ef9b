"""One CSV row an episode: run (from 1), episode (from 1), return, length in steps."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final, TextIO

from rl_tui.common.files import file_or_stream
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

HEADER: Final = "run,episode,return,length\n"


class EpisodeRows:
    """Writes the episodes of one run to ``stream`` as they are finished. Returns keep all their digits."""

    def __init__(self, stream: TextIO, run: int) -> None:
        self._stream = stream
        self._run = run
        self._episodes = 0

    def __call__(self, returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        """Write the next episodes, [n] each."""
        episodes = range(self._episodes + 1, self._episodes + 1 + len(returns))
        rows = zip(episodes, returns.tolist(), lengths.tolist(), strict=True)
        run = self._run
        self._stream.writelines(f"{run},{episode},{total!r},{length}\n" for episode, total, length in rows)
        self._episodes += len(returns)


@contextmanager
def csv_file(target: Path | TextIO) -> Iterator[TextIO]:
    """Yield ``target``, opened if it is a path, with the header written.

    A file is kept or removed as :func:`file_or_stream` does. A stream stays open, and its errors are its own.
    """
    with file_or_stream(target) as stream:
        stream.write(HEADER)
        yield stream
