"""The option that says into which file a picture goes."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import click

from rl_tui.cli.options.numbers import OptionValue

SUFFIXES: Final = (".svg", ".png")


class PictureFile(OptionValue):
    """A file whose name says what kind of picture it takes."""

    name = "F.svg|F.png"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return what the help shows in place of a value: the ends of names in small letters."""
        return self.name

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Return the path; fails naming the ends that a name may have."""
        path = Path(str(value))
        if path.suffix.lower() not in SUFFIXES:
            self.fail(f"{value} does not end in {' or '.join(SUFFIXES)}", param, ctx)
        return path


out_option: Final = click.option(
    "--out", type=PictureFile(), help='write the picture there; a PNG takes pip install "rl-tui[plot]"'
)
