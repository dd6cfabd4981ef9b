"""What kind of test each is, and which are about a subject."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

TESTS: Final = Path(__file__).parent
KINDS: Final = {
    "unit": "starts neither an app nor a child process",
    "screen": "plays an app by a pilot",
    "process": "starts a real program: in a terminal, in a browser, or alone",
}
SLOW: Final = "slow: takes seconds, and is left out of the quick tests"
INTERPRETED: Final = "interpreted: runs go on interpreted until machine code comes, as they do for people"


def kind_of(item: pytest.Item) -> str:
    """Return what a test or its file is marked with; without a mark, what tests of its folder are."""
    marked = next((kind for kind in KINDS if item.get_closest_marker(kind)), None)
    if marked is not None:
        return marked
    room = item.path.relative_to(TESTS).parts[0]
    if room in ("browser", "terminals", item.path.name):  # the last: at the top there is no room
        return "process"
    plays = "snap_compare" in item.fixturenames or inspect.iscoroutinefunction(item.function)
    return "screen" if room == "tui" and plays else "unit"


def about(items: list[pytest.Item], subject: str) -> list[pytest.Item]:
    """Return the tests that are about ``subject``: an id, a panel, a module. Raises UsageError without any.

    Tests of real programs, which take long, only where there are no others.
    """
    wanted = _plain(subject)
    found = [item for item in items if wanted in _names(item) or _stands_in(wanted, _title(item))]
    if not found:
        known = {name for item in items for name in _names(item) if re.fullmatch("[a-z0-9-]+", name)}
        near = get_close_matches(wanted, known, n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else "see rl-tui list, and the modules of rl_tui"
        raise pytest.UsageError(f"no test is about {subject!r}: {hint}")
    return [item for item in found if kind_of(item) != "process"] or found


def _plain(name: str) -> str:
    return name.lower().replace("_", "-")


def _stands_in(wanted: str, text: str) -> bool:
    return re.search(rf"(?<![a-z0-9]){re.escape(wanted)}(?![a-z0-9])", text) is not None


def _title(item: pytest.Item) -> str:
    """Return file and function of a test, without its parameters."""
    return _plain(f"{item.path.stem} {item.function.__name__}")


def _names(item: pytest.Item) -> set[str]:
    """Return the ids among the parameters of a test, and the modules that its file imports."""
    parameters = item.callspec.params.values() if hasattr(item, "callspec") else ()
    return {_plain(text) for value in parameters for text in _texts(value)} | _imported(item.path)


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        yield from (each for each in value.values() if isinstance(each, str))
    elif is_dataclass(value):
        parts = (getattr(value, field.name) for field in fields(value))
        yield from (each for each in parts if isinstance(each, str))


@cache
def _imported(path: Path) -> frozenset[str]:
    lines = re.findall(r"^from rl_tui\.(.+) import (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    modules = {module.rpartition(".")[2] for module, _ in lines}
    within = {name for _, names in lines for name in re.findall(r"\b[a-z_]+\b", names)}
    return frozenset(map(_plain, modules | within))


def is_quick(item: pytest.Item) -> bool:
    """True for unit tests that take no seconds, and for the small pictures, in which every screen is seen."""
    if item.path.stem == "test_pictures":
        return "80x24" in item.name
    return kind_of(item) == "unit" and not item.get_closest_marker("slow")
