"""A bandit as the text of a script."""

from __future__ import annotations

from typing import Final

from rl_tui.lab.export.literals import packed
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds.text import ARRAY, WorldText
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.sections.bandit_section import BERNOULLI, BanditSection

SETUP: Final = """
# The true means, which the agent does not see: those of this seed. Look away if you want to guess
$means
$settings


class Bandit(gym.Env):
    observation_space = gym.spaces.Discrete(1)
    action_space = gym.spaces.Discrete(len(MEANS))
    $drifting_means

    def reset(self, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, arm):
        # One state, and every pull is a whole episode
        $reward
        $drift
        return 0, reward, True, False, {}


env = Bandit()
"""

MODEL: Final = """
def outcomes(state, arm):
    # Of a noisy reward a planner needs to know the mean: (probability, next state, reward, the end)
    return [(1.0, 0, MEANS[arm], True)]
"""

REPORT: Final = """
print("arm  estimate  true mean")
for arm, estimate in enumerate(Q[0]):
    mark = "  <- greedy" if estimate == Q[0].max() else ""
    print(f"{arm:>3}  {estimate:>8.3f}  {$mean:>9.3f}{mark}")
"""


def bandit_text(section: BanditSection, mdp: TabularMDP) -> WorldText:
    """Return the text of the bandit of ``section`` with the arms of ``mdp``."""
    bernoulli = section.rewards == BERNOULLI
    means = [
        sum(float(mdp.probability[each] * mdp.reward[each]) for each in mdp.outcomes_of(arm))
        for arm in range(mdp.pairs)
    ]
    settings = [] if bernoulli else [f"STD = {section.std!r}  # the noise of every reward"]
    mean = "MEANS[arm]"
    if section.drift:
        settings.append(f"DRIFT = {section.drift!r}  # after each pull every mean takes a step of this size")
        mean = "env.means[arm]"
    return WorldText(
        setup=fill(
            SETUP,
            {
                "means": packed(map(repr, means), "MEANS = "),
                "settings": "\n".join(settings),
                "drifting_means": "means = np.array(MEANS)" if section.drift else "",
                "reward": _reward(bernoulli, bool(section.drift)),
                "drift": "self.means += DRIFT * self.np_random.standard_normal(len(MEANS))"
                if section.drift
                else "",
            },
        ),
        new_table=fill(ARRAY, {"states": "1", "actions": "len(MEANS)"}),
        report=REPORT,
        report_pieces={"mean": mean},
        model=MODEL,
        starts="[0]",
        remarks=("The means of the arms, which the agent has to find out, are written in this script.",),
    )


def _reward(bernoulli: bool, drifts: bool) -> str:
    if bernoulli:
        return "reward = 1.0 if self.np_random.random() < MEANS[arm] else 0.0"
    mean = "self.means[arm]" if drifts else "MEANS[arm]"
    return f"reward = {mean} + STD * self.np_random.standard_normal()"
