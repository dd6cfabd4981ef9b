"""Pictures in files: the end of the name says which kind."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from rl_tui.common.files import whole_file
from rl_tui.studies.pictures.picture import Picture
from rl_tui.studies.pictures.png import check_matplotlib, png_of
from rl_tui.studies.pictures.svg import svg_of

PNG: Final = ".png"


@contextmanager
def picture_file(path: Path) -> Iterator[Callable[[Picture], None]]:
    """Yield what writes a picture to ``path``: a PNG where the name ends so, else an SVG.

    That it cannot be written, or not drawn, shows before there is a picture: then UserError is raised. The
    file is kept or removed as :func:`whole_file` does.
    """
    is_png = path.suffix.lower() == PNG
    if is_png:
        check_matplotlib()
    with whole_file(path) as stream:

        def write(picture: Picture) -> None:
            if is_png:
                stream.buffer.write(png_of(picture))
            else:
                stream.write(svg_of(picture))

        yield write
