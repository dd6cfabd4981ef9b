"""All keys, how to read the panels, and the notes of the scenario."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import ClassVar, Final

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.widgets import Static

from rl_tui.tui.actions.action import Place
from rl_tui.tui.actions.registry import actions_of
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.explained import Explained, Explanation
from rl_tui.tui.screens.notes import notes_markdown
from rl_tui.tui.theme.look import Look

_PANELS: Final = (
    (
        "World",
        "The scenario as the agent finds it. In a grid the tint and the number are V(s), the best estimate "
        "of the state; arrows are the greedy actions, several (or + where there is no room) where they tie, "
        "none where nothing is known yet, letters where actions have no direction; ◉ is the agent, ● a hole, "
        "▓ a cliff, ★ the goal, S the start. In a graph each edge names action, "
        "probability and reward, and the greedy action is bold. An arm of a "
        "bandit shows its estimate ± its standard error, the standard deviation that the noise of the "
        "rewards leaves in it. ▸ marks the greedy arm, ◉ the last pull. In focus it has a cursor, as the "
        "table has; the place where one stands is marked in the other.",
    ),
    (
        "Q",
        "One row a state, one column an action. The frame marks the greedy cell; the cell that the last "
        "step updated is lit; an unvisited cell looks different from a zero. v turns to the exact Q*, the "
        "error Q−Q* and visits. It has a cursor: tab to the table, then the arrows; m shows the model of "
        "the pair under it, and esc follows the agent again.",
    ),
    (
        "Return",
        "The return of each episode as band and mean, with the mean of the last 100 beside it; the exact "
        "expected return of the greedy policy; and dotted what is best for this γ (in short γ-best): the "
        "undiscounted return of the policy that is best for the γ in force. At a smaller γ another policy "
        "can collect more undiscounted return than that one. Once something is learned, the gap between "
        "episodes and greedy policy is mostly what exploring costs. The axis counts finished episodes, the "
        "top line the one under way: between two it is the next. Where the run cannot keep up with the "
        "wanted speed, the top line ends with the one measured.",
    ),
    (
        "Timeline",
        "The row below the curve is what was run so far, from step 0 to the end of the branch; the handle is "
        "the moment that every panel shows. b, B and g go back, and so do a click, a drag and, with the row "
        "in focus (tab), the arrows, < and > by one step, pgup and pgdn by a tenth. g takes a step or, as "
        "e12, an episode, and goes to where that one begins. To play on from there "
        "repeats what happened; to change something begins a branch, and j goes back to the other. ◆ is a "
        "change, ╍ steps taken by hand, ┻ where the branch began.",
    ),
    (
        "Lanes",
        "c opens a run beside this one: the same scenario and seed, one thing different; up to four. All "
        "advance together, and the curves lie over one another. Every other panel shows one lane, which the "
        "title of the curve names: l goes to the next, and what is changed is changed there only. The layer "
        "Q−Q₂ of the table is its difference from the first of the others.",
    ),
    (
        "Budget",
        "Pulls and winnings of a bandit; revealed or spent, its regret too: over all pulls, the true mean "
        "of the best arm less that of the arm pulled. Luck is left out, so winnings and regret need not add "
        "up to the best possible.",
    ),
    (
        "Controls",
        "What the agent is told. Focus a slider with tab or 1, 2, 3, 4: left and right change it, digits "
        "type a value, the mouse drags it. a chooses the algorithm, p the policy, which is the rule by "
        "which actions are chosen; o lists everything, schedules and the sample average too. A change acts "
        "from the next step on; initial Q and seed start again.",
    ),
    (
        "Last step",
        "One turn of the loop with its real numbers: what was chosen and why, what the world did, and the "
        "update. δ is the error that the update shrinks. Algorithms that wait for n rewards or for the end "
        "of the episode say so. Where one step moves many estimates, by their traces (how recently each "
        "pair was taken) or from a model, one is told in full and the others are counted.",
    ),
    (
        "Microscope",
        "d takes the last step apart, live. Numbers that came from a cell of the table look as that cell "
        "does, which is lit: one was updated, the underlined ones were looked up. The backup hangs from the "
        "state and its action all that might have followed; ▸ marks what did. The target of this sample "
        "stands beside the expected one, the mean over all outcomes with the same estimates: what lies "
        "between them is luck. At the end stands how the cell under the table's cursor went, else the one "
        "updated last, with its exact value dotted.",
    ),
    (
        "Rewards",
        "A cell of a map that always pays something other than the usual step does says how much in its "
        "corner; where there is no room, + means more and − less.",
    ),
    (
        "Planners",
        "Value iteration and policy iteration take no steps in the world: they read its table. A step backs "
        "up one state, and a sweep over all states stands in place of the episode, so s, e and space work "
        "as ever. Nothing is played, so the curve has only the exact return of the greedy policy. When no "
        "value moves any more the planner is done; another γ gives it something to do again.",
    ),
    (
        "Stepped",
        "An environment without a table is stepped for real. Nobody knows its exact answer, so Q*, the "
        "error, the optimum and planners are missing; everything else is the same.",
    ),
    (
        "Breakpoints",
        "k sets one where the cursor is, on a state in the world or on a pair in the table; an arm of a "
        "bandit is a pair. ! marks it, and the run pauses each time the state is reached or the pair taken. "
        "u lists them all, and what else a run may be run until.",
    ),
    (
        "You",
        "y makes you the agent: the arrows take the action of their direction, digits the first, second … "
        "of the actions that the border of the world lists. The agent learns from what you do as from its "
        "own steps; s lets it take one in between. y or esc hands back.",
    ),
    (
        "Focus",
        "tab and shift+tab go from panel to panel; arrows move the cursor of world and table, which scroll "
        "with it, and f shows the panel in focus alone.",
    ),
)


class HelpScreen(Dialog[None]):
    """Everything that is worth knowing here, on one page that scrolls."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("question_mark,q", "cancel", "back", id="close_help", tooltip="Close the help."),
    ]

    def __init__(self, look: Look, place: Place, notes: str = "") -> None:
        super().__init__()
        self._look = look
        self._place = place
        self._notes = notes

    def compose(self) -> ComposeResult:
        """Yield the keys."""
        box = Vertical(id="box", classes="tall")
        with box, VerticalScroll():
            yield Explained(list(self._explanations()), self._look.glyphs)
        box.border_title = "Help"
        box.border_subtitle = "arrows: scroll   ? or q: close"

    def on_mount(self) -> None:
        """Let the arrows scroll."""
        page = self.query_one(VerticalScroll)
        page.focus()
        if self._notes:
            self.watch(page, "scroll_y", self._add_notes, init=False)
            self.call_after_refresh(self._fill)

    async def _fill(self) -> None:
        page = self.query_one(VerticalScroll)
        if page.is_attached and not page.max_scroll_y:  # there is nothing to scroll
            await self._add_notes()

    async def _add_notes(self) -> None:
        """Put the notes at the end once the page is scrolled: Markdown is slow to load."""
        if not self._notes:
            return
        notes, self._notes = notes_markdown(self._notes, self._look.glyphs), ""
        page = self.query_one(VerticalScroll)
        to_end = page.scroll_target_y >= page.max_scroll_y
        await page.mount(Static(Text("\nNotes", "bold")), notes)
        if to_end:
            self.call_after_refresh(page.scroll_end, animate=False)

    def _explanations(self) -> Iterator[Explanation]:
        for group, actions in groupby(actions_of(self._place), key=lambda action: action.group):
            yield Explanation(group)
            for action in actions:
                yield Explanation(f"  {action.shown}", action.help)
        if Place.PLAYGROUND in self._place:
            yield Explanation("")
            yield Explanation("Panels")
            for title, sentences in _PANELS:
                yield Explanation(f"  {title}", sentences)
