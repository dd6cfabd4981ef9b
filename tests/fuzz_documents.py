"""Scenario documents, most of them nearly valid."""

from __future__ import annotations

from functools import cache
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID

BLOCK = 40

names = st.one_of(
    st.sampled_from("abc"),
    st.sampled_from("abc"),
    st.text(st.characters(exclude_categories=("Cs",)), max_size=8),
    st.sampled_from(["", " ", "x" * 60, "漢字漢字", "👩‍👩‍👧", "e\u0301", "שלום", "[b]", "a, b", "0"]),
)
numbers: st.SearchStrategy[Any] = st.one_of(
    st.integers(-3, 12),
    st.integers(-3, 12),
    st.floats(-2, 2),
    st.floats(),
    st.integers(),
    st.sampled_from([1e12, -1e12, 1e13, 10**9, 10**30]),
)
odd: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | numbers | names,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(names, inner, max_size=4),
    max_leaves=6,
)


def mostly(strategy: st.SearchStrategy[Any], wild: st.SearchStrategy[Any] = odd) -> st.SearchStrategy[Any]:
    return st.integers(0, 9).flatmap(lambda dice: wild if dice == 9 else strategy)


def table(required: dict[str, Any], optional: dict[str, Any]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries(required, optional=optional)


@st.composite
def shares(draw: st.DrawFn) -> dict[str, Any]:
    """Draw a distribution. It sums to 1 unless an odd value is in it."""
    over = draw(st.lists(names, min_size=1, max_size=3, unique=True))
    found: dict[str, Any] = {name: 1 / len(over) for name in over}
    if draw(st.integers(0, 5)) == 0:
        found[over[0]] = draw(odd)
    return found


transitions = table(
    {
        "state": mostly(st.sampled_from("abc")),
        "action": mostly(names),
        "reward": mostly(numbers),
        "to": mostly(st.sampled_from("abc") | shares()),
    },
    {"std": mostly(st.floats(0, 2))},
)
mdp = table(
    {
        "start": mostly(st.just("a") | shares()),
        "transition": mostly(st.lists(transitions, min_size=1, max_size=6)),
    },
    {
        "time_limit": mostly(st.integers(0, 50)),
        "place": mostly(
            st.dictionaries(names, st.lists(st.integers(0, 9), min_size=2, max_size=2), max_size=3)
        ),
    },
)
lines = st.integers(1, 6).flatmap(
    lambda width: st.lists(st.text("SS..GH#<>^vxé", min_size=width, max_size=width), min_size=1, max_size=6)
)
entries = table(
    {"kind": mostly(st.sampled_from(["floor", "wall", "start", "goal", "hole", "cliff"]))},
    {
        "reward": mostly(numbers),
        "terminal": mostly(st.booleans()),
        "exit": mostly(st.booleans()),
        "jump": mostly(st.sampled_from("SGx.")),
        "back": mostly(st.booleans()),
        "only": mostly(st.lists(st.sampled_from(["left", "up", "stay", "none"]), max_size=2)),
    },
)
rules = {
    "moves": mostly(st.sampled_from(["four", "king", "king+stay"])),
    "rewards": mostly(st.sampled_from(["entering", "leaving"])),
    "step_reward": mostly(numbers),
    "bump_reward": mostly(numbers),
    "noise": mostly(st.floats(0, 1)),
    "slippery": mostly(st.booleans()),
    "wind": mostly(st.lists(st.integers(-2, 2), max_size=6)),
    "wind_rows": mostly(st.lists(st.integers(-2, 2), max_size=6)),
    "gusts": mostly(st.booleans()),
    "time_limit": mostly(st.integers(0, 50)),
    "legend": mostly(st.dictionaries(st.sampled_from("xéG.S"), entries, max_size=2)),
}
random_map = table(
    {"rows": mostly(st.integers(1, 9)), "columns": mostly(st.integers(1, 9))},
    {"holes": mostly(st.floats(0, 0.9))},
)
grid = table({"map": mostly(lines.map("\n".join))}, rules) | table({"random": mostly(random_map)}, rules)
bandit = table(
    {},
    {
        "arms": mostly(st.integers(1, 12)),
        "rewards": mostly(st.sampled_from(["gaussian", "bernoulli"])),
        "mean": mostly(
            st.fixed_dictionaries({"normal": mostly(st.lists(numbers, min_size=2, max_size=2))})
            | st.fixed_dictionaries({"uniform": mostly(st.lists(st.floats(0, 1), min_size=2, max_size=2))})
        ),
        "means": mostly(st.lists(mostly(st.floats(0, 1)), max_size=5)),
        "std": mostly(st.floats(0, 2)),
        "drift": mostly(st.floats(0, 2)),
        "budget": mostly(st.integers(1, 500)),
    },
)
lakes = ["FrozenLake-v1", "FrozenLake8x8-v1", "CliffWalking-v1", "Taxi-v3", "Taxi-v4", "Blackjack-v1"]
others = ["CartPole-v1", "MountainCar-v0", "Acrobot-v1", "Pendulum-v1", "GridWorld-v0", "phys2d/CartPole-v1"]
environments = st.sampled_from(lakes) | st.sampled_from(others)
arguments = st.dictionaries(
    st.sampled_from(["is_slippery", "map_name", "desc", "natural", "sab", "is_rainy", "max_episode_steps"])
    | st.sampled_from(
        ["render_mode", "id", "goal_velocity", "success_rate", "reward_schedule", "additional_wrappers"]
    ),
    st.booleans()
    | st.sampled_from(
        ["4x4", "8x8", None, 1, 0, -1, 10**30, 0.5, [], ["SFG"], ["S", "G"], ["SG", "F"], [1, 2, 3]]
    )
    | odd,
    max_size=2,
)
bins = table(
    {"count": mostly(st.lists(mostly(st.integers(1, 6)), min_size=2, max_size=4))},
    {"low": mostly(st.lists(numbers, max_size=4)), "high": mostly(st.lists(numbers, max_size=4))},
) | table({"edges": mostly(st.lists(mostly(st.lists(numbers, max_size=4).map(sorted)), max_size=4))}, {})
gymnasium = table(
    {"id": mostly(environments)},
    {"kwargs": mostly(arguments), "table": mostly(st.booleans()), "bins": mostly(bins)},
)
defaults = table(
    {},
    {
        "algorithm": mostly(st.sampled_from(list(BY_ID))),
        "alpha": mostly(st.floats(0, 1) | st.just("sample-average")),
        "gamma": mostly(st.floats(0, 1)),
        "epsilon": mostly(st.floats(0, 1)),
        "episodes": mostly(st.integers(1, 50)),
        "policy": mostly(st.sampled_from(list(POLICY_BY_ID))),
        "initial_q": mostly(numbers),
        "ties": mostly(st.sampled_from(["random", "first"])),
        "n": mostly(st.integers(1, 8)),
        "planning_steps": mostly(st.integers(0, 9)),
    },
)
head = {
    "title": mostly(names),
    "summary": mostly(names),
    "order": mostly(st.integers(0, 9)),
    "defaults": mostly(defaults),
}
documents = st.one_of(
    table({"mdp": mostly(mdp)}, head),
    table({"grid": mostly(grid)}, head),
    table({"bandit": mostly(bandit)}, head),
    table({"gymnasium": mostly(gymnasium)}, head),
    table({"gymnasium": mostly(gymnasium)}, {**head, "extra": odd}),
)


@cache
def block(number: int) -> list[dict[str, Any]]:
    drawn: list[dict[str, Any]] = []

    @seed(number)
    @settings(
        max_examples=BLOCK,
        database=None,
        phases=[Phase.generate],
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(documents)
    def collect(document: dict[str, Any]) -> None:
        drawn.append(document)

    collect()
    return drawn
