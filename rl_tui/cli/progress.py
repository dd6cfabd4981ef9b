"""A progress bar on stderr, where that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

import click

from rl_tui.worlds.words import short_count

_PARTS: Final = 1000


@contextmanager
def progress(label: str) -> Iterator[Callable[[int, int], None]]:
    """Yield what is to be called with how much is done and how much there is to do."""
    if not sys.stderr.isatty():
        yield lambda done, wanted: None
        return
    with click.progressbar(
        length=_PARTS,
        label=label,
        file=sys.stderr,
        width=0,  # what the rest leaves of the line
        update_min_steps=0,  # of what is very long, how much is done is news too
        item_show_func=_how_far,
    ) as bar:

        def show(done: int, wanted: int) -> None:
            bar.update(min(done, wanted) * _PARTS // wanted - bar.pos, (done, wanted))

        yield show


def _how_far(come: tuple[int, int] | None) -> str | None:
    return None if come is None else f"{short_count(come[0])} of {short_count(come[1])}"
