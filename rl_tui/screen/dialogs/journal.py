"""Going to a moment, branch or change."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, NamedTuple

from textual.binding import Binding, BindingType

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.words import counted
from rl_tui.live.commands import AddBranch, GoTo
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs import recipe as recipes
from rl_tui.runs.timeline.branches import Timeline
from rl_tui.screen.dialogs.compare_lanes import branches_beside
from rl_tui.screen.dialogs.form import Candidate, Choice, Form, TypedLine
from rl_tui.screen.draw.names import action_name
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.kit.snapshot_facts import episodes_begun
from rl_tui.screen.panels.controls.settings import called
from rl_tui.screen.panels.timeline import first_reward, known_end
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.editing.edit import BETWEEN, PREFIX, written_edits
from rl_tui.worlds.world import World

# The branches


STEP_BACK, EPISODE_BACK = "b", "B"  # keys of the playground in sentences
HOW_TO_BRANCH: Final = (
    f"To make another branch, go back with {STEP_BACK} or {EPISODE_BACK} and change something."
)
NO_CHANGE: Final = "Nothing was changed in this branch."
_MOST_EDITS: Final = 2  # of a stroke that are listed
_KEYS: Final = "c: compare   tab: changes"


class Moment(NamedTuple):
    """A branch (from 0) and a step in it, None for its current moment."""

    branch: int
    step: int | None = None


class JournalScreen(Form):
    """Branches and changes. The answer is where to go."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("c", "compare", "compare", id="journal.compare", tooltip="Open the branch as another run."),
        Binding("tab", "changes", "changes", id="journal.changes", tooltip="List the changes, to go to one."),
    ]

    def __init__(self, look: Look, snapshot: Snapshot) -> None:
        timeline = snapshot.timeline
        unit = "pull" if snapshot.world.is_bandit else "step"
        self.journals = [
            journal_lines(branch.journal, snapshot.recipe, snapshot.world, look.glyphs)
            for branch in timeline.branches
        ]
        self._timeline = timeline
        self._beside = branches_beside(snapshot)
        candidates = [
            _branch_row(timeline, number, lines, unit) for number, lines in enumerate(self.journals)
        ]
        super().__init__("Branches", candidates, str(timeline.branch), look.glyphs, keys=_KEYS, does="go")

    def choose(self, id: str) -> None:  # noqa: A002
        """Answer the branch."""
        self.dismiss(Moment(int(id)))

    def action_changes(self) -> None:
        """List the changes, and answer one's moment."""
        branch, name = self.branch, self._timeline.branches[self.branch].name
        if not self.journals[branch]:
            self.tell_about(NO_CHANGE)
            return
        rows = [Candidate(f"{place}", line.text) for place, line in enumerate(self.journals[branch])]

        def chosen(place: str | None) -> None:
            if place is not None:
                self.dismiss(Moment(branch, self.journals[branch][int(place)].step))

        self.app.push_screen(Choice(f"Changes in {name}", rows, "", self.glyphs), chosen)

    def action_compare(self) -> None:
        """Answer the branch to compare with."""
        name = self._timeline.branches[self.branch].name
        if self.branch in self._beside:
            self.dismiss(AddBranch(self.branch))
        elif self.branch != self._timeline.branch:
            self.tell_about(f"Not here: {name} is already open as a run.")
        elif len(self.journals) > 1:
            self.tell_about(f"Not here: {name} is the current one. Choose another branch.")
        else:
            self.tell_about("Not here: there is no other branch to compare with.")

    @property
    def branch(self) -> int:
        """The branch under the cursor."""
        return int(self.at or 0)


def _branch_row(timeline: Timeline, number: int, lines: Sequence[JournalLine], unit: str) -> Candidate:
    branch = timeline.branches[number]
    parts = _how_much(lines)
    if branch.parent is not None:
        parts.insert(0, f"from {timeline.branches[branch.parent].name} at {unit} {branch.fork:,}")
    changes = " · ".join(line.text for line in lines[-_MOST_CHANGES:]) or NO_CHANGE
    about = (
        *([as_sentence(", ".join(parts))] if branch.parent is not None or lines else []),
        changes,
        *([HOW_TO_BRANCH] if len(timeline.branches) == 1 else []),
    )
    return Candidate(
        str(number), branch.name, about, value=f"to {unit} {branch.end:,}", words=", ".join(parts)
    )


