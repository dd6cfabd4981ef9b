"""A run as a plain Python script that needs only Gymnasium and NumPy, with other random numbers."""

from __future__ import annotations

import re
import textwrap
from typing import TYPE_CHECKING, Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy, parameters_of
from rl_tui.agents.compatibility import check_compatible, is_bandit
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.runs.export.literals import WIDEST
from rl_tui.runs.export.template import WorldText, fill, sections
from rl_tui.runs.export.world_text import world_text
from rl_tui.runs.recipe import Recipe, begin
from rl_tui.worlds.mdp.space import FiniteSpace

if TYPE_CHECKING:
    from rl_tui.worlds.world import World


# Constants and schedules


_NAMES: Final = {"n": "STEPS"}
_SCHEDULES: Final = {
    "epsilon": ("epsilon_schedule", "epsilon_min", "epsilon_decay"),
    "alpha": ("step_size_schedule", "alpha_min", "alpha_decay"),
}


class ParameterText:
    """Hyperparameters of one algorithm as text."""

    def __init__(self, algorithm: str, hyperparameters: Hyperparameters) -> None:
        self.algorithm = BY_ID[algorithm]
        self.policy = POLICY_BY_ID[hyperparameters.policy]
        self.hyperparameters = hyperparameters
        self.used = parameters_of(algorithm, hyperparameters.policy)
        self.sample_average = hyperparameters.sample_average and not self.algorithm.planner

    @property
    def flags(self) -> set[str]:
        """Conditions for lines of a text, such as `ties first`."""
        words = {
            f"{name} {self.hyperparameters.value(name)}"
            for name, parameter in PARAMETERS.items()
            if not (parameter.range or parameter.schedule)
        }
        return {*words, "sample average"} if self.sample_average else words

    def constants(self, episodes: int, seed: int, episodes_of_run: int = 0) -> str:
        """Return the lines of the constants. `episodes_of_run` is 0 if unknown."""
        constants = [*self._parameters()]
        if not self.algorithm.planner:
            other = f" (the run had {episodes_of_run:,})" if episodes_of_run not in (0, episodes) else ""
            constants.append(("EPISODES", f"{episodes:_}", f"how many episodes to train{other}"))
        constants.append(("SEED", str(seed), "where all randomness comes from"))
        width = max(len(f"{name} = {value}") for name, value, _ in constants)
        return "\n".join(f"{f'{name} = {value}':<{width}}  # {text}" for name, value, text in constants)

    def _parameters(self) -> list[tuple[str, str, str]]:
        # words are not constants: they select lines of the text
        skipped = {"initial_q", *(name for name in self.used if PARAMETERS[name].range is None)}
        for name, parts in _SCHEDULES.items():
            if not self.is_scheduled(name):
                skipped.update(parts)
        if self.sample_average:
            skipped.update(("alpha", *_SCHEDULES["alpha"]))
        names = [name for name in self.used if name not in skipped]
        if "gamma" not in names:
            names.insert(0, "gamma")
        return [self._constant(name) for name in [*names, "initial_q"]]

    def _constant(self, name: str) -> tuple[str, str, str]:
        parameter = PARAMETERS[name]
        symbol = "" if parameter.symbol in (name, "planning", "accuracy") else f"{parameter.symbol}, "
        return self.name_of(name), repr(self.hyperparameters.value(name)), f"{symbol}{parameter.help}"

    def name_of(self, name: str) -> str:
        """Return the name of the constant for a hyperparameter."""
        return _NAMES.get(name, name.upper())

    def is_scheduled(self, name: str) -> bool:
        """Return True if `name`, epsilon or alpha, has a schedule."""
        schedule, _, decay = _SCHEDULES[name]
        if name not in self.used or (name == "alpha" and self.sample_average):
            return False
        return self.hyperparameters.value(schedule) != "constant" and self.hyperparameters.value(decay) != 0.0

    def schedules(self) -> str:
        """Return the lines that compute ε and α for an episode."""
        return "\n".join(self._schedule(name) for name in _SCHEDULES if self.is_scheduled(name))

    def in_episode(self, text: str) -> str:
        """Replace `EPSILON` and `ALPHA` by scheduled variables."""
        for name in filter(self.is_scheduled, _SCHEDULES):
            text = re.sub(rf"\b{name.upper()}\b", name, text)
        return text

    def _schedule(self, name: str) -> str:
        schedule, least, decay = _SCHEDULES[name]
        start, end, fall = (self.name_of(each) for each in (name, least, decay))
        if self.hyperparameters.value(schedule) == "exponential":
            return f"{name} = {end} + ({start} - {end}) * np.exp(-{fall} * episode)"
        if float(self.hyperparameters.value(name)) >= float(self.hyperparameters.value(least)):
            return f"{name} = max({end}, {start} - {fall} * episode)"
        return f"{name} = min({end}, {start} + {fall} * episode)"

    @property
    def counts_visits(self) -> bool:
        """True if the script counts visits of pairs."""
        averages = self.sample_average and not self.algorithm.counts_updates
        return averages or (self.policy.counts_visits and not self.algorithm.planner)


