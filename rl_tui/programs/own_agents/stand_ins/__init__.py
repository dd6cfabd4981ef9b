"""Stand-ins for course modules that an agent imports."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Final

from rl_tui.programs.own_agents.binding import Style

_MODULES: Final[Mapping[Style, Mapping[str, str]]] = {
    Style.RL_GLUE: dict.fromkeys(("agent", "base_agent", "rl_glue", "rl_glue.agent"), "rl_glue_base"),
    Style.BERKELEY: dict.fromkeys(("learningAgents", "game", "featureExtractors", "util"), "berkeley_base"),
}


class _StandIn(MetaPathFinder, Loader):
    """Finds modules that no other finder has found."""

    def __init__(self, modules: Mapping[str, str]) -> None:
        self._modules = modules

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname not in self._modules:
            return None
        return ModuleSpec(fullname, self, is_package=any(f"{fullname}." in each for each in self._modules))

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        source = import_module(f"{__name__}.{self._modules[module.__name__]}")
        public = {name: value for name, value in vars(source).items() if not name.startswith("_")}
        module.__dict__.update(public)


def offer_stand_ins(style: Style, own_name: str) -> None:
    """Make the stand-ins of `style` importable, unless such modules exist.

    A stand-in with the name of the agent's own file comes first, because no agent imports itself.
    """
    modules = _MODULES.get(style, {})
    if own_name in modules:
        sys.meta_path.insert(0, _StandIn({own_name: modules[own_name]}))
        import_module(own_name)
    sys.meta_path.append(_StandIn(modules))
