"""Printed output: JSON for programs, columns and progress bars for people."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.common.findings import printable
from rl_tui.common.packages import why_interpreted
from rl_tui.common.words import lasting, short_count

if TYPE_CHECKING:
    from rl_tui.runs.training.seeded_runs import OnProgress


# JSON and columns


_DIGITS: Final = 5
_SMALLEST: Final = 1e-5
_NOISE: Final = 1e-12  # rounding noise around 0


def print_json(document: Any) -> None:
    """Print one JSON document, or raise ValueError for NaN or an infinity."""
    click.echo(json.dumps(document, allow_nan=False))


def write_text(text: str, out: str) -> None:
    """Write to the file `out`, or to stdout for ``-``."""
    if out == "-":
        click.echo(text, nl=False)
    else:
        from rl_tui.common.files import whole_file

        with whole_file(Path(out)) as stream:
            stream.write(text)


def complain(message: str) -> None:
    """Print on stderr, with control characters escaped."""
    click.echo("\n".join(map(printable, message.split("\n"))), err=True)


def columns(rows: Sequence[Sequence[str]], right: Sequence[int] = ()) -> str:
    """Return rows of equal length as aligned columns; `right` ones align to the right."""
    from rich.cells import cell_len

    widths = [max(cell_len(cell) for cell in column) for column in zip(*rows, strict=True)]

    def padded(row: Sequence[str]) -> str:
        cells = []
        for place, (cell, width) in enumerate(zip(row, widths, strict=True)):
            space = " " * (width - cell_len(cell))
            cells.append(space + cell if place in right else cell + space)
        return "  ".join(cells).rstrip()

    return "\n".join(padded(row) for row in rows)


def number(value: float | str | None, form: str = ".5g") -> str:
    """Format a number for people. None becomes a dash; a word stays.

    Rounding noise below 1e-12 is shown as 0.
    """
    if value is None:
        return "-"
    return value if isinstance(value, str) else format(_without_noise(value), form)


def alike(values: Sequence[float | None]) -> list[str]:
    """Format numbers side by side, with the same number of decimals.

    The largest number gets five digits. If all are below 1e-5, all get an exponent. Common trailing zeros are
    removed. A number that would round to 0 becomes a bound, such as ``<.01``, and None a dash.
    """
    known = [_without_noise(value) for value in values if value is not None]
    largest = max(map(abs, known), default=0.0)
    if 0.0 < largest < _SMALLEST:
        return [number(value, ".3e") if value else number(value) for value in values]
    decimals = max(0, _DIGITS - 1 - math.floor(math.log10(largest))) if largest else 0
    plain = [f"{value:.{decimals}f}" for value in known]
    while decimals and all(text.endswith("0") for text in plain):
        decimals, plain = decimals - 1, [text[:-1].removesuffix(".") for text in plain]
    shown = iter(_bounded(value, text, decimals) for value, text in zip(known, plain, strict=True))
    return ["-" if value is None else next(shown) for value in values]


def _bounded(value: float, text: str, decimals: int) -> str:
    if any(digit in text for digit in "123456789"):
        return text
    bound = f"{10.0**-decimals:.{decimals}f}"
    return text.removeprefix("-") if not value else f"<{bound}" if value > 0.0 else f">-{bound}"


def _without_noise(value: float) -> float:
    return 0.0 if abs(value) < _NOISE else value


def can_print(text: str) -> bool:
    """Return True if stdout can encode `text`."""
    try:
        text.encode(getattr(sys.stdout, "encoding", None) or "ascii")
    except UnicodeEncodeError:
        return False
    return True


# Progress bars on stderr


_PARTS: Final = 1000
WORTH_A_FORECAST: Final = 0.5
"""Seconds after which the remaining time can be estimated."""
_LONGEST_FINISH: Final = 20.0  # seconds


class Progress:
    """A progress display, called with the amount done and the total."""

    def __init__(self, advance_bar: Callable[[int, str], object]) -> None:
        self._advance_bar = advance_bar
        self._parts = 0
        self._begun: tuple[float, int] | None = None

    def __call__(self, done: int, wanted: int) -> None:
        """Show that `done` of `wanted` is finished."""
        self._begun = self._begun or (time.monotonic(), done)
        self.show(done, wanted, _how_far(self._begun, done, wanted))

    def show(self, done: int, wanted: int, text: str) -> None:
        """Show the progress with `text` instead of the default words."""
        before, self._parts = self._parts, min(done, wanted) * _PARTS // max(1, wanted)
        self._advance_bar(self._parts - before, text)

    def say(self, text: str) -> None:
        """Show `text` until the next progress. The time estimate then starts again."""
        self._begun = None
        self._advance_bar(0, text)


@contextmanager
def progress(label: str, *, has_end: bool = True) -> Iterator[Progress]:
    """Yield a progress display on stderr, invisible if stderr is not a terminal.

    Without an end only text is shown.
    """
    if not sys.stderr.isatty():
        yield Progress(lambda parts, text: None)
        return
    # text only: click's bar without a length fails when nothing is counted
    without_bar: dict[str, Any] = {"bar_template": "%(label)s  %(info)s", "show_percent": False}
    with click.progressbar(
        length=_PARTS,
        **({} if has_end else without_bar),
        label=label,
        file=sys.stderr,
        width=0,  # the rest of the line
        show_eta=False,  # click has no estimate before the first part is done
        update_min_steps=0,
        item_show_func=lambda text: text,
    ) as bar:
        yield Progress(bar.update)


def with_compiling(bar: Progress) -> OnProgress:
    """Return a callback that also shows when kernels are compiled."""
    from rl_tui.agents.compiling.background import BACKGROUND

    def on_progress(done: int, wanted: int) -> None:
        if BACKGROUND.is_busy:
            bar.say("compiling, soon faster")
        else:
            bar(done, wanted)

    return on_progress


def finish_compiling() -> None:
    """Wait up to 20 seconds for a kernel that finished too late for this run.

    The next run then finds its code. If compiling failed, the reason is printed.
    """
    from rl_tui.agents.compiling.background import BACKGROUND

    why_not = BACKGROUND.why_not(list(BACKGROUND.failed))
    if why_not and why_not != why_interpreted():  # the command began with that
        complain(why_not)
    if BACKGROUND.is_busy and sys.stderr.isatty():  # only where a person waits
        sys.stdout.flush()
        click.echo("compiling the rest, so that the next start is fast; ctrl+c skips it", err=True)
        with suppress(KeyboardInterrupt):
            BACKGROUND.finish(_LONGEST_FINISH)


def _how_far(begun: tuple[float, int], done: int, wanted: int) -> str:
    # Such as "30.2M of 1000T, 3 years left"
    start, before = begun
    seconds = time.monotonic() - start
    words = f"{short_count(done)} of {short_count(wanted)}"
    if seconds < WORTH_A_FORECAST or not before < done < wanted:
        return words
    return f"{words}, {lasting((wanted - done) * seconds / (done - before))} left"
