"""Everything a person can do, once: bindings, palette, help panel and key line derive from this list.

The keys that open panels come from the table of panels.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rl_tui.tui.actions.action import Action, Group, Place
from rl_tui.tui.panels.catalogue import PANELS, PanelRow

ORDINALS: Final = ("first", "second", "third", "fourth")

_ACTIONS: Final[tuple[Action, ...]] = (
    Action(
        "open",
        "enter",
        "open",
        "Open the scenario, or go on with the session.",
        Group.SCENARIO,
        Place.CATALOGUE,
        rank=0,
    ),
    Action(
        "delete_session",
        "delete",
        "delete",
        "Delete the session under the cursor, after asking; shift+tab goes to the sessions.",
        Group.SESSION,
        Place.CATALOGUE,
        symbol="del",
        for_the_owner=True,
    ),
    Action(
        "run.run_or_pause",
        "space",
        "run",
        "Run, or pause where it stands.",
        Group.RUN,
        rank=0,
        while_running="pause",
        aliases="go play start stop train",
    ),
    Action("run.step", "s", "step", "Take one step, then pause.", Group.RUN, rank=1),
    Action(
        "run.episode",
        "e",
        "episode",
        "Run to the end of the episode (of a planner: the sweep), then pause.",
        Group.RUN,
        rank=2,
    ),
    Action(
        "run.faster",
        "plus,equals_sign",
        "faster",
        "Next higher speed: 1, 3, 10, 30 … steps a second, up to as fast as it goes.",
        Group.RUN,
        symbol="+",
        rank=3,
        hint=("+ −", "speed"),
    ),
    Action("run.slower", "minus,underscore", "slower", "Next lower speed.", Group.RUN, symbol="−"),
    Action(
        "run.watch",
        "W",
        "watch it learn",
        "Run fast until the first reward, then stop a moment for each state that gets a value; + − end it.",
        Group.RUN,
    ),
    Action(
        "run.reset",
        "r",
        "reset",
        "Start again: these settings, the same seed.",
        Group.RUN,
        rank=12,
        aliases="restart clear",
    ),
    Action(
        "time.step_back",
        "b",
        "step back",
        "Go one step back; to change something there begins another branch.",
        Group.TIME,
        rank=3,
        hint=("b B", "back"),
        aliases="undo",
    ),
    Action(
        "time.episode_back",
        "B",
        "episode back",
        "Go back to where the episode began, then to the one before it.",
        Group.TIME,
    ),
    Action(
        "time.go_to",
        "g",
        "go to",
        "Go to a step or an episode, as far as the run has come; or drag the timeline.",
        Group.TIME,
        rank=15,
        needs_world=True,
    ),
    Action(
        "time.show_branches",
        "j",
        "journal",
        "Show the branches of the run and what was changed in each; enter goes to one, c compares.",
        Group.TIME,
        rank=16,
        needs_world=True,
    ),
    Action(
        "until.choose",
        "u",
        "run until",
        "Run until a reward, a change of the policy, a value: choose what to wait for.",
        Group.TIME,
        rank=6,
        needs_world=True,
    ),
    Action(
        "until.toggle_breakpoint",
        "k",
        "breakpoint",
        "Pause whenever the state or pair under the cursor is met; again takes it away.",
        Group.TIME,
        rank=17,
        needs_world=True,
    ),
    Action("until.clear_breakpoints", "K", "no breakpoints", "Take all breakpoints away.", Group.TIME),
    Action(
        "agent.choose_algorithm",
        "a",
        "algorithm",
        "Choose the algorithm; Q and visits are kept.",
        Group.AGENT,
        rank=9,
        needs_world=True,
    ),
    Action(
        "agent.choose_policy",
        "p",
        "policy",
        "Choose the rule by which actions are chosen.",
        Group.AGENT,
        rank=13,
        needs_world=True,
    ),
    Action(
        "agent.next_ties",
        "t",
        "ties",
        "Break ties between equal best actions at random, or take the first.",
        Group.AGENT,
        rank=20,
    ),
    Action(
        "agent.ask_initial_q",
        "i",
        "initial Q",
        "Set what every estimate starts from, and start again.",
        Group.AGENT,
        rank=21,
    ),
    Action("agent.ask_seed", "n", "seed", "Set the seed, and start again.", Group.AGENT, rank=22),
    *(
        Action(
            f"agent.focus_slider_{number}",
            str(number),
            f"{ordinal} slider",
            f"Go to the {ordinal} slider: arrows move it; enter, a number, enter set it; esc leaves it.",
            Group.AGENT,
            command=f"agent.focus_slider({number})",
        )
        for number, ordinal in enumerate(ORDINALS, start=1)
    ),
    Action(
        "agent.show_options",
        "o",
        "options",
        "Everything the agent is told, schedules and sample averages too; enter changes it.",
        Group.AGENT,
        rank=14,
        aliases="alpha gamma epsilon lambda tau discount exploration hyper-parameters parameters settings",
    ),
    Action(
        "manual.toggle",
        "y",
        "you",
        "Be the agent: arrows or numbers take its steps, and it learns from them; again hands back.",
        Group.AGENT,
        rank=8,
        needs_world=True,
    ),
    Action(
        "view.next_layer",
        "v",
        "layer",
        "Next layer of the table: Q, exact Q*, error Q−Q*, visits.",
        Group.VIEW,
        rank=4,
    ),
    Action("view.turn_actions", "V", "Q in cells", "Show Q of every action in a map, or V.", Group.VIEW),
    Action(
        "view.zoom",
        "f",
        "zoom",
        "Show the focused panel (else the world) alone, and back.",
        Group.VIEW,
        rank=11,
    ),
    Action(
        "lanes.compare",
        "c",
        "compare",
        "Run another agent beside this one, with one thing different, or another branch.",
        Group.VIEW,
        rank=7,
        needs_world=True,
    ),
    Action("lanes.next_lane", "l", "next lane", "Lead the next of the runs side by side.", Group.VIEW),
    Action("lanes.one_lane", "z", "one lane", "Show one lane alone, or two side by side.", Group.VIEW),
    Action("turn_legends", "L", "legends", "Hide or show what panels and their signs mean.", Group.VIEW),
    Action("view.numbers", "number_sign", "numbers", "Number the states in cells.", Group.VIEW, symbol="#"),
    Action(
        "view.model",
        "m",
        "model",
        "Show the model: the outcomes of each pair.",
        Group.VIEW,
        rank=11,
        needs_world=True,
    ),
    Action(
        "view.reveal",
        "h",
        "reveal",
        "Show or hide what a bandit keeps secret.",
        Group.VIEW,
        rank=18,
        needs_world=True,
    ),
    Action(
        "session.save",
        "w",
        "save",
        "Save the session under a name; it is kept by itself as well.",
        Group.SESSION,
        rank=19,
        for_the_owner=True,
    ),
    Action(
        "export.choose",
        "x",
        "export",
        "Write the run as a command, a Python script, tables or a picture.",
        Group.SESSION,
        rank=10,
        for_the_owner=True,
        needs_world=True,
    ),
    Action(
        "previous_scenario",
        "left_square_bracket",
        "previous scenario",
        "Go to the previous scenario.",
        Group.SCENARIO,
        symbol="[",
        rank=12,
        hint=("[ ]", "scenario"),
    ),
    Action(
        "next_scenario",
        "right_square_bracket",
        "next scenario",
        "Go to the next scenario.",
        Group.SCENARIO,
        symbol="]",
    ),
    Action(
        "back",
        "escape",
        "back",
        "Leave the zoom or an opened panel, else go back to the catalogue: twice, once a step was taken.",
        Group.SCENARIO,
        symbol="esc",
        rank=18,
        aliases="menu list",
    ),
    Action(
        "help",
        "question_mark",
        "help",
        "Explain the word under the mouse or the panel in focus; else, and again, show this help.",
        Group.PROGRAM,
        Place.BOTH,
        symbol="?",
        rank=-1,
    ),
    Action(
        "glossary",
        "slash",
        "glossary",
        "Look a word up: each with its equation and where it stands in Sutton and Barto's book.",
        Group.PROGRAM,
        Place.BOTH,
        symbol="/",
    ),
    Action(
        "palette",
        "ctrl+p",
        "palette",
        "Find every action by its name, and the colour themes.",
        Group.PROGRAM,
        Place.BOTH,
        command="app.command_palette",
        rank=23,
    ),
    Action(
        "redraw",
        "ctrl+l",
        "draw again",
        "Draw the whole screen again, where something else wrote over it.",
        Group.PROGRAM,
        Place.BOTH,
        command="app.redraw",
        everywhere=True,
    ),
    Action(
        "suspend",
        "ctrl+z",
        "to the shell",
        "Stop here and go to the shell; its command fg comes back.",
        Group.PROGRAM,
        Place.BOTH,
        command="app.suspend_process",
        for_the_owner=True,
        everywhere=True,
    ),
    Action(
        "quit",
        "q",
        "quit",
        "Quit; in the help and in the model only close them.",
        Group.PROGRAM,
        Place.BOTH,
        command="app.quit",
        rank=24,
        aliases="exit leave end bye",
    ),
    Action(
        "ask_to_quit",
        "ctrl+c",
        "quit, asking",
        "Ask whether to quit; enter or a second ctrl+c does.",
        Group.PROGRAM,
        Place.BOTH,
        command="app.ask_to_quit",
        everywhere=True,
    ),
)


def all_actions(panels: Iterable[PanelRow] = PANELS) -> tuple[Action, ...]:
    """Return every action; those that open ``panels`` follow the one that zooms them."""
    after = next(number for number, action in enumerate(_ACTIONS, start=1) if action.id == "view.zoom")
    opening = (
        Action(
            f"board.{row.id}",
            row.opened_by.key,
            row.opened_by.label,
            row.opened_by.help,
            Group.VIEW,
            command=f"board.toggle('{row.id}')",
            rank=row.opened_by.rank,
            needs_world=True,
        )
        for row in panels
        if row.opened_by is not None
    )
    return (*_ACTIONS[:after], *opening, *_ACTIONS[after:])


ACTIONS: Final = all_actions()


def actions_of(place: Place, panels: Iterable[PanelRow] = PANELS) -> tuple[Action, ...]:
    """Return the actions that apply in ``place``, in the order of the list."""
    screen = place & Place.BOTH
    kiosk = Place.KIOSK in place
    return tuple(
        action
        for action in all_actions(panels)
        if screen in action.place and not (kiosk and action.for_the_owner)
    )
