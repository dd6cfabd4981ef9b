"""One CSV row an episode: run (from 1), episode (from 1), return, length in steps."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final, TextIO

from rl_tui.worlds.errors import UserError
from rl_tui.worlds.mdp import BoolArray, FloatArray, IntArray

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

    What was written is kept whatever else fails, but where the file itself cannot be written to its end it
    goes, and UserError is raised. A stream stays open, and its errors are its own.
    """
    if not isinstance(target, Path):
        target.write(HEADER)
        yield target
        return
    is_begun = False
    try:
        with target.open("w", encoding="utf-8", newline="") as stream:
            is_begun = True
            stream.write(HEADER)
            yield stream
    except OSError as error:
        if is_begun and target.is_file():  # what could not be opened is as it was
            with suppress(OSError):
                target.unlink()
        raise UserError(f"{target}: cannot be written ({error.strerror or error})") from error
