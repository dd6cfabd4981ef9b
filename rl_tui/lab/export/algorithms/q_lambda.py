"""Watkins's Q(λ)."""

from typing import Final

UPDATED: Final = ("s", "a")

TEXT: Final = """
returns = []
for episode in range(EPISODES):
    $begin
    state, _ = env.reset()
    action = choose(state)
    trace = {}  # e(S,A) of the pairs that led here
    total, done = 0.0, False
    while not done:
        # Take A, observe R and S'; choose A' from S' using the policy derived from Q
        next_state, reward, terminated, truncated, _ = env.step(action)
        $note
        next_action = None if terminated else choose(next_state)
        # δ <- R + γ max Q(S',·) - Q(S,A)   (section 12.10)
        $end_of_time
        future = 0.0 if terminated else Q[next_state].max()
        is_greedy = not terminated and Q[next_state][next_action] == future
        error = reward + GAMMA * future - Q[state][action]
        trace[state, action] = $trace
        # Q <- Q + α δ e for every pair that has a trace
        for (s, a), e in trace.items():
            Q[s][a] += $alpha * error * e
        # e <- γλ e; no trace leads beyond an action that is not greedy
        decay = GAMMA * LAMBDA if is_greedy else 0.0
        trace = {pair: decay * e for pair, e in trace.items() if decay * e > 1e-12}
        state, action = next_state, next_action
        total, done = total + reward, terminated or truncated
    returns.append(total)
"""
