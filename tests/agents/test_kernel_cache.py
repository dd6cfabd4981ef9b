"""When compiled code is discarded and shared."""

from __future__ import annotations

import ast
import inspect
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

import pytest

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.compiling.cache_folder import cache_folder
from rl_tui.agents.compiling.cache_key import (
    COMPILER,
    DECORATORS,
    NATIVE,
    PACKAGE,
    cache_key,
    imports,
    kernel_sources,
)
from rl_tui.agents.kernels import compiled
from rl_tui.agents.kernels.compiled import COMPILED, FAMILIES, INLINED

MODULES = {
    ".".join(("rl_tui", *file.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__"): file
    for file in PACKAGE.rglob("*.py")
}

# A kernel that compiles quickly
SCRIPT = """
from pathlib import Path
import rl_tui
from rl_tui.agents.compiling.jit import dispatcher_of
from rl_tui.agents.kernels.position import discount_rewards, new_position

position = new_position(0)
position.rewards[:3] = 8.0, 4.0, 2.0
machine_code = dispatcher_of(discount_rewards)
machine_code(position, 0.5, 3, 3)
print(Path(rl_tui.__file__).parent, position.discounted, sum(machine_code.stats.cache_hits.values()))
"""

TWO_TYPES = """
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.compiling.jit import dispatcher_of

@compiled
def half(x):
    return x / 2

machine_code = dispatcher_of(half)
print(machine_code(3.0), machine_code(3), sum(machine_code.stats.cache_hits.values()))
"""


def parsed_imports(tree: ast.AST) -> Iterator[str]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            for otherwise in node.orelse:
                yield from parsed_imports(otherwise)
            continue
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.module is not None
            assert node.level == 0
            yield node.module
            yield from (f"{node.module}.{each.name}" for each in node.names)
        yield from parsed_imports(node)


def imported(file: Path) -> set[str]:
    return MODULES.keys() & set(parsed_imports(ast.parse(file.read_bytes())))


def test_the_key_covers_what_kernels_import_and_no_more() -> None:
    reached = set[str]()
    marks = {f"{DECORATORS}.{name}" for name, each in vars(compiled).items() if inspect.isfunction(each)}
    marks.remove(f"{DECORATORS}.has_member")
    sources = {module: file.read_bytes() for module, file in MODULES.items()}
    naming = [module for module, source in sources.items() if DECORATORS.encode() in source]
    waiting = [module for module in naming if marks & set(parsed_imports(ast.parse(sources[module])))]
    assert waiting
    waiting += [COMPILER, NATIVE]
    while waiting:
        module = waiting.pop()
        if module not in reached:
            reached.add(module)
            waiting += imported(MODULES[module]) if module != COMPILER else ()
    assert kernel_sources().keys() == reached
    assert 0 < len(reached) < len(MODULES) / 4
    assert {module.split(".")[1] for module in reached} <= {"agents", "worlds", "common"}
    assert all(source == sources[module] for module, source in kernel_sources().items())


def test_everything_marked_is_in_the_key() -> None:
    for module in MODULES:
        if module.startswith("rl_tui.agents"):
            import_module(module)
    members = [each for family in FAMILIES for each in (family.otherwise, *family.members.values())]
    marked = MODULES.keys() & {each.__module__ for each in (*COMPILED, *INLINED, *members)}
    assert marked
    chosen = {each.module for each in (*BY_ID.values(), *POLICY_BY_ID.values())}
    assert marked | chosen | {DECORATORS, COMPILER, NATIVE} <= kernel_sources().keys()


@pytest.mark.parametrize(
    ("source", "found"),
    [
        (
            "from rl_tui.worlds import world, drawing",
            {"rl_tui.worlds", "rl_tui.worlds.world", "rl_tui.worlds.drawing"},
        ),
        (
            "def f():\n    from rl_tui.worlds import (\n        world,\n        drawing,\n    )",
            {"rl_tui.worlds", "rl_tui.worlds.world", "rl_tui.worlds.drawing"},
        ),
        ("import rl_tui.worlds.world as here", {"rl_tui.worlds.world"}),
        ("import rl_tui", {"rl_tui"}),
        ("if TYPE_CHECKING:\n    from rl_tui.worlds import world\n\nimport rl_tui.common", {"rl_tui.common"}),
        ("from else_tui.a import world\nx = 'rl_tui.worlds'", set()),
    ],
)
def test_imports_are_found_wherever_they_stand(source: str, found: set[str]) -> None:
    assert imports(source.encode()) == found


@pytest.fixture(scope="module")
def clones(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folders = [tmp_path_factory.mktemp(name) for name in ("one", "other")]
    for folder in folders:
        shutil.copytree(PACKAGE, folder / "rl_tui", ignore=shutil.ignore_patterns("__pycache__"))
    return folders


def test_the_key_is_the_same_wherever_the_package_stands(clones: list[Path]) -> None:
    assert {cache_key(clone / "rl_tui") for clone in clones} == {cache_key()} == {cache_folder().name}


@pytest.mark.parametrize(
    ("module", "old", "new", "counts"),
    [
        ("rl_tui.runs.run", "def advance", "def advance ", False),
        ("rl_tui.screen.app.app", "import", "import ", False),
        ("rl_tui.agents.learner", "def advance", "def advance ", False),
        ("rl_tui.agents.compiling.loops", "def", "def ", False),
        ("rl_tui.agents.compiling.jit", "nogil=True", "nogil=False", True),
        ("rl_tui", "__version__", "__version__ ", False),
        ("rl_tui.agents.kernels.position", "DIVERGED = 2", "DIVERGED = 9", True),
        ("rl_tui.agents.kernels.parameters", "def step_size", "def step_size ", True),
        ("rl_tui.agents.algorithms.q_learning", "def", "def ", True),
        ("rl_tui.agents.policies.ucb", "def", "def ", True),
        ("rl_tui.worlds.mdp.space", "def", "def ", True),
    ],
)
def test_only_an_edit_of_what_kernels_come_from_throws_them_away(
    clones: list[Path], module: str, old: str, new: str, counts: bool
) -> None:
    with edited(clones[0] / "rl_tui", module, old, new) as package:
        assert (cache_key(package) != cache_key()) == counts
    assert cache_key(package) == cache_key()


def test_schedules_in_another_order_are_other_kernels(clones: list[Path]) -> None:
    old, new = '"constant", "linear"', '"linear", "constant"'
    with edited(clones[0] / "rl_tui", "rl_tui.agents.hyperparameters", old, new) as package:
        assert cache_key(package) != cache_key()


@contextmanager
def edited(package: Path, module: str, old: str, new: str) -> Iterator[Path]:
    file = package / MODULES[module].relative_to(PACKAGE)
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    yield package
    file.write_text(text)


def run(clone: Path, script: Path, cache: Path, **also: str) -> str:
    environment = os.environ | {"PYTHONPATH": str(clone), "RL_TUI_CACHE_DIR": str(cache), **also}
    done = subprocess.run(
        [sys.executable, "-m", script.stem],
        cwd=script.parent,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    return done.stdout.strip()


def files(folder: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


@pytest.mark.exhaustive("starts Python five times")
@pytest.mark.process
def test_another_clone_reads_what_the_first_compiled(clones: list[Path], tmp_path: Path) -> None:
    one, other = clones
    script, cache = tmp_path / "script.py", tmp_path / "cache"
    script.write_text(SCRIPT)
    answer = "[10.5    0.125]"
    assert run(one, script, cache) == f"{one / 'rl_tui'} {answer} 0"
    compiled = files(cache)
    assert len(compiled) == 2  # an index and the code
    assert run(other, script, cache) == f"{other / 'rl_tui'} {answer} 1"
    assert run(other, script, cache, RL_TUI_KIOSK="1") == f"{other / 'rl_tui'} {answer} 1"
    assert files(cache) == compiled
    # Code for another processor is in the same folder
    assert run(other, script, cache, NUMBA_CPU_NAME="generic").endswith(" 0")
    assert len(files(cache)) == 3
    assert run(one, script, cache).endswith(" 1")


@pytest.mark.process
def test_code_for_other_types_is_not_taken(tmp_path: Path) -> None:
    script, cache = tmp_path / "script.py", tmp_path / "cache"
    script.write_text(TWO_TYPES)
    assert run(PACKAGE.parent, script, cache) == "1.5 1.5 0"
    assert run(PACKAGE.parent, script, cache) == "1.5 1.5 2"
    one, other = sorted(cache.rglob("*.nbc"))
    one_code, other_code = one.read_bytes(), other.read_bytes()
    one.write_bytes(other_code)
    other.write_bytes(one_code)
    assert run(PACKAGE.parent, script, cache) == "1.5 1.5 0"
