"""n-step SARSA."""

from typing import Final

UPDATED: Final = ("s", "a")

TABLES: Final = "$update_counts"

COUNTS: Final = "updates = new_table(0.0)  # of each estimate; the step size is 1 over it"

TEXT: Final = """
returns = []
for episode in range(EPISODES):
    $begin
    state, _ = env.reset()
    # S, A and R of every step of this episode; R[t + 1] follows S[t], A[t] as in the book
    S, A, R = [state], [choose(state)], [0.0]
    t, T, terminated = 0, np.inf, False
    while True:
        if t < T:
            state, action = S[t], A[t]
            next_state, reward, terminated, truncated, _ = env.step(action)
            $note
            S.append(next_state)
            R.append(reward)
            A.append(None if terminated else choose(next_state))
            if terminated or truncated:
                T = t + 1
        tau = t - STEPS + 1  # the step whose estimate is updated now
        if tau >= 0:
            # G <- R + γR + ... + γⁿ Q(S,A) of n steps later, if the episode goes on (equation 7.5)
            last = min(tau + STEPS, T)
            G = sum(GAMMA ** (i - tau - 1) * R[i] for i in range(tau + 1, last + 1))
            $end_of_time
            if last < T or not terminated:
                G += GAMMA ** (last - tau) * Q[S[last]][A[last]]
            s, a = S[tau], A[tau]
            $count_update
            Q[s][a] += $alpha * (G - Q[s][a])
        if tau == T - 1:
            break
        t += 1
    returns.append(sum(R))
"""

COUNT_UPDATE: Final = "updates[s][a] += 1"
