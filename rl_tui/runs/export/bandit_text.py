"""A bandit as the text of a script."""

from __future__ import annotations

from rl_tui.runs.export.literals import packed
from rl_tui.runs.export.template import TEXTS, WorldText, fill, sections
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.sections.bandit_section import BERNOULLI, BanditSection


def bandit_text(section: BanditSection, mdp: TabularMDP) -> WorldText:
    """Return the text of the bandit of ``section`` with the arms of ``mdp``."""
    flags = {"bernoulli": section.rewards == BERNOULLI, "drift": bool(section.drift)}
    texts = sections(f"{__package__}.bandit", {name for name, is_set in flags.items() if is_set})
    means = [
        sum(float(mdp.probability[each] * mdp.reward[each]) for each in mdp.outcomes_of(arm))
        for arm in range(mdp.pairs)
    ]
    pieces = {
        "means": packed(map(repr, means), "MEANS = "),
        "std": repr(section.std),
        "drift": repr(section.drift),
    }
    return WorldText(
        setup=fill(texts["setup"], pieces),
        new_table=fill(TEXTS["array"], {"states": "1", "actions": "len(MEANS)"}),
        report=texts["report"],
        model=texts["model"],
        starts="[0]",
        remarks=("The means of the arms, which the agent has to find out, are written in this script.",),
    )
