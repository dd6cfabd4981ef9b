"""A progress bar on stderr, where that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

import click

_PARTS: Final = 1000


@contextmanager
def progress(label: str) -> Iterator[Callable[[int, int], None]]:
    """Yield what is to be called with how much is done and how much there is to do."""
    if not sys.stderr.isatty():
        yield lambda done, wanted: None
        return
    with click.progressbar(length=_PARTS, label=label, file=sys.stderr) as bar:

        def show(done: int, wanted: int) -> None:
            bar.update(min(done, wanted) * _PARTS // wanted - bar.pos)

        yield show
