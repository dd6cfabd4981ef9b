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
        "One page of a lesson: a text, and often a question or a task. enter does what the page asks, pgdn "
        "and pgup turn pages, and h shows a hint. Beside the condition of a task, ✓ means true, ○ not yet, "
        "and … not known.",
        caption="read, predict, do, compare",
        terms=("agent", "state", "action", "reward", "policy", "value", "return"),
        of_lesson=True,
    ),
    PanelRow(
        row.WORLD,
        "rl_tui.screen.panels.world_views:WorldPlaceholder",
        "World",
        "The world with the agent's estimates. Colour and number show V(s), how good a state looks. "
        "Arrows, bold edges or ▸ mark greedy actions. Several arrows (*) mean a tie. ◉ agent, ★ goal, "
        "● hole, ╱ cliff, S start, · all equal or unknown. A frame marks the last update, ◤ a difference "
        "between two runs. An arm shows its estimate ± standard error.",
        caption="where the agent acts",
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
        "The tools for editing the world, with the current brush highlighted. Click or drag on the world to "
        "paint. With the arrow (A), a click only moves the cursor, and a drag marks a rectangle. Sliders "
        "set the rules of the world and the values under the cursor. Dim tools are not available now.",
        caption="brushes, values and rules",
        terms=("slip", "wind", "reward", "truncated", "mdp", "arm"),
        of_drawing=True,
    ),
    PanelRow(
        row.TABLE,
        "rl_tui.screen.panels.q_table.q_table:QTable",
        "Q",
        "One row per state, one column per action, in the colours of the world. A frame marks the greedy "
        "action. ▐ ▴ ▾ mark the last update, and a dot a pair never tried. v shows the exact Q*, the error "
        "Q−Q* and visits. ‹ and › mark values beyond the scale. A number too small to show is <.01 or >−.01.",
        caption="what each action seems worth",
        terms=("q", "pair", "greedy", "agent", "target", "q-star", "error", "visits", "ties", "optimism"),
        is_twofold=True,
    ),
    PanelRow(
        row.CURVE,
        "rl_tui.screen.panels.curve.curve:ReturnCurve",
        "Return",
        "The area is the mean return of the last episodes. The solid line is the exact return of the greedy "
        "policy, with a gap if this policy may never end. The dashed line is the return of the optimal "
        "policy for the current γ. ▾ and ▴ mark values beyond the axis. If all returns are equal, it "
        "shows steps.",
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
        "The run so far, on the axis of the curve. Drag the handle, or use the arrows, to go back: all "
        "panels show that moment. Play on to repeat the run, or change something to begin a branch. ★ first "
        "reward, ┃ new greedy policy, ◆ edited world, ▾ changed setting, ╍ your own steps, ┆ start of the "
        "branch.",
        caption="go back in the run",
        terms=("branch", "episode", "seed"),
        has_border=False,
    ),
    PanelRow(
        row.BUDGET,
        "rl_tui.screen.panels.budget:BudgetPanel",
        "Budget",
        "Pulls and winnings of a bandit. Its regret appears when the exact values are shown or the budget "
        "is spent. Regret leaves luck out, so winnings and regret need not add up to the best possible.",
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
        "The settings of the agent, with a slider for each that has an effect. 1 to 4 go to a slider, left "
        "and right change it, and enter types a value. A change applies from the next step on. A new "
        "initial Q (r i) or seed (r s) starts the run again. a o shows every setting.",
        caption="its settings and sliders",
        terms=("alpha", "gamma", "epsilon", "policy", "off-policy", "on-policy", "ties", "optimism", "seed"),
    ),
    PanelRow(
        row.PROGRAM,
        "rl_tui.screen.panels.program.program:ProgramPanel",
        "Program",
        "Your script under rl-tui watch: its environment, its table and its update. Rule, step size and "
        "discount come from the changes of the table, and nothing is guessed. Only steps whose next state "
        "has a value other than 0 reveal γ. a f shows errors, a w the output, a b another table. Save the "
        "file to start it again.",
        caption="your own code, watched",
        terms=("program", "finding", "informative-step", "departs", "alpha", "gamma", "target"),
        of_program=True,
    ),
    PanelRow(
        row.LAST_STEP,
        "rl_tui.screen.panels.last_step.last_step:LastStepPanel",
        "Last step",
        "One step: the action, its result, and the update in numbers. The heading shows how the action was "
        "chosen. The bar compares δ with the range of all estimates. It points to the left if δ is "
        "negative. If a step changes many estimates, the panel shows one and counts the others.",
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
        "One sentence about progress: nothing yet, how far values have spread, or that an optimal policy is "
        "found. It appears in full screen (f), and while panels appear one by one.",
        caption="what is learned just now",
        terms=("state", "value", "reward", "policy", "greedy"),
        has_border=False,
    ),
    PanelRow(
        row.MICROSCOPE,
        "rl_tui.screen.panels.microscope.microscope:Microscope",
        "Microscope",
        "The last step in detail, live. Highlighted numbers belong to the updated cell, underlined ones "
        "were looked up. The backup shows all possible outcomes, with ▸ at the real one. The expected "
        "target is the mean over them, and the difference is luck. At the end is the history of the cell "
        "under the cursor, else of the updated one.",
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
        "The same run under many other seeds: is a result luck? Each row compares this seed with the mean "
        "over all, with its standard error. With several runs, differences are per seed, in brackets with "
        "three standard errors on either side. enter counts again after a change.",
        caption="is it luck, or better?",
        terms=(
            *("standard-error", "many-seeds", "paired-difference", "seed"),
            *("lane", "regret", "last-100", "greedy"),
        ),
        opened_by=OpeningKey(
            "t m",
            "many seeds",
            "Run the same under many other seeds.",
            old="M",
        ),
        wide_rows=12,
        not_for_program="this is for built-in agents. For yours: rl-tui grade {file}",
        shows=("many seeds",),
    ),
    PanelRow(
        row.DISCOUNT,
        "rl_tui.screen.panels.discount:DiscountPanel",
        "Flip points",
        "Q* of each action in one state, from γ = 0 to 1. The highest line is optimal, and ◆ marks where "
        "another action becomes it. Upright lines are flip points, and ┃ changes the optimal path. ● marks "
        "the current γ. Choose a flip point with the arrows, and press enter to set γ beyond it. Limit: "
        "worlds of up to 100 states.",
        caption="where the optimal actions change",
        terms=("gamma", "flip-point", "turns-the-way", "optimal-values-by-gamma", "earned-at-flip", "q-star"),
        opened_by=OpeningKey(
            "t g", "flip points", "Show each γ at which the optimal actions change.", old="G"
        ),
        wide_rows=15,
        shows=("flips", "answer"),
        lacks=_without_flips,
    ),
    PanelRow(
        row.POLICIES,
        "rl_tui.screen.panels.policies.policies:Policies",
        "Policies",
        "The exact return of each policy: random, greedy, agent, optimal, and your own (w p). The first "
        "number is undiscounted and within the time limit, and at start is V there. World and curve show "
        "the policy under the cursor. enter keeps that and closes the panel, esc goes back to the agent.",
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
        "Facts to know before you give a world to a class: returns, path length, the wait for the first "
        "update, flip points, and states without a way in or out. All this is exact. Then each algorithm is "
        "trained for a short while, to see whether a greedy policy may never end: a trial, not a proof.",
        caption="is this world sound?",
        terms=(
            *("uniform-policy", "best-by-clock", "fewest-steps", "first-update", "flip-point"),
            *("unreached", "no-way-out", "return", "greedy", "truncated"),
        ),
        opened_by=OpeningKey("w c", "world check", "Check the world for traps and dead ends.", old="Q"),
        not_for_program="this checks scenarios. In a shell: rl-tui check --deep",
        shows=("policies", "why", "flips", "answer"),
        lacks=_without_check,
    ),
    PanelRow(
        row.FINDINGS,
        "rl_tui.screen.panels.program.findings:FindingsPanel",
        "Findings",
        "Problems of your program, the worst first, each with its evidence, its line in the source (▸) and "
        "a correction. At least three steps prove a bug, and none may contradict it. Declared: it relies on "
        "a value read from your code. A risk is code that bad luck can break. enter goes to the first step "
        "that shows it.",
        caption="what is wrong, and where",
        terms=("finding", "program", "departs", "informative-step", "bootstrap", "terminal", "truncated"),
        opened_by=OpeningKey(
            "a f",
            "findings",
            "Show what is wrong with your program.",
            old="F",
        ),
        of_program=True,
    ),
    PanelRow(
        row.OUTPUT,
        "rl_tui.screen.panels.program.output:OutputPanel",
        "Output",
        "The last lines that your program wrote, each after the number of steps taken. ! marks stderr, and "
        "the traceback of an exception is at the end. The view follows the last line until you scroll up. "
        "end follows again.",
        caption="what your program wrote",
        terms=("program", "step", "finding"),
        opened_by=OpeningKey("a w", "output", "Show what your program wrote, and its traceback.", old="O"),
        of_program=True,
    ),
)
"""In the order of the tab key."""
