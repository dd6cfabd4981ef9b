"""A progress bar on stderr, where that is a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

import click

from rl_tui.common.words import lasting, short_count

_PARTS: Final = 1000
_WORTH_A_FORECAST: Final = 0.5  # seconds


@contextmanager
def progress(label: str) -> Iterator[Callable[[int, int], None]]:
    """Yield what is to be called with how much is done and how much there is to do."""
    if not sys.stderr.isatty():
        yield lambda done, wanted: None
        return
    begun: tuple[float, int] | None = None
    with click.progressbar(
        length=_PARTS,
        label=label,
        file=sys.stderr,
        width=0,  # what the rest leaves of the line
        show_eta=False,  # it knows none before the first of so many parts is done
        update_min_steps=0,
        item_show_func=lambda text: text,
    ) as bar:

        def show(done: int, wanted: int) -> None:
            nonlocal begun
            begun = begun or (time.monotonic(), done)
            bar.update(min(done, wanted) * _PARTS // wanted - bar.pos, _how_far(begun, done, wanted))

        yield show


def _how_far(begun: tuple[float, int], done: int, wanted: int) -> str:
    """Return ``30.2M of 1000T, 3 years left``, if it goes on as it did since the time and count ``begun``."""
    start, before = begun
    seconds = time.monotonic() - start
    words = f"{short_count(done)} of {short_count(wanted)}"
    if seconds < _WORTH_A_FORECAST or not before < done < wanted:
        return words
    return f"{words}, {lasting((wanted - done) * seconds / (done - before))} left"
