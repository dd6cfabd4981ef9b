# expect: {"rule": "q-learning", "alpha": 0.4, "gamma": 0.9, "alpha_schedule": "constant", "table": "q"}
import argparse

import gymnasium
import numpy


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--episodes", type=int, default=60)
    parser.add_argument("--lr", type=float, default=0.4)
    parser.add_argument("--discount", type=float, default=0.9)
    args = parser.parse_args()

    env = gymnasium.make("Taxi-v4")
    rng = numpy.random.default_rng()
    q = numpy.zeros([500, 6])
    for i in range(args.episodes):
        s, _ = env.reset()
        over = False
        while not over:
            a = int(rng.integers(6)) if rng.random() < 0.1 else int(q[s].argmax())
            s_, r, over, cut, _ = env.step(a)
            target = r if over else r + args.discount * q[s_].max()
            q[s, a] = (1 - args.lr) * q[s, a] + args.lr * target
            s = s_
            if cut:
                break


if __name__ == "__main__":
    main()
