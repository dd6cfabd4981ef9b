"""The function for each command to a watched program, and the refusals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.common.errors import UserError
from rl_tui.live import commands
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.live.programs.program_snapshot import usual_recipe
from rl_tui.live.state import State
from rl_tui.runs.recipe import SetParameter

if TYPE_CHECKING:
    from rl_tui.live.programs.program_playback import ProgramPlayback

_NAMES: Final = {"alpha": "α", "gamma": "γ", "epsilon": "ε"}


def refusal_of(command: commands.Command, file: str) -> str:
    """Return the reason why `command` does not apply to the program in `file`."""
    match command:
        case commands.Apply(SetParameter(name)):
            return f"your program sets this: change {_NAMES.get(name, name)} in {file}, and save it"
        case commands.Apply():
            return f"your program sets how it learns: change it in {file}, and save it"
        case commands.Take():
            return "your program takes its own steps: s takes one"
        case commands.WatchLearning():
            return "a program has no automatic speed: use + and −"
        case commands.ChooseBranch() | commands.AddBranch():
            return "a program has no branches"
        case commands.ChooseLane():
            return "your program is the run in view; c o compares it with the other run"
        case commands.StudySeeds():
            return "rl-tui grade runs your program with many seeds"
    return "this is not available for a watched program"


def _set_speed(playback: ProgramPlayback, command: commands.SetSpeed) -> None:
    transport = playback.transport
    transport.speed = command.speed
    if transport.state is State.RUNNING:
        if command.speed is not None:
            transport.program.hold()
        transport.start_pace(at_once=False)


def _step_back(playback: ProgramPlayback, _: commands.StepBack) -> None:
    playback.transport.show(playback.history.shown.step - 1)


def _episode_back(playback: ProgramPlayback, _: commands.EpisodeBack) -> None:
    playback.transport.rest()
    history = playback.history
    began = history.begin_of_episode(history.shown.episodes + 1)
    if began >= history.shown.step:  # at the end of an episode, return to its beginning
        began = history.begin_of_episode(max(1, history.shown.episodes))
    _show_beginning(playback, began)


def _show_beginning(playback: ProgramPlayback, step: int) -> None:
    playback.transport.show(step)
    playback.history.begun_at = step


def _go_to(playback: ProgramPlayback, command: commands.GoTo) -> None:
    if command.episode is not None:
        _show_beginning(playback, playback.history.begin_of_episode(command.episode))
    elif command.step is not None:
        playback.transport.show(command.step)


def _toggle_breakpoint(playback: ProgramPlayback, command: commands.ToggleBreakpoint) -> None:
    breakpoints = playback.transport.breakpoints.toggled(state=command.state, pair=command.pair)
    breakpoints.check(playback.beside.world.space)
    playback.transport.pause_at(breakpoints)


def _clear_breakpoints(playback: ProgramPlayback, _: commands.ClearBreakpoints) -> None:
    playback.transport.pause_at(Breakpoints())


def _restart(playback: ProgramPlayback, _: commands.Restart) -> None:
    playback.restart()


def _choose_table(playback: ProgramPlayback, command: commands.ChooseTable) -> None:
    playback.restart(replace(playback.program.request, table=command.name))


def _look_at(playback: ProgramPlayback, command: commands.LookAt) -> None:
    playback.questions.beside.viewport = command.viewport


def _follow_cell(playback: ProgramPlayback, command: commands.FollowCell) -> None:
    playback.questions.beside.cell = command.pair


def _study_policy(playback: ProgramPlayback, command: commands.StudyPolicy) -> None:
    playback.questions.beside.studied = command.kind


def _hide_answer(playback: ProgramPlayback, command: commands.HideAnswer) -> None:
    playback.questions.beside.is_hidden = command.is_hidden


def _ask_flips(playback: ProgramPlayback, _: commands.AskFlips) -> None:
    playback.questions.beside.flips.begin(playback.beside.world.mdp)


def _draw_action(playback: ProgramPlayback, command: commands.DrawAction) -> None:
    space, state, action = playback.beside.world.space, command.state, command.action
    if not 0 <= state < space.states or (action is not None and space.pair_of(state, action) is None):
        raise UserError("this action does not exist in this state")
    playback.questions.beside.draw(state, action)


def _add_lane(playback: ProgramPlayback, command: commands.AddLane) -> None:
    usual, found = usual_recipe(playback.program.world, playback.program.request.seed), playback.found
    algorithm = usual.algorithm if found.algorithm == OWN_PROGRAM.id else found.algorithm
    recipe = replace(usual, algorithm=algorithm, hyperparameters=found.hyperparameters)
    playback.beside.add(recipe, command.changes)


def _drop_lane(playback: ProgramPlayback, command: commands.DropLane) -> None:
    if command.lane == 0:
        raise UserError("your program cannot be ended here: end another run")
    playback.beside.drop(command.lane - 1)


def _mark_lane(playback: ProgramPlayback, command: commands.MarkLane) -> None:
    if 1 <= command.lane <= len(playback.beside.runs):
        playback.beside.marked = command.lane - 1


def _nothing(_: ProgramPlayback, __: commands.Command) -> None:
    """Ignore a command that does not concern a program."""


HANDLERS: Final[Mapping[type, Callable[[ProgramPlayback, Any], None]]] = {
    commands.Play: lambda playback, _: playback.transport.run(),
    commands.Pause: lambda playback, _: playback.transport.rest(),
    commands.Step: lambda playback, _: playback.transport.take_steps(1),
    commands.RunEpisode: lambda playback, _: playback.transport.run_until(Until(Event.EPISODE_END)),
    commands.RunUntil: lambda playback, command: playback.transport.run_until(command.until),
    commands.Train: lambda playback, command: playback.transport.train(command.steps),
    commands.SetSpeed: _set_speed,
    commands.StepBack: _step_back,
    commands.EpisodeBack: _episode_back,
    commands.GoTo: _go_to,
    commands.ToggleBreakpoint: _toggle_breakpoint,
    commands.ClearBreakpoints: _clear_breakpoints,
    commands.Restart: _restart,
    commands.ChooseTable: _choose_table,
    commands.LookAt: _look_at,
    commands.FollowCell: _follow_cell,
    commands.StudyPolicy: _study_policy,
    commands.HideAnswer: _hide_answer,
    commands.AskFlips: _ask_flips,
    commands.DrawAction: _draw_action,
    commands.ClearDrawing: lambda playback, _: playback.questions.beside.clear(),
    commands.AddLane: _add_lane,
    commands.DropLane: _drop_lane,
    commands.MarkLane: _mark_lane,
    commands.EndStudy: _nothing,
    commands.AskWhy: _nothing,
}
"""Handler for each type of command. Other types are refused."""
