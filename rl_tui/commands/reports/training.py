"""The report of a training."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, parameters_of
from rl_tui.agents.exact.solve import best_expected_return
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.commands.line.output import alike, columns, number
from rl_tui.commands.reports.policy_map import policy_map
from rl_tui.common.findings import printable
from rl_tui.common.words import counted
from rl_tui.runs.bandit import BanditFigures
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.runs.figures import exact_world, why_inexact
from rl_tui.runs.measures import EXACT, MEASURES
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.run import Run
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.programs.evidence.verdict import ProgramVerdict

Figures = Mapping[str, Any]
Row = tuple[str, str, str]

FIRST_REWARD: Final = "first reward"
TITLES: Final = {name: measure.title for name, measure in MEASURES.items()}
LAST: Final = 100
MOST_NAMES: Final = 8
MOST_CHANGES: Final = 20
_NO_RETURN: Final = """\
such runs
are left out of the expected return. At γ = 1 they are also left out of the value
at the start."""
_WHOLE: Final = ("episodes", "steps")
_ROWS: Final = (*EXACT, "return_last_100", "length_last_100", "first_reward_episode", "episodes", "steps")
_BANDIT_ROWS: Final = (
    "expected_return",
    "best_arm_rate",
    "winnings",
    "regret",
    "max_error",
    "return_last_100",
    "episodes",
)


def one_run(run: Run, figures: Figures) -> str:
    """Return the report of one run. `figures` is the document of ``train --json``."""
    plans, spent = run.learner.plans, run.bandit
    parts = [_head(run.recipe)]
    if figures.get("journal"):
        parts.append(_changes(figures["journal"]))
    if spent is not None and not plans:
        parts += [_done(figures, "pull"), "", columns(_bandit_rows(figures, spent))]
    else:
        done = _planned(run, figures) if plans else _done(figures, "episode")
        parts += [done, "", policy_map(run.world, figures["policy"]), "", columns(_rows(run, figures))]
    if figures["first_reward_episode"] is None and not plans:
        parts += ["", no_reward(run.recipe)]
    return "\n".join(parts)


def _changes(journal: Sequence[Figures]) -> str:
    rows = [(f"after {each['step']:,}", str(each["name"]), number(each["value"], ".12g")) for each in journal]
    return columns([("step", "changed", "to"), *rows[:MOST_CHANGES]]) + (
        f"\n... and {len(rows) - MOST_CHANGES:,} more: --json has all" if len(rows) > MOST_CHANGES else ""
    )


def update_in_words(verdict: ProgramVerdict) -> str:
    """Return the detected update rule and its bugs, one line each."""
    from rl_tui.programs.evidence.verdict import Rule  # built-in agents never need this import

    update = verdict.update
    known = [
        f"{symbol} {number(value, '.6g')}"
        for symbol, value in (("α", update.alpha), ("γ", update.gamma))
        if value is not None
    ]
    is_known = update.rule != Rule.UNKNOWN
    what = f"its update is {update.rule.value}" if is_known else "its update is not known"
    settings = f"{' with' if is_known else ';'} {', '.join(known)}" if known else ""
    faults = (f"{each.noun}: {each.fault.value}: {each.text}" for each in verdict.findings)
    return "\n".join((f"{what}{settings}", *map(printable, faults)))


def agent_run(world: World, mdp: TabularMDP | None, title: str, figures: Figures, found: str) -> str:
    """Return the report of a user's own agent. `found` is about its update rule."""
    best = best_expected_return(mdp) if mdp else None
    exact = (
        _greedy_rows(figures, best)
        if mdp and figures["q"]
        else [("exact numbers", "none", _no_exact(figures))]
    )
    first = figures["first_reward_episode"]
    rows = [
        *exact,
        *_last_rows(figures),
        (FIRST_REWARD, "never" if first is None else f"episode {first:,}", "the first reward other than 0"),
    ]
    drawn = ["", policy_map(world, figures["policy"])] if figures["policy"] else []
    return "\n".join(
        [agent_head(title, figures), found, _done(figures, "episode"), *drawn, "", columns(rows)]
    )


