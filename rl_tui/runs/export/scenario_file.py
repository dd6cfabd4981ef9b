"""Scenario files of edited worlds, with rules that protect existing files."""

from __future__ import annotations

import codecs
import os
import stat
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rl_tui.common.errors import UserError
from rl_tui.common.files import free_name, new_path, write_atomically, write_new
from rl_tui.common.findings import is_plain
from rl_tui.common.streams import streams
from rl_tui.common.text_file import UnreadableError, open_plain, read_text
from rl_tui.runs.exact_answers import LIVE_STATES
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.saving import saved_text, value_text
from rl_tui.worlds.editing.templates import named, template_text
from rl_tui.worlds.files.catalogue import user_folder
from rl_tui.worlds.files.scenario import Scenario, scenario_of
from rl_tui.worlds.files.shipped import SUFFIX, shipped_folder, shipped_names
from rl_tui.worlds.mdp.digest import table_digest

if TYPE_CHECKING:
    from rl_tui.runs.recipe import Recipe
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


@dataclass(frozen=True, slots=True)
class ScenarioFile:
    """The file of an edited world. `path` is None if there is none to overwrite."""

    text: str
    path: Path | None = None

    def text_with(self, draft: Draft) -> str:
        """Return its text with the world of `draft`."""
        return saved_text(self.text, draft)

    @property
    def has_changed(self) -> bool:
        """True if another program has changed the file since."""
        if self.path is None or not self.path.exists():
            return False
        try:
            return read_text(self.path) != self.text
        except UnreadableError:
            return True

    def written(self, path: Path, text: str) -> ScenarioFile:
        """Write `text` to `path`, overwriting only this file itself.

        A first name also becomes the title. Check `has_changed` before. Raises UserError.
        """
        if self.path is None:
            text = named(text, path.stem)
        try:
            if path == self.path and path.exists():
                _write_over(path, text)
            else:
                if path.parent == user_folder():
                    path.parent.mkdir(parents=True, exist_ok=True)
                write_new(path, text)
        except (OSError, UnreadableError) as error:
            reason = getattr(error, "strerror", None) or error
            raise UserError(f"{path} cannot be written ({reason}): save it under another name") from error
        return replace(self, path=path, text=text)


def new_world(kind: str) -> Scenario:
    """Return a blank world of a `kind` in `BLANK`, without a file."""
    return scenario_of(template_text(kind), Path(f"my-world{SUFFIX}"))


def file_of(scenario: Scenario) -> ScenarioFile:
    """Return the file of `scenario`, perhaps only its first lines."""
    text = scenario.text or f"title = {value_text(scenario.title)}\n"
    path = scenario.source.absolute()
    is_its_own = (
        bool(scenario.text) and path.is_file() and path.resolve().parent != shipped_folder().resolve()
    )
    return ScenarioFile(text, path if is_its_own else None)


def is_on_screen(scenario: Scenario, recipe: Recipe, mdp: TabularMDP | None) -> bool:
    """Return True if `scenario` equals that of `recipe` in `mdp`. Large worlds are not compared."""
    if mdp is None or mdp.states > LIVE_STATES or _head(scenario) != _head(recipe.scenario):
        return False
    try:
        drawn = scenario.build(streams(recipe.seed).world).mdp
    except UserError:
        return False
    return drawn is not None and table_digest(drawn) == table_digest(mdp)


def _head(scenario: Scenario) -> tuple[object, ...]:
    """Return everything in a file except the world."""
    defaults, answer = dict(scenario.defaults), scenario.hides_answer
    texts = scenario.title, scenario.summary, scenario.guess, scenario.see, scenario.try_this, scenario.notes
    return *texts, scenario.preview_steps, scenario.order, defaults, answer


def offered_name(scenario: Scenario) -> str:
    """Return a free name among the user's scenarios."""
    # a dot would look like the start of a suffix
    stem = scenario.id.replace(".", "-")
    return free_name(stem, SUFFIX, user_folder(), shipped_names()).removesuffix(SUFFIX)


def path_named(text: str, file: ScenarioFile) -> Path:
    """Return the path for a name (in the user's folder) or path. Raises UserError if unusable."""
    name = text.strip()
    is_path = "/" in name or "\\" in name
    stem = name.removesuffix(SUFFIX)
    if not is_plain(name) or not os.path.basename(stem).strip("."):
        raise UserError("type a name such as my-maze, or a path such as ./my-maze.toml")
    if not is_path and stem in shipped_names():
        raise UserError(f"{stem} is a scenario of rl-tui: type another name")
    path = Path(f"{stem}{SUFFIX}") if is_path else _own_path(stem)
    try:
        path = path.expanduser().absolute()
    except RuntimeError as error:
        raise UserError(f"{name}: {error}") from error
    if path == file.path or (not is_path and not path.parent.is_dir()):
        return path  # the folder is created when the file is written
    return new_path(str(path))


def _own_path(stem: str) -> Path:
    return user_folder() / f"{stem}{SUFFIX}"


def _write_over(path: Path, text: str) -> None:
    """Replace the content of `path`, but not its permissions, BOM or symbolic link."""
    path = path.resolve()
    if not path.is_file() or path.parent == shipped_folder().resolve():
        raise UserError(f"{path}: not one of your own files; save it under another name")
    content = text.encode()
    with open_plain(path, "a scenario file") as stream:
        mark = codecs.BOM_UTF8 if stream.read(len(codecs.BOM_UTF8)) == codecs.BOM_UTF8 else b""
    with path.open("r+b"):
        pass  # the permission of the file counts, even if the folder allows a replacement
    write_atomically(path, mark + content, stat.S_IMODE(path.stat().st_mode))
