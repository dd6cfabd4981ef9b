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


class Progress:
    """Shows how far it has come: call it with how much is done, and how much there is to do."""

    def __init__(self, advance_bar: Callable[[int, str], object]) -> None:
        self._advance_bar = advance_bar
        self._parts = 0
        self._begun: tuple[float, int] | None = None

    def __call__(self, done: int, wanted: int) -> None:
        """Show that ``done`` of ``wanted`` is done."""
        self._begun = self._begun or (time.monotonic(), done)
        before, self._parts = self._parts, min(done, wanted) * _PARTS // max(1, wanted)
        self._advance_bar(self._parts - before, _how_far(self._begun, done, wanted))

    def say(self, text: str) -> None:
        """Show ``text`` in place of how much is done, until there is more; a forecast then begins anew."""
        self._begun = None
        self._advance_bar(0, text)


@contextmanager
def progress(label: str) -> Iterator[Progress]:
    """Yield what shows how far it has come."""
    if not sys.stderr.isatty():
        yield Progress(lambda parts, text: None)
        return
    with click.progressbar(
        length=_PARTS,
        label=label,
        file=sys.stderr,
        width=0,  # what the rest leaves of the line
        show_eta=False,  # it knows none before the first of so many parts is done
        update_min_steps=0,
        item_show_func=lambda text: text,
    ) as bar:
        yield Progress(bar.update)


def _how_far(begun: tuple[float, int], done: int, wanted: int) -> str:
    """Return ``30.2M of 1000T, 3 years left``, if it goes on as it did since the time and count ``begun``."""
    start, before = begun
    seconds = time.monotonic() - start
    words = f"{short_count(done)} of {short_count(wanted)}"
    if seconds < _WORTH_A_FORECAST or not before < done < wanted:
        return words
    return f"{words}, {lasting((wanted - done) * seconds / (done - before))} left"