def agent_head(title: str, figures: Figures, seeds: str = "") -> str:
    """Return the title line: scenario, agent, and seed or `seeds`."""
    agent = figures["agent"]
    return f"{title}: {agent['name']} of {agent['file']}, {seeds or 'seed ' + str(figures['seed'])}"


def _no_exact(figures: Figures) -> str:
    return "no table of values was found in the agent" if figures["q"] is None else NO_TABLE


def several_runs(recipe: Recipe, figures: Figures) -> str:
    """Return the report of several runs, from the document of ``train --runs --json``."""
    runs = figures["runs"]
    rows = [("", "mean", "stderr", "min", "max", "runs")]
    for name, title in _summary_titles(runs).items():
        summary = figures["summary"][name]
        if summary["count"] == 0 and name in EXACT:
            continue
        known = [summary[key] for key in ("mean", "stderr", "min", "max")]
        shown = [number(each, ",.0f") for each in known] if name in _WHOLE else alike(known)
        rows.append((title, shown[0], shown[1], shown[2], shown[3], f"{summary['count']:,}"))
    last = runs[-1]["seed"]
    seeds = f"seeds {recipe.seed} to {last}" if last != recipe.seed else f"seed {recipe.seed}"
    head = agent_head(recipe.scenario.title, figures, seeds) if "agent" in figures else _head(recipe, seeds)
    parts = [head, "", columns(rows, right=(1, 2, 3, 4, 5))]
    if "winnings" not in runs[0] and figures["summary"]["value_at_start"]["count"]:
        parts += ["", f"The {TITLES['value_at_start']} is discounted, returns are not."]
    endless = sum(row["expected_return"] is None and row["max_error"] is not None for row in runs)
    if endless:
        share = f"{endless:,} of {counted(len(runs), 'run')}"
        parts += ["", f"In {share} the greedy policy may never end; {_NO_RETURN}"]
    blind = sum(row["first_reward_episode"] is None for row in runs)
    if blind and "agent" not in figures:
        parts += ["", no_reward(recipe, blind, len(runs))]
    return "\n".join(parts)


def _done(figures: Figures, thing: str) -> str:
    seconds, speed = number(figures["seconds"], ".3f"), figures["steps_per_second"]
    rate = f", {_rate(speed)} steps/s" if speed else ""
    steps = f", {counted(figures['steps'], 'step')}" if thing == "episode" else ""
    return f"{counted(figures['episodes'], thing)}{steps} in {seconds} s{rate}"


def _rate(speed: float) -> str:
    return f"{speed / 1e6:.1f} million" if speed >= 1e5 else f"{speed:,.0f}"


def _planned(run: Run, figures: Figures) -> str:
    done = f"{counted(figures['episodes'], 'sweep')}, {counted(figures['steps'], 'backup')} of a state"
    return f"{done}\n{run.message}" if run.message else done


def _rows(run: Run, figures: Figures) -> list[Row]:
    mdp = exact_world(run)
    best = best_expected_return(mdp) if mdp else None
    if run.learner.plans:
        return _greedy_rows(figures, best)
    first = figures["first_reward_episode"]
    return [
        *(_greedy_rows(figures, best) if mdp else [("exact numbers", "none", why_inexact(run))]),
        *_last_rows(figures),
        (FIRST_REWARD, "never" if first is None else f"episode {first:,}", "the first reward other than 0"),
    ]


def _greedy_rows(figures: Figures, best: float | None) -> list[Row]:
    value, optimum = alike([figures["value_at_start"], figures["optimal_value_at_start"]])
    expected, possible = alike([figures["expected_return"], best])
    ends = figures["greedy_ends"]
    return [
        (TITLES["value_at_start"], f"{value}, optimal {optimum}", "discounted: greedy policy"),
        (TITLES["expected_return"], f"{expected}, optimal {possible}", "undiscounted: greedy policy"),
        (TITLES["greedy_ends"], "-" if ends is None else f"with probability {number(ends)}", ""),
        (TITLES["max_error"], number(figures["max_error"]), "max |Q - Q*|"),
    ]


