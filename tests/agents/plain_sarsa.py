"""The box on page 130, line by line."""

from plain_world import PlainWorld, Table


def plain_sarsa(world: PlainWorld) -> Table:
    q = world.table()
    while world.steps_left:
        state, ended = world.start(), False
        pair = world.choose(state, q)
        while world.steps_left and not ended:
            reward, next_state, terminated, truncated = world.take(pair)
            alpha = world.step_size(world.visits[pair])
            following, next_pair = 0.0, -1
            if not terminated:
                next_pair = world.choose(next_state, q)
                following = q[next_pair]
            q[pair] += alpha * (reward + world.hyperparameters.gamma * following - q[pair])
            state, pair, ended = next_state, next_pair, terminated or truncated
    return q
