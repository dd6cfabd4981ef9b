"""The pages of the site that need no text of their own: one for each scenario, algorithm and policy."""

from __future__ import annotations

from collections.abc import Iterable

from generate import (
    SETTING_HEADS,
    capital,
    option_name,
    picture_of,
    printed,
    sentence,
    setting_row,
    table,
)

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.runs.export.script import script
from rl_tui.runs.library import episodes_of, recipe_for
from rl_tui.runs.recipe import Recipe, begin
from rl_tui.screen.glossary.glossary import glossary, terms_called
from rl_tui.worlds.files.catalogue import find, scenarios, shipped_folder
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

ROWS = {**BY_ID, **POLICY_BY_ID}
SHIPPED = [each for each in scenarios() if each.source.parent == shipped_folder()]
PICTURE_KEYS = "wait:2000"
MOST_STATES = 100  # of a table on a page
_LONG = 30  # lines that a page shows at once


def scenario_list() -> str:
    """Return the page that lists all scenarios."""
    rows = [(f"[{each.title}]({each.id}.md)", _algorithm_link(each), each.summary) for each in SHIPPED]
    return _joined(
        "# Scenarios",
        "The worlds that come with the program. Each page has a picture, notes, settings and exact values. "
        "In a random world, picture and values are those of seed 0.",
        table(("scenario", "algorithm", "what it is"), rows),
        "[Edit a world](../how-to/edit-a-world.md) and [Scenario files](../reference/scenario-files.md) "
        "describe how to make your own.",
    )


def scenario_picture(scenario: Scenario) -> str:
    """Return the playground of a scenario after some training, as SVG."""
    return picture_of("screenshot", scenario.id, "--keys", PICTURE_KEYS)


def scenario_page(scenario: Scenario) -> str:
    """Return the page of a scenario: picture, sizes, notes, settings, exact values."""
    recipe = recipe_for(scenario)
    world = begin(recipe).world
    limit = world.space.time_limit
    sizes = [
        ("states", f"{world.space.states:,}"),
        ("actions", f"{len(world.space.action_names):,}"),
        ("steps of an episode", f"at most {limit:,}" if limit else "no limit"),
        ("episodes", f"{episodes_of(scenario):,}"),
        ("algorithm", _algorithm_link(scenario)),
    ]
    return _joined(
        f"# {scenario.title}",
        scenario.summary,
        f"![{scenario.title}, after some steps of training]({scenario.id}.svg)",
        f"    rl-tui play {scenario.id}",
        table(("property", "value"), sizes),
        "## Notes",
        scenario.notes.strip(),
        "## Settings",
        "The settings at the start. The options of `rl-tui play` and `rl-tui train` change them.",
        table(("option", "value", "meaning"), [*_values(recipe)]),
        "## Exact values",
        *_exact_values(scenario, world),
    )


def _values(recipe: Recipe) -> Iterable[tuple[str, ...]]:
    used = parameters_of(recipe.algorithm, recipe.hyperparameters.policy)
    for name in used:
        value = recipe.hyperparameters.value(name)
        if not PARAMETERS[name].schedule or value != Hyperparameters().value(name):
            yield f"`{option_name(name)}`", f"{value}", PARAMETERS[name].help


def _exact_values(scenario: Scenario, world: World) -> Iterable[str]:
    if world.mdp is None:
        yield "This world is only simulated. It has no transition table, so it has no exact values."
        return
    yield (
        "This command computes the optimal values. V is the value of a state, Q the value of an action. The "
        "last lines are the value at the start and the returns; see "
        "[Exact values](../explanation/exact-answers.md)."
    )
    yield f"    rl-tui solve {scenario.id}"
    title, values, *others = printed("solve", scenario.id).strip().split("\n\n")
    if world.mdp.states > MOST_STATES:
        yield f"It prints all {world.mdp.states:,} states. The summary:"
        values = ""
    text = "\n\n".join(part for part in (title, values, *others) if part)
    block = f"```text\n{text}\n```"
    if scenario.hides_answer or text.count("\n") > _LONG:
        block = f'<details markdown="1">\n<summary>Show the values</summary>\n\n{block}\n\n</details>'
    yield block


def _algorithm_link(scenario: Scenario) -> str:
    row = BY_ID[recipe_for(scenario).algorithm]
    return f"[{row.name}](../algorithms/{row.id}.md)"


def algorithm_list() -> str:
    """Return the page that lists all algorithms and policies."""
    parts = [
        "# Algorithms",
        "Every algorithm and policy that comes with the program. Each page has the equation, the settings, "
        "and a plain script that needs only Gymnasium and NumPy.",
    ]
    for title, rows in (("Algorithms", BY_ID), ("Policies", POLICY_BY_ID)):
        listed = [(f"[{each.name}]({each.id}.md)", sentence(each.summary)) for each in rows.values()]
        parts += [f"## {title}", table(("name", "what it does"), listed)]
    return _joined(*parts)


def algorithm_page(row: Algorithm | Policy) -> str:
    """Return the page of an algorithm or a policy: equation, settings, plain script, scenarios."""
    recipe = example_of(row)
    option = "policy" if isinstance(row, Policy) else "algorithm"
    terms = [glossary()[each].text for each in terms_called([row.name])][:1]
    return _joined(
        f"# {row.name if row.name[1] == '-' else capital(row.name)}",
        sentence(row.summary),
        f"    {row.equation}",
        f"Source: Sutton & Barto, *Reinforcement Learning*, 2nd edition, {row.source}.",
        *terms,
        f"    rl-tui play {recipe.scenario.id} --{option} {row.id}",
        "## Settings",
        *_settings_of(row),
        "## A plain script",
        f"This script does the same on “{recipe.scenario.title}”. On screen, `m x` writes one for your run.",
        f"```python\n{example_script(row)}```",
        *_scenarios_with(row),
    )


def example_of(row: Algorithm | Policy) -> Recipe:
    """Return the run that shows an algorithm or a policy on its page."""
    if isinstance(row, Policy):
        alpha = {"alpha": 0.1} if row.needs_step_size else {}
        return recipe_for(find("bandit" if row.bandits_only else "frozenlake"), {"policy": row.id, **alpha})
    return recipe_for(find("frozenlake"), {"algorithm": row.id})


def example_script(row: Algorithm | Policy) -> str:
    """Return the plain script of that run."""
    recipe = example_of(row)
    return script(recipe, episodes_of(recipe.scenario))


def _settings_of(row: Algorithm | Policy) -> Iterable[str]:
    names = [name for name in row.parameters if name != "policy" and not PARAMETERS[name].schedule]
    yield table(SETTING_HEADS, [setting_row(PARAMETERS[name]) for name in names])
    yield "[All settings](../reference/agents.md#settings) lists the schedules too."


def _scenarios_with(row: Algorithm | Policy) -> Iterable[str]:
    """Yield the scenarios that start with it, or whose notes use it."""
    named = (f"`{row.id}`", f"--algorithm {row.id}", f"--policy {row.id}", row.name)
    found = [
        each
        for each in SHIPPED
        if recipe_for(each).algorithm == row.id or any(name in each.notes for name in named)
    ]
    if found:
        yield "## Scenarios"
        yield "\n".join(f"* [{each.title}](../scenarios/{each.id}.md): {each.summary}" for each in found)


def _joined(*parts: str) -> str:
    return "\n\n".join(parts) + "\n"
