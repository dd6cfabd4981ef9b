"""The box on page 147, line by line. A truncated episode bootstraps from the pair that would follow."""

import math

from plain_world import PlainWorld, Table


def plain_n_step_sarsa(world: PlainWorld) -> Table:
    q, count = world.table(), world.counts()
    n, gamma = world.hyperparameters.n, world.hyperparameters.gamma
    while world.steps_left:
        A = [world.choose(world.start(), q)]
        R = [0.0]
        T, terminated, t = math.inf, False, 0
        while True:
            if t < T:
                if not world.steps_left:
                    return q
                reward, next_state, terminated, truncated = world.take(A[t])
                R.append(reward)
                if not terminated:
                    A.append(world.choose(next_state, q))
                if terminated or truncated:
                    T = t + 1
            tau = t - n + 1
            if tau >= 0:
                h = min(tau + n, T)
                G, discount = 0.0, 1.0
                for i in range(tau + 1, int(h) + 1):
                    G += discount * R[i]
                    discount *= gamma
                if h < T or not terminated:
                    G += discount * q[A[int(h)]]
                count[A[tau]] += 1
                q[A[tau]] += world.step_size(count[A[tau]]) * (G - q[A[tau]])
            if tau == T - 1:
                break
            t += 1
    return q
