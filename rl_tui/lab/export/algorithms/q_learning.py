"""Q-learning."""

from typing import Final

TEXT: Final = """
returns = []
for episode in range(EPISODES):
    $begin
    state, _ = env.reset()
    total, done = 0.0, False
    while not done:
        # Choose A from S using the policy derived from Q; take it, observe R and S'
        action = choose(state)
        next_state, reward, terminated, truncated, _ = env.step(action)
        $note
        # Q(S,A) <- Q(S,A) + α [R + γ max Q(S',·) - Q(S,A)]   (equation 6.8)
        $end_of_time
        future = 0.0 if terminated else Q[next_state].max()
        Q[state][action] += $alpha * (reward + GAMMA * future - Q[state][action])
        state, total, done = next_state, total + reward, terminated or truncated
    returns.append(total)
"""
