"""Prioritized sweeping."""

from typing import Final

UPDATED: Final = ("s", "a")

TABLES: Final = """
# The model: what each pair led to when it was last taken, (R, S'), where None is the end
model = {}
leads_here = {}  # the pairs that lead to each state in the model
queue = {}  # the pairs that wait for an update, each with its priority
"""

TEXT: Final = """
def error_of(pair):
    # R + γ max Q(S',·) - Q(S,A), by the model
    (state, action), (reward, next_state) = pair, model[pair]
    future = 0.0 if next_state is None else Q[next_state].max()
    return reward + GAMMA * future - Q[state][action]


def consider(pair):
    # P <- |R + γ max Q(S',·) - Q(S,A)|; if P > θ insert the pair with priority P
    priority = abs(error_of(pair))
    if priority > THRESHOLD:
        queue[pair] = max(priority, queue.get(pair, 0.0))


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
        # Model(S,A) <- R, S'   (box on page 170)
        $end_of_time
        if (state, action) in model:
            leads_here[model[state, action][1]].discard((state, action))
        result = None if terminated else next_state
        model[state, action] = (reward, result)
        leads_here.setdefault(result, set()).add((state, action))
        consider((state, action))
        # n times, while there is something to do: update the most urgent pair
        for _ in range(PLANNING_STEPS):
            if not queue:
                break
            s, a = urgent = min(queue, key=lambda pair: (-queue[pair], pair))
            del queue[urgent]
            Q[s][a] += $alpha * error_of(urgent)
            # What is now to be said of the pairs that lead there?
            for pair in leads_here.get(s, ()):
                consider(pair)
        state, total, done = next_state, total + reward, terminated or truncated
    returns.append(total)
"""