_MOST_CHANGES: Final = 4  # of a branch that are listed


def _how_much(lines: Sequence[JournalLine]) -> list[str]:
    changes, by_hand = sum(not line.by_hand for line in lines), sum(line.by_hand for line in lines)
    settings = [counted(changes, "change")] if changes else []
    steps = [f"{by_hand:,} by hand"] if by_hand else []
    return settings + steps or ["no change"]


@dataclass(frozen=True, slots=True)
class JournalLine:
    """A change at ``step``, or steps ``by_hand`` up to ``last``."""

    step: int
    last: int
    what: str
    by_hand: int = 0

    @property
    def text(self) -> str:
        """``step 1,200: α 0.1 → 0.5``, ``steps 3,400–3,460: 61 by hand``."""
        first = self.step + bool(self.by_hand)  # a setting applies after its step, a person takes the next
        when = f"step {first:,}" if self.last <= first else f"steps {first:,}–{self.last:,}"
        return f"{when}: {self.what}"


def journal_lines(
    journal: Sequence[recipes.JournalEntry], recipe: recipes.Recipe, world: World, glyphs: Glyphs
) -> list[JournalLine]:
    """Write ``journal``, joining steps by hand."""
    lines: list[JournalLine] = []
    for entries in _grouped(journal):
        first, last, change = entries[0].step, entries[-1].step, entries[-1].change
        if isinstance(change, recipes.TakeAction):
            count = len(entries)
            what = f"{count} by hand" if count > 1 else f"by hand {_taken(world, change.action, glyphs)}"
            lines.append(JournalLine(first, last + 1, what, count))
            continue
        if isinstance(change, recipes.OrderSweep):
            what = f"next sweep: {change.phase}"
        elif isinstance(change, recipes.WorldChange):
            what = _edited(change)
        else:
            symbol = f"{PARAMETERS[change.name].symbol} " if isinstance(change, recipes.SetParameter) else ""
            before, recipe = recipe, recipes.changed_recipe(recipe, change)
            what = f"{symbol}{_called(before, change)} → {_called(recipe, change)}"
        lines.append(JournalLine(first, first, what))
    return lines


def _grouped(journal: Sequence[recipes.JournalEntry]) -> Iterator[Sequence[recipes.JournalEntry]]:
    group: list[recipes.JournalEntry] = []
    for entry in journal:
        if group and not _goes_on(group[-1], entry):
            yield group
            group = []
        group.append(entry)
    if group:
        yield group


def _goes_on(before: recipes.JournalEntry, entry: recipes.JournalEntry) -> bool:
    was, change = before.change, entry.change
    if type(was) is not type(change) or isinstance(change, recipes.WorldChange):
        return False
    if (
        isinstance(change, recipes.SetParameter)
        and isinstance(was, recipes.SetParameter)
        and change.name != was.name
    ):
        return False
    return entry.step == before.step + isinstance(change, recipes.TakeAction)


def _edited(change: recipes.WorldChange) -> str:
    match change:
        case recipes.EditWorld(edits):
            more = len(edits) - _MOST_EDITS
            shown = written_edits(edits[:_MOST_EDITS]).replace(PREFIX, "").replace(BETWEEN, f"{BETWEEN} ")
            return f"world: {shown}{f' and {more:,} more' if more > 0 else ''}"
        case recipes.UndoEdit():
            return "world: an edit undone"
        case recipes.RedoEdit():
            return "world: an edit redone"


def _taken(world: World, action: int | str, glyphs: Glyphs) -> str:
    names = world.space.action_names
    if isinstance(action, str) and action not in names:
        return action
    return action_name(world, names.index(action) if isinstance(action, str) else action, glyphs)


def _called(recipe: recipes.Recipe, change: recipes.Setting) -> str:
    if isinstance(change, recipes.SwitchAlgorithm):
        return algorithm_row(recipe.algorithm).name
    return called(change.name, recipe.hyperparameters.value(change.name))


# Go to a moment


_GO_ON: Final = "esc, then space goes on from there"
_OFFSETS: Final = {"+": 1, "-": -1}
_STEPS: Final = ("", "step", "steps", "pull", "pulls")  # a pull is a step
_EPISODES: Final = ("e", "ep", "episode", "episodes", "sweep", "sweeps")
_NUMBER: Final = r"\d{1,18}|\d{1,3}(?:,\d{3}){1,5}"
_SHARE: Final = re.compile(r"(\d{1,18}(?:\.\d+)?)\s*%", re.ASCII)
_MOMENT: Final = re.compile(rf"([a-z]*|[+-])\s*({_NUMBER})", re.ASCII)


