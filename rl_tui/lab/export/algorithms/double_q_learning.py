"""Double Q-learning."""

from typing import Final

TABLES: Final = """
# Two tables that judge each other; Q is their mean, by which actions are chosen
Q1, Q2 = new_table(INITIAL_Q), new_table(INITIAL_Q)
$update_counts
"""

COUNTS: Final = (
    "updates1, updates2 = new_table(0.0), new_table(0.0)  # in each table; the step size is 1 over it"
)

TEXT: Final = """
returns = []
for episode in range(EPISODES):
    $begin
    state, _ = env.reset()
    total, done = 0.0, False
    while not done:
        # Choose A from S using the policy derived from Q1 and Q2; take it, observe R and S'
        action = choose(state)
        next_state, reward, terminated, truncated, _ = env.step(action)
        $note
        # With probability 0.5 the one table learns, else the other
        first = rng.random() < 0.5
        learning, judging = (Q1, Q2) if first else (Q2, Q1)
        $count_update
        # Q1(S,A) <- Q1(S,A) + α [R + γ Q2(S', argmax Q1(S',·)) - Q1(S,A)]   (equation 6.10)
        $end_of_time
        future = 0.0
        if not terminated:
            future = judging[next_state][argmax(learning[next_state])]
        error = reward + GAMMA * future - learning[state][action]
        learning[state][action] += $alpha * error
        Q[state][action] = (Q1[state][action] + Q2[state][action]) / 2
        state, total, done = next_state, total + reward, terminated or truncated
    returns.append(total)
"""

COUNT_UPDATE: Final = """updates = updates1 if first else updates2
updates[state][action] += 1"""
