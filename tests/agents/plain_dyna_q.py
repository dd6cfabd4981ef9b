"""The box on page 164, line by line. One draw picks the state, and its remainder picks the action."""

from plain_world import PlainWorld, Table


def plain_dyna_q(world: PlainWorld) -> Table:
    q, gamma = world.table(), world.hyperparameters.gamma
    model: dict[int, dict[int, tuple[float, int | None]]] = {}

    def improve(pair: int, reward: float, next_state: int | None) -> None:
        following = 0.0 if next_state is None else world.best(next_state, q)
        q[pair] += world.step_size(world.visits[pair]) * (reward + gamma * following - q[pair])

    while world.steps_left:
        state, ended = world.start(), False
        while world.steps_left and not ended:
            pair = world.choose(state, q)
            reward, next_state, terminated, truncated = world.take(pair)
            answer = (reward, None if terminated else next_state)
            improve(pair, *answer)
            model.setdefault(state, {})[pair] = answer
            for _ in range(world.hyperparameters.planning_steps):
                draw = world.dice.random() * len(model)
                taken = model[list(model)[int(draw)]]
                imagined = list(taken)[int((draw - int(draw)) * len(taken))]
                improve(imagined, *taken[imagined])
            state, ended = next_state, terminated or truncated
    return q
