"""Dyna-Q."""

from typing import Final

TABLES: Final = """
# The model: what each pair led to when it was last taken, (R, S'), where None is the end
model = {}
tried = {}  # the actions taken so far in each state
"""

TEXT: Final = """
def learn(state, action, reward, next_state):
    # Q(S,A) <- Q(S,A) + α [R + γ max Q(S',·) - Q(S,A)]   (equation 6.8)
    future = 0.0 if next_state is None else Q[next_state].max()
    Q[state][action] += $alpha * (reward + GAMMA * future - Q[state][action])


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
        $end_of_time
        result = None if terminated else next_state
        learn(state, action, reward, result)
        # Model(S,A) <- R, S'   (box on page 164)
        if (state, action) not in model:
            tried.setdefault(state, []).append(action)
        model[state, action] = (reward, result)
        # n times: a state seen before and an action taken there, by chance; learn from the model
        seen = list(tried)
        for _ in range(PLANNING_STEPS):
            s = seen[rng.integers(len(seen))]
            a = tried[s][rng.integers(len(tried[s]))]
            learn(s, a, *model[s, a])
        state, total, done = next_state, total + reward, terminated or truncated
    returns.append(total)
"""
