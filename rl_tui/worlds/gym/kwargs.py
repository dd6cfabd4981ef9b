"""What an environment may be made with: what its own constructor takes, nothing that wraps or replaces it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

from rl_tui.common.findings import Finding, Location, shown
from rl_tui.worlds.files.schema import is_plain, with_control_character

_IN_LINES: Final = "\n\t"
_DRAWN_HERE: Final = "no such argument: the world is drawn here"
_NOT_ITS_OWN: Final = "arguments of the environment itself"
# What Gymnasium's make takes for itself, or a registration says; the time limit alone may be chosen
_REFUSED: Final[Mapping[str, str]] = {
    "render_mode": _DRAWN_HERE,
    **dict.fromkeys(
        (
            "id",
            "entry_point",
            "vector_entry_point",
            "additional_wrappers",
            "wrappers",
            "spec",
            "disable_env_checker",
            "order_enforce",
            "kwargs",
            "env",
            "env_id",
            "make_kwargs",
        ),
        _NOT_ITS_OWN,
    ),
}


def kwargs_findings(kwargs: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield which of the raw ``kwargs`` may not be given, and which texts in them no terminal should see."""
    for name, value in kwargs.items():
        if name in _REFUSED:
            yield Finding(("kwargs", name), shown(value), _REFUSED[name])
    yield from _unprintable(kwargs)


def _unprintable(kwargs: Mapping[str, Any]) -> Iterator[Finding]:
    left: list[tuple[object, Location]] = [(kwargs, ("kwargs",))]  # tables may lie deep in one another
    while left:
        value, location = left.pop()
        if isinstance(value, Mapping):
            for key, each in value.items():
                if not is_plain(key):
                    yield Finding((*location, key), with_control_character(key), "a key that can be printed")
                left.append((each, (*location, key)))
        elif isinstance(value, list):
            left += [(each, (*location, index)) for index, each in enumerate(value)]
        elif isinstance(value, str) and not is_plain(value, _IN_LINES):
            found = with_control_character(value, _IN_LINES)
            yield Finding(location, found, "a text without control characters")
