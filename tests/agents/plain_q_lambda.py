"""Watkins's Q(λ) as section 12.10 describes it. Faded traces are dropped."""

from plain_world import PlainWorld, Table


def plain_q_lambda(world: PlainWorld) -> Table:
    q, hyperparameters = world.table(), world.hyperparameters
    while world.steps_left:
        state, ended = world.start(), False
        pair = world.choose(state, q)
        z = dict.fromkeys(q, 0.0)
        while world.steps_left and not ended:
            reward, next_state, terminated, truncated = world.take(pair)
            z[pair] = z[pair] + 1 if hyperparameters.traces == "accumulating" else 1
            following, next_pair, greedy = 0.0, -1, False
            if not terminated:
                next_pair = world.choose(next_state, q)
                following = world.best(next_state, q)
                greedy = q[next_pair] == following
            delta = reward + hyperparameters.gamma * following - q[pair]
            for each in q:
                if z[each]:
                    q[each] += world.step_size(world.visits[each]) * z[each] * delta
                z[each] *= hyperparameters.gamma * hyperparameters.lambda_ if greedy else 0.0
                if z[each] < 1e-12:
                    z[each] = 0.0
            state, pair, ended = next_state, next_pair, terminated or truncated
    return q
