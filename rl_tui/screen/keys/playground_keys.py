"""The actions on a run, as ordered in menus."""

from __future__ import annotations

from typing import Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.screen.keys.action import Action, Group

ORDINALS: Final = ("first", "second", "third", "fourth")
DRAW_PATH: Final = ("w", "d")

DECIDES: Final = "your program sets this. Edit {file} and save: it restarts"
"""Why a watched program's settings cannot be changed."""
_NO_ENTRY: Final = ("", "")
_ITS_SEED: Final = "the seed is set at the start: rl-tui watch {file} --seed N"

_LESSON: Final[tuple[Action, ...]] = (
    Action("lesson.go_on", "enter", "go on", "Do what the page asks: read on, or answer.").also(
        old="A,R", aliases="lesson page learn text read answer predict prediction question impossible claim"
    ),
    Action("lesson.next_page", "pagedown", "next page", "Scroll down, then go to the next page.").also(
        symbol="pgdn",
        old="full_stop",
        rank=1,
        is_first=True,
        hint=("pgdn pgup", "page"),
        aliases="lesson skip forward",
    ),
    Action(
        "lesson.previous_page", "pageup", "previous page", "Scroll up, then go to the previous page."
    ).also(symbol="pgup", old="comma", aliases="lesson back previous"),
    Action("lesson.hint", "h", "hint", "Show the next hint of the task, then the solution.").also(
        old="H", rank=2, is_first=True, aliases="lesson help solution"
    ),
)
LESSON_ACTIONS: Final = tuple(
    each.also(group=Group.LESSON, needs_world=True, of_lesson=True) for each in _LESSON
)

_RUN: Final[tuple[Action, ...]] = (
    Action("run.run_or_pause", "space", "run", "Run, or pause.").also(
        rank=0,
        is_first=True,
        while_running="pause",
        aliases="go play start stop train continue resume",
        takes_steps=True,
    ),
    Action("run.step", "s", "step", "Take one step, then pause.", rank=1, is_first=True, takes_steps=True),
    Action(
        "run.episode", "e", "episode", "Run one episode, or one pass of a planner.", rank=2, takes_steps=True
    ),
    Action("time.step_back", "b", "back", "Go back one step, to the settings of that time.").also(
        rank=3, is_first=True, entry=("b B", "back"), aliases="undo rewind", stays=True
    ),
    Action(
        "time.episode_back", "B", "episode start", "Go back to the start of the episode.", entry=_NO_ENTRY
    ),
    *(
        Action(id_, key, label, help_, command=does, symbol=sign, unfocused=True, takes_steps=key == "right")
        for id_, key, label, help_, does, sign in (
            ("time.on", "right", "forward", "Take a step, or repeat a past step.", "run.step", "→"),
            ("time.back", "left", "step back", "Go back one step.", "time.step_back", "←"),
            ("time.to_start", "home", "start", "Go to step 0.", "time.seek(0)", ""),
            ("time.to_end", "end", "end", "Go to the end of the run so far.", "", ""),
        )
    ),
    Action("run.faster", "plus,equals_sign", "faster", "Go faster: 1, 3, 10, 30 … steps a second.").also(
        symbol="+", rank=8, hint=("+ −", "speed"), entry=("+ −", "speed"), aliases="speed"
    ),
    Action("run.slower", "minus,underscore", "slower", "Go slower.").also(
        symbol="−", entry=_NO_ENTRY, aliases="speed"
    ),
    Action("until.choose", "u", "until…", "Choose when to stop: reward, new policy, value …").also(
        rank=13, aliases="skip jump", needs_world=True, takes_steps=True
    ),
    Action("view.enter_world", "up,down,k,j", "cursor", "Move a cursor in the world.").also(
        symbol="↑ ↓", unfocused=True
    ),
    *(
        Action(
            f"agent.focus_slider_{number}", str(number), f"{ordinal} slider", f"Go to the {ordinal} slider."
        ).also(
            command=f"agent.focus_slider({number})",
            entry=_NO_ENTRY if number > 1 else ("1 2 3 4", "sliders"),
            not_for_program=DECIDES,
        )
        for number, ordinal in enumerate(ORDINALS, start=1)
    ),
    Action("view.next_layer", "v", "view", "Show another view of world and table.").also(
        rank=4, aliases="layer error visits"
    ),
    Action("view.zoom", "f", "full screen", "Show only the panel in focus, or all again.").also(
        rank=14, aliases="fullscreen zoom projector kiosk big", keeps_page=True
    ),
    Action("manual.toggle", "y", "you act", "Take the agent's steps yourself.").also(
        rank=15,
        needs_world=True,
        takes_steps=True,
        not_for_program="your program takes its own steps. esc: choose a scenario to act in",
    ),
)

