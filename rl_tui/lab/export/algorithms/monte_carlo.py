"""Monte Carlo control."""

from typing import Final

TABLES: Final = "$update_counts"

COUNTS: Final = "updates = new_table(0.0)  # of each estimate; the step size is 1 over it"

TEXT: Final = """
returns = []
for episode in range(EPISODES):
    $begin
    state, _ = env.reset()
    steps, done = [], False
    # Generate an episode by the policy derived from Q
    while not done:
        action = choose(state)
        next_state, reward, terminated, truncated, _ = env.step(action)
        $note
        steps.append((state, action, reward))
        state, done = next_state, terminated or truncated
    # Backwards through it: G <- γG + R, then Q(S,A) <- Q(S,A) + α [G - Q(S,A)]   (section 5.4)
    $first_return
    for state, action, reward in reversed(steps):
        G = GAMMA * G + reward
        $count_update
        Q[state][action] += $alpha * (G - Q[state][action])
    returns.append(sum(reward for _, _, reward in steps))
"""

COUNT_UPDATE: Final = "updates[state][action] += 1"