# The agent


_TEXTS: Final = f"{__package__}.agent"
_BEGIN_WORLD: Final = "env.reset(seed=SEED)  # the randomness of the world"
_NEW_Q: Final = "Q = new_table(INITIAL_Q)"
_LEAST_VARIANCE: Final = 1e-12


def learner_text(params: ParameterText, text: WorldText, space: FiniteSpace) -> list[str]:
    """Return the parts of a learning script. Raises UserError."""
    flags = {*params.flags, *(["time limit"] if text.truncates else [])}
    reward_flags, noise = _known_rewards(params, space)
    algorithm = _texts_of(params.algorithm, params, flags)
    policy = _texts_of(params.policy, params, {*flags, *reward_flags})
    own = sections(_TEXTS, flags)
    visit = "N[state][action] += 1" if params.counts_visits else ""
    pieces = {
        "schedules": params.schedules(),
        "note": "\n".join(each for each in (visit, policy.get("note", "")) if each),
    }
    loop = fill(algorithm["learn"], pieces)
    functions = [fill(policy["choose"], {"noise": noise})]
    if "expected_value" in loop:
        functions.append(policy["expected value"])
    return [
        text.setup,
        _BEGIN_WORLD,
        text.new_table,
        _tables(params, algorithm, policy),
        *_argmax(own, [loop, *functions]),
        *functions,
        loop,
        fill(own["learned"], {"report": _report(text, params)}),
    ]


def planner_text(params: ParameterText, text: WorldText) -> list[str]:
    """Return the parts of a planning script. Raises UserError without a model."""
    if not text.starts:
        raise UserError(
            "no script: a planner needs a transition table, and this environment has none; choose an "
            "algorithm that learns, such as q-learning"
        )
    planner, own = _texts_of(params.algorithm, params, params.flags), sections(_TEXTS, params.flags)
    pieces = {
        "fields": text.fields.replace("noise", "_"),
        "starts": text.starts,
        "act": planner["act"],
        "report": _report(text, params),
    }
    played = fill(own["played"], pieces)
    return [
        text.setup,
        _BEGIN_WORLD,
        *([text.model] if text.model else []),
        text.new_table,
        _NEW_Q,
        *_argmax(own, [planner["plan"], played]),
        fill(own["look ahead"], pieces),
        planner["plan"],
        played,
    ]


def _texts_of(row: Algorithm | Policy, params: ParameterText, flags: set[str]) -> dict[str, str]:
    try:
        texts = sections(row.module, flags)
    except (FileNotFoundError, ModuleNotFoundError, ValueError) as error:  # no text, no package, no name
        raise UserError(f"there is no script for {row.id} yet") from error
    return {name: params.in_episode(text) for name, text in texts.items()}


