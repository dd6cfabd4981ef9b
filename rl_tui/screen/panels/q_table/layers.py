"""The layers of the Q-table."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from rich.style import Style

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.number_form import NumberForm, SteadyForms
from rl_tui.screen.kit import layers
from rl_tui.screen.kit.numbers_in_common import ends, finite, lanes_in_view
from rl_tui.screen.kit.snapshot_facts import followed_step, has_estimates, studied_answer
from rl_tui.screen.kit.value_scale import Ramp, ValueScale
from rl_tui.screen.panels.policies.studied import shown_actions
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import FloatArray

LEARNED_NOT: Final = (layers.Layer.OPTIMAL, layers.Layer.POLICY)  # layers without learned numbers


def policy_q(snapshot: Snapshot) -> layers.Exact | None:
    """Return Q and likeliest pairs of the studied policy, [P] each."""
    answer, kind = studied_answer(snapshot), snapshot.answers.studied
    if answer is None or kind is None or answer.q is None or answer.policy is None:
        return None
    if snapshot.world.is_bandit:
        return None
    return answer.q, shown_actions(snapshot, kind, answer.policy)


def lacks_values(snapshot: Snapshot, layer: layers.Layer) -> bool:
    """Return whether values are missing because a policy may never end."""
    known = policy_q(snapshot) if layer is layers.Layer.POLICY else None
    return known is not None and bool(np.isnan(known[0]).any())


def exact_of(snapshot: Snapshot, layer: layers.Layer) -> layers.Exact | None:
    """Return exact numbers and framed pairs."""
    if layer is layers.Layer.POLICY:
        return policy_q(snapshot)
    if layer is layers.Layer.OPTIMAL:
        return layers.shown_exact(snapshot)
    return layers.exact_q(snapshot) if layer is layers.Layer.ERROR else None


def layer_choices(snapshot: Snapshot | None) -> tuple[layers.Layer, ...]:
    """Return the available layers."""
    missing = {layers.Layer.LANDSCAPE}
    if snapshot is None or layers.other_lane(snapshot) is None:
        missing.add(layers.Layer.LANES)
    if snapshot is None or policy_q(snapshot) is None:
        missing.add(layers.Layer.POLICY)
    if snapshot is not None and layers.hides_exact(snapshot):
        missing.update(layers.EXACT_LAYERS if not layers.veils_exact(snapshot) else (layers.Layer.ERROR,))
    if snapshot is not None and not has_estimates(snapshot):
        missing.update((layers.Layer.ERROR, layers.Layer.LANES))
    return tuple(layer for layer in layers.Layer if layer not in missing)


class Lit(NamedTuple):
    """The updated ``pair``, and its ``error``'s sign."""

    pair: int
    error: int


def lit_pair(snapshot: Snapshot) -> Lit | None:
    """Return the updated pair, unless too fast."""
    last = followed_step(snapshot)
    return None if last is None else Lit(last.updated_pair, last.error_sign)


