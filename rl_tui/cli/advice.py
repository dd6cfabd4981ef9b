"""What to say, and to suggest, where a run never saw a reward."""

from __future__ import annotations

from rl_tui.lab.run.recipe import Recipe


def no_reward(recipe: Recipe, blind: int = 1, runs: int = 1) -> str:
    """Return that ``blind`` of so many runs never saw a reward, why that may be, and what to try."""
    who = "This run" if runs == 1 else f"{blind:,} of {runs:,} runs"
    hyperparameters = recipe.hyperparameters
    if hyperparameters.initial_q != 0.0:
        # Estimates that start elsewhere move without a reward too: something was learned, and no tie lasts
        return f"{who} never saw a reward. Try more --episodes or a larger --epsilon."
    blank = f"{who} never saw a reward and learned nothing"
    if hyperparameters.ties == "first":
        return (
            f"{blank}: all estimates stay equal, and --ties first then\n"
            "always takes the first action, which here leads nowhere. Try --ties random."
        )
    return f"{blank}. Try more --episodes, a larger --epsilon,\nor an --initial-q above what can be earned."
