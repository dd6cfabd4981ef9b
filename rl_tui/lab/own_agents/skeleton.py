"""Agents with the update left out, one of each shape, to begin with."""

from __future__ import annotations

from pathlib import Path

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.lab.own_agents.shapes import Style

_FOLDER = Path(__file__).parent / "skeletons"
_LONGEST_REASON = 120


def skeleton(style: Style) -> str:
    """Return the text of an agent in ``style`` whose update is still to be written."""
    return (_FOLDER / f"{style.value}.py.txt").read_text(encoding="utf-8")


def write_skeleton(path: Path, style: Style) -> None:
    """Write an agent in ``style`` to ``path``, a new file. Raises UserError where that cannot be."""
    name = shown(str(path))
    if path.suffix != ".py":
        raise UserError(f"{name}: expected the name of a Python file, one that ends in .py")
    try:
        with path.open("x", encoding="utf-8", newline="\n") as stream:
            stream.write(skeleton(style))
    except FileExistsError as error:
        raise UserError(f"{name}: is there already, and is not written over; choose another name") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise UserError(f"{name}: cannot be written ({one_line(reason, _LONGEST_REASON)})") from error
