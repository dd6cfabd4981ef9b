"""The panels of the playground, a row each: board, places, keys, palette and help derive from this table."""

from __future__ import annotations

from typing import Final

from rl_tui.screen.kit.row import (
    BUDGET,
    CONTROLS,
    CURVE,
    DISCOUNT,
    DRAW,
    FINDINGS,
    LAST_STEP,
    LESSON,
    MANY_SEEDS,
    MICROSCOPE,
    OUTPUT,
    POLICIES,
    PROGRAM,
    TABLE,
    TIMELINE,
    WORLD,
    WORLD_CHECK,
    OpeningKey,
    PanelRow,
)
from rl_tui.worlds.drawing import Arms, Drawing


def _has_arms(drawing: Drawing | None) -> bool:
    return isinstance(drawing, Arms)


PANELS: Final[tuple[PanelRow, ...]] = (
    PanelRow(
        LESSON,
        "rl_tui.screen.panels.lesson.lesson:LessonPanel",
        "Lesson",
        "The open page of a lesson. Where a page asks for a prediction, no step is taken before that (A); "
        "then the run goes on, and the truth stands beside it. Beside each condition of a task stands "
        "whether it holds now: ✓ or ✗, and … while that is not known. H gives a hint, then the next, at the "
        "end the solution. Pages turn by . and , alone; . leaves a page undone if pressed twice. N sets the "
        "run of the page up again. Where there is no room for page and world side by side they take turns: "
        "R.",
        caption="read, predict, do, compare",
        terms=("agent", "state", "action", "reward", "policy", "value", "return"),
        of_lesson=True,
    ),
    PanelRow(
        WORLD,
        "rl_tui.screen.panels.world_views:WorldPlaceholder",
        "World",
        "The scenario as the agent finds it. In a grid the tint and the number are V(s), the best estimate "
        "of the state; arrows are the greedy actions, the paler the less they lead the second best, several "
        "(or * where there is no room) where they tie, letters where actions have no direction; · stands "
        "where all are as good, or nothing is known yet; ◉ is the agent, ● a hole, ╱ a cliff, ★ the goal, S "
        "the start. A frame is around the cell that was just updated, green where its estimate rose, red "
        "where it fell; ━▶ is the way of the last step, red where it slipped. V turns to "
        "Q of every action, each at its side of the cell or "
        "behind its sign, · where it was never tried: the greedy ones are framed, or have an arrow where the "
        "tint stands for the number. In a graph each edge names action, "
        "probability and reward, and the greedy action is bold. An arm of a "
        "bandit shows its estimate ± its standard error, the standard deviation that the noise of the "
        "rewards leaves in it. ▸ marks the greedy arm, ◉ the last pull. In focus it has a cursor, as the "
        "table has; the place where one stands is marked in the other. Two lanes stand side by side, the "
        "lower number left; ▸ marks the one that keys and sliders are about, and ◤ the states where their "
        "greedy actions differ, ties counted. Only states known to both count: updated, or with estimates "
        "that differ. C draws the world: hatched (╱) is what is drawn and not in force, ↻ marks states whose "
        "best actions, exactly, the last stroke turned, and the legend has a sign for those from which no "
        "way leads to an end.",
        caption="as the agent meets it",
        terms=(
            *("agent", "state", "action", "reward", "value", "greedy", "terminal", "ties", "policy", "mdp"),
            *("arm", "standard-error", "trail", "slip", "wind"),
        ),
        is_twofold=True,
    ),
    PanelRow(
        DRAW,
        "rl_tui.screen.panels.draw_panel:DrawPanel",
        "Draw",
        "While you draw the world (C): every tool with its key, or to be clicked. The brush in force stands "
        "out; a click or a drag on the world paints with it, the wheel changes what is paid there. With the "
        "arrow (A) a click moves the cursor only, and a drag marks a rectangle. Sliders set the rules of the "
        "world, and what is under the cursor: digits or tab go to them, enter types a value. Of a graph each "
        "outcome of the state under the cursor has a line: shift with up and down, or a click, chooses one. "
        "What cannot be done now is dim.",
        caption="what there is to draw with",
        terms=("slip", "wind", "reward", "truncated", "mdp", "arm"),
        of_drawing=True,
    ),
    PanelRow(
        TABLE,
        "rl_tui.screen.panels.q_table.q_table:QTable",
        "Q",
        "One row a state, one column an action. The frame marks the greedy cell; ▐ stands before "
        "the cell that was just updated, ▴ or ▾ behind it; one never visited is a dot. Tints are those of "
        "the map, and ‹ or › says that a value lies beyond. v turns table and map to the exact Q*, "
        "the error Q−Q* and visits. It has a cursor: tab to the table, then the arrows; m shows the model of "
        "the pair under it, and esc follows the agent again. The tables of two lanes have cursor, rows and "
        "layer in common; ◤ stands behind a state where their greedy actions differ. <.01 and >−1 are not 0, "
        "but less than a unit of the last digit.",
        caption="what each action seems worth",
        terms=("q", "pair", "greedy", "agent", "target", "q-star", "error", "visits", "ties", "optimism"),
        is_twofold=True,
    ),
    PanelRow(
        CURVE,
        "rl_tui.screen.panels.curve.curve:ReturnCurve",
        "Return",
        "The area is the moving mean of the returns, each the undiscounted sum of its rewards; where all "
        "returns are equal, of the steps per episode. The heading says of how many episodes. The line is the "
        "exact return of the greedy policy, with a gap where that may never end. Dashed: the return of the "
        "policy that is optimal for this γ (γ-best); at a smaller γ another policy can collect more. The "
        "cost of exploring is exact: the return of the greedy policy less that of the agent. ▾ and ▴ mark "
        "means off the axis. Both axes change in steps; the horizontal one counts finished episodes.",
        caption="what each episode has earned",
        terms=(
            "return",
            "episode",
            "greedy",
            "last-100",
            "gamma-best",
            "best-arm",
            "gap",
            "explore",
            "discounted-return",
            "sweep",
        ),
    ),
    PanelRow(
        TIMELINE,
        "rl_tui.screen.panels.timeline:TimelineBar",
        "Timeline",
        "The row below the curve is the run so far, on the same axis of episodes; the handle is the moment "
        "that every panel shows. b, B and g go back, and so do a click, a drag and, with the row "
        "in focus (tab), the arrows, < and > by one step, pgup and pgdn by a tenth. g takes a step or, as "
        "e12, an episode, and goes to where that one begins. To play on from there "
        "repeats what happened; to change something begins a branch, and j goes back to the other. ★ is the "
        "first reward, ┃ a new greedy policy, ◆ an edit of the world, ▾ a setting, ╍ your own steps, ┆ where "
        "the branch began.",
        caption="the run, to go back in",
        terms=("branch", "episode", "seed"),
        has_border=False,
    ),
    PanelRow(
        BUDGET,
        "rl_tui.screen.panels.budget:BudgetPanel",
        "Budget",
        "Pulls and winnings of a bandit; once shown or spent, its regret too: over all pulls, the true mean "
        "of the best arm less that of the arm pulled. Luck is left out, so winnings and regret need not add "
        "up to the best possible.",
        caption="what the pulls earned",
        terms=(
            "winnings",
            "regret",
            "best-possible",
            "best-arm-share",
            "best-arm",
            "bandit",
            "arm",
            "reward",
            "step",
        ),
        needs=_has_arms,
    ),
    PanelRow(
        CONTROLS,
        "rl_tui.screen.panels.controls.controls:Controls",
        "Agent",
        "The settings of the agent. Focus a slider with tab or 1, 2, 3, 4: left and right change it; enter "
        "types a value, and one that begins with 1 to 4 needs it first, as these go to sliders; the mouse "
        "drags it; esc leaves it. What would change nothing has no slider. a chooses the algorithm, p the "
        "policy, which is the rule by which actions are chosen; o "
        "lists everything, schedules and the sample average too. A change acts from the next step on; "
        "initial Q and seed start again.",
        caption="its settings and sliders",
        terms=("alpha", "gamma", "epsilon", "policy", "off-policy", "on-policy", "ties", "optimism", "seed"),
    ),
    PanelRow(
        PROGRAM,
        "rl_tui.screen.panels.program.program:ProgramPanel",
        "Program",
        "A program of your own, watched (rl-tui watch SCRIPT.py): its environment, the table that was found "
        "in it, and the update that it makes, worked out from how the table moves: rule, step size and "
        "discount, the share of steps that they fit, and the first that departs. Only steps on which the "
        "value of the next state is not 0 tell γ: so many there were. Nothing is guessed: what no step "
        "decides is said to be open. Below stands what is wrong with it, which F shows, and notes; O shows "
        "what it wrote, and T chooses another of its tables. Our agents have their sliders here; of your "
        "program its file decides, and saving it starts it again.",
        caption="your own code, watched",
        terms=("program", "finding", "informative-step", "departs", "alpha", "gamma", "target"),
        of_program=True,
    ),
    PanelRow(
        LAST_STEP,
        "rl_tui.screen.panels.last_step.last_step:LastStepPanel",
        "Last step",
        "What the agent did, where that led, and the update: each word stands above its number. The heading "
        "says how the action was chosen. The bar shows δ, the error that the update shrinks, as a share of "
        "the range of all estimates; negative is left of the middle. best, next or mean is the estimate of "
        "the next state. Where one step moves many estimates, by their traces (how recently each pair was "
        "taken) or from a model, one is shown and the others are counted.",
        caption="one turn of the loop",
        terms=(
            "td-error",
            "target",
            "bootstrap",
            "alpha",
            "gamma",
            "reward",
            "terminal",
            "truncated",
            "lambda",
        ),
    ),
    PanelRow(
        MICROSCOPE,
        "rl_tui.screen.panels.microscope.microscope:Microscope",
        "Microscope",
        "d takes the last step apart, live. Numbers of the cell that was updated stand out; those that "
        "were looked up are underlined, here as in the table. The backup hangs from the "
        "state and its action all that might have followed; ▸ marks what did. The target of this sample "
        "stands beside the expected one, the mean over all outcomes with the same estimates: what lies "
        "between them is luck. The history at the end is that of one cell, its exact value dotted: tab to "
        "the world and choose a state with the arrows. Without a cursor it is the cell updated last.",
        caption="the last step, taken apart",
        terms=(
            "backup",
            "bellman",
            "target",
            "td-error",
            "bootstrap",
            "discounted-return",
            "return",
            "q-star",
        ),
        opened_by=OpeningKey(
            "d",
            "microscope",
            "Open the last step under the microscope.",
            rank=9,
        ),
    ),
    PanelRow(
        MANY_SEEDS,
        "rl_tui.screen.panels.many_seeds:ManySeeds",
        "Many seeds",
        "One seed decides nothing. M runs the same again under other seeds, beside this run and at low "
        "priority: 8, then 16, up to 256, for as many episodes as this run has had, within bounds. Each "
        "figure of this seed stands beside the mean over all, with the standard error of that mean. With "
        "lanes, each seed runs in every one, and the difference is told seed by seed, in brackets with three "
        "standard errors on either side; of regret, less is better. The curve has the mean over seeds behind "
        "its own lines, two standard errors wide on either side. What was changed since is not in it: enter "
        "counts again.",
        caption="is it luck, or better?",
        terms=(
            "standard-error",
            "many-seeds",
            "paired-difference",
            "seed",
            "lane",
            "regret",
            "last-100",
            "greedy",
        ),
        opened_by=OpeningKey(
            "t m",
            "many seeds",
            "Run the same under many other seeds: means with their errors.",
            old="M",
        ),
        is_wide=True,
        not_for_program="this runs built-in agents; rl-tui grade {file} runs your program under many seeds",
    ),
    PanelRow(
        DISCOUNT,
        "rl_tui.screen.panels.discount:DiscountPanel",
        "Flip points",
        "Which actions are best depends on γ. G draws Q* of every action of one state, that of the cursor of "
        "world or table, else the agent's, from γ = 0 to 1; the highest line is the best action, and ◆ "
        "stands where another one becomes it. Upright lines are flip points: every γ at which the optimal "
        "actions of some state change, worked out exactly. ┃ marks those that turn the way from the start; "
        "they stand on the slider of γ too, and, while this panel is open, all others as │. Dots with ● "
        "stand at the γ in force. The list says what the optimal policy earns just below and just above, "
        "undiscounted, and which states turn. The arrows choose a flip, and enter sets γ beyond it; on the "
        "slider { and } do so. A program of your own sets γ in its file. Flip points are "
        "worked out for worlds of up to 100 states.",
        caption="where the best policy turns",
        terms=("gamma", "flip-point", "turns-the-way", "optimal-values-by-gamma", "earned-at-flip", "q-star"),
        opened_by=OpeningKey(
            "t g",
            "flip points",
            "Show each γ at which the best actions change.",
            old="G",
        ),
        is_wide=True,
    ),
    PanelRow(
        POLICIES,
        "rl_tui.screen.panels.policies.policies:Policies",
        "Policies",
        "What policies are worth, exact, each in a row: one that picks at random, the greedy one "
        "of this moment, the agent as it acts now, exploring as it does, the optimal one for the γ in force, "
        "and one that you drew (D). The first figure is the return an episode has on average, undiscounted "
        "and within the time limit; at start stands V there. What exploring costs is what the greedy policy "
        "earns more than the agent as it acts. Of the policy under the cursor the world shows V and the "
        "likeliest actions, and the curve has its return as a dashed line; enter keeps that when the panel "
        "is closed, and the table then has a layer Qπ; P or esc goes back to what the agent learned. "
        "A policy at work in a large world is worked out while the run is paused.",
        caption="what each way to act is worth",
        terms=(
            *("policy-value", "policy-return", "exploring-cost", "behaviour", "greedy", "uniform-policy"),
            *("q-pi", "value-at-start", "expected-steps", "chance-of-ending", "bellman-expectation"),
        ),
        opened_by=OpeningKey(
            "t p",
            "policies",
            "Compare policies by their exact return.",
            old="P",
        ),
    ),
    PanelRow(
        WORLD_CHECK,
        "rl_tui.screen.panels.world_check:WorldCheckPanel",
        "World check",
        "What one wants to know of a world before giving it to a class, be it drawn or not: what policies "
        "earn that pick at random and that are best, in how few steps the best one may come to an end, how "
        "long nothing is learned with the settings in force, at which γ the best actions change, which "
        "states are never reached, and from which there is no way to an end. Then each algorithm is trained "
        "for a short while, to see whether a greedy policy may come out that never ends; that is tried, not "
        "proven. All else is exact. After a change of the world or of the settings it is worked out anew, at "
        "low priority. # numbers the states of a map. rl-tui check --deep prints the same.",
        caption="before a class gets it",
        terms=(
            *("uniform-policy", "best-by-clock", "fewest-steps", "first-update", "flip-point"),
            *("unreached", "no-way-out", "return", "greedy", "truncated"),
        ),
        opened_by=OpeningKey(
            "w c",
            "world check",
            "Check the world for traps and dead ends.",
            old="Q",
        ),
        not_for_program="this checks worlds of scenarios; rl-tui check --deep checks one by its id or file",
    ),
    PanelRow(
        FINDINGS,
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
        OUTPUT,
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
