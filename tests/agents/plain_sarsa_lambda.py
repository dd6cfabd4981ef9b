"""The box on page 305, line by line, with one feature for each pair. Faded traces are dropped."""

from plain_world import PlainWorld, Table


def plain_sarsa_lambda(world: PlainWorld) -> Table:
    q, hyperparameters = world.table(), world.hyperparameters
    while world.steps_left:
        state, ended = world.start(), False
        pair = world.choose(state, q)
        z = dict.fromkeys(q, 0.0)
        while world.steps_left and not ended:
            reward, next_state, terminated, truncated = world.take(pair)
            z[pair] = z[pair] + 1 if hyperparameters.traces == "accumulating" else 1
            following, next_pair = 0.0, -1
            if not terminated:
                next_pair = world.choose(next_state, q)
                following = q[next_pair]
            delta = reward + hyperparameters.gamma * following - q[pair]
            for each in q:
                if z[each]:
                    q[each] += world.step_size(world.visits[each]) * z[each] * delta
                z[each] *= hyperparameters.gamma * hyperparameters.lambda_
                if z[each] < 1e-12:
                    z[each] = 0.0
            state, pair, ended = next_state, next_pair, terminated or truncated
    return q
