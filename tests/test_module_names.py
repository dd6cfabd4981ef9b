"""Module names in strings, and private names of Textual."""

from __future__ import annotations

import ast
import pkgutil
import re
import tomllib
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import pytest

import rl_tui
from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.commands.main import RlTui
from rl_tui.commands.serving.site import PAGE
from rl_tui.worlds.files.shipped import shipped_folder

pytestmark = pytest.mark.unit

ROOT: Final = Path(__file__).parents[1]
PACKAGE: Final = Path(rl_tui.__file__).parent
DOTTED: Final = re.compile(r"""["'](rl_tui(?:\.\w+)+(?::\w+)?)["']""")
CROSS_REFERENCE: Final = re.compile(r":(?:mod|class|func|meth|data):`~?(rl_tui[\w.]+)`")
GLOB: Final = re.compile(r"""["']([\w/]*\*[\w/*]*\.\w+)["']""")


SCRIPTS: Final = ROOT / "tests" / "programs" / "scripts"
"""Programs to be watched: some are notebooks, not Python."""


def sources(*folders: Path) -> list[Path]:
    found = (path for folder in folders for path in folder.rglob("*.py"))
    return sorted(path for path in found if not path.is_relative_to(SCRIPTS))


@cache
def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def named_in_strings() -> set[str]:
    texts = [text_of(path) for path in sources(PACKAGE, ROOT / "tests")]
    return {each[1] for text in texts for form in (DOTTED, CROSS_REFERENCE) for each in form.finditer(text)}


def project() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def is_missing(name: str) -> bool:
    try:
        pkgutil.resolve_name(name)
    except (ImportError, AttributeError):
        return True
    return False


def test_what_a_string_names_exists() -> None:
    names = named_in_strings()
    assert [name for name in sorted(names) if is_missing(name)] == []
    assert {each.module for each in (*BY_ID.values(), *POLICY_BY_ID.values())} <= names
    assert any(":" in name for name in names)


@pytest.mark.parametrize(("name", "module"), sorted(RlTui.modules.items()))
def test_every_command_is_in_its_module(name: str, module: str) -> None:
    assert import_module(module).command.name == name


def test_a_walk_through_the_package_meets_every_module() -> None:
    walked = {module.name for module in pkgutil.walk_packages(rl_tui.__path__, "rl_tui.")}
    files = {path.relative_to(PACKAGE.parent).with_suffix("") for path in sources(PACKAGE)}
    names = {".".join(path.parts).removesuffix(".__init__") for path in files}
    assert walked == names - {"rl_tui"}


def test_import_contracts_name_modules_that_exist() -> None:
    contracts = project()["tool"]["importlinter"]["contracts"]
    keys = ("source_modules", "forbidden_modules")
    named = [name for each in contracts for key in keys for name in each.get(key, ())]
    for each in contracts:
        for container in each.get("containers", ()):
            rooms = [room for layer in each["layers"] for room in re.split(r"\s*[|:]\s*", layer)]
            named += [f"{container}.{room.strip('()')}" for room in rooms]
    assert len(named) > len(contracts)
    assert [name for name in named if find_spec(name) is None] == []


def test_packaging_names_what_exists() -> None:
    configuration = project()
    scripts = configuration["project"]["scripts"]
    assert scripts
    for entry in scripts.values():
        assert callable(pkgutil.resolve_name(entry))
    hatch = configuration["tool"]["hatch"]
    targets = hatch["build"]["targets"]
    paths = [hatch["version"]["path"], *targets["wheel"]["packages"], *targets["wheel"]["force-include"]]
    assert [
        path for path in (*paths, *targets["sdist"]["include"]) if not [*ROOT.glob(path.lstrip("/"))]
    ] == []
    assert [name for name in configuration["tool"]["mypy"]["packages"] if find_spec(name) is None] == []


def test_no_pattern_of_files_in_the_package_matches_nothing() -> None:
    patterns = {each[1] for path in sources(PACKAGE) for each in GLOB.finditer(text_of(path))}
    assert "*.toml" in patterns
    folders = (PACKAGE, shipped_folder())
    assert [each for each in sorted(patterns) if not any(any(folder.glob(each)) for folder in folders)] == []


@pytest.mark.parametrize(
    ("folder", "pattern"), [(shipped_folder(), "*.toml"), (PACKAGE, "**/*.tcss"), (PAGE, "*.html")]
)
def test_a_folder_that_is_listed_has_such_files(folder: Path, pattern: str) -> None:
    assert any(folder.glob(pattern))


def private_names_of_textual(path: Path) -> list[str]:
    names: list[str] = []
    if not re.search(r"(import|from) textual\b", text_of(path)):
        return names
    for node in ast.walk(ast.parse(text_of(path))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return [
        name
        for name in names
        if name.split(".")[0] == "textual" and any(re.match("_(?!_)", part) for part in name.split("."))
    ]


def test_private_names_of_textual_are_imported_in_the_terminal_only() -> None:
    terminal = PACKAGE / "screen" / "terminal"
    assert any(private_names_of_textual(path) for path in sources(terminal))
    others = [path for path in sources(PACKAGE) if not path.is_relative_to(terminal)]
    assert [name for path in others for name in private_names_of_textual(path)] == []