def _tables(params: ParameterText, algorithm: dict[str, str], policy: dict[str, str]) -> str:
    lines = [_NEW_Q]
    if params.counts_visits:
        averages = params.sample_average and not params.algorithm.counts_updates
        step_size = "; the step size is 1/N" if averages else ""
        lines.append(f"N = new_table(0.0)  # number of times each action was taken{step_size}")
    lines += [texts["tables"] for texts in (algorithm, policy) if texts.get("tables")]
    return "\n".join(lines)


def _known_rewards(params: ParameterText, space: FiniteSpace) -> tuple[list[str], str]:
    """Return what posterior sampling knows about the arms: a flag or their variances."""
    from rl_tui.agents.policies.thompson import new_rule

    if not is_bandit(space):
        return [], ""
    rule = new_rule(space, params.hyperparameters)
    if rule.bernoulli:
        return ["bernoulli"], ""
    # Without noise the first reward gives the mean; the least variance avoids a division by 0
    variances = [max(float(each), _LEAST_VARIANCE) for each in rule.variance]
    variance = repr(variances[0]) if len(set(variances)) == 1 else f"np.array({variances})"
    return [], f"VARIANCE = {variance}  # σ², the noise of the rewards, is known to this rule"


def _argmax(own: dict[str, str], parts: list[str]) -> list[str]:
    return [own["argmax"]] if any(" argmax(" in each or "[argmax(" in each for each in parts) else []


def _report(text: WorldText, params: ParameterText) -> str:
    worked_out = "np.isclose(values, values.max(), rtol=0, atol=1e-6)"
    equals = worked_out if params.algorithm.planner else "values == values.max()"
    return fill(text.report, {**text.report_pieces, "equals": equals})


# The whole script


_NEEDS: Final = (
    "Needs Gymnasium and NumPy only. Numbers of equations, sections and pages are those of Sutton & Barto, "
    "Reinforcement Learning, 2nd edition"
)
_CHANGED: Final = (
    "The run behind this script had other settings or another world at first, or steps taken by "
    "hand. This script uses the final settings and world from the beginning, and the agent takes every step."
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
    """Write the script that trains the algorithm of `recipe`.

    Its head says if the run had other settings at first (`changed`) or another number of episodes, and which
    of several runs it is (`lane`, `1 of 2`). Raises UserError if the world is too large or too complex, or
    the algorithm cannot work in it.
    """
    world = world or begin(recipe).world
    check_compatible(world.space, recipe.algorithm, recipe.hyperparameters)
    text = world_text(recipe, world)
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
    """Put two empty lines around functions and classes."""
    blocks: list[str] = []
    for index, part in enumerate(parts):
        before = parts[index - 1] if index else ""
        around = part.startswith(("def ", "class ")) or _ends_in_body(before)
        blocks.append(f"\n{part}" if around else part)
    return blocks


def _ends_in_body(part: str) -> bool:
    for line in reversed(part.split("\n")):
        if line and not line.startswith((" ", ")", "]", "}")):
            return line.startswith(("def ", "class "))
    return False


def _remarks_on_run(changed: bool, lane: str) -> list[str]:
    return [*([f"It contains only run {lane}."] if lane else []), *([_CHANGED] if changed else [])]


def _head(recipe: Recipe, text: WorldText, params: ParameterText, remarks_on_run: list[str]) -> str:
    title = recipe.scenario.title.replace("\\", "/").replace('"', "'")
    algorithm = params.algorithm
    policy = "" if algorithm.planner else f", policy {params.policy.name}"
    remarks = [*text.remarks, *remarks_on_run]
    sentences = " ".join([f"{_NEEDS} (this algorithm: {algorithm.source}).", *remarks])
    first = textwrap.wrap(f"{algorithm.name} on “{title}”{policy}.", WIDEST)
    return '"""' + "\n".join([*first, "", *textwrap.wrap(sentences, WIDEST)]) + '\n"""'
