"""The mean learning curve as CSV: a row for each bin of episodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TextIO


def write_curve(stream: TextIO, curve: Mapping[str, list[Any]]) -> None:
    """Write ``curve``, as ``train --runs --json`` has it, under the names of its lists; None is left empty.

    Numbers keep all their digits.
    """
    stream.write(f"{','.join(curve)}\n")
    for row in zip(*curve.values(), strict=True):
        stream.write(f"{','.join('' if value is None else repr(value) for value in row)}\n")
