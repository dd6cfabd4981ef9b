"""The box on page 136, line by line."""

from plain_world import PlainWorld, Table


def plain_double_q_learning(world: PlainWorld) -> Table:
    q1, q2 = world.table(), world.table()
    count1, count2 = world.counts(), world.counts()

    def shown() -> Table:
        return {pair: (q1[pair] + q2[pair]) / 2 for pair in q1}

    while world.steps_left:
        state, ended = world.start(), False
        while world.steps_left and not ended:
            pair = world.choose(state, shown())
            reward, next_state, terminated, truncated = world.take(pair)
            # Heads or tails. The remainder of the draw, stretched to [0, 1) again, decides between equals
            draw = world.dice.random()
            if draw < 0.5:
                learning, judging, count, rest = q1, q2, count1, 2 * draw
            else:
                learning, judging, count, rest = q2, q1, count2, 2 * draw - 1
            count[pair] += 1
            alpha = world.step_size(count[pair])
            following = 0.0 if terminated else judging[world.argmax(next_state, learning, rest)]
            learning[pair] += alpha * (reward + world.hyperparameters.gamma * following - learning[pair])
            state, ended = next_state, terminated or truncated
    return shown()