class Figures:
    """The numbers of one layer at one moment.

    Greedy pairs are exactly equal, as the agent compares. ``sources``: pairs looked up by the last update.
    Both runs' ``numbers`` share a form, kept steady by ``forms``.
    """

    def __init__(
        self,
        snapshot: Snapshot,
        layer: layers.Layer,
        look: Look,
        exact: layers.Exact | None,
        forms: SteadyForms,
        scale: ValueScale,
        lit: Lit | None = None,
        sources: frozenset[int] = frozenset(),
    ) -> None:
        self.layer = layer
        self._look = look
        self._q = snapshot.agent.q
        self._visits = snapshot.agent.visits
        is_learned = layer not in LEARNED_NOT
        self._exact_greedy = None if is_learned or exact is None else exact[1]
        self._lit = lit if is_learned else None
        self._sources = sources if is_learned else frozenset()
        self._values: npt.NDArray[np.float64] | npt.NDArray[np.int64] = _values(snapshot, layer, exact)
        window = snapshot.agent.part if is_learned else None
        self._held = None if window is None else window.held  # of a large world: known numbers
        self._is_unknown = layer is layers.Layer.Q and not has_estimates(snapshot)
        self.numbers = _numbers(snapshot, layer, exact)
        self.low, self.high = ends(self.numbers)
        self._scale = ValueScale(self.low, self.high, Ramp.ERRORS) if layer is layers.Layer.LANES else scale
        self._total_visits: int | None = None
        self._steady = forms
        self._forms: dict[int, NumberForm] = {}

    def text(self, pair: int, width: int) -> str:
        """Write the number, or a dot without one."""
        if self._held is not None and not self._held[pair]:
            return ""
        x = self._values[pair].item()
        glyphs = self._look.glyphs
        if self.layer is layers.Layer.OPTIMAL and math.isnan(x):
            return layers.veiled(glyphs)
        if self._is_unknown or (x == 0 and self._is_new(pair) and self.layer is not layers.Layer.ERROR):
            return "." if glyphs.name == "ascii" else "·"
        if self.layer is layers.Layer.VISITS:
            return numbers.count(int(x), width)
        if self.layer is layers.Layer.POLICY and math.isnan(x):  # unlike a diverged estimate
            return numbers.missing(glyphs)
        return self._form(width).text(x, glyphs)

    def cells(self, width: int) -> int:
        """Return the longest number's width."""
        if self.layer is layers.Layer.VISITS:
            return len(numbers.count(int(self.high), width))
        return self._form(width).cells

    def style(self, pair: int, *, is_tinted: bool = True) -> Style:
        """Return a number's style."""
        palette = self._look.palette
        if is_tinted and self._held is not None and not self._held[pair]:
            return palette.text
        if pair in self._sources:
            return palette.source
        if self._is_unknown or self._is_new(pair):
            return palette.unvisited
        return self._tint(self._values[pair].item()) if is_tinted else palette.text

    def share(self, pair: int) -> float:
        """Return the share of visits, 0 to 1."""
        if self._total_visits is None:
            self._total_visits = int(self._visits.sum())
        return int(self._visits[pair]) / max(1, self._total_visits)

    def error(self, pair: int) -> int | None:
        """Return the last error's sign."""
        return self._lit.error if self._lit is not None and pair == self._lit.pair else None

    def greedy(self, pairs: range) -> tuple[int, ...]:
        """Return the greedy ones of ``pairs``."""
        if self._held is not None and not self._held[pairs.start]:
            return ()
        inside = slice(pairs.start, pairs.stop)
        if self._exact_greedy is not None:
            marked = self._exact_greedy[inside]
        else:
            q = self._q[inside]
            best = q.max()
            if not self._visits[inside].any() and q.min() == best:
                return ()
            marked = q == best
        return tuple(pairs.start + place for place in np.flatnonzero(marked).tolist())

    def framed(self, pairs: range) -> tuple[int, ...]:
        """Return the greedy ones, if not all."""
        greedy = self.greedy(pairs)
        return greedy if len(greedy) < len(pairs) else ()

    def _is_new(self, pair: int) -> bool:
        if self.layer is layers.Layer.LANES and self._values[pair]:  # the other run has been there
            return False
        return self.layer not in LEARNED_NOT and not self._visits[pair]

    def _tint(self, x: float) -> Style:
        palette = self._look.palette
        if math.isnan(x) and self.layer in LEARNED_NOT:
            return palette.text if self.layer is layers.Layer.POLICY else palette.unvisited
        return self._scale.style(x, palette) if math.isfinite(x) else palette.bad

    def _form(self, width: int) -> NumberForm:
        form = self._forms.get(width)
        if form is None:
            form = self._forms[width] = self._steady.form((self.layer, width), self.numbers, width)
        return form

    def share_form(self, width: int, form: NumberForm) -> None:
        """Use ``form`` for numbers of ``width`` cells."""
        self._forms[width] = form


def _values(
    snapshot: Snapshot, layer: layers.Layer, exact: layers.Exact | None
) -> npt.NDArray[np.float64] | npt.NDArray[np.int64]:
    if layer is layers.Layer.VISITS:
        return snapshot.agent.visits
    if layer is layers.Layer.Q:
        return snapshot.agent.q
    if layer is layers.Layer.LANES:
        other = layers.other_lane(snapshot)
        return np.zeros(len(snapshot.agent.q)) if other is None else np.asarray(snapshot.agent.q - other.q)
    if exact is None:
        raise ValueError(f"the layer {layer} needs the exact values")
    return exact[0] if layer in LEARNED_NOT else np.asarray(snapshot.agent.q - exact[0])


def _numbers(snapshot: Snapshot, layer: layers.Layer, exact: layers.Exact | None) -> FloatArray:
    found: list[npt.NDArray[np.float64] | npt.NDArray[np.int64]] = []
    for lane in lanes_in_view(snapshot):
        known = exact if lane is snapshot else exact_of(lane, layer)
        if layer is layers.Layer.LANES and lane is not snapshot:
            found.append(-found[0])
        elif known is not None or layer not in (*layers.EXACT_LAYERS, layers.Layer.POLICY):
            part = None if layer in LEARNED_NOT else lane.agent.part
            values = _values(lane, layer, known)
            found.append(values if part is None else values[part.pairs])
    return finite(np.concatenate(found, dtype=np.float64))
