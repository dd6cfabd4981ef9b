"""The box on page 170, line by line."""

from plain_world import PlainWorld, Table


def plain_prioritized_sweeping(world: PlainWorld) -> Table:
    q, hyperparameters = world.table(), world.hyperparameters
    model: dict[int, tuple[float, int | None]] = {}
    waiting: dict[int, float] = {}

    def error(pair: int) -> float:
        reward, next_state = model[pair]
        following = 0.0 if next_state is None else world.best(next_state, q)
        return reward + hyperparameters.gamma * following - q[pair]

    def consider(pair: int) -> None:
        if abs(error(pair)) > hyperparameters.threshold:
            waiting[pair] = max(waiting.get(pair, 0.0), abs(error(pair)))

    while world.steps_left:
        state, ended = world.start(), False
        while world.steps_left and not ended:
            pair = world.choose(state, q)
            reward, next_state, terminated, truncated = world.take(pair)
            model[pair] = (reward, None if terminated else next_state)
            consider(pair)
            for _ in range(hyperparameters.planning_steps):
                if not waiting:
                    break
                urgent = min(waiting, key=lambda each: (-waiting[each], each))
                del waiting[urgent]
                q[urgent] += world.step_size(world.visits[urgent]) * error(urgent)
                for each, (_, led_to) in model.items():
                    if led_to is not None and urgent in world.pairs(led_to):
                        consider(each)
            state, ended = next_state, terminated or truncated
    return q