_AGENT: Final[tuple[Action, ...]] = (
    Action(
        "agent.choose_algorithm", "a a", "algorithm…", "Choose another algorithm. Q and visits are kept."
    ).also(aliases=" ".join(BY_ID), not_for_program=DECIDES),
    Action("agent.choose_policy", "a p", "policy…", "Choose the rule that picks the actions.").also(
        aliases=" ".join(POLICY_BY_ID), old="p", not_for_program=DECIDES
    ),
    Action("agent.next_ties", "a t", "ties", "Break ties between actions at random, or take the first.").also(
        not_for_program=DECIDES
    ),
    Action("agent.show_options", "a o", "settings…", "Show and change every setting.").also(
        old="o",
        aliases="alpha gamma epsilon lambda tau discount exploration hyperparameters parameters "
        "options config preferences",
        not_for_program=DECIDES,
    ),
    *(
        Action(
            f"run.{does}", f"a {does[0]}", does, f"{does.capitalize()} the policy once, in every state."
        ).also(
            command=f"run.sweep('{noun}')",
            old=does[0].upper(),
            aliases=f"policy iteration sweep {noun}",
            takes_steps=True,
            not_for_program="only planners have sweeps. s: step, e: episode",
        )
        for does, noun in (("evaluate", "evaluation"), ("improve", "improvement"))
    ),
    Action("program.choose_table", "a b", "table…", "Choose which table of your program is Q.").also(
        old="T", of_program=True
    ),
)

_WORLD: Final[tuple[Action, ...]] = (
    Action("editing.toggle", "w d", "edit world", "Edit the world while the agent learns.").also(
        old="C",
        aliases="draw brush paint map wall goal hole reward noise slip wind maze create",
        not_for_program="your program has its own world. Scenarios can be edited",
    ),
    Action("drawing.toggle", "w p", "draw policy", "Draw your own policy and see its return.").also(
        old="D", aliases="arrows own sketch evaluate", shows=("policies", "answer")
    ),
)

_SIGHT: Final[tuple[Action, ...]] = (
    Action("view.hide_answer", "w h", "exact values", "Hide or show the exact values.").also(
        aliases="answer optimal solve solution cheat", shows=("answer",), keeps_page=True
    ),
    Action("view.turn_actions", "w a", "Q cells", "Show all Q in the cells, or only V.", old="V"),
    Action("view.numbers", "w n", "numbers", "Number the states in the cells.", old="number_sign"),
    *(
        Action(f"{word}_scenario", f"w {bracket}", label, f"Go to the {word} scenario.").also(
            command=f"scenario.go_by({offset})",
            old=name,
            old_only_tells=True,
            not_for_program="your program is not on the start screen. esc: go there",
            not_in_lesson="esc leaves the lesson. Its progress is kept",
        )
        for word, bracket, label, offset, name in (
            ("previous", "[", "previous world", -1, "left_square_bracket"),
            ("next", "]", "next world", 1, "right_square_bracket"),
        )
    ),
)

_TOOLS: Final[tuple[Action, ...]] = (
    Action("scenario.map_settings", "t s", "settings map", "Compare nearby settings under many seeds.").also(
        old="S",
        aliases="atlas sweep hyperparameters sensitivity heatmap",
        not_for_program=DECIDES,
        not_in_lesson="a lesson has its own questions. esc: leave the lesson",
    ),
    Action("why.explain", "t y", "why", "Explain why nothing is learned yet.").also(
        old="Y",
        aliases="first update reward wait stuck remedy",
        not_for_program="this is for built-in agents. c a: compare with one",
        shows=("why",),
        keeps_page=True,
    ),
    Action(
        "until.toggle_breakpoint", "t b", "breakpoint", "Set or clear a stopping point at the cursor."
    ).also(aliases="debug"),
    Action("until.clear_breakpoints", "t n", "no breakpoints", "Clear all breakpoints.").also(
        old="K", old_only_tells=True
    ),
)

