"""The part of a script that plans."""

from __future__ import annotations

from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.lab.export.pieces import BEGIN_WORLD, argmax, report, template
from rl_tui.lab.export.settings_text import Told
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds.text import WorldText

_LOOK_AHEAD: Final = """
def look_ahead(state, action):
    # Σ p(s',r|s,a) [r + γ V(s')]; after the end there is nothing
    return sum(
        probability * (reward + GAMMA * (0.0 if terminated else V[next_state]))
        for $fields in outcomes(state, action)
    )


# The states that can be reached from the start: only these count
states, waiting = set(), list($starts)
while waiting:
    state = waiting.pop()
    if state not in states:
        states.add(state)
        for action in range(len(Q[state])):
            waiting += [result[1] for result in outcomes(state, action) if not result[3]]
states = sorted(states)
"""
_PLAYED: Final = """
# How good is it? Play it
returns = []
for _ in range(100):
    state, _ = env.reset()
    total, done, steps = 0.0, False, 0
    while not done and steps < 10_000:
        action = $act
        state, reward, terminated, truncated, _ = env.step(action)
        total, done, steps = total + reward, terminated or truncated, steps + 1
    returns.append(total)

print(f"{sweeps} sweeps; mean return of the last 100 episodes: {np.mean(returns):.3f}")

$report
"""


def planner_text(told: Told, text: WorldText) -> list[str]:
    """Return the parts that make the world, plan with its model, and play what was planned.

    Raises UserError where the world of the script has no model.
    """
    if not text.starts:
        raise UserError(
            "no script: this environment itself shows no transition table to plan with; take an algorithm "
            "that learns, such as q-learning"
        )
    planner = template("algorithms", told.algorithm)
    has_policy = told.algorithm == "policy-iteration"
    act, improve = "argmax(Q[state])", ""
    if has_policy:
        act = "int(rng.choice(len(Q[state]), p=policy[state]))"
        improve = planner.AMONG_EQUALS if told.values.ties == "random" else planner.FIRST_OF_EQUALS
    return [
        text.setup,
        BEGIN_WORLD,
        *([text.model.strip("\n")] if text.model else []),
        text.new_table,
        "Q = new_table(INITIAL_Q)",
        *([] if has_policy else [argmax(told)]),
        fill(_LOOK_AHEAD, {"fields": text.fields.replace("noise", "_"), "starts": text.starts}),
        fill(planner.TEXT, {"improve": improve}),
        fill(_PLAYED, {"act": act, "report": report(text, told)}),
    ]
