"""Commands wait for no pipe, and read no endless file."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import click
import pytest

from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.lessons.check import is_lesson_file
from rl_tui.lessons.lesson import read_lesson
from rl_tui.live.sessions.session import read_session
from rl_tui.programs.watched.child.script import check_script
from rl_tui.runs.library import checked, find
from rl_tui.runs.policy_file import read_policy
from rl_tui.studies.pictures.reading import read_results
from rl_tui.studies.sweeps.store import Store
from rl_tui.worlds.mdp.space import FiniteSpace

SPARSE: Final = 30 * 10**9


def scenario(path: Path) -> None:
    find(str(path))


def to_check(path: Path) -> None:
    assert not is_lesson_file(path)
    _, faults = checked(path)
    raise UserError("\n".join(map(str, faults)))


def policy(path: Path) -> None:
    from rl_tui.runs.library import recipe_named
    from rl_tui.runs.recipe import begin

    space = begin(recipe_named("student")).world.space
    assert isinstance(space, FiniteSpace)
    read_policy(str(path), space)


def written_store(path: Path) -> None:
    Store.to_write(path).close()


Kind = tuple[str, Callable[[Path], object]]
SCENARIO: Final[Kind] = (".toml", scenario)
LESSON: Final[Kind] = (".toml", read_lesson)
SESSION: Final[Kind] = (".json", read_session)
SCRIPT: Final[Kind] = (".py", check_script)
KINDS: Final[dict[str, tuple[Kind, ...]]] = {
    "SCENARIO|FILE.toml|gym:ENV_ID": (SCENARIO,),
    "[SCENARIO|FILE.toml|gym:ENV_ID]": (SCENARIO,),
    "[SCENARIO|FILE.toml|gym:ENV_ID]...": (SCENARIO,),
    "[SCENARIO|FILE.toml|gym:ENV_ID|SESSION.json]": (SCENARIO, SESSION),
    "[SCENARIO|FILE.toml]": (SCENARIO,),
    "ID|FILE.toml": (SCENARIO, LESSON),
    "[ID|FILE.toml]": (LESSON,),
    "FILE.toml ...": ((".toml", to_check),),
    "uniform|optimal|greedy|FILE.json": ((".json", policy),),
    "SESSION.json": (SESSION,),
    "FILE.py[:NAME]|SESSION.json|FOLDER": (SCRIPT, SESSION),
    "SCRIPT.py": (SCRIPT,),
    "[SCRIPT.py]": (SCRIPT,),
    "FILE.py[:NAME]": (SCRIPT,),
    "RESULTS...": ((".json", read_results), (".csv", read_results), (".sqlite", read_results)),
    "IN.sqlite...": ((".sqlite", Store.to_read),),
    "FILE.sqlite": ((".sqlite", written_store),),
}
"""By the file's name in the help: its suffixes, and its reader."""
NAMES_FILE: Final = re.compile(r"FILE|FOLDER|SCRIPT|RESULTS|SESSION|\.(toml|json|sqlite|py)\b")
WRITTEN: Final = {"csv", "curve", "out"}
"""Parameters for files that are only written."""


def commands() -> Iterator[tuple[str, click.Command]]:
    from rl_tui.commands.by_name.sweeping.sweep import merge_command

    context = click.Context(program)
    for name in program.list_commands(context):
        command = program.get_command(context, name)
        assert command is not None
        yield name, command
    yield "sweep merge", merge_command


def named_files() -> Iterator[tuple[str, str]]:
    for name, command in commands():
        for each in command.params:
            said = each.metavar or (each.name == "store" and "FILE.sqlite") or ""
            names_file = isinstance(each.type, click.Path) or NAMES_FILE.search(said)
            if names_file and each.name not in WRITTEN:
                yield f"{name} {each.name}", said


def test_every_parameter_that_names_a_file_has_its_reader() -> None:
    found = dict(named_files())
    assert len(found) > 20
    unknown = {where: said for where, said in found.items() if said not in KINDS}
    assert not unknown, (
        f"{unknown}: read such a file by rl_tui/common/text_file.py, and add what help calls it, with what "
        "reads it, to KINDS here; a file that is only written belongs in WRITTEN"
    )
    assert set(KINDS) == set(found.values())  # otherwise a row would be useless


def pipe(path: Path) -> None:
    os.mkfifo(path)


def device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def folder(path: Path) -> None:
    path.mkdir()


def damaged(path: Path) -> None:
    path.write_bytes(b"SQLite format 3\0 \xff\xfe\0")


def sparse(path: Path) -> None:
    with path.open("wb") as stream:
        stream.truncate(SPARSE)


READERS: Final = sorted(
    {(suffix, read) for kinds in KINDS.values() for suffix, read in kinds}, key=lambda kind: str(kind)
)


@pytest.mark.parametrize(
    ("make", "said"),
    [(pipe, "a pipe"), (device, "a device"), (folder, "a folder"), (damaged, ""), (sparse, "")],
)
@pytest.mark.parametrize(("suffix", "read"), READERS)
def test_what_is_no_such_file_is_refused_in_a_line(
    tmp_path: Path, suffix: str, read: Callable[[Path], object], make: Callable[[Path], None], said: str
) -> None:
    path = tmp_path / f"named{suffix}"
    make(path)
    with pytest.raises(UserError) as told:
        read(path)
    line = str(told.value)
    assert path.name in line
    assert said in line
    assert "\n" not in line