_COMPARE: Final[tuple[Action, ...]] = (
    Action(
        "lanes.another_algorithm",
        "c a",
        "another algorithm",
        "Compare with another algorithm, under the same seed.",
    ).also(aliases="side by side lane", takes_steps=True),
    Action(
        "lanes.another_setting", "c s", "another setting", "Compare with a run that differs in one setting."
    ).also(aliases="side by side lane", takes_steps=True, not_for_program=DECIDES),
    Action(
        "lanes.another_seed", "c n", "another seed", "Compare with the same run under the next seed."
    ).also(aliases="side by side lane luck", takes_steps=True, not_for_program=_ITS_SEED),
    Action("lanes.another_branch", "c b", "a branch", "Compare with another branch of this run.").also(
        takes_steps=True, not_for_program="your program has one branch. c a: an agent beside it"
    ),
    Action("lanes.show_runs", "c c", "runs…", "Choose the run to control, and another to show."),
    Action("lanes.next_lane", "c l", "next run", "Switch to the next run.").also(
        old="l", not_for_program="keys control your program here. c o: one run, or two"
    ),
    Action("lanes.one_lane", "c o", "one run", "Show one run, or two side by side.", old="z"),
    Action("lanes.end", "c e", "end run", "End the run that you control, after asking."),
)

_MORE: Final[tuple[Action, ...]] = (
    Action("time.go_to", "m g", "go to…", "Go to a step or an episode.", old="g"),
    Action("time.show_branches", "m b", "branches…", "Show the branches and their changes.").also(
        aliases="journal history log undo redo changes",
        not_for_program="your program has one branch. b and B: go back in it",
    ),
    Action("run.watch", "m w", "watch it", "Run fast, and slow down when something is learned.").also(
        old="W",
        old_only_tells=True,
        aliases="learn",
        takes_steps=True,
        not_for_program="this is for built-in agents. + and −: speed",
    ),
    Action("session.save", "m s", "save…", "Save the session under a name.").also(
        keeps_page=True,
        for_the_owner=True,
        not_for_program="nothing to save: {file} and its seed repeat the run",
    ),
    Action("export.choose", "m x", "export…", "Write a command, a script, tables or a picture.").also(
        old="x",
        aliases="screenshot image svg csv python code share copy print plot chart graph",
        shows=("answer",),
        keeps_page=True,
        for_the_owner=True,
        not_for_program="this is for built-in agents. Your program is in {file}",
    ),
    Action("panels.turn", "m p", "panels", "Show all panels, or only those that matter now.").also(
        rank=4, is_first=True, aliases="layout"
    ),
    Action("view.turn_legends", "m l", "legends", "Hide or show the legends of panels.", old="L"),
    Action("theme", "m c", "colours…", "Choose the colours.").also(
        command="app.change_theme", aliases="color dark light theme"
    ),
)

_AGAIN: Final[tuple[Action, ...]] = (
    Action("run.reset", "r r", "the same", "Start again with the current settings and the same seed.").also(
        aliases="restart reset clear new"
    ),
    Action(
        "agent.next_seed", "r n", "next seed", "Start again with the next seed.", not_for_program=_ITS_SEED
    ),
    Action("agent.ask_seed", "r s", "seed…", "Type the seed, and start again.").also(
        old="n", not_for_program=_ITS_SEED
    ),
    Action(
        "agent.ask_initial_q",
        "r i",
        "initial Q…",
        "Type the initial estimate of every action, and start again.",
    ).also(old="i", not_for_program=DECIDES),
    Action("lesson.set_up", "r p", "page's setup", "Restart the run of this page, with its settings.").also(
        old="N", old_only_tells=True, aliases="lesson again reset restart", of_lesson=True
    ),
)

BEFORE_PANELS: Final = (*LESSON_ACTIONS, *_RUN, *_AGENT, *_WORLD)
AFTER_PANELS: Final = (*_SIGHT, *_TOOLS, *_COMPARE, *_MORE, *_AGAIN)
"""The keys that open panels come between these two."""
