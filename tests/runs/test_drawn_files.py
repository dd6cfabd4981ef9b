"""Files of edited worlds."""

from __future__ import annotations

import codecs
import errno
import os
from dataclasses import replace
from pathlib import Path

import pytest

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.runs.export.scenario_file import file_of, is_on_screen, offered_name, path_named
from rl_tui.runs.library import recipe_for
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.files.catalogue import find, group_of, user_folder
from rl_tui.worlds.files.scenario import Scenario, read_scenario
from rl_tui.worlds.files.shipped import shipped_folder

pytestmark = pytest.mark.unit

TEXT = "title = \"Mine\"\n[grid] # here\nmap = '''\nS..G\n'''\n"
OTHER = TEXT.replace("S..G", "S...G")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def drawn_text(scenario: Scenario, edits: str = "world.cell[0,1]=H") -> str:
    draft = first_draft(scenario, 0)
    for edit in read_edits(edits):
        draft = draft.edited(edit)
    return file_of(scenario).text_with(draft)


def test_its_own_file_is_written_over_and_known_from_then_on(path: Path) -> None:
    scenario = read_scenario(path)
    file = file_of(scenario)
    assert (file.path, file.has_changed) == (path, False)
    saved = file.written(path, drawn_text(scenario))
    assert path.read_text(encoding="utf-8") == TEXT.replace("S..G", "SH.G")
    assert not saved.has_changed
    path.write_text(OTHER, encoding="utf-8")
    assert saved.has_changed


def test_byte_order_mark_line_ends_and_rights_stay(path: Path) -> None:
    path.write_bytes(codecs.BOM_UTF8 + TEXT.replace("\n", "\r\n").encode())
    path.chmod(0o640)
    scenario = read_scenario(path)
    saved = file_of(scenario).written(path, drawn_text(scenario))
    wanted = TEXT.replace("S..G", "SH.G").replace("\n", "\r\n").encode()
    assert path.read_bytes() == codecs.BOM_UTF8 + wanted
    assert path.stat().st_mode & 0o777 == 0o640
    assert not saved.has_changed


def test_a_link_stays_and_what_it_leads_to_is_written(path: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.toml"
    link.symlink_to(path)
    scenario = read_scenario(link)
    file_of(scenario).written(link, drawn_text(scenario))
    assert link.is_symlink()
    assert "SH.G" in path.read_text(encoding="utf-8")


def test_a_file_that_is_gone_is_written_anew_and_one_that_came_in_its_place_is_not_written_over(
    path: Path,
) -> None:
    scenario = read_scenario(path)
    file, text = file_of(scenario), drawn_text(scenario)
    path.unlink()
    assert not file.has_changed
    file.written(path, text)
    assert path.read_text(encoding="utf-8") == text
    path.unlink()
    path.mkdir()
    assert file.has_changed
    with pytest.raises(UserError, match="under another name"):
        file.written(path, text)
    path.rmdir()
    path.symlink_to(path.with_name("nowhere"))
    with pytest.raises(UserError, match="already exists"):
        file.written(path, text)


def test_another_file_is_never_written_over(path: Path, tmp_path: Path) -> None:
    scenario = read_scenario(path)
    file, other = file_of(scenario), tmp_path / "other.toml"
    other.write_text("another's", encoding="utf-8")
    with pytest.raises(UserError, match="already exists"):
        path_named(str(other), file)
    with pytest.raises(UserError, match="already exists"):
        file.written(other, drawn_text(scenario))
    assert other.read_text(encoding="utf-8") == "another's"
    with pytest.raises(UserError, match="no folder"):
        path_named(str(tmp_path / "no" / "such.toml"), file)
    with pytest.raises(UserError, match="is a scenario of rl-tui"):
        path_named("maze", file)


def test_a_shipped_world_is_saved_under_a_name_of_its_own_and_played_by_it() -> None:
    scenario = find("maze")
    file = file_of(scenario)
    assert file.path is None
    name = offered_name(scenario)
    assert name == "maze-2"
    text = drawn_text(scenario, "world.cell[0,1]=H")
    saved = file.written(path_named(name, file), text)
    assert saved.path == user_folder() / "maze-2.toml"
    again = find("maze-2")
    assert (again.title, group_of(again)) == ("maze-2", "Yours")
    assert not saved.has_changed
    assert offered_name(scenario) == "maze-3"


def test_what_was_saved_from_the_screen_is_no_change_to_ask_about(path: Path) -> None:
    scenario = read_scenario(path)
    recipe = recipe_for(scenario)
    drawn = first_draft(scenario, 0).edited(read_edits("world.cell[0,1]=H")[0])
    mdp = drawn.build().mdp
    assert not is_on_screen(scenario, recipe, mdp)
    file_of(scenario).written(path, drawn_text(scenario))
    saved = read_scenario(path)
    assert is_on_screen(saved, recipe, mdp)
    assert not is_on_screen(saved, recipe, scenario.build(streams(0).world).mdp)
    assert not is_on_screen(replace(saved, defaults={"gamma": 0.5}), recipe, mdp)


def test_an_environment_without_a_file_gets_one(tmp_path: Path) -> None:
    scenario = find("gym:FrozenLake-v1")
    file = file_of(scenario)
    assert file.path is None
    saved = file.written(tmp_path / "new.toml", drawn_text(scenario))
    again = read_scenario(tmp_path / "new.toml")
    assert (again.title, again.kind) == ("new", "grid")
    assert not saved.has_changed


@pytest.mark.parametrize("name", ["", ".", "..", "/", "./", "../", ".toml", "./.toml", "a\x1b[31mb", "a\nb"])
def test_what_names_no_file_is_refused(path: Path, name: str) -> None:
    with pytest.raises(UserError, match="type a name") as told:
        path_named(name, file_of(read_scenario(path)))
    assert str(told.value).isprintable()


@pytest.mark.parametrize("what", ["folder", "pipe", "link to a shipped one"])
def test_what_has_come_in_place_of_the_file_and_is_none_of_ones_own_stays(path: Path, what: str) -> None:
    scenario = read_scenario(path)
    file, text = file_of(scenario), drawn_text(scenario)
    shipped = shipped_folder() / "maze.toml"
    before = shipped.read_bytes()
    path.unlink()
    if what == "folder":
        path.mkdir()
    elif what == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to(shipped)
    assert file.has_changed
    with pytest.raises(UserError, match="under another name"):
        file.written(path, text)
    assert shipped.read_bytes() == before


def test_on_a_full_disk_the_file_stays_as_it_was(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    scenario = read_scenario(path)
    file, text = file_of(scenario), drawn_text(scenario)
    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(UserError, match="No space left"):
        file.written(path, text)
    assert [(each.name, each.read_text()) for each in path.parent.iterdir()] == [(path.name, TEXT)]
