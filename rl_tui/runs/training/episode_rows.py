"""CSV files of training: one row per episode (run, episode from 1, return, length), or the mean curve."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any, Final, TextIO

from rl_tui.common.files import file_or_stream, whole_file
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# The mean learning curve: one row for each bin of episodes


def write_curve(stream: TextIO, curve: Mapping[str, list[Any]]) -> None:
    """Write `curve` with a header and all digits. None is empty."""
    stream.write(f"{','.join(curve)}\n")
    for row in zip(*curve.values(), strict=True):
        stream.write(f"{','.join('' if value is None else repr(value) for value in row)}\n")


HEADER: Final = "run,episode,return,length\n"


class EpisodeRows:
    """Writes the finished episodes of one run, with all digits."""

    def __init__(self, stream: TextIO, run: int) -> None:
        self._stream = stream
        self._run = run
        self._episodes = 0

    def __call__(self, returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        """Write the next episodes, `[n]` each."""
        episodes = range(self._episodes + 1, self._episodes + 1 + len(returns))
        rows = zip(episodes, returns.tolist(), lengths.tolist(), strict=True)
        run = self._run
        self._stream.writelines(f"{run},{episode},{total!r},{length}\n" for episode, total, length in rows)
        self._episodes += len(returns)


@contextmanager
def csv_file(target: Path | TextIO) -> Iterator[TextIO]:
    """Yield `target` with the header written. A stream stays open."""
    with file_or_stream(target) as stream:
        stream.write(HEADER)
        yield stream


Listening = Callable[[int], AbstractContextManager[EpisodeRows | None]]
"""Opens a writer for the episodes of a seed."""


@contextmanager
def episodes_in_order(
    csv: Path | TextIO | None, first_seed: int
) -> Iterator[tuple[Listening, Callable[[int], None]]]:
    """Collect the episodes of parallel runs, and write them to `csv` in the order of seeds.

    Yields a function that opens a writer for a seed, and one that copies a finished seed.
    """
    if csv is None:
        yield lambda _: nullcontext(), lambda _: None
        return
    with csv_file(csv) as target, TemporaryDirectory() as name:
        folder = Path(name)

        @contextmanager
        def listening(seed: int) -> Iterator[EpisodeRows]:
            draft = folder / f"{seed}.draft"
            try:
                with whole_file(draft) as stream:
                    yield EpisodeRows(stream, seed - first_seed + 1)
            finally:
                if draft.exists():
                    draft.rename(folder / str(seed))

        def hand_on(seed: int) -> None:
            part = folder / str(seed)
            if part.exists():  # it is missing if the run did not begin or does not respond
                with part.open(encoding="utf-8", newline="") as episodes:
                    copyfileobj(episodes, target)
                part.unlink()

        yield listening, hand_on
