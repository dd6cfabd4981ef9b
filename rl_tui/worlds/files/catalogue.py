"""The list of scenarios: shipped ones and the user's own."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Final, NamedTuple

import platformdirs

from rl_tui.common.errors import Fault, ScenarioError, UserError
from rl_tui.common.findings import shown
from rl_tui.common.kiosk import in_kiosk
from rl_tui.worlds.files.scenario import LAST, PREFIX, Scenario, environment_scenario, read_scenario
from rl_tui.worlds.files.shipped import SUFFIX, shipped_folder

YOURS: Final = "Yours"
"""Group of the user's own scenarios."""
GROUPS: Final = (
    (100, "Begin here"),
    (200, "Bandits"),
    (300, "Textbook examples"),
    (400, "Larger and harder"),
    (LAST + 1, "Simulated environments"),
)
"""Groups of shipped scenarios: upper bound of ``order``, and heading."""


class Catalogue(NamedTuple):
    """All scenarios in order, and the errors of unreadable files."""

    scenarios: list[Scenario]
    broken: list[ScenarioError]


def user_folder() -> Path:
    """Return the folder of the user's scenarios, which may not exist."""
    try:
        return platformdirs.user_config_path("rl-tui", appauthor=False) / "scenarios"
    except RuntimeError:  # no home folder
        return Path(os.devnull) / "scenarios"


def read_catalogue() -> Catalogue:
    """Read all scenario files: shipped ones by ``order``, then the user's.

    Environments are not created.
    """
    catalogue = Catalogue([], [])
    taken: set[str] = set()
    for folder in _folders():
        found = []
        for path in _files(folder):
            try:
                scenario = read_scenario(path, ask_environment=False)
            except ScenarioError as error:
                catalogue.broken.append(error)
                continue
            if scenario.id in taken:
                fault = Fault(
                    str(path), "", f"{scenario.id} is a scenario of rl-tui; choose another file name"
                )
                catalogue.broken.append(ScenarioError([fault]))
            else:
                found.append(scenario)
        found.sort(key=lambda scenario: (scenario.order, scenario.id))
        catalogue.scenarios.extend(found)
        taken.update(scenario.id for scenario in found)
    return catalogue


def group_of(scenario: Scenario) -> str:
    """Return the heading of `scenario` on the start screen."""
    if scenario.source.parent != shipped_folder():
        return YOURS
    return next(name for below, name in GROUPS if scenario.order < below)


def scenarios() -> list[Scenario]:
    """Return all readable scenarios: shipped ones in teaching order, then the user's."""
    return read_catalogue().scenarios


def find(name_or_path: str) -> Scenario:
    """Return a scenario by id, by path (with a separator or .toml), or by ``gym:ENV_ID``.

    Only the latter creates an environment here.

    Raises:
        ScenarioError: The file has errors.
        UserError: There is no such scenario, or a kiosk does not allow it.
    """
    is_path = name_or_path.endswith(SUFFIX) or "/" in name_or_path or "\\" in name_or_path
    if in_kiosk() and (is_path or name_or_path.startswith(PREFIX)):
        raise UserError(f"kiosk mode cannot open {shown(name_or_path)}; choose a scenario from rl-tui list")
    if name_or_path.startswith(PREFIX):
        return environment_scenario(name_or_path)
    if is_path:
        return read_scenario(name_or_path, ask_environment=False)
    for folder in _folders():
        for path in _files(folder):
            if path.stem == name_or_path:
                return read_scenario(path, ask_environment=False)
    names = [scenario.id for scenario in scenarios()]
    near = get_close_matches(name_or_path.lower(), names, n=3, cutoff=0.5)
    hint = f"did you mean {', '.join(near)}?" if near else f"choose from {', '.join(names)}"
    if not in_kiosk() and re.search(r"[.:]|-v\d+$", name_or_path):
        hint = f"expected a name from rl-tui list, FILE{SUFFIX}, or {PREFIX}ENV_ID"
        module, colon, _ = name_or_path.partition(":")
        if colon:
            hint = f"for an environment, write {PREFIX}{name_or_path} and add --allow-module {module}"
    raise UserError(f"there is no scenario {shown(name_or_path)}: {hint}")


def _folders() -> tuple[Path, ...]:
    return (shipped_folder(),) if in_kiosk() else (shipped_folder(), user_folder())


def _files(folder: Path) -> Iterator[Path]:
    try:
        yield from sorted(folder.glob(f"*{SUFFIX}"))
    except OSError:  # an unreadable folder counts as empty
        return
