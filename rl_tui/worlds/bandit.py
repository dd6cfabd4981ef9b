"""The ``[bandit]`` table: arms with Gaussian rewards and a budget of pulls (Sutton & Barto, section 2.3)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import BeforeValidator

from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.findings import Finding, shown
from rl_tui.worlds.schema import Expect, Number, Section, is_number, is_table, number, refused, whole_number
from rl_tui.worlds.world import World
from rl_tui.worlds.world_section import WorldSection

if TYPE_CHECKING:
    from numpy.random import Generator

MOST_ARMS: Final = 10_000
LARGEST_STD: Final = 1e6
MOST_PULLS: Final = 1_000_000_000

STATE_NAME: Final = "bandit"


def _is_normal(value: object) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and number().test(value[0])
        and number(0, LARGEST_STD).test(value[1])
    )


class MeanDistribution(Section):
    """Where the true means of the arms are drawn from, anew for every seed."""

    normal: Annotated[
        tuple[float, float],
        Expect(f"[mean, standard deviation], the second from 0 to {LARGEST_STD:g}", _is_normal),
    ] = (0.0, 1.0)


def _number_of_means(means: object) -> object:
    if not isinstance(means, list) or not 0 < len(means) <= MOST_ARMS:
        raise refused(shown(means), f"1 to {MOST_ARMS:,} numbers")
    return means


class BanditSection(WorldSection):
    """The whole table: ``arms`` means drawn from ``mean``, or ``means`` written out (then without ``arms``).

    ``std`` is the standard deviation of the rewards of every arm, ``budget`` the pulls of a run.
    """

    arms: Annotated[int, whole_number(1, MOST_ARMS)] = 0
    mean: Annotated[MeanDistribution, Expect("a table, { normal = [mean, std] }", is_table)] = (
        MeanDistribution()
    )
    means: Annotated[list[Number], BeforeValidator(_number_of_means)] | None = None
    std: Annotated[float, number(0, LARGEST_STD)] = 1.0
    budget: Annotated[int, whole_number(1, MOST_PULLS)] = 1_000

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield what does not fit together: who says how many arms there are, and what they pay."""
        arms, means = raw.get("arms"), raw.get("means")
        if "means" not in raw and "arms" not in raw:
            yield Finding(("arms",), "nothing", f"a whole number from 1 to {MOST_ARMS:,}, or means")
        if isinstance(means, list) and is_number(arms) and len(means) != arms:
            yield Finding(
                ("means",),
                f"{len(means)} mean{'s' if len(means) > 1 else ''}",
                f"as many as there are arms ({shown(arms)})",
            )
        if "means" in raw and "mean" in raw:
            yield Finding(("mean",), "mean beside means", "either the distribution or the means themselves")

    @property
    def drawn_from_seed(self) -> bool:
        """Whether the means are drawn."""
        return self.means is None

    def build(self, generator: Generator) -> World:
        """Return the world; means that the file does not fix are the first draws from ``generator``."""
        from rl_tui.worlds.mdp import Outcome, Transition, tabular_mdp

        means = self._means(generator)
        arms = range(len(means))
        mdp = tabular_mdp(
            [STATE_NAME],
            [str(arm) for arm in arms],
            [Transition(0, arm, [Outcome(1.0, 0, means[arm], True, self.std, arm)]) for arm in arms],
            {0: 1.0},
        )
        return World(mdp, Arms(), self.budget)

    def _means(self, generator: Generator) -> list[float]:
        if self.means is not None:
            return self.means
        mean, std = self.mean.normal
        return [float(drawn) for drawn in generator.normal(mean, std, self.arms)]
