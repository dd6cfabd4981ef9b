"""Let Optuna choose the step size and the exploration rate of SARSA on the cliff.

pip install rl-tui optuna
python tune_with_optuna.py [TRIALS]
"""

import sys

import optuna

import rl_tui


def mean_return(trial: optuna.Trial) -> float:
    """Return the mean return of the last 100 of 300 episodes, over ten seeds."""
    runs = rl_tui.train(
        "cliff",
        algorithm="sarsa",
        alpha=trial.suggest_float("alpha", 0.02, 1.0, log=True),
        epsilon=trial.suggest_float("epsilon", 0.0, 0.3),
        episodes=300,
        runs=10,
    )
    return runs.summary["return_last_100"]["mean"]


def main(trials: int = 40) -> None:
    """Print the best settings, and their result under seeds that Optuna did not see."""
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=0))
    study.optimize(mean_return, n_trials=trials)
    print(f"best of {trials} trials: {study.best_value:.2f} with {study.best_params}")
    # the best trial was also lucky: fresh seeds are fair
    fresh = rl_tui.train("cliff", algorithm="sarsa", **study.best_params, episodes=300, runs=30, seed=1000)
    print(f"with 30 fresh seeds: {fresh.summary['return_last_100']['mean']:.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
