"""The box on page 131, line by line."""

from plain_world import PlainWorld, Table


def plain_q_learning(world: PlainWorld) -> Table:
    q = world.table()
    while world.steps_left:
        state, ended = world.start(), False
        while world.steps_left and not ended:
            pair = world.choose(state, q)
            reward, next_state, terminated, truncated = world.take(pair)
            alpha = world.step_size(world.visits[pair])
            following = 0.0 if terminated else world.best(next_state, q)
            q[pair] += alpha * (reward + world.hyperparameters.gamma * following - q[pair])
            state, ended = next_state, terminated or truncated
    return q
