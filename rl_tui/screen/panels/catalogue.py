"""The table of all panels, for board, keys, palette and help."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rl_tui.screen.kit import row
from rl_tui.screen.kit.row import OpeningKey, PanelRow

if TYPE_CHECKING:
    from rl_tui.live.snapshot import Snapshot


def _without_table(snapshot: Snapshot) -> str:
    from rl_tui.runs.exact_answers import NO_TABLE

    return NO_TABLE if snapshot.world.mdp is None else ""


def _without_flips(snapshot: Snapshot) -> str:
    from rl_tui.screen.panels.discount import why_empty

    return why_empty(snapshot)


def _without_check(snapshot: Snapshot) -> str:
    from rl_tui.studies.world_check.world_checks import why_unchecked

    return why_unchecked(snapshot.world)


PANELS: Final[tuple[PanelRow, ...]] = (
    PanelRow(
        row.LESSON,
        "rl_tui.screen.panels.lesson.lesson:LessonPanel",
        "Lesson",
        "The open page of a lesson. What it asks stands below its text, with the keys. enter does it: it "
        "reads on, answers, or says that a task cannot be done. Where a page asks for a prediction, no step "
        "is taken before you made it; then the run goes on, and the page shows the truth beside your answer. "
        "Each condition of a task is marked: ✓ holds, ○ does not yet, … is not known. h shows a hint, then "
        "the next, and at the end the solution. pgdn and pgup scroll the page, then turn it; press pgdn "
        "twice to skip a page that is not done. r p restarts the run of the page, with its settings. Where "
        "page and world have no room side by side, esc leads to the world, and enter back to the page.",
        caption="read, predict, do, compare",
        terms=("agent", "state", "action", "reward", "policy", "value", "return"),
        of_lesson=True,
    ),
    PanelRow(
        row.WORLD,
        "rl_tui.screen.panels.world_views:WorldPlaceholder",
        "World",
        "The scenario as the agent finds it. In a grid, colour and number show V(s), the best estimate of "
        "the state. Arrows are the greedy actions, paler where they lead the second best by less. Several "
        "arrows (or * in a small cell) are a tie, letters are actions without a direction, and · means "
        "that all actions are equal or nothing is known yet. ◉ is the agent, ● a hole, ╱ a cliff, ★ the "
        "goal, S the start. A frame marks the cell that was just updated, green where its estimate rose, "
        "red where it fell; ━▶ is the way of the last step, red where it slipped. w a shows Q of every "
        "action, each at its side of the cell or behind its symbol, with · where it was never tried. The "
        "greedy ones have a frame, or an arrow where the colour shows the value. In a graph, each edge "
        "names action, probability and reward, and the greedy action is bold. An arm of a bandit shows its "
        "estimate ± its standard error, the standard deviation that the noise of the rewards leaves in it. "
        "▸ marks the greedy arm, ◉ the last pull. In focus the world has a cursor, as the table has, and "
        "each marks the place of the other. Two runs appear side by side, the lower number left. ▸ marks "
        "the run that you control, and ◤ the states where their greedy actions differ, ties counted. Only "
        "states known to both count: updated, or with estimates that differ. w d edits the world: hatched "
        "cells (╱) are drawn but not active yet, ↻ marks states whose optimal actions the last stroke "
        "changed, and the legend has a symbol for states from which no way leads to an end.",
        caption="as the agent meets it",
        terms=(
            *("agent", "state", "action", "reward", "value", "greedy", "terminal", "ties", "policy", "mdp"),
            *("arm", "standard-error", "trail", "slip", "wind"),
        ),
        is_twofold=True,
    ),
    PanelRow(
        row.DRAW,
        "rl_tui.screen.panels.draw_panel:DrawPanel",
        "Draw",
        "While you edit the world (w d): what is in hand, what is under the cursor, the brushes, sliders. "
        "The current brush is highlighted. A click or a drag on the world paints with it, and the wheel "
        "changes the reward there. With the arrow (A), a click only moves the cursor, and a drag marks a "
        "rectangle. Sliders set the rules of the world and the values under the cursor: digits or tab go to "
        "them, enter types a value. In a graph, each outcome of the state under the cursor has a line: shift "
        "with up and down, or a click, chooses one. The menu w has all other tools. What cannot be used now "
        "is dim.",
        caption="what there is to draw with",
        terms=("slip", "wind", "reward", "truncated", "mdp", "arm"),
        of_drawing=True,
    ),
    PanelRow(
        row.TABLE,
        "rl_tui.screen.panels.q_table.q_table:QTable",
        "Q",
        "One row per state, one column per action. The frame marks the greedy cell, unless all are equal. "
        "▐ is before the cell that was just updated, ▴ or ▾ behind it; one never visited has a dot. Colours "
        "are those of the map, and ‹ or › marks a value beyond the scale. v turns table and map to the exact "
        "Q*, the error Q−Q* and visits. The table has a cursor: tab to the table, then the arrows; w m "
        "shows the model of the pair under it, and esc follows the agent again. The tables of two runs "
        "share cursor, rows and view; ◤ is behind a state where their greedy actions differ. <.01 and >−1 "
        "are not 0, but less than a unit of the last digit.",
        caption="what each action seems worth",
        terms=("q", "pair", "greedy", "agent", "target", "q-star", "error", "visits", "ties", "optimism"),
        is_twofold=True,
    ),
    PanelRow(
        row.CURVE,
        "rl_tui.screen.panels.curve.curve:ReturnCurve",
        "Return",
        "The area is the moving mean of the returns, each the undiscounted sum of its rewards; where all "
        "returns are equal, that of the steps per episode. The heading shows over how many episodes. The "
        "line is the exact return of the greedy policy, with a gap where that may never end. The dashed "
        "line is the return of the policy that is optimal for this γ; at a smaller γ another policy can "
        "collect more. The cost of exploring is exact: the return of the greedy policy less that of the "
        "agent. ▾ and ▴ mark means off the axis. Both axes change in steps; the horizontal one counts "
        "finished episodes.",
        caption="what each episode has earned",
        terms=(
            *("return", "episode", "greedy", "last-100", "gamma-best"),
            *("best-arm", "gap", "explore", "discounted-return", "sweep"),
        ),
    ),
    PanelRow(
        row.TIMELINE,
        "rl_tui.screen.panels.timeline:TimelineBar",
        "Timeline",
        "The row below the curve is the run so far, on the same axis of episodes; the handle is the moment "
        "that every panel shows. b and B go back, as a click or a drag does. With the row in focus (tab), "
        "the arrows move the handle, < and > by one step, pgup and pgdn by a tenth. m g goes to a step or, "
        "with e12, to where that episode begins. To play on from there repeats what happened. A change "
        "begins a branch, and m b goes back to the other. ★ is the first reward, ┃ a new greedy policy, ◆ "
        "an edit of the world, ▾ a setting, ╍ your own steps, ┆ where the branch began.",
        caption="the run, to go back in",
        terms=("branch", "episode", "seed"),
        has_border=False,
    ),
    PanelRow(
        row.BUDGET,
        "rl_tui.screen.panels.budget:BudgetPanel",
        "Budget",
        "Pulls and winnings of a bandit; once shown or spent, its regret too: over all pulls, the true mean "
        "of the best arm less that of the arm pulled. Luck is left out, so winnings and regret need not add "
        "up to the best possible.",
        caption="what the pulls earned",
        terms=(
            *("winnings", "regret", "best-possible", "best-arm-share", "best-arm"),
            *("bandit", "arm", "reward", "step"),
        ),
    ),
    PanelRow(
        row.CONTROLS,
        "rl_tui.screen.panels.controls.controls:Controls",
        "Agent",
        "The settings of the agent. Focus a slider with tab or 1, 2, 3, 4: left and right change it; enter "
        "types a value, and one that begins with 1 to 4 needs it first, as these go to sliders; the mouse "
        "drags it; esc leaves it. A setting that would change nothing has no slider. a a chooses the "
        "algorithm, a p the policy, the rule that picks the actions. a o shows every setting, schedules "
        "and the sample average too. A change applies from the next step on; r i sets initial Q and r s "
        "the seed, and both start again.",
        caption="its settings and sliders",
        terms=("alpha", "gamma", "epsilon", "policy", "off-policy", "on-policy", "ties", "optimism", "seed"),
    ),
    PanelRow(
        row.PROGRAM,
        "rl_tui.screen.panels.program.program:ProgramPanel",
        "Program",
        "Your own program, watched (rl-tui watch SCRIPT.py): its environment, the table that was found in "
        "it, and the update that it makes. The movements of the table reveal the rule, step size and "
        "discount, the share of steps that they fit, and the first that departs. Only steps whose next "
        "state has a value other than 0 reveal γ; the panel counts them. Nothing is guessed: a question "
        "that no step decides stays open. Below are errors, which a f shows, and notes; a w shows the "
        "output of the program, and a b chooses another of its tables. Built-in agents have their sliders "
        "here. The settings of your program are in its file, and saving that restarts it.",
        caption="your own code, watched",
        terms=("program", "finding", "informative-step", "departs", "alpha", "gamma", "target"),
        of_program=True,
    ),
    PanelRow(
        row.LAST_STEP,
        "rl_tui.screen.panels.last_step.last_step:LastStepPanel",
        "Last step",
        "What the agent did, where that led, and the update: each word stands above its number. The heading "
        "says how the action was chosen. The bar shows δ, the error that the update shrinks, as a share of "
        "the range of all estimates; negative is left of the middle. best, next or mean is the estimate of "
        "the next state. Where one step moves many estimates, by their traces (how recently each pair was "
        "taken) or from a model, one is shown and the others are counted.",
        caption="one turn of the loop",
        terms=(
            *("td-error", "target", "bootstrap", "alpha", "gamma"),
            *("reward", "terminal", "truncated", "lambda"),
        ),
    ),
    PanelRow(
        row.CAPTION,
        "rl_tui.screen.panels.caption:CaptionLine",
        "Caption",
        "One sentence below the world says what is learned just now: nothing yet, how far values have "
        "spread, or that an optimal policy is found. It is there while panels come one by one and below the "
        "world alone (f); beside a lesson the row of its page is there.",
        caption="what is learned just now",
        terms=("state", "value", "reward", "policy", "greedy"),
        has_border=False,
    ),
    PanelRow(
        row.MICROSCOPE,
        "rl_tui.screen.panels.microscope.microscope:Microscope",
        "Microscope",
        "d shows the last step under the microscope, live. Numbers of the cell that was updated are "
        "highlighted; those that were looked up are underlined, here and in the table. Below the state and "
        "its action, the backup shows all that might have followed; ▸ marks what did. Beside the target of "
        "this sample is the expected one, the mean over all outcomes with the same estimates; the "
        "difference is luck. The history at the end is that of one cell, its exact value dotted: tab to "
        "the world and choose a state with the arrows. Without a cursor it is the cell updated last.",
        caption="the last step in detail",
        terms=(
            *("backup", "bellman", "target", "td-error"),
            *("bootstrap", "discounted-return", "return", "q-star"),
        ),
        opened_by=OpeningKey("d", "microscope", "Open the last step under the microscope.", rank=9),
        shows=("model",),
    ),
    PanelRow(
        row.MANY_SEEDS,
        "rl_tui.screen.panels.many_seeds:ManySeeds",
        "Many seeds",
        "One seed decides nothing. t m runs the same again under other seeds, beside this run and at low "
        "priority: 8, then 16, up to 256, for as many episodes as this run has had, within bounds. Each "
        "number of this seed is compared with the mean over all, with the standard error of that mean. "
        "With several runs, each seed is used in every run, and the differences are per seed, in brackets "
        "with three standard errors on either side; of regret, less is better. The curve has the mean over "
        "seeds behind its own lines, two standard errors wide on either side. Later changes are not "
        "included: enter counts again.",
        caption="is it luck, or better?",
        terms=(
            *("standard-error", "many-seeds", "paired-difference", "seed"),
            *("lane", "regret", "last-100", "greedy"),
        ),
        opened_by=OpeningKey(
            "t m",
            "many seeds",
            "Run the same under many other seeds: means with their errors.",
            old="M",
        ),
        wide_rows=12,
        not_for_program="this runs built-in agents; rl-tui grade {file} runs your program under many seeds",
        shows=("many seeds",),
    ),
    PanelRow(
        row.DISCOUNT,
        "rl_tui.screen.panels.discount:DiscountPanel",
        "Flip points",
        "The optimal actions depend on γ. t g draws Q* of every action of one state, from γ = 0 to 1: the "
        "state under the cursor of world or table, else the agent's. The highest line is the optimal "
        "action, and ◆ marks where another one becomes it. Upright lines are flip points: every γ at which "
        "the optimal actions of some state change, computed exactly. ┃ marks those that change the optimal "
        "path from the start; the slider of γ shows them too, and, while this panel is open, all others as "
        "│. Dots with ● mark the current γ. The list shows what the optimal policy earns just below and "
        "just above, undiscounted, and which states change. The arrows choose a flip point, and enter sets "
        "γ beyond it; on the slider { and } do so. A program of your own sets γ in its file. Flip points "
        "are worked out for worlds of up to 100 states.",
        caption="where the optimal actions change",
        terms=("gamma", "flip-point", "turns-the-way", "optimal-values-by-gamma", "earned-at-flip", "q-star"),
        opened_by=OpeningKey("t g", "flip points", "Show each γ at which the best actions change.", old="G"),
        wide_rows=15,
        shows=("flips", "answer"),
        lacks=_without_flips,
    ),
    PanelRow(
        row.POLICIES,
        "rl_tui.screen.panels.policies.policies:Policies",
        "Policies",
        "The exact returns of policies, a row each: random, greedy at this moment, the agent with its "
        "exploration, optimal for the current γ, and your own (w p draws it). The first number "
        "is the mean return of an episode, undiscounted and within the time limit; at start is V there. "
        "The cost of exploring is what the greedy policy earns more than the agent. The world shows V and "
        "the likeliest actions of the policy under the cursor, and the curve its return as a dashed line. "
        "enter closes the panel and keeps these, and the table then has a view Qπ; esc goes back to what "
        "the agent learned. In a large world, the return of the agent is computed while the run is paused.",
        caption="exact return of each policy",
        terms=(
            *("policy-value", "policy-return", "exploring-cost", "behaviour", "greedy", "uniform-policy"),
            *("q-pi", "value-at-start", "expected-steps", "chance-of-ending", "bellman-expectation"),
        ),
        opened_by=OpeningKey("t p", "policies", "Compare policies by their exact return.", old="P"),
        shows=("policies",),
        lacks=_without_table,
    ),
    PanelRow(
        row.WORLD_CHECK,
        "rl_tui.screen.panels.world_check:WorldCheckPanel",
        "World check",
        "Is this world sound? The answers to know before you give a world to a class: the returns of the "
        "random and the optimal policy, the fewest steps to an end, how long nothing is learned with the "
        "current settings, each γ at which the optimal actions change, the states that are never reached, "
        "and those from which no way leads to an end. All this is exact. Then each algorithm is trained "
        "for a short while, to see whether a greedy policy may never end; that is a trial, not a proof. "
        "After a change of the world or of the settings, everything is computed again at low priority. w n "
        "numbers the states of a map. rl-tui check --deep prints the same.",
        caption="is this world sound?",
        terms=(
            *("uniform-policy", "best-by-clock", "fewest-steps", "first-update", "flip-point"),
            *("unreached", "no-way-out", "return", "greedy", "truncated"),
        ),
        opened_by=OpeningKey("w c", "world check", "Check the world for traps and dead ends.", old="Q"),
        not_for_program="this checks worlds of scenarios; rl-tui check --deep checks one by its id or file",
        shows=("policies", "why", "flips", "answer"),
        lacks=_without_check,
    ),
    PanelRow(
        row.FINDINGS,
        "rl_tui.screen.panels.program.findings:FindingsPanel",
        "Findings",
        "What is wrong with the program that is watched, the worst first. A fault is claimed only from at "
        "least three steps on which two readings of the code predict different numbers, all of them for one "
        "and none for the other; declared means that it rests on a number read from the code. A risk is what "
        "may go wrong by bad luck. Each says what was seen, on how many steps, shows the line in the source, "
        "marked ▸, and the correction. The arrows choose one, enter goes to the first step that shows it.",
        caption="what is wrong, and where",
        terms=("finding", "program", "departs", "informative-step", "bootstrap", "terminal", "truncated"),
        opened_by=OpeningKey(
            "a f",
            "findings",
            "Show what is wrong with your program, the line, and the correction.",
            old="F",
        ),
        of_program=True,
    ),
    PanelRow(
        row.OUTPUT,
        "rl_tui.screen.panels.program.output:OutputPanel",
        "Output",
        "The last lines that the watched program wrote, each behind the number of steps that it had taken. "
        "! marks what it wrote to stderr. Where it raised an exception, its traceback stands at the end. The "
        "last line stays in view until the arrows, pgup or home go up; end follows again.",
        caption="what your program wrote",
        terms=("program", "step", "finding"),
        opened_by=OpeningKey("a w", "output", "Show what your program wrote, and its traceback.", old="O"),
        of_program=True,
    ),
)
"""In the order of the tab key."""
