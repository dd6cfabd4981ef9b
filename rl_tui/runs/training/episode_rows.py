"""CSV of training: a row an episode (run and episode from 1, return, length in steps), and the mean curve."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any, Final, TextIO

from rl_tui.common.files import file_or_stream, whole_file
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# The mean learning curve, a row for each bin of episodes


def write_curve(stream: TextIO, curve: Mapping[str, list[Any]]) -> None:
    """Write ``curve``, as ``train --runs --json`` has it, under the names of its lists; None is left empty.

    Numbers keep all their digits.
    """
    stream.write(f"{','.join(curve)}\n")
    for row in zip(*curve.values(), strict=True):
        stream.write(f"{','.join('' if value is None else repr(value) for value in row)}\n")


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


Listening = Callable[[int], AbstractContextManager[EpisodeRows | None]]
"""Opens what writes the episodes of a seed."""


@contextmanager
def episodes_in_order(
    csv: Path | TextIO | None, first_seed: int
) -> Iterator[tuple[Listening, Callable[[int], None]]]:
    """Yield what writes the episodes of seeds, trained side by side, and what hands on those of one seed.

    They are handed on to ``csv``, which is kept or removed as :func:`csv_file` does. Run 1 is that of
    ``first_seed``. Without ``csv`` nothing is written.
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
            if part.exists():  # or it could not even begin, or does not answer
                with part.open(encoding="utf-8", newline="") as episodes:
                    copyfileobj(episodes, target)
                part.unlink()

        yield listening, hand_on
