"""Machine code is only in places where others cannot write."""

from __future__ import annotations

import grp
import os
import pwd
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner

from rl_tui.agents.compiling.base_folder import (
    KERNELS,
    VARIABLE,
    base_folder,
    closed_to_others,
    refusals,
    why_others_can_write,
    why_unsafe,
)
from rl_tui.commands.main import program

pytestmark = [pytest.mark.unit, pytest.mark.skipif(os.name != "posix", reason="modes are POSIX")]

US, SOMEBODY = os.geteuid(), os.geteuid() + 1
FOLDER = 0o040000


@pytest.fixture
def shared_group(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grp, "getgrgid", lambda _: SimpleNamespace(gr_name="many", gr_mem=["ada", "bob"]))


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr("platformdirs.user_cache_path", lambda *_, **__: tmp_path / "own")
    return tmp_path / "own"


def made(folder: Path, mode: int) -> Path:
    folder.mkdir()
    folder.chmod(mode)
    return folder


def status(mode: int, owner: int) -> os.stat_result:
    return os.stat_result((FOLDER | mode, 0, 0, 1, owner, 7, 0, 0, 0, 0))


@pytest.mark.parametrize(
    ("mode", "owner", "is_above", "told"),
    [
        (0o755, US, False, ""),
        (0o755, 0, False, ""),
        (0o755, SOMEBODY, False, "another user"),
        (0o700, SOMEBODY, True, "another user"),
        (0o775, US, False, "its group"),
        (0o775, 0, True, "its group"),
        (0o777, US, False, "all users"),
        (0o777, US, True, "all users"),
        (0o1777, 0, True, ""),
        (0o1777, 0, False, "all users"),
    ],
)
def test_who_else_can_write(mode: int, owner: int, is_above: bool, told: str, shared_group: None) -> None:
    why = why_others_can_write(status(mode, owner), is_above=is_above)
    assert told in why
    assert bool(why) == bool(told)


@pytest.mark.parametrize(
    ("name", "members", "is_theirs"),
    [("ada", [], True), ("ada", ["ada"], True), ("ada", ["bob"], False), ("class", [], False)],
)
def test_the_group_of_one_person_is_that_person(
    name: str, members: list[str], is_theirs: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pwd, "getpwuid", lambda _: SimpleNamespace(pw_name="ada"))
    monkeypatch.setattr(grp, "getgrgid", lambda _: SimpleNamespace(gr_name=name, gr_mem=members))
    assert (why_others_can_write(status(0o775, US)) == "") == is_theirs


def test_a_folder_above_that_anybody_can_write_to_is_found(tmp_path: Path) -> None:
    above = made(tmp_path / "above", 0o777)
    inside = made(above / "inside", 0o755)
    assert str(above) in why_unsafe(inside)
    above.chmod(0o1777)
    assert why_unsafe(inside) == ""
    assert why_unsafe(inside / "not" / "there") == ""


def test_a_link_is_judged_by_where_it_leads(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(made(tmp_path / "open", 0o777))
    assert str(tmp_path / "open") in why_unsafe(tmp_path / "link")


def test_what_is_chosen_is_passed_over_for_the_own_folder(
    own: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = made(tmp_path / "chosen", 0o777)
    monkeypatch.setenv(VARIABLE, str(chosen))
    assert base_folder() == own
    assert [str(chosen) in each for each in refusals()] == [True]
    chosen.chmod(0o755)
    assert (base_folder(), [*refusals()]) == (chosen, [])
    made(chosen / KERNELS, 0o777)
    assert base_folder() == own


def test_where_the_own_folder_is_open_too_nothing_is_kept(own: Path) -> None:
    made(own, 0o777)
    assert base_folder() == Path(os.devnull)
    assert [str(own) in each for each in refusals()] == [True]


def test_that_nothing_is_to_be_kept_can_be_chosen(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, os.devnull)
    assert (base_folder(), [*refusals()]) == (Path(os.devnull), [])


@pytest.mark.parametrize("umask", [0, 0o002, 0o077])
def test_what_is_kept_is_closed_to_others(tmp_path: Path, umask: int) -> None:
    before = os.umask(umask)
    try:
        with closed_to_others():
            (tmp_path / "kept").mkdir()
        (tmp_path / "other").mkdir()
    finally:
        os.umask(before)
    assert (tmp_path / "kept").stat().st_mode & 0o777 == 0o777 & ~(umask | 0o022)
    assert (tmp_path / "other").stat().st_mode & 0o777 == 0o777 & ~umask


def test_commands_say_what_is_left_out_and_warm_refuses_it(
    own: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = made(tmp_path / "chosen", 0o777)
    monkeypatch.setenv(VARIABLE, str(chosen))
    listed: Any = CliRunner().invoke(program, ["list"])
    assert (listed.exit_code, listed.stderr.count(f"{VARIABLE}={chosen} is ignored")) == (0, 1)
    warmed: Any = CliRunner().invoke(program, ["warm", "student"])
    assert (warmed.exit_code, warmed.stdout, [*chosen.iterdir()]) == (1, "", [])
    assert warmed.stderr.startswith(f"{VARIABLE}={chosen} is ignored: ")
