"""The private names that tests need, with the reason."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

pytestmark = pytest.mark.unit

MOST: Final = 28
WHY: Final = {
    # Textual has no public name for it
    "_batch_count": "a layout is not over while the app holds updates back",
    "_close_all": "the moment between the end of an app and that of its screens",
    "_compositor": "all that is drawn on a screen, as text",
    "_context": "a pilot waits for the app of the moment without being given it",
    "_parse_rules": "styles are parsed once for all apps",
    "_size": "a widget that stands on no screen has no size of its own",
    "_time": "a clock that stalls",
    # Hypothesis has no public name for it
    "_hypothesis_internal_use_settings": "everyday tests try fewer examples than all tests",
    # Numba: set by compiling/jit.py
    "_OverloadFunctionTemplate": "a Numba without it compiles all that is inlined",
    "_can_compile": "the same",
    "_get_jit_decorator": "the same",
    "_run_module_as_main": "a program that is forked begins as python -m begins it",
    "_termui_impl": "the clock of a progress bar",
    "_execute_child": "it alone starts the processes of Popen",
    # The program
    "_LOCK": "an environment is closed while another thread is between two calls",
    "_advance": "a loop is compiled only where that pays",
    "_draw": "a snapshot made by hand is drawn without a player",
    "_newest": "the same",
    "_only_typed": "a Numba that knows nothing of it",
    "_pasted": "a paste without end is held in few pieces",
    "_playback": "the making of a snapshot is timed alone",
    "_told": "a process has told nothing yet",
    "_position": "an episode of ten million steps, and a choice that is taken back",
}
PUBLIC: Final = {
    *("_asdict", "_exit", "_field_defaults", "_fields", "_make", "_replace"),  # by Python's own convention
    *("_repr_html_", "_repr_svg_"),  # and IPython: a notebook calls them to display an object
}
BY_NAME: Final = {"delattr", "getattr", "hasattr", "setattr"}
PRIVATE: Final = re.compile(r"_(?!_)\w+")


def private_names(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        dotted: list[str] = []
        if isinstance(node, ast.Attribute):
            is_own = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
            dotted = [] if is_own else [node.attr]
        elif isinstance(node, ast.ImportFrom):
            dotted = [node.module or "", *(alias.name for alias in node.names)]
        elif isinstance(node, ast.Import):
            dotted = [alias.name for alias in node.names]
        elif (
            isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in BY_NAME
        ):
            texts = [each.value for each in node.args[:2] if isinstance(each, ast.Constant)]
            dotted = [each for each in texts if isinstance(each, str)]
        for name in dotted:
            yield from (each for each in name.split(".") if PRIVATE.fullmatch(each))


def test_private_names_are_few_and_each_has_its_reason() -> None:
    paths = sorted(path for path in Path(__file__).parent.rglob("*.py") if "scripts" not in path.parts)
    uses = Counter(name for path in paths for name in private_names(path) if name not in PUBLIC)
    assert set(uses) == set(WHY)
    assert uses.total() <= MOST, uses
