"""The mean learning curve as CSV: a row for each bin of episodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

from rl_tui.lab.experiments.whole_file import whole_file


def write_curve(stream: TextIO, curve: Mapping[str, list[Any]]) -> None:
    """Write ``curve``, as ``train --runs --json`` has it, under the names of its lists; None is left empty.

    Numbers keep all their digits.
    """
    stream.write(f"{','.join(curve)}\n")
    for row in zip(*curve.values(), strict=True):
        stream.write(f"{','.join('' if value is None else repr(value) for value in row)}\n")


@contextmanager
def curve_file(target: Path | TextIO) -> Iterator[TextIO]:
    """Yield ``target``, opened if it is a path: what cannot be written shows before there is a curve.

    A file is kept or removed as :func:`whole_file` does. A stream stays open, and its errors are its own.
    """
    if isinstance(target, Path):
        with whole_file(target) as stream:
            yield stream
    else:
        yield target
