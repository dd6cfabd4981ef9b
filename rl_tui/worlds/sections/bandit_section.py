"""The ``[bandit]`` table: arms, rewards and a budget (Sutton & Barto, 2nd ed., chapter 2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Final, TypeGuard

from rl_tui.common.findings import Finding, shown
from rl_tui.common.limits import LARGEST_STD, MOST_ARMS, MOST_PULLS
from rl_tui.common.words import counted
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Number,
    WorldSection,
    is_number,
    is_table,
    number,
    one_of,
    sized,
    whole_number,
)
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator

    from rl_tui.worlds.mdp.tabular_mdp import Outcome

STATE_NAME: Final = "bandit"
BERNOULLI: Final = "bernoulli"
REWARDS: Final = ("gaussian", BERNOULLI)
_PROBABILITY: Final = "means from 0 to 1, since they are probabilities"


def _is_normal(value: object) -> bool:
    return _is_pair(value) and number(0, LARGEST_STD).test(value[1])


def _is_interval(value: object) -> TypeGuard[list[float]]:
    return _is_pair(value) and value[0] <= value[1]


def _is_pair(value: object) -> TypeGuard[list[float]]:
    return isinstance(value, list) and len(value) == 2 and all(number().test(each) for each in value)


class MeanDistribution(FileSection):
    """Distribution of the true means, drawn again for every seed.

    Either `normal`, mean and standard deviation, or `uniform`, lowest and highest value.
    """

    normal: (
        Annotated[
            tuple[float, float],
            Expect(f"[mean, standard deviation], the second from 0 to {LARGEST_STD:g}", _is_normal),
        ]
        | None
    ) = None
    uniform: (
        Annotated[tuple[float, float], Expect("[low, high], the first not above the second", _is_interval)]
        | None
    ) = None


_MEANS: Final = Expect(f"1 to {MOST_ARMS:,} numbers", sized(list, MOST_ARMS, 1))


class BanditSection(WorldSection):
    """A bandit with `arms` means drawn from `mean`, or explicit `means`.

    Gaussian `rewards` have the standard deviation `std`. Bernoulli rewards are 1 with the mean as
    probability, else 0. Default means come from N(0, 1), those of Bernoulli arms from [0, 1]. After every
    pull, every mean moves by a step with the standard deviation `drift`. A run has `budget` pulls.
    """

    arms: Annotated[int, whole_number(1, MOST_ARMS)] = 0
    rewards: Annotated[str, one_of(REWARDS)] = REWARDS[0]
    mean: Annotated[
        MeanDistribution,
        Expect("a table, { normal = [mean, std] } or { uniform = [low, high] }", is_table),
    ] = MeanDistribution()
    means: Annotated[list[Number], _MEANS] | None = None
    std: Annotated[float, number(0, LARGEST_STD)] = 1.0
    drift: Annotated[float, number(0, LARGEST_STD)] = 0.0
    budget: Annotated[int, whole_number(1, MOST_PULLS)] = 1_000

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield contradictions about arms and their rewards."""
        arms, means, mean = raw.get("arms"), raw.get("means"), raw.get("mean")
        if "means" not in raw and "arms" not in raw:
            yield Finding(("arms",), "nothing", f"a whole number from 1 to {MOST_ARMS:,}, or means")
        if isinstance(means, list) and is_number(arms) and len(means) != arms:
            expected = f"as many as there are arms ({shown(arms)})"
            yield Finding(("means",), counted(len(means), "mean"), expected)
        if "means" in raw and "mean" in raw:
            yield Finding(("mean",), "mean and means are both set; keep one of them")
        if isinstance(mean, dict) and "normal" in mean and "uniform" in mean:
            yield Finding(("mean",), "normal and uniform are both set; keep one of them")
        if raw.get("rewards") == BERNOULLI:
            yield from _bernoulli_findings(raw)

    @property
    def drawn_from_seed(self) -> bool:
        """True if the means are random."""
        return self.means is None

    def sketch(self) -> Arms:
        """Return the drawing of the bandit."""
        return Arms(self.arms if self.means is None else len(self.means))

    def build(self, generator: Generator) -> World:
        """Build the world. Random means are the first draws from `generator`."""
        from rl_tui.worlds.mdp.tabular_mdp import Transition, tabular_mdp

        means = self.drawn_means(generator)
        mdp = tabular_mdp(
            [STATE_NAME],
            [str(arm) for arm in range(len(means))],
            [Transition(0, arm, self._outcomes(arm, mean)) for arm, mean in enumerate(means)],
            {0: 1.0},
        )
        return World(replace(mdp, drift_std=self.drift) if self.drift else mdp, Arms(len(means)), self.budget)

    def drawn_means(self, generator: Generator) -> list[float]:
        """Return the true means. Random ones are drawn from `generator`."""
        if self.means is not None:
            return self.means
        uniform = self.mean.uniform
        if uniform is None and self.mean.normal is None and self.rewards == BERNOULLI:
            uniform = (0.0, 1.0)
        if uniform is not None:
            return [float(drawn) for drawn in generator.uniform(*uniform, self.arms)]
        return [float(drawn) for drawn in generator.normal(*(self.mean.normal or (0.0, 1.0)), self.arms)]

    def _outcomes(self, arm: int, mean: float) -> list[Outcome]:
        from rl_tui.worlds.mdp.tabular_mdp import Outcome

        if self.rewards == BERNOULLI:
            return [Outcome(mean, 0, 1.0, True, 0.0, arm), Outcome(1.0 - mean, 0, 0.0, True, 0.0, arm)]
        return [Outcome(1.0, 0, mean, True, self.std, arm)]


def _bernoulli_findings(raw: Mapping[str, Any]) -> Iterator[Finding]:
    means, mean = raw.get("means"), raw.get("mean")
    if isinstance(means, list):
        for index, each in enumerate(means[:MOST_ARMS]):
            if number().test(each) and not 0 <= each <= 1:
                yield Finding(("means", index), shown(each), _PROBABILITY)
    if isinstance(mean, dict):
        interval = mean.get("uniform")
        if "normal" in mean:
            yield Finding(
                ("mean", "normal"),
                "bernoulli rewards need means from 0 to 1; use uniform = [low, high]",
            )
        if _is_interval(interval) and not 0 <= interval[0] <= interval[1] <= 1:
            yield Finding(("mean", "uniform"), shown(interval), f"[low, high]: {_PROBABILITY}")
    for key in ("std", "drift"):
        if key in raw:
            yield Finding((key,), f"bernoulli rewards have no {key}; leave it out")
