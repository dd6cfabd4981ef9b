"""A step in words and as an equation (Sutton & Barto, 2nd ed., Fig. 3.1).

Most texts have forms, longest first.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

from rich.style import Style

from rl_tui.agents.catalogue import Lookup
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.agents.last_step import LastStep
from rl_tui.live.last_step.step_report import StepStory
from rl_tui.programs.evidence.verdict import Rule
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.draw.precision import agrees, figure, in_brackets, leading_zeros, parsed
from rl_tui.screen.kit.blocks import Equation, Term
from rl_tui.screen.panels.last_step.state_backup_text import backup_text
from rl_tui.screen.panels.last_step.update_text import UpdateText, setting, update_text
from rl_tui.screen.panels.program.words import clause
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

# The parts of the step


_TABLES = ("", "₁", "₂")
_NOT_KNOWN: Final = "the update is not known"
_FEWEST: Final = 2  # decimals of an estimate
_MORE: Final = 6  # decimals beyond the first significant digit


class StepWords:
    """The texts of ``story``.

    ``meant`` and ``went``: empty unless it slips. ``estimate`` was updated, ``bootstrap`` is in its target.
    """

    def __init__(self, story: StepStory, glyphs: Glyphs) -> None:
        world, last = story.world, story.last

        def action(number: int | None) -> str:
            return "" if number is None else names.action_name(world, number, glyphs)

        self.story = story
        self.state = names.state_name(world, last.state, glyphs)
        self.place = names.place(world, last.state)
        self.choices = _choices(story, glyphs)
        self.action = "" if last.planned else action(int(world.space.pair_action[last.pair]))
        self.meant, self.went = action(story.meant), action(story.went)
        self.chance = "" if story.chance is None else names.chance(story.chance, glyphs)
        self.reward = numbers.brief(last.reward, glyphs, decimals=4)
        self.next_state = "" if story.world.is_bandit else names.state_name(world, last.next_state, glyphs)
        self.landmark = names.landmark(world, last.next_state)
        self.endings = _endings(story)
        estimate = f"Q{_TABLES[last.table]}({names.pair_name(world, last.updated_pair, glyphs)})"
        self.estimate = estimate if last.learned else ""
        self.bootstrap = _bootstrap(story, glyphs)
        self.others: Sequence[str] = ()
        self.why_no_equation: Sequence[str] = ()
        if story.has_equation:
            self.update = update_text(last, story.step_size, glyphs, bootstraps=story.bootstraps)
            if last.gathered == last.reward:
                self.reward = self.update.gathered
            if last.others:
                others = f"{last.others:,}"
                self.others = f"and {others} {story.terms.others}", f"and {others} more", f"+{others}"
        else:
            self.update = _change_text(last, glyphs)
            self.why_no_equation = _why_no_equation(story)
        backup = story.state_backup
        self.backup = None if backup is None else backup_text(world, backup, glyphs)

    @property
    def outcome(self) -> str:
        """``wind ↑ 1, → 4``, ``meant ←, slipped ↓``, ``→ Pass``."""
        moved = f"meant {self.meant}, {self.slip}" if self.went else f"→ {self.next_state}"
        return f"{self.wind}, {moved}" if self.wind else moved

    @property
    def changes_nothing(self) -> bool:
        """True if the update seems to change nothing."""
        last = self.story.last
        return not self.story.has_equation and not last.others and last.before == last.after

    @property
    def wind(self) -> str:
        """The wind in cells: ``wind ↑ 1``."""
        cells = self.story.wind
        return f"wind {'↑' if cells > 0 else '↓'} {abs(cells)}" if cells else ""

    @property
    def slip(self) -> str:
        """The real action: ``slipped ↓``."""
        return f"{'went' if self.went == self.meant else 'slipped'} {self.went}"


@lru_cache(maxsize=1)
def words_of(story: StepStory, glyphs: Glyphs) -> StepWords:
    """Describe ``story``, once for all panels."""
    return StepWords(story, glyphs)


def _bootstrap(story: StepStory, glyphs: Glyphs) -> str:
    last, symbols = story.last, story.terms.bootstrap
    if last.planned or not story.bootstraps:
        return symbols if last.planned else ""
    # for a remembered pair, it is not the next state of this step
    is_next = last.bootstrap_state == last.next_state
    return symbols.format(
        next=names.state_name(story.world, last.next_state, glyphs) if is_next else "s′",
        own=_TABLES[last.table],
        other=_TABLES[3 - last.table] if last.table else "",
    )


def _endings(story: StepStory) -> Sequence[str]:
    if story.world.is_bandit or story.last.planned:
        return ()
    if story.last.terminated:
        return "the episode ends", "ends"
    if story.last.truncated:
        return "truncated by the time limit: still bootstraps", "truncated, still bootstraps", "time limit"
    return ()


def _choices(story: StepStory, glyphs: Glyphs) -> Sequence[str]:
    last, best = story.last, story.greedy
    if last.planned:
        return ()
    if last.by_hand:
        return "you chose it", "by you"
    if story.program is not None:
        return _choice_texts_of_program(last.pair, best, len(story.world.space.pairs_of(last.state)))
    if not story.policy.explores_by_epsilon:
        return _chosen_by_policy(story, glyphs)
    if last.explored:
        luck = ", by chance the greedy one" if last.pair in best else ""
        return f"a random action ({_share(last.epsilon)}){luck}", f"random{luck}", "random"
    if len(best) > 1:
        return f"one of {len(best)} tied greedy actions", f"greedy, {len(best)} tied", "greedy"
    return "the greedy action", "greedy"


def _share(epsilon: float) -> str:
    if not 0.0 < epsilon < 1.0:
        return "every step"
    one_in = 1.0 / epsilon
    is_whole = abs(one_in - round(one_in)) < numbers.NEGLIGIBLE
    return f"1 step in {one_in:,.0f}" if is_whole else f"{numbers.percent(epsilon)} of steps"


def _chosen_by_policy(story: StepStory, glyphs: Glyphs) -> Sequence[str]:
    policy = story.policy
    values = {name: story.hyperparameters.value(name) for name in policy.parameters if PARAMETERS[name].slide}
    if "epsilon" in values:
        values["epsilon"] = story.last.epsilon  # a schedule may have changed it
    written = ", ".join(
        f"{PARAMETERS[name].symbol} = {value if isinstance(value, str) else setting(value, glyphs)}"
        for name, value in values.items()
    )
    full = f"{policy.name} ({written})" if written else policy.name
    if story.last.explored:
        return f"{full}, not the greedy one", f"{policy.name}, not greedy"
    return f"{full}, the greedy one", f"{policy.name}, greedy"


def _choice_texts_of_program(pair: int, best: Sequence[int], count: int) -> Sequence[str]:
    """Return how a program chose, never "random": its exploration is unknown."""
    if not best:
        return "your program chose it", "its choice"
    if pair not in best:
        return "your program chose it: not greedy", "not greedy"
    if len(best) == count > 1:
        tied = "both tied" if count == 2 else f"all {count} tied"
        return f"your program chose it: {tied}", tied
    if len(best) > 1:
        return f"your program chose it: greedy, one of {len(best)} tied", f"greedy, {len(best)} tied"
    return "your program chose it: greedy", "greedy"


def _change_text(last: LastStep, glyphs: Glyphs) -> UpdateText:
    before = 0.0 if math.isnan(last.before) else last.before
    difference, first = last.after - before, _FEWEST + leading_zeros(before, last.after)
    texts = ["", "", ""]
    for decimals in range(first, first + _MORE):
        texts = [figure(each, decimals, glyphs) for each in (before, last.after, difference)]
        between = parsed(texts[1], glyphs) - parsed(texts[0], glyphs)
        shows = texts[0] != texts[1] or not difference
        if shows and agrees(between, texts[2], glyphs, decimals, digits=0.5):
            break
    sign = "+" if difference > 0.0 else ""
    return UpdateText(texts[0], "", "", "", "", "", sign + texts[2], texts[1])


def _why_no_equation(story: StepStory) -> Sequence[str]:
    last, program = story.last, story.program
    if last.others:
        cells = f"{last.others + 1:,} cells"
        return (f"this step changed {cells}; an update of one cell does not explain this", f"changed {cells}")
    update = None if program is None else program.verdict.update
    if update is None or update.rule is Rule.UNKNOWN:
        reason = "" if update is None else clause(update.reason)
        forms = (f"{_NOT_KNOWN}: {reason}", reason) if reason else ()
        return (*forms, f"{_NOT_KNOWN} yet", "not known yet")
    if update.rule is Rule.MONTE_CARLO:
        return (
            "Monte Carlo: at the end of an episode, from the return of its steps",
            "at the end, from returns",
        )
    if program is not None and program.table is not None and program.table.other:
        return "one of your two tables changed; their mean is shown", "one of two tables changed"
    return "this step does not fit the update rule of the other steps", "differs from its update", "departs"


# The update as an equation


NOW: Final = "now"  # the updated estimate of the pair that was taken
_WHICH: Final = {
    Lookup.BEST: "best",
    Lookup.NEXT: "next",
    Lookup.MEAN: "mean",
    Lookup.OTHER: "other",
    Lookup.POLICY: "next",
}
"""Words for the estimate in the target."""


def equation(
    words: StepWords, look: Look, before: Style, bootstrap: Style, after: Style, label: str
) -> Equation:
    """Return ``now = was + α·(r + γ·best − was)`` with its numbers."""
    story, update, glyphs = words.story, words.update, look.glyphs
    is_own = story.last.updated_pair == story.last.pair and not story.last.table
    left = Term("", NOW if is_own else words.estimate, update.after, after)
    gain = [Term(" = " if story.last.planned else f"{glyphs.times}(", story.terms.gathered, update.gathered)]
    if words.bootstrap:
        which = _WHICH[story.terms.lookup] if story.reads_by_the_book else words.bootstrap
        gain.append(Term(" + ", story.terms.discount, update.discount))
        gain.append(Term(glyphs.times, which, in_brackets(update.bootstrap, glyphs), bootstrap))
    if not story.last.planned:
        step_size = "1/N" if "/" in update.step_size else "α e" if story.has_trace else "α"
        gain = [
            Term(" = ", "was", update.before, before),
            Term(" + ", step_size, update.step_size),
            *gain,
            Term(f" {glyphs.minus} ", "was", in_brackets(update.before, glyphs), before),
            Term(")"),
        ]
    return Equation(left, gain, Piece(label, error_style(words, look)))


def error_style(words: StepWords, look: Look) -> Style:
    """Return the colour of δ's sign."""
    error = words.update.error
    falls = look.palette.bad if error.startswith(look.glyphs.minus) else look.palette.text
    return look.palette.good if error.startswith("+") else falls
