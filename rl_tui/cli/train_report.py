"""What training came to, for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.agents.planning import best_expected_return
from rl_tui.cli.output import columns, number
from rl_tui.cli.policy_map import policy_map
from rl_tui.lab.recipe import Recipe
from rl_tui.lab.run import Run

Figures = Mapping[str, Any]

_SUMMARY: Final = {
    "value_at_start": "value at the start",
    "expected_return": "expected return",
    "max_error": "largest error of Q",
    "return_last_100": "return, last 100 episodes",
    "length_last_100": "length, last 100 episodes",
    "first_reward_episode": "first reward, episode",
    "episodes": "episodes",
    "steps": "steps",
}


def one_run(run: Run, figures: Figures) -> str:
    """Return the report of one run; ``figures`` is its document of ``train --json``."""
    seconds, speed = number(figures["seconds"], ".3f"), figures["steps_per_second"]
    rate = f", {speed / 1e6:.1f} million steps/s" if speed else ""
    done = f"{figures['episodes']:,} episodes, {figures['steps']:,} steps in {seconds} s{rate}"
    best = number(best_expected_return(run.world.mdp))
    value, optimum = number(figures["value_at_start"]), number(figures["optimal_value_at_start"])
    rows = [
        ("value at the start", f"{value} of {optimum}", "greedy policy of optimum"),
        ("expected return", f"{number(figures['expected_return'])} of {best}", "greedy policy of best"),
        ("greedy policy ends", number(figures["greedy_ends"]), "probability"),
        ("largest error of Q", number(figures["max_error"]), "max |Q - Q*|"),
        ("last 100 episodes", number(figures["return_last_100"]), "mean return, exploring"),
        ("", number(figures["length_last_100"]), "mean length"),
        ("first reward", _first_reward(figures), ""),
    ]
    parts = [_head(run.recipe), done, "", policy_map(run.world, figures["policy"]), "", columns(rows)]
    if figures["first_reward_episode"] is None:
        parts += ["", advice(run.recipe)]
    return "\n".join(parts)


def several_runs(recipe: Recipe, figures: Figures) -> str:
    """Return the report of several runs; ``figures`` is their document of ``train --runs --json``."""
    runs = figures["runs"]
    rows = [("", "mean", "stderr", "min", "max", "runs")]
    for name, title in _SUMMARY.items():
        summary = figures["summary"][name]
        form = ",.0f" if name in ("episodes", "steps") else ".5g"
        shown = [number(summary[key], form) for key in ("mean", "stderr", "min", "max")]
        rows.append((title, shown[0], shown[1], shown[2], shown[3], f"{summary['count']:,}"))
    last = runs[-1]["seed"]
    seeds = f"seeds {recipe.seed} to {last}" if last != recipe.seed else f"seed {recipe.seed}"
    parts = [_head(recipe, seeds), "", columns(rows, right=(1, 2, 3, 4, 5))]
    blind = sum(row["first_reward_episode"] is None for row in runs)
    if blind:
        parts += ["", f"{blind:,} of {len(runs):,} runs never saw a reward.", advice(recipe)]
    return "\n".join(parts)


def advice(recipe: Recipe) -> str:
    """Return why a run may never see a reward, and what to try."""
    if recipe.hyperparameters.ties == "first":
        return (
            "No reward, nothing learned: the estimates stay equal, and --ties first then always takes the\n"
            "first action, which here leads nowhere. Try --ties random."
        )
    return (
        "No reward, nothing learned: the agent has not come upon one yet. Try more --episodes, a larger\n"
        "--epsilon, or an --initial-q above what can be earned."
    )


def _head(recipe: Recipe, seeds: str = "") -> str:
    algorithm = BY_ID[recipe.algorithm]
    values = recipe.hyperparameters.as_dict()
    settings = "  ".join(
        f"{PARAMETERS[name].symbol} {number(values[name], '.12g')}" for name in algorithm.parameters
    )
    return f"{recipe.scenario.title}: {algorithm.name}, {seeds or f'seed {recipe.seed}'}\n{settings}"


def _first_reward(figures: Figures) -> str:
    first = figures["first_reward_episode"]
    return "never" if first is None else f"episode {first:,}"
