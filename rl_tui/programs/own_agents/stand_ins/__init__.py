"""Stand-ins for course modules that an agent imports."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module
from typing import Final

from rl_tui.common.made_modules import MadeModules
from rl_tui.programs.own_agents.binding import Style

_MODULES: Final[Mapping[Style, Mapping[str, str]]] = {
    Style.RL_GLUE: dict.fromkeys(("agent", "base_agent", "rl_glue", "rl_glue.agent"), "rl_glue_base"),
    Style.BERKELEY: dict.fromkeys(("learningAgents", "game", "featureExtractors", "util"), "berkeley_base"),
}


def _stand_ins(modules: Mapping[str, str]) -> MadeModules:
    def content(name: str) -> Mapping[str, object]:
        source = import_module(f"{__name__}.{modules[name]}")
        return {name: value for name, value in vars(source).items() if not name.startswith("_")}

    return MadeModules(modules.__contains__, content)


def offer_stand_ins(style: Style, own_name: str) -> None:
    """Make the stand-ins of `style` importable, unless such modules exist.

    A stand-in with the name of the agent's own file comes first, because no agent imports itself.
    """
    modules = _MODULES.get(style, {})
    if own_name in modules:
        sys.meta_path.insert(0, _stand_ins({own_name: modules[own_name]}))
        import_module(own_name)
    sys.meta_path.append(_stand_ins(modules))
