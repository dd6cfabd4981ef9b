"""SARSA."""

from typing import Final

TEXT: Final = """
returns = []
for episode in range(EPISODES):
    $begin
    state, _ = env.reset()
    action = choose(state)
    total, done = 0.0, False
    while not done:
        # Take A, observe R and S'; choose A' from S' using the policy derived from Q
        next_state, reward, terminated, truncated, _ = env.step(action)
        $note
        next_action = None if terminated else choose(next_state)
        # Q(S,A) <- Q(S,A) + α [R + γ Q(S',A') - Q(S,A)]   (equation 6.7)
        $end_of_time
        future = 0.0 if terminated else Q[next_state][next_action]
        Q[state][action] += $alpha * (reward + GAMMA * future - Q[state][action])
        state, action = next_state, next_action
        total, done = total + reward, terminated or truncated
    returns.append(total)
"""
