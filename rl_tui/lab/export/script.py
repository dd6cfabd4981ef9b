"""A run as a plain Python script with Gymnasium and NumPy only, as a student might have written it.

It is another program: its random numbers are others, so its steps are others, but it is the same world and
the same algorithm, and it learns the same.
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

from rl_tui.agents.compatibility import check_compatible
from rl_tui.common.errors import UserError
from rl_tui.lab.export.agent_text import learner_text, planner_text
from rl_tui.lab.export.literals import WIDEST
from rl_tui.lab.export.parameter_text import ParameterText
from rl_tui.lab.export.worlds.text import WorldText
from rl_tui.lab.run.recipe import Recipe, begin

if TYPE_CHECKING:
    from rl_tui.worlds.world import World

_NEEDS: Final = (
    "Needs Gymnasium and NumPy only. Numbers of equations, sections and pages are those of Sutton & Barto, "
    "Reinforcement Learning, 2nd edition"
)
_CHANGED: Final = (
    "The run that this was written from had other settings or another world at first, or steps taken by "
    "hand; here what held at its end holds from the beginning, and the agent takes every step."
)


def script(
    recipe: Recipe,
    episodes: int,
    world: World | None = None,
    *,
    changed: bool = False,
    episodes_of_run: int = 0,
    lane: str = "",
) -> str:
    """Return the script that trains the algorithm of ``recipe`` for ``episodes`` episodes.

    ``world`` is that of the recipe, if it is at hand. ``changed`` says that a run came to these settings on
    the way only, which the script then says. It also says how many ``episodes_of_run`` there were, if that is
    another number, and of which ``lane`` it is (``1 of 2``), if there were several. Raises UserError, in a
    line, where there can be none: the world is too large to be read, its observations are no short script's
    business, or the algorithm cannot work in it.
    """
    world = world or begin(recipe).world
    check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)
    text = _world_text(recipe, world)
    params = ParameterText(recipe.algorithm, recipe.hyperparameters)
    planner = params.algorithm.planner
    parts = planner_text(params, text) if planner else learner_text(params, text, world.space)
    imports = "\n".join([*text.imports, "", "import gymnasium as gym", "import numpy as np"]).lstrip("\n")
    blocks = [
        _head(recipe, text, params, _remarks_on_run(changed, lane)),
        imports,
        params.constants(episodes, recipe.seed, episodes_of_run),
        "rng = np.random.default_rng(SEED)  # the randomness of the agent",
        *_separate(parts),
    ]
    return "\n\n".join(blocks) + "\n"


def _separate(parts: list[str]) -> list[str]:
    """Return the parts, with the two empty lines that belong around functions and classes."""
    blocks: list[str] = []
    for index, part in enumerate(parts):
        before = parts[index - 1] if index else ""
        around = part.startswith(("def ", "class ")) or _ends_in_body(before)
        blocks.append(f"\n{part}" if around else part)
    return blocks


def _ends_in_body(part: str) -> bool:
    """Return whether ``part`` ends inside a function or a class."""
    for line in reversed(part.split("\n")):
        if line and not line.startswith((" ", ")", "]", "}")):
            return line.startswith(("def ", "class "))
    return False


def _world_text(recipe: Recipe, world: World) -> WorldText:
    from rl_tui.common.streams import streams
    from rl_tui.lab.export.worlds.bandit_text import bandit_text
    from rl_tui.lab.export.worlds.grid_text import grid_text
    from rl_tui.lab.export.worlds.gymnasium_text import gymnasium_text
    from rl_tui.lab.export.worlds.table_text import table_text
    from rl_tui.worlds.grid.section import GridSection
    from rl_tui.worlds.gym.section import GymnasiumSection
    from rl_tui.worlds.sections.bandit_section import BanditSection

    section = recipe.scenario.section
    if isinstance(section, GymnasiumSection):
        return gymnasium_text(section, world)
    if isinstance(section, GridSection):
        return grid_text(section, streams(recipe.seed).world)
    if world.prospects:
        raise UserError(
            f"no script for {recipe.scenario.id}: some of its states look alike, scripts have all"
        )
    if world.mdp is None:
        raise UserError(f"no script for {recipe.scenario.id}: nobody knows what its actions lead to")
    if isinstance(section, BanditSection):
        return bandit_text(section, world.mdp)
    return table_text(world.mdp)


def _remarks_on_run(changed: bool, lane: str) -> list[str]:
    """Return in which ways the run was more than the script."""
    return [*([f"It contains lane {lane} only."] if lane else []), *([_CHANGED] if changed else [])]


def _head(recipe: Recipe, text: WorldText, params: ParameterText, remarks_on_run: list[str]) -> str:
    title = recipe.scenario.title.replace("\\", "/").replace('"', "'")
    algorithm = params.algorithm
    policy = "" if algorithm.planner else f", policy {params.policy.name}"
    remarks = [*text.remarks, *remarks_on_run]
    sentences = " ".join([f"{_NEEDS} (this algorithm: {algorithm.source}).", *remarks])
    first = textwrap.wrap(f"{algorithm.name} on “{title}”{policy}.", WIDEST)
    return '"""' + "\n".join([*first, "", *textwrap.wrap(sentences, WIDEST)]) + '\n"""'
