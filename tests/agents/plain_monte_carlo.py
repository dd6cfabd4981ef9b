"""The box on page 101 with every visit (section 5.4) and an incremental mean (equation 6.1).

A truncated episode adds the policy's expected return from its last state, discounted.
"""

from plain_world import PlainWorld, Table


def plain_monte_carlo(world: PlainWorld) -> Table:
    q, count, gamma = world.table(), world.counts(), world.hyperparameters.gamma
    while world.steps_left:
        state, ended = world.start(), False
        episode = []
        while not ended:
            if not world.steps_left:
                return q
            pair = world.choose(state, q)
            reward, state, terminated, truncated = world.take(pair)
            episode.append((pair, reward))
            ended = terminated or truncated
        beyond = 0.0 if terminated else world.expectation(state, q)
        G, discount = 0.0, 1.0
        for pair, reward in reversed(episode):
            G = gamma * G + reward
            discount *= gamma
            count[pair] += 1
            q[pair] += world.step_size(count[pair]) * (G + discount * beyond - q[pair])
    return q
