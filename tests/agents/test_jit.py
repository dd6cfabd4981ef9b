from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
from numba.core import event
from numba.core.typing.templates import _OverloadFunctionTemplate

from rl_tui.agents.compiling import jit
from rl_tui.agents.compiling.cache_folder import LONGEST_UNUSED, cache_folder, prune
from rl_tui.agents.compiling.jit import dispatcher_of
from rl_tui.agents.kernels.compiled import compiled, inlined, inlined_by_type, member_of

SCRIPT = """
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.compiling.jit import dispatcher_of
from rl_tui.agents.compiling.machine_cache import CACHED

@compiled
def double(x):
    return 2.0 * x

machine_code = dispatcher_of(double)
print(machine_code(21.0), CACHED, sum(machine_code.stats.cache_hits.values()))
"""


def run_with_cache(folder: Path, script: Path, **also: str) -> str:
    if not script.exists():  # a newer script would not be the compiled one
        script.write_text(SCRIPT, encoding="utf-8")
    environment = os.environ | {"RL_TUI_CACHE_DIR": str(folder), **also}
    finished = subprocess.run(
        [sys.executable, "-m", script.stem],
        cwd=script.parent,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.stderr == ""
    return finished.stdout.strip()


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("filled")
    assert run_with_cache(folder / "cache", folder / "kernel.py") == "42.0 True 0"
    return folder


@pytest.mark.usefixtures("real_start")
@pytest.mark.process
def test_the_second_process_reads_what_the_first_compiled(filled: Path) -> None:
    assert run_with_cache(filled / "cache", filled / "kernel.py") == "42.0 True 1"


@pytest.mark.process
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", [lambda whole: b"", lambda whole: whole[:-9]])
def test_a_damaged_cache_is_rebuilt(filled: Path, ending: str, damage: Callable[[bytes], bytes]) -> None:
    cache, script = filled / "cache", filled / "kernel.py"
    damaged = list(cache.rglob(f"*.{ending}"))
    assert damaged
    for file in damaged:
        file.write_bytes(damage(file.read_bytes()))
    assert run_with_cache(cache, script) == "42.0 True 0"
    assert run_with_cache(cache, script) == "42.0 True 1"


@pytest.mark.process
def test_it_does_without_files_that_are_something_else(filled: Path, tmp_path: Path) -> None:
    cache, script = tmp_path / "cache", filled / "kernel.py"
    shutil.copytree(filled / "cache", cache)
    for file in [*cache.rglob("*.nbi"), *cache.rglob("*.nbc")]:
        file.unlink()
        file.mkdir()
    assert run_with_cache(cache, script) == "42.0 True 0"


@pytest.mark.process
def test_a_cache_of_another_version_is_not_read(filled: Path) -> None:
    cache, script = filled / "cache", filled / "kernel.py"
    (index,) = cache.rglob("*.nbi")
    version, content = pickle.dumps("0.0.1"), index.read_bytes()
    index.write_bytes(version + content[len(pickle.dumps(numba.__version__)) :])
    assert run_with_cache(cache, script) == "42.0 True 0"


def test_caches_that_nobody_has_used_for_long_are_removed(tmp_path: Path) -> None:
    now = 1e9
    ages = {
        "0.68.1-0123456789abcdef": LONGEST_UNUSED + 60.0,
        "0.68.1-0000000000000000": LONGEST_UNUSED - 60.0,
        "0.61.0-ffffffffffffffff": 9e8,
        "somebody else's": 9e8,
        "0.68.1-1111111111111111": 9e8,
    }
    for name, age in ages.items():
        (tmp_path / name / "inside").mkdir(parents=True)
        os.utime(tmp_path / name, (now - age, now - age))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (tmp_path / "0.68.1-2222222222222222").symlink_to(elsewhere)
    prune(tmp_path, tmp_path / "0.68.1-1111111111111111", now)
    assert sorted(each.name for each in tmp_path.iterdir()) == [
        "0.68.1-0000000000000000",
        "0.68.1-1111111111111111",
        "0.68.1-2222222222222222",
        "elsewhere",
        "somebody else's",
    ]
    prune(tmp_path / "nowhere", tmp_path, now)


def test_where_nobody_has_a_home_it_does_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless(*_: object, **__: object) -> None:
        raise RuntimeError("could not determine the home directory")

    monkeypatch.setattr("platformdirs.user_cache_path", homeless)
    monkeypatch.delenv("RL_TUI_CACHE_DIR", raising=False)
    assert cache_folder.__wrapped__().is_relative_to(os.devnull)


@pytest.mark.process
def test_it_does_without_a_cache_where_none_can_be_written(tmp_path: Path) -> None:
    occupied = tmp_path / "a file"
    occupied.write_text("")
    assert run_with_cache(occupied, tmp_path / "kernel.py") == "42.0 False 0"
    assert occupied.read_text() == ""


@pytest.mark.process
def test_a_kiosk_reads_the_cache_and_writes_nothing(filled: Path, tmp_path: Path) -> None:
    cache, script = filled / "cache", filled / "kernel.py"
    before = {path: path.stat().st_mtime_ns for path in cache.rglob("*")}
    assert run_with_cache(cache, script, RL_TUI_KIOSK="1") == "42.0 True 1"
    assert run_with_cache(cache, tmp_path / "other.py", RL_TUI_KIOSK="1") == "42.0 True 0"
    assert {path: path.stat().st_mtime_ns for path in cache.rglob("*")} == before
    assert run_with_cache(tmp_path / "no cache", script, RL_TUI_KIOSK="1") == "42.0 False 0"
    assert not (tmp_path / "no cache").exists()


class One:
    class Alike(NamedTuple):
        number: float
        word: bool


class Other:
    class Alike(NamedTuple):
        number: float
        word: bool


@inlined_by_type
def answer_of(asked: Any) -> int:
    return 0


@compiled
def ask(asked: Any) -> int:
    return answer_of(asked)


def test_types_that_look_alike_do_not_run_each_others_code() -> None:
    member_of(answer_of, One.Alike)(lambda _: 1)
    member_of(answer_of, Other.Alike)(lambda _: 2)
    one, other = One.Alike(0.5, True), Other.Alike(0.5, True)
    for form in (ask, dispatcher_of(ask)):
        assert [form(one), form(other), form(one)] == [1, 2, 1]


@inlined
def plus_one(number: float) -> float:
    return number + 1.0


@inlined
def plus_two(number: float) -> float:
    return plus_one(plus_one(number))


@inlined_by_type
def grown(asked: Any) -> float:
    return plus_two(asked.number)


def never_cached(kernel: Callable[..., Any]) -> Any:
    dispatcher_of(ask)  # numba then knows the types of everything marked
    return numba.njit(kernel)


def compiled_by(run: Callable[[], object]) -> list[str]:
    with event.install_recorder("numba:compile") as recorder:
        run()
    return [each.data["dispatcher"].py_func.__name__ for _, each in recorder.buffer if each.is_start]


def test_what_is_inlined_is_not_compiled_on_its_own() -> None:
    def kernel(asked: Any) -> float:
        return grown(asked) + plus_two(0.5) + plus_one(0.5)

    fresh = never_cached(kernel)
    assert compiled_by(lambda: fresh(One.Alike(0.5, True))) == ["kernel"]
    assert fresh(One.Alike(0.5, True)) == kernel(One.Alike(0.5, True)) == 6.5


def test_numba_asks_for_what_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    # jit.py sets both. If a Numba version renames them, everything inlined is compiled in full again
    assert callable(_OverloadFunctionTemplate._get_jit_decorator)
    dispatcher = numba.njit(lambda number: number)
    monkeypatch.setattr(dispatcher, "_can_compile", False)
    assert compiled_by(lambda: dispatcher.get_call_template((numba.float64,), {})) == []


def test_a_numba_that_does_not_ask_compiles_in_its_own_way(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jit, "_only_typed", numba.njit)

    @inlined
    def doubled(number: float) -> float:
        return 2.0 * number

    def kernel(number: float) -> float:
        return doubled(number)

    fresh = never_cached(kernel)
    assert compiled_by(lambda: fresh(0.5)) == ["kernel", "doubled"]
    assert fresh(0.5) == 1.0


@pytest.mark.parametrize(
    ("faulty", "said"),
    [
        (lambda asked: asked.unheard_of, "Unknown attribute 'unheard_of'"),
        (lambda asked: asked.number + "word", "No implementation of function"),
        (lambda asked, missing: missing, "missing a required argument: 'missing'"),
    ],
)
def test_what_cannot_be_typed_where_it_is_inlined_is_told(faulty: Callable[..., Any], said: str) -> None:
    within = inlined(faulty)

    def kernel(asked: Any) -> Any:
        return within(asked)

    fresh = never_cached(kernel)
    with pytest.raises(numba.TypingError, match=said):
        fresh(One.Alike(0.5, True))


def test_a_call_of_machine_code_keeps_hold_of_nothing() -> None:
    def kernel(generator: np.random.Generator, numbers: Any) -> Any:
        return generator.random() + numbers[0]

    dispatcher_of(ask)
    fresh = numba.njit(_nrt=False)(kernel)  # like the kernels, which count no references
    generator, numbers = np.random.default_rng(0), np.zeros(1)
    fresh(generator, numbers)
    before = sys.getrefcount(generator), sys.getrefcount(numbers)
    for _ in range(50):
        fresh(generator, numbers)
    assert (sys.getrefcount(generator), sys.getrefcount(numbers)) == before
