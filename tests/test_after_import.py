"""Hooks that run after the import of a foreign module."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

from rl_tui.common.after_import import after_import

pytestmark = pytest.mark.unit

NAMES = ("imported_first", "imported_second")


@pytest.fixture(autouse=True)
def _modules_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "meta_path", list(sys.meta_path))
    monkeypatch.setattr(sys, "modules", dict(sys.modules))
    monkeypatch.syspath_prepend(tmp_path)


def write(folder: Path, *, zipped: bool) -> None:
    texts = {f"{name}.py": "made = [__name__]\n" for name in NAMES}
    if not zipped:
        for name, text in texts.items():
            (folder / name).write_text(text)
        return
    with zipfile.ZipFile(folder / "both.zip", "w") as archive:
        for name, text in texts.items():
            archive.writestr(name, text)
    sys.path.insert(0, str(folder / "both.zip"))


@pytest.mark.parametrize("zipped", [False, True])
def test_it_is_done_after_that_module_alone_each_time_it_is_imported(tmp_path: Path, zipped: bool) -> None:
    write(tmp_path, zipped=zipped)
    done: list[str] = []
    after_import("imported_first", lambda module: done.append(f"first {module.made}"))
    after_import("imported_first", lambda module: done.append(f"then {module.made}"))
    assert importlib.util.find_spec("imported_first") is not None
    assert importlib.import_module("imported_second").made == ["imported_second"]
    assert done == []
    first = importlib.import_module("imported_first")
    expected = ["first ['imported_first']", "then ['imported_first']"]
    assert sorted(done) == expected
    importlib.import_module("imported_first")
    assert sorted(done) == expected
    importlib.reload(first)
    assert sorted(done) == sorted(expected * 2)


@pytest.mark.parametrize("zipped", [False, True])
def test_the_module_is_as_if_nothing_had_been_asked_for(tmp_path: Path, zipped: bool) -> None:
    write(tmp_path, zipped=zipped)
    plain = importlib.import_module("imported_first")
    del sys.modules["imported_first"]
    after_import("imported_first", lambda _: None)
    module = importlib.import_module("imported_first")
    assert module is not plain
    assert module.__spec__.loader is module.__loader__
    assert type(module.__loader__) is type(plain.__loader__)
    assert (module.__file__, module.__spec__.origin) == (plain.__file__, plain.__spec__.origin)


def test_it_is_done_at_once_where_the_module_is_there() -> None:
    done: list[ModuleType] = []
    after_import("sys", done.append)
    assert done == [sys]


def test_a_module_that_is_nowhere_is_not_found_as_ever() -> None:
    after_import("there_is_no_such_module", lambda _: pytest.fail("it was imported"))
    assert importlib.util.find_spec("there_is_no_such_module") is None
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("there_is_no_such_module")
