"""The keys in texts are current."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import pytest

from rl_tui.screen.keys.action import MENUS
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.playground.modes.editing import ALWAYS, TOOLBOXES

ROOT: Final = Path(__file__).parents[1]
GLOSSARY: Final = ROOT / "rl_tui/screen/glossary/glossary.toml"
PLAIN: Final = [*sorted(ROOT.glob("lessons/*.toml")), *sorted(ROOT.glob("scenarios/*.toml"))]
PAGES: Final = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]
MADE: Final = re.compile(r"<!-- made by make docs: .*?<!-- end -->", re.DOTALL)
QUOTED: Final = re.compile(r"`([^`\s]|[a-z] [^`\s])`")
SIGNS: Final = {
    "number_sign": "#",
    "left_square_bracket": "[",
    "right_square_bracket": "]",
    "full_stop": ".",
    "comma": ",",
}
CURRENT: Final = {key for each in ACTIONS for key in (each.shown, *each.key.split(","))}
OLD: Final = {key for each in ACTIONS for key in each.old.split(",") if key}
ONLY_OLD: Final = {SIGNS.get(key, key) for key in OLD} - CURRENT
DRAWING: Final = {tool.key for each in TOOLBOXES.values() for tool in (*each.tools, *ALWAYS)}
PATHS: Final = {each.key for each in ACTIONS if each.menu} | DRAWING

OTHERS: Final = {
    "cheat-sheet.md": "p",  # the letter of a menu
    "ask-exact-questions.md": "C",  # a tool
    "commands.md": "V.x",  # of JSON, or the beginning of names
    "edit-a-world.md": "[],AHz",  # tools
    "first-hour.md": "p",  # the letter of a menu
    "keys.md": "op",  # a tool, or the letter of a menu
    "scenario-files.md": "#.GHSV",  # characters of maps
    "sweep-settings.md": "n",  # a key of the map of settings
    "terminals-and-ssh.md": "GO",  # characters in ASCII
    "use-from-python.md": "Pq",  # attributes of environments and results
    "write-and-grade-an-agent.md": "Q.",  # an attribute of agents, or the beginning of names
}
"""Quoted words on a page that look like keys but are not."""


def quoted_in(path: Path) -> set[str]:
    return set(QUOTED.findall(MADE.sub("", path.read_text(encoding="utf-8"))))


@pytest.mark.parametrize("path", [*PLAIN, *PAGES, GLOSSARY], ids=lambda path: path.name)
def test_no_text_names_an_old_key_or_a_row_that_no_menu_has(path: Path) -> None:
    named = quoted_in(path)
    assert named & ONLY_OLD <= set(OTHERS.get(path.name, ""))
    assert {each for each in named if " " in each and each[0] in MENUS} <= PATHS


@pytest.mark.parametrize("path", PLAIN, ids=lambda path: path.name)
def test_lessons_and_notes_name_a_menu_with_its_letter(path: Path) -> None:
    hint = "" if path.parent.name == "lessons" else "h"
    assert quoted_in(path).isdisjoint({*MENUS, *"jk", *hint})


def test_the_glossary_names_current_keys() -> None:
    text = " ".join(GLOSSARY.read_text(encoding="utf-8").split())
    named = re.findall(r"(?<![\w(] )\b((?:[a-z] )?[A-Za-z]) (?:lists|shows|runs|counts|goes|opens)\b", text)
    assert {"v", "t p"} <= set(named) <= CURRENT
