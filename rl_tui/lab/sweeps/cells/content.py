"""What the world of a cell is, whatever its file is called: a digest of its content, and the world itself."""

from __future__ import annotations

import hashlib
import json
import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from rl_tui.agents.compatibility import is_bandit
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.lab.run.library import find
from rl_tui.lab.sweeps.cells.exact_facts import ExactFacts
from rl_tui.lab.sweeps.cells.world_settings import scenario_with
from rl_tui.lab.sweeps.variation import Value
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.world import World

MOST_BYTES: Final = 256 * 2**20
"""So much memory the worlds that are kept for further cells may take."""
MOST_WORLDS: Final = 2_000
_USUAL_SIZE: Final = 50_000


@dataclass(frozen=True, eq=False)
class WorldContent:
    """The world of a cell: what it is, and what many cells share of it."""

    scenario: Scenario
    """The scenario, the settings of its world made."""
    example: World
    """The world, or where each seed draws its own, one of them: states and actions are alike in all."""
    digest: str
    """The sha256 of all that the world is, ids, titles, notes and file names left out."""
    is_bandit: bool
    """Whether every step ends its episode, in one state."""
    facts: ExactFacts = field(init=False)
    """The exact answers of ``example``."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "facts", ExactFacts(self.example.mdp))

    @property
    def shared(self) -> World | None:
        """The world of every seed; None where each seed draws its own."""
        return None if self.scenario.section.drawn_from_seed else self.example


class Worlds:
    """The worlds that the cells of one plan are in, made when asked for; some MB of them are kept."""

    def __init__(self) -> None:
        self._scenarios: dict[str, Scenario] = {}
        self._contents: OrderedDict[tuple[object, ...], WorldContent | UserError] = OrderedDict()
        self._bytes = 0
        self._lock = threading.RLock()

    def of(self, scenario: Scenario | str, settings: Mapping[str, Value], seed: int) -> WorldContent:
        """Return the content of ``scenario``, one or the name of one, with ``settings`` of its world.

        ``seed`` is that of the example where each seed draws its own. Raises UserError where there is none.
        """
        with self._lock:
            place = (scenario, *((name, type(value), value) for name, value in settings.items()))
            known = self._contents.get(place)
            if known is None:
                try:
                    known = self._content(scenario, settings, seed)
                except UserError as reason:
                    known = reason
                self._keep(place, known)
            else:
                self._contents.move_to_end(place)
        if isinstance(known, UserError):
            raise known
        return known

    def _content(self, scenario: Scenario | str, settings: Mapping[str, Value], seed: int) -> WorldContent:
        if isinstance(scenario, str):
            if scenario not in self._scenarios:
                self._scenarios[scenario] = find(scenario)
            scenario = self._scenarios[scenario]
        return content_of(scenario_with(scenario, settings), seed)

    def _keep(self, place: tuple[object, ...], known: WorldContent | UserError) -> None:
        self._contents[place] = known
        self._bytes += _size(known)
        while len(self._contents) > 1 and (self._bytes > MOST_BYTES or len(self._contents) > MOST_WORLDS):
            _, dropped = self._contents.popitem(last=False)
            self._bytes -= _size(dropped)


def content_of(scenario: Scenario, seed: int) -> WorldContent:
    """Return the content of ``scenario``, with the world of ``seed`` as the example.

    Raises UserError where it cannot be built.
    """
    world = scenario.build(streams(seed).world)
    return WorldContent(scenario, world, _digest(scenario, world), is_bandit(world.space))


def _size(known: WorldContent | UserError) -> int:
    return _USUAL_SIZE + (known.example.nbytes if isinstance(known, WorldContent) else 0)


def _digest(scenario: Scenario, world: World) -> str:
    section = scenario.section
    said: dict[str, Any] = {"arms": isinstance(world.drawing, Arms)}
    if section.drawn_from_seed:
        said |= {"drawn": scenario.kind, "section": section.model_dump(mode="json", by_alias=True)}
        said["section"].pop("budget", None)  # where a run on screen ends
    elif world.mdp is not None:
        said["table"] = table_digest(world.mdp)
    else:
        said |= {"stepped": section.model_dump(mode="json", by_alias=True), **_environment(scenario)}
        said["time_limit"] = world.space.time_limit
    text = json.dumps(said, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _environment(scenario: Scenario) -> dict[str, str]:
    """Return the version of Gymnasium, and what identifies the code of an environment that is not its own."""
    import gymnasium

    from rl_tui.worlds.gym.registered import looked_at
    from rl_tui.worlds.gym.section import GymnasiumSection

    section = scenario.section
    assert isinstance(section, GymnasiumSection)
    said = {"gymnasium": gymnasium.__version__}
    with looked_at(section.id, section.kwargs) as environment:
        module = type(environment.unwrapped).__module__
    if module.split(".")[0] != "gymnasium":
        said["code"] = _source_digest(module)
    return said


def _source_digest(module: str) -> str:
    """Return the sha256 of the source of ``module``; its name alone where there is no source."""
    import sys
    from pathlib import Path

    file = getattr(sys.modules.get(module), "__file__", None)
    try:
        return hashlib.sha256(Path(file or "").read_bytes()).hexdigest()
    except OSError:
        return module
