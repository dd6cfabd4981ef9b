"""The kind of each test, and the tests about a subject."""

from __future__ import annotations

import inspect
import re
from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import settings

from rl_tui.agents.catalogue import BY_ID as ALGORITHM_BY_ID
from rl_tui.agents.catalogue import POLICY_BY_ID

TESTS: Final = Path(__file__).parent
KINDS: Final = {
    "unit": "starts neither an app nor a child process",
    "screen": "plays an app by a pilot",
    "process": "starts a real program: in a terminal, in a browser, or alone",
}
SLOW: Final = "slow: takes seconds; left out of the quick tests"
EXHAUSTIVE: Final = (
    "exhaustive(reason, but=()): runs with --all only; every day its cases with the ids in but"
)
INTERPRETED: Final = "interpreted: runs go on interpreted until machine code comes, as they do for people"
COMPILED: Final = "compiled: loops run as machine code from their first step"


def kind_of(item: pytest.Item) -> str:
    marked = next((kind for kind in KINDS if item.get_closest_marker(kind)), None)
    if marked is not None:
        return marked
    room = item.path.relative_to(TESTS).parts[0]
    if room in ("browser", "terminals", item.path.name):  # the last case: a file at the top has no folder
        return "process"
    plays = "snap_compare" in item.fixturenames or inspect.iscoroutinefunction(item.function)
    return "screen" if room == "screen" and plays else "unit"


def may_be_about(path: Path, subject: str) -> bool:
    """It names the subject, or its tests loop over a catalogue that contains it."""
    text = path.read_text(encoding="utf-8")
    if _plain(subject) in _plain(f"{path.stem} {text}"):
        return True
    return any(
        re.search(rf'parametrize\(\s*\(?"[^)\]]*\b{parameter}\b|\.{parameter}\b', text)
        for parameter, ids in _ids().items()
        if _plain(subject) in ids
    )


def about(items: list[pytest.Item], subject: str) -> list[pytest.Item]:
    """Return the tests about an id, a panel or a module. Raises UsageError.

    Slow tests of real programs are returned only if there are no others.
    """
    wanted = _plain(subject)
    found = [item for item in items if wanted in _names(item) or _stands_in(wanted, _title(item))]
    if not found:
        modules = {_plain(path.stem) for path in (TESTS.parent / "rl_tui").rglob("*.py")}
        near = get_close_matches(wanted, modules.union(*_ids().values()), n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else "see rl-tui list, and the modules of rl_tui"
        raise pytest.UsageError(f"no test is about {subject!r}: {hint}")
    return [item for item in found if kind_of(item) != "process"] or found


@cache
def _ids() -> dict[str, frozenset[str]]:
    return {
        "algorithm": frozenset(ALGORITHM_BY_ID),
        "policy": frozenset(POLICY_BY_ID),
        "scenario": frozenset(path.stem for path in (TESTS.parent / "scenarios").glob("*.toml")),
    }


def _plain(name: str) -> str:
    return name.lower().replace("_", "-")


def _stands_in(wanted: str, text: str) -> bool:
    return re.search(rf"(?<![a-z0-9]){re.escape(wanted)}(?![a-z0-9])", text) is not None


def _title(item: pytest.Item) -> str:
    return _plain(f"{item.path.stem} {item.function.__name__}")


def _names(item: pytest.Item) -> set[str]:
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


def is_everyday(item: pytest.Item, named: Collection[str]) -> bool:
    mark = item.get_closest_marker("exhaustive")
    if mark is None or any("::" in name for name in named):
        return True
    return hasattr(item, "callspec") and item.callspec.id in mark.kwargs.get("but", ())


def take_few_examples(test: Any) -> None:
    """Limit a property test to a fifth of its examples, enough to notice constant errors."""
    asked_for = test._hypothesis_internal_use_settings
    fewer = settings(asked_for, max_examples=max(3, asked_for.max_examples // 5))
    test._hypothesis_internal_use_settings = fewer


def is_quick(item: pytest.Item) -> bool:
    if item.path.stem == "test_pictures":
        return "80x24" in item.name
    return kind_of(item) == "unit" and not item.get_closest_marker("slow")