BRANCHES: Final = "branches"
"""The answer if the person wants to choose a branch."""


def goto_form(snapshot: Snapshot, glyphs: Glyphs) -> Form:
    """Ask for a moment, as :func:`parse_goto` reads it."""

    def read(text: str) -> str:
        if text != BRANCHES:
            parse_goto(text, snapshot)
        return text

    entry = TypedLine(str(snapshot.timeline.current.here), _expected(snapshot), read)
    return Form("Go to", _places(snapshot), "", glyphs, entry=entry, does="go")


def _places(snapshot: Snapshot) -> Iterator[Candidate]:
    branch, unit = snapshot.timeline.current, "pull" if snapshot.world.is_bandit else "step"
    results = known_end(snapshot).results
    reward = None if snapshot.agent.row.planner else first_reward(results)
    about = "" if results.first_reward_episode else "about "  # the curve of one's own script has bins
    change = branch.journal[-1].step if branch.journal else None
    yield Candidate("start", "start", value=f"{unit} 0")
    yield Candidate(
        "e1" if reward is None else f"e{int(reward) + 1}",
        "first reward",
        ("The first return above 0.",),
        "" if reward is not None else "no return is above 0 so far",
        "" if reward is None else f"{about}episode {int(reward) + 1:,}",
    )
    yield Candidate(
        f"step {change or 0}",
        "last change",
        ("Your latest change.",),
        "" if change is not None else "nothing was changed in this branch",
        "" if change is None else f"{unit} {change:,}",
    )
    yield Candidate("50%", "50 %", value=f"{unit} {round(branch.end / 2):,}")
    yield Candidate("end", "end", value=f"{unit} {branch.end:,}")
    count = len(snapshot.timeline.branches)
    yield Candidate(BRANCHES, "branches", ("Choose a branch, or a change in one.",), value=f"{count:,}")


def parse_goto(text: str, snapshot: Snapshot) -> GoTo:
    """Return the command for ``text``. Raises ValueError if it is not a moment of the run."""
    end = snapshot.timeline.current.end
    text = text.strip().lower().replace("−", "-")
    if text in ("start", "end"):
        return GoTo(0 if text == "start" else end)
    share = _SHARE.fullmatch(text)
    if share:
        if float(share[1]) > 100.0:
            raise ValueError("type a percentage from 0% to 100%")
        return GoTo(round(end * float(share[1]) / 100.0))
    moment = _MOMENT.fullmatch(text)
    if not moment or moment[1] not in (*_OFFSETS, *_STEPS, *_EPISODES):
        raise ValueError("type a step (500, +50, -50), an episode (e12), a percentage, start or end")
    number = int(moment[2].replace(",", ""))
    if moment[1] in _EPISODES:
        return _episode(number, snapshot)
    if moment[1] in _OFFSETS:
        number = max(0, snapshot.timeline.current.here + _OFFSETS[moment[1]] * number)
    if number > end:
        raise ValueError(f"the run has reached step {end:,} so far; {_GO_ON}")
    return GoTo(number)


def _episode(number: int, snapshot: Snapshot) -> GoTo:
    unit = unit_of(snapshot)
    begun = episodes_begun(snapshot)
    if number < 1:
        raise ValueError(f"{unit}s count from 1")
    if number > begun and not snapshot.timeline.in_past:
        raise ValueError(f"the run has reached {unit} {begun:,} so far; {_GO_ON}")
    return GoTo(episode=number)


def unit_of(snapshot: Snapshot) -> str:
    """Return episode, or sweep for a planner."""
    return "sweep" if snapshot.agent.row.planner else "episode"


def _expected(snapshot: Snapshot) -> str:
    end = snapshot.timeline.current.end
    if snapshot.agent.row.planner:
        first = f"a step from 0 to {end:,}, sweep 12"
    elif snapshot.world.is_bandit:
        first = f"a pull from 0 to {end:,}"
    else:
        first = f"a step from 0 to {end:,}, e12 for episode 12"
    return f"{first}, -50 for 50 back, 50%, start or end"
