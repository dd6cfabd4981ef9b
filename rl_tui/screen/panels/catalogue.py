"""The table of all panels."""

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
        "and pgup turn pages, and h shows a hint. A task lists its conditions. ✓ marks a condition that is "
        "true, ○ one that is not true yet, and … one that is not known yet.",
        caption="read, predict, do, compare",
        words="agent state action reward policy value return",
        of_lesson=True,
    ),
    PanelRow(
        row.WORLD,
        "rl_tui.screen.panels.world_views:WorldPlaceholder",
        "World",
        "Colour and number show V(s): how good a state looks to the agent. Arrows, bold edges or ▸ mark "
        "greedy actions, which look best. Several arrows, or *, mean a tie. ◉ agent, ★ goal, ● hole, ╱ "
        "cliff, S start, · no greedy action yet. A frame marks the last update. ◤ marks a difference between "
        "two runs. A bandit's arm shows its estimate ± standard error.",
        caption="where the agent acts",
        words="agent state action reward value greedy terminal ties policy mdp arm standard-error trail "
        "slip wind",
        is_twofold=True,
    ),
    PanelRow(
        row.DRAW,
        "rl_tui.screen.panels.draw_panel:DrawPanel",
        "Draw",
        "The tools for editing the world. The brush in use is highlighted. Click or drag on the world to "
        "paint. With the arrow tool (A), a click only moves the cursor, and a drag marks a rectangle. "
        "Sliders set the rules of the world, and the values of the cell under the cursor. Dim tools are not "
        "available now.",
        caption="brushes, values and rules",
        words="slip wind reward truncated mdp arm",
        of_drawing=True,
    ),
    PanelRow(
        row.TABLE,
        "rl_tui.screen.panels.q_table.q_table:QTable",
        "Q",
        "One row per state, one column per action, in the colours of the world. A frame marks the greedy "
        "action. ▐ marks the last update: ▴ the estimate rose, ▾ it fell. A dot means never tried. v shows "
        "the exact Q*, the error Q−Q*, visits and the landscape. <.01 and 0⁺ are almost 0.",
        caption="what each action seems worth",
        words="q pair greedy agent target q-star error visits ties optimism",
        is_twofold=True,
    ),
    PanelRow(
        row.CURVE,
        "rl_tui.screen.panels.curve.curve:ReturnCurve",
        "Return",
        "Filled: mean return of the last ten episodes (of more in long runs). Solid: the greedy policy's "
        "exact return, with a gap if it may never end. Dashed: the optimal return, or a policy of t p. ▾ ▴: "
        "values outside the axis. The chart shows steps if all returns are equal, V's error if no state has "
        "two actions.",
        caption="what each episode has earned",
        words="return episode greedy last-100 gamma-best best-arm gap explore discounted-return sweep",
    ),
    PanelRow(
        row.TIMELINE,
        "rl_tui.screen.panels.timeline:TimelineBar",
        "Timeline",
        "The run so far. Drag the handle, or use the arrows, to go back: all panels show the run as it was. "
        "Continue from there, or change something to begin a branch. ★ first reward, ┃ new greedy policy, "
        "◆ edited world, ▾ changed setting, ╍ your own steps, ┆ start of the branch.",
        caption="go back in the run",
        words="branch episode seed",
        has_border=False,
    ),
    PanelRow(
        row.BUDGET,
        "rl_tui.screen.panels.budget:BudgetPanel",
        "Budget",
        "The pulls of a bandit, and its winnings: the sum of rewards. Regret is the expected loss compared "
        "with the best arm. Regret appears when exact values are shown, or after the last pull. "
        "Winnings depend on luck, and regret does not. So winnings plus regret can differ from the best "
        "possible sum.",
        caption="what the pulls earned",
        words="winnings regret best-possible best-arm-share best-arm bandit arm reward step",
    ),
    PanelRow(
        row.CONTROLS,
        "rl_tui.screen.panels.controls.controls:Controls",
        "Agent",
        "Each setting with an effect has a slider. 1 to 4 go to a slider, left and right change it, enter "
        "types a value. ┃ on γ marks a flip point, where an optimal action changes: { and } go there. "
        "Changes apply from the next step. A new initial Q (r i) or seed (r s) restarts the run. a o shows "
        "all settings.",
        caption="its settings and sliders",
        words="alpha gamma epsilon policy off-policy on-policy ties optimism seed flip-point",
    ),
    PanelRow(
        row.PROGRAM,
        "rl_tui.screen.panels.program.program:ProgramPanel",
        "Program",
        "Your script under rl-tui watch: its environment, its table and its update. The update rule, α and "
        "γ are computed from the changes of the table. A step reveals γ only if its next state has a value "
        "other than 0. a f shows errors, a w shows output, a b chooses another table. Save the file to "
        "restart it.",
        caption="your own code, watched",
        words="program finding informative-step departs alpha gamma target",
        of_program=True,
    ),
    PanelRow(
        row.LAST_STEP,
        "rl_tui.screen.panels.last_step.last_step:LastStepPanel",
        "Last step",
        "The action, its result, and the update in numbers. The heading shows how the action was chosen. The "
        "bar shows δ, the TD error, and points left if δ is negative. It is full if |δ| reaches a quarter of "
        "the range of all estimates. If a step changes many estimates, the panel shows one and counts the "
        "others.",
        caption="action, result and update",
        words="td-error target bootstrap alpha gamma reward terminal truncated lambda",
    ),
    PanelRow(
        row.CAPTION,
        "rl_tui.screen.panels.caption:CaptionLine",
        "Caption",
        "One sentence about progress, such as: nothing is learned yet. It appears in full screen (f), "
        "and in your first runs, while panels appear one by "
        "one.",
        caption="what is being learned",
        words="state value reward policy greedy",
        has_border=False,
    ),
    PanelRow(
        row.MICROSCOPE,
        "rl_tui.screen.panels.microscope.microscope:Microscope",
        "Microscope",
        "The last step in detail. Highlighted numbers belong to the updated cell. Underlined numbers were "
        "read from Q. The backup diagram shows all possible outcomes; ▸ marks the real one. The estimate "
        "moves towards the target of the real outcome. The expected target is the mean over all outcomes. "
        "The history shows the cell under the cursor, otherwise the updated cell.",
        caption="the last step in detail",
        words="backup bellman target td-error bootstrap discounted-return return q-star",
        opened_by=OpeningKey("d", "microscope", "Open the last step under the microscope.", rank=9),
        shows=("model",),
    ),
    PanelRow(
        row.MODEL,
        "rl_tui.screen.panels.model:ModelPanel",
        "Model",
        "The parts of the MDP, ⟨S, A, P, R, γ⟩, and one state–action pair in full: its outcomes, its "
        "estimate, and the Bellman equation of its exact value. ↑ and ↓ choose the state, ← and → the "
        "action. The world marks s, a and each possible s′. A cursor in world or table chooses a pair too.",
        caption="what the world can do",
        words="model mdp state action reward gamma pair bellman q-star",
        opened_by=OpeningKey("w m", "model", "Show the outcomes of each state–action pair."),
        shows=("model",),
    ),
    PanelRow(
        row.MANY_SEEDS,
        "rl_tui.screen.panels.many_seeds:ManySeeds",
        "Many seeds",
        "Repeats the run with many other seeds, to see whether a result is luck. Each row shows the result "
        "of the run on screen, then the mean over all seeds ± its standard error. Two or more runs are "
        "compared seed by seed: the brackets show the difference ± three standard errors. After you change "
        "a setting, enter repeats the study.",
        caption="luck, or a real difference?",
        words="standard-error many-seeds paired-difference seed lane regret last-100 greedy",
        opened_by=OpeningKey("t m", "many seeds", "Repeat this run with many other seeds.", old="M"),
        wide_rows=12,
        not_for_program="this is for built-in agents. For yours: rl-tui grade {file}",
        shows=("many seeds",),
    ),
    PanelRow(
        row.DISCOUNT,
        "rl_tui.screen.panels.discount:DiscountPanel",
        "Flip points",
        "Q* of the best and the second best action in one state, for γ from 0 to 1. At each flip point an "
        "optimal action changes. ◆: in this state. ┃: on the optimal path from the start. ●: the current γ. "
        "v shows all actions. Arrows choose a flip point. enter moves γ past it. Limit: worlds of up to 100 "
        "states.",
        caption="where the optimal actions change",
        words="gamma flip-point turns-the-way optimal-values-by-gamma earned-at-flip q-star",
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
        'The exact return of each policy; "drawn" is your own (w p). The column "return" is the undiscounted '
        'mean within the time limit. The column "at start" is discounted. ‹ marks a bar too long to draw. '
        "World and curve show the policy under the cursor. enter closes the panel but keeps showing that "
        "policy. The agent does not use it.",
        caption="exact return of each policy",
        words="policy-value policy-return exploring-cost behaviour greedy uniform-policy q-pi "
        "value-at-start expected-steps chance-of-ending bellman-expectation",
        opened_by=OpeningKey("t p", "policies", "Compare policies by their exact return.", old="P"),
        shows=("policies",),
        lacks=_without_table,
    ),
    PanelRow(
        row.WORLD_CHECK,
        "rl_tui.screen.panels.world_check:WorldCheckPanel",
        "World check",
        "Facts to know before you give a world to a class: returns, path length, the wait for the first "
        "update, flip points, and states without a way in or out. These facts are exact. Then each "
        "algorithm is trained briefly, to see whether its greedy policy may never end. This part is a "
        "trial, not a proof.",
        caption="does this world work?",
        words="uniform-policy best-by-clock fewest-steps first-update flip-point unreached no-way-out "
        "return greedy truncated",
        opened_by=OpeningKey("w c", "world check", "Check the world for traps and dead ends.", old="Q"),
        not_for_program="not available for scripts. In a shell: rl-tui check --deep",
        shows=("policies", "why", "flips", "answer"),
        lacks=_without_check,
    ),
    PanelRow(
        row.FINDINGS,
        "rl_tui.screen.panels.program.findings:FindingsPanel",
        "Findings",
        "Problems of your program, worst first, each with evidence, its line (▸) and a correction. At least "
        "three steps prove a bug, and no step contradicts it. Declared: the proof uses a value read from "
        "your code. Risk: your code has found no reward, but random actions would have found one. enter goes "
        "to the first step that shows the problem.",
        caption="what is wrong, and where",
        words="finding program departs informative-step bootstrap terminal truncated",
        opened_by=OpeningKey("a f", "findings", "Show what is wrong with your program.", old="F"),
        of_program=True,
    ),
    PanelRow(
        row.OUTPUT,
        "rl_tui.screen.panels.program.output:OutputPanel",
        "Output",
        "The last lines that your program wrote, each with the number of steps before it. ! marks stderr "
        "(errors and warnings), and the traceback of an exception is at the end. The view follows the last "
        "line until you scroll up. Press end to follow again.",
        caption="what your program wrote",
        words="program step finding",
        opened_by=OpeningKey("a w", "output", "Show what your program wrote, and its traceback.", old="O"),
        of_program=True,
    ),
)
"""In the order of the tab key."""