def _last_rows(figures: Figures) -> list[Row]:
    if figures["return_last_100"] is None:
        return [("last episodes", "none is finished", "")]
    return [
        (
            _last(figures["episodes"]),
            number(figures["return_last_100"]),
            "undiscounted mean return, exploring",
        ),
        ("", number(figures["length_last_100"]), "mean length"),
    ]


def _bandit_rows(figures: Figures, spent: BanditFigures) -> list[Row]:
    greedy, best = alike([figures["expected_return"], figures["optimal_value_at_start"]])
    share = "-" if spent.best_arm_rate is None else f"{spent.best_arm_rate:.1%} of the time"
    possible = f"always the best arm: {spent.best_possible:,.1f} on average"
    return [
        ("greedy arm", _arms(figures["policy"][0]), "the best estimate"),
        ("its true mean", f"{greedy}, best {best}", "greedy arm, best arm"),
        ("best arm pulled", share, ""),
        ("winnings", f"{spent.winnings:,.1f}", possible),
        ("regret", f"{spent.regret:,.1f}", "lost by pulling other arms (true means)"),
        (TITLES["max_error"], number(figures["max_error"]), "max |Q - q*|"),
        (_last(figures["episodes"], "pull"), number(figures["return_last_100"]), "mean reward, exploring"),
    ]


def _arms(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= MOST_NAMES else f"{len(names):,} arms tie"


def _last(episodes: int, thing: str = "episode") -> str:
    # "last N episodes" with the real number, at most 100
    number_of = min(episodes, LAST)
    return f"last {thing}" if number_of == 1 else f"last {counted(number_of, thing)}"


def _summary_titles(runs: Sequence[Figures]) -> dict[str, str]:
    fewest, most = (min(pick(row["episodes"] for row in runs), LAST) for pick in (min, max))
    if "winnings" in runs[0]:
        own = {
            "expected_return": "true mean of the greedy arm",
            "return_last_100": f"reward, {_last(most, 'pull')}",
            "episodes": "pulls",
        }
        return {name: own.get(name, TITLES[name]) for name in _BANDIT_ROWS}
    last = _last(most) if fewest == most else f"last {most} episodes or fewer"
    own = {"return_last_100": f"return, {last}", "length_last_100": f"length, {last}"}
    return {name: own.get(name, TITLES[name]) for name in _ROWS}


def _head(recipe: Recipe, seeds: str = "") -> str:
    algorithm, hyperparameters = BY_ID[recipe.algorithm], recipe.hyperparameters
    policy = POLICY_BY_ID[hyperparameters.policy]
    name = algorithm.name if algorithm.planner else f"{algorithm.name}, {policy.name}"
    settings = "  ".join(
        f"{PARAMETERS[each].symbol} {number(hyperparameters.value(each), '.12g')}"
        for each in parameters_of(algorithm.id, policy.id)
        if _counts(each, hyperparameters)
    )
    return f"{recipe.scenario.title}: {name}, {seeds or f'seed {recipe.seed}'}\n{settings}"


def _counts(name: str, hyperparameters: Hyperparameters) -> bool:
    # Not the policy, nor a schedule without decay
    if PARAMETERS[name].schedule:
        return hyperparameters.value("epsilon_decay" if name.startswith("epsilon") else "alpha_decay") != 0.0
    return name != "policy"


def no_reward(recipe: Recipe, blind: int = 1, runs: int = 1) -> str:
    """Return a note that `blind` of `runs` runs never saw a reward, with a suggestion."""
    who = "This run" if runs == 1 else f"{blind:,} of {runs:,} runs"
    hyperparameters = recipe.hyperparameters
    if hyperparameters.initial_q != 0.0:
        # Estimates with Q₀ ≠ 0 change even without a reward, so something was learned and ties disappear
        return f"{who} never saw a reward. Try more --episodes or a larger --epsilon."
    blank = f"{who} never saw a reward and learned nothing"
    if hyperparameters.ties == "first":
        return (
            f"{blank}: all estimates stay equal, and --ties first then\n"
            "always takes the first action, which here leads nowhere. Try --ties random."
        )
    return (
        f"{blank}. Try more --episodes, a larger --epsilon,\nor an --initial-q above every possible return."
    )
