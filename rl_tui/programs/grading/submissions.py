"""The files to grade, agents or scripts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.programs.evidence.syntax import imported_modules, parsed_file
from rl_tui.programs.own_agents.loading import (
    AgentName,
    AgentPlace,
    agents_in,
    makes_environment,
    runs_when_imported,
    the_agent,
)
from rl_tui.programs.watched.child.script import read_script

_SUFFIX: Final = ".py"
_LEFT_OUT: Final = ("_", "test_", "conftest", ".")
"""Prefixes of file names that are not submissions: parts of others, and tests."""
_MOST: Final = 1_000


class Submission(NamedTuple):
    """A file to grade, with its name in the report, and its class or function if given."""

    name: str
    agent: AgentName


class FoundSubmissions(NamedTuple):
    """The submissions by name, and the names of skipped Python files."""

    submissions: list[Submission]
    left_out: list[str]


def submissions_in(target: str) -> FoundSubmissions:
    """Return the submissions in `target`, `FILE.py[:NAME]` or a folder. Raises UserError if there are none.

    Files of a folder that others import, or whose names start with `_`, `.`, `test_` or `conftest`, are
    skipped.
    """
    folder = Path(target)
    if not folder.is_dir():
        agent = AgentName.read(target)
        if not agent.path.exists():
            raise UserError(f"{shown(target)}: no such file or folder")
        return FoundSubmissions([Submission(target, agent)], [])
    try:
        files = sorted(each for each in folder.iterdir() if each.suffix == _SUFFIX and each.is_file())
    except OSError as error:
        raise UserError(f"{shown(target)}: cannot be read ({error.strerror})") from error
    left_out = [each.name for each in files if each.name.startswith(_LEFT_OUT)]
    kept = [each for each in files if not each.name.startswith(_LEFT_OUT)]
    parts = _parts_of_others(kept)
    kept = [each for each in kept if each not in parts]
    left_out = sorted([*left_out, *(f"{each.name} (imported by others)" for each in parts)])
    if not kept:
        raise UserError(f"{shown(target)}: found no submission in this folder; expected Python files")
    if len(kept) > _MOST:
        raise UserError(f"{shown(target)}: found {len(kept):,} Python files; expected at most {_MOST:,}")
    return FoundSubmissions([Submission(each.name, AgentName(each, "")) for each in kept], left_out)


def _parts_of_others(files: Sequence[Path]) -> list[Path]:
    trees = {each: parsed_file(str(each)) for each in files}
    imported = {
        name.partition(".")[0]
        for file, tree in trees.items()
        if tree is not None
        for name in imported_modules(tree)
        if name != file.stem
    }
    return [
        each
        for each, tree in trees.items()
        if tree is not None
        and each.stem in imported
        and not (agents_in(tree, each.parent) or makes_environment(tree))
    ]


def agent_of(submission: Submission) -> AgentPlace | None:
    """Return the agent of `submission`, or None for a script. Raises UserError if there is no such agent."""
    path, name = submission.agent
    tree = read_script(path).tree
    if name:
        return the_agent(tree, path, name)
    is_script = runs_when_imported(tree) or not agents_in(tree, path.parent)
    return None if is_script else the_agent(tree, path)
