"""One function for each command, and one for each state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.live import commands
from rl_tui.live.pace.compilation import LOOK_AGAIN
from rl_tui.live.pace.pacing import AT_ONCE, CHUNK
from rl_tui.live.pace.stop_condition import until_in_words
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.live.record import Record
from rl_tui.live.state import State
from rl_tui.live.world_editor import IN_LESSON
from rl_tui.runs.recipe import Change, OrderSweep, TakeAction, WorldChange, begin

if TYPE_CHECKING:
    from rl_tui.live.playback import Playback


# Commands


def _watch_learning(playback: Playback, _: commands.WatchLearning) -> None:
    playback.rest()
    playback.transport.go_by_learning(playback.answer)
    playback.run()


def _restart(playback: Playback, command: commands.Restart) -> None:
    """Restart in the edited world, unless the scenario or seed asks for another one."""
    group, recipe, before = playback.group, command.recipe, playback.group.current.recipe
    learning, first = playback.transport.learning, group.first.world
    is_same_scenario = recipe.scenario == before.scenario
    beginning = begin(recipe, first if is_same_scenario else None)
    if beginning.world is not first:
        playback.questions.change_world(before, recipe)
    is_same_world = is_same_scenario and (beginning.world is first or recipe.seed == before.seed)
    lanes = group.restarted(recipe, keeps_edits=is_same_world)
    breakpoints = playback.breakpoints if is_same_world else Breakpoints()
    playback.editor.forget()
    playback.start(Record(lanes, group.shown, breakpoints, playback.transport.speed), beginning.world)
    if not is_same_scenario:
        playback.questions.seed_studies.end()
    if learning is not None:
        playback.transport.go_by_learning(playback.answer)


def _pause(playback: Playback, _: commands.Pause) -> None:
    playback.rest()
    if playback.state is State.SEEKING and not playback.waits:
        playback.group.stop_seek()
        playback.seek()  # other runs may still have to catch up
    elif playback.state is not State.SEEKING:
        playback.end_if_over()


def _take(playback: Playback, command: commands.Take) -> None:
    playback.rest()
    names = playback.group.current.run.world.space.action_names
    known = 0 <= command.action < len(names)
    playback.group.apply(TakeAction(names[command.action] if known else command.action))
    playback.group.follow()
    playback.stop_if_due()


def _let_pass(playback: Playback, command: commands.LetPass) -> None:
    if not playback.automatic and playback.state is State.RUNNING:
        playback.transport.ticks_left += command.ticks


def _run_sweep(playback: Playback, command: commands.RunSweep) -> None:
    playback.rest()
    run = playback.group.built_in.run
    learner = run.learner
    is_under_way = learner.episode_step > 0
    if is_under_way and learner.phase == command.phase:
        playback.run_until(Until(Event.EPISODE_END))
        return
    if learner.ordered != command.phase:  # it may already be on the branch
        _change(playback, OrderSweep(command.phase))
    if not run.over:
        playback.run_until(Until(Event.EPISODE_END, number=int(is_under_way)))


def _change(playback: Playback, change: Change) -> None:
    _apply(playback, change)
    if playback.group.seeking:
        playback.seek()


def _apply(playback: Playback, change: Change) -> None:
    playback.group.apply(change)
    playback.take_in_change()


def _draw_world(playback: Playback, command: commands.DrawWorld) -> None:
    _change_world(playback, playback.editor.draw(playback.group.built_in.run, command.edits))


def _undo_stroke(playback: Playback, _: commands.UndoStroke) -> None:
    _change_world(playback, playback.editor.undo(playback.group.built_in.run))


def _redo_stroke(playback: Playback, _: commands.RedoStroke) -> None:
    _change_world(playback, playback.editor.redo(playback.group.built_in.run))


def _change_world(playback: Playback, change: WorldChange | None) -> None:
    if playback.questions.lesson is not None:
        raise UserError(IN_LESSON)
    if change is None:
        return
    if playback.editor.puts_off(playback.group.built_in.run, change):
        playback.rebuild()
    else:
        _change(playback, change)


def make_changes_that_waited(playback: Playback) -> bool:
    """Make changes with ready worlds. Return True if more are pending."""
    run, editor = playback.group.built_in.run, playback.editor
    try:
        while editor.is_ahead:
            change = editor.next_change(run)
            if change is None:
                return True
            _apply(playback, change)
            editor.take_in(run)
            playback.changed = True
    except UserError as fault:
        run.ready = None
        editor.forget()
        playback.rest()
        playback.paused_by = str(fault)
    return False


def _open_editor(playback: Playback, command: commands.OpenEditor) -> None:
    playback.editor.is_open = command.is_open


def _look_at(playback: Playback, command: commands.LookAt) -> None:
    playback.questions.viewport = command.viewport


def _follow_cell(playback: Playback, command: commands.FollowCell) -> None:
    playback.questions.cell = command.pair


def _study_policy(playback: Playback, command: commands.StudyPolicy) -> None:
    playback.questions.studied = command.kind


def _ask_why(playback: Playback, command: commands.AskWhy) -> None:
    playback.questions.asks_why = command.is_asked


def _ask_flips(playback: Playback, _: commands.AskFlips) -> None:
    playback.questions.flips.begin(playback.group.current.run.world.mdp)


def _ask_check(playback: Playback, command: commands.AskCheck) -> None:
    playback.questions.ask_check(is_asked=command.is_asked)


def _hide_answer(playback: Playback, command: commands.HideAnswer) -> None:
    playback.questions.is_hidden = command.is_hidden


def _keep_lesson(playback: Playback, command: commands.KeepLesson) -> None:
    playback.questions.lesson = command.lesson
    if "run" in playback.questions.kept_back:
        playback.rest()


def _watch_program(playback: Playback, command: commands.WatchProgram) -> None:
    playback.questions.watch_program(command.path)


def _draw_action(playback: Playback, command: commands.DrawAction) -> None:
    space, state, action = playback.group.current.run.world.space, command.state, command.action
    if not 0 <= state < space.states or (action is not None and space.pair_of(state, action) is None):
        raise UserError("this action does not exist in this state")
    playback.questions.draw(state, action)


def _toggle_breakpoint(playback: Playback, command: commands.ToggleBreakpoint) -> None:
    playback.set_breakpoints(playback.breakpoints.toggled(state=command.state, pair=command.pair))


def _step_back(playback: Playback, _: commands.StepBack) -> None:
    current = playback.group.current
    target = None if current.seek is None else current.seek.target.step
    here = current.run.step if target is None else target
    _seek_to(playback, step=here - 1)


def _episode_back(playback: Playback, _: commands.EpisodeBack) -> None:
    run = playback.group.current.run
    _seek_to(playback, episode=max(1, run.learner.episodes + (not run.learner.begins_episode)))


def _seek_to(
    playback: Playback, *, step: int | None = None, episode: int | None = None, branch: int | None = None
) -> None:
    playback.rest()
    playback.group.seek_to(step=step, episode=episode, branch=branch)
    playback.seek()


def _add_lane(playback: Playback, command: commands.AddLane) -> None:
    playback.group.add(command.changes, next_seed=command.next_seed)
    playback.take_in_change()
    playback.seek()


def _add_branch(playback: Playback, command: commands.AddBranch) -> None:
    playback.group.add_branch(command.branch)
    playback.take_in_change()
    playback.seek()


def _show_another(playback: Playback, show: Callable[[int], None], lane: int) -> None:
    if playback.condition is not None:
        playback.rest()  # the event belonged to the run shown before
    show(lane)
    playback.watch()
    playback.take_in_change()
    playback.seek()


HANDLERS: Final[Mapping[type, Callable[[Playback, Any], None]]] = {
    commands.Play: lambda playback, _: playback.run(),
    commands.WatchLearning: _watch_learning,
    commands.Pause: _pause,
    commands.Step: lambda playback, _: playback.take_step(),
    commands.Take: _take,
    commands.RunEpisode: lambda playback, _: playback.run_until(Until(Event.EPISODE_END)),
    commands.RunSweep: _run_sweep,
    commands.RunUntil: lambda playback, command: playback.run_until(command.until),
    commands.Train: lambda playback, command: playback.train(command.steps),
    commands.LetPass: _let_pass,
    commands.SetSpeed: lambda playback, command: playback.transport.set_speed(command.speed),
    commands.Apply: lambda playback, command: _change(playback, command.change),
    commands.Restart: _restart,
    commands.OpenEditor: _open_editor,
    commands.DrawWorld: _draw_world,
    commands.UndoStroke: _undo_stroke,
    commands.RedoStroke: _redo_stroke,
    commands.LookAt: _look_at,
    commands.FollowCell: _follow_cell,
    commands.StudyPolicy: _study_policy,
    commands.AskFlips: _ask_flips,
    commands.AskCheck: _ask_check,
    commands.DrawAction: _draw_action,
    commands.ClearDrawing: lambda playback, _: playback.questions.clear(),
    commands.HideAnswer: _hide_answer,
    commands.AskWhy: _ask_why,
    commands.KeepLesson: _keep_lesson,
    commands.WatchProgram: _watch_program,
    commands.ToggleBreakpoint: _toggle_breakpoint,
    commands.ClearBreakpoints: lambda playback, _: playback.set_breakpoints(Breakpoints()),
    commands.StepBack: _step_back,
    commands.EpisodeBack: _episode_back,
    commands.GoTo: lambda playback, command: _seek_to(playback, step=command.step, episode=command.episode),
    commands.ChooseBranch: lambda playback, command: _seek_to(playback, branch=command.branch),
    commands.AddLane: _add_lane,
    commands.AddBranch: _add_branch,
    commands.ChooseLane: lambda playback, command: _show_another(playback, playback.group.show, command.lane),
    commands.MarkLane: lambda playback, command: playback.group.mark(command.lane),
    commands.StudySeeds: lambda playback, _: playback.questions.seed_studies.begin(playback.group),
    commands.EndStudy: lambda playback, _: playback.questions.seed_studies.end(),
    commands.DropLane: lambda playback, command: _show_another(playback, playback.group.drop, command.lane),
}
"""Handler for each type of command."""


# Work in each state


def continue_seek(playback: Playback) -> float:
    """Advance the seek, and at its end resume."""
    transport = playback.transport
    playback.waits = playback.compilation.waits(transport.steps_to_seek)
    if not playback.waits and transport.continue_seek(AT_ONCE):
        playback.go_on()
    elif transport.has_news():
        playback.changed = True
    return LOOK_AGAIN if playback.waits else 0.0


def _build(playback: Playback) -> float:
    playback.build()
    playback.changed = True
    return 0.0


def _continue_training(playback: Playback) -> float:
    if playback.compilation.waits(playback.steps_to_train):
        return LOOK_AGAIN
    playback.steps_to_train -= playback.transport.take_steps(playback.steps_to_train)
    if playback.steps_to_train == 0 or playback.group.current.run.over:
        playback.end_training()
    return 0.0


def _continue_rebuild(playback: Playback) -> float:
    if make_changes_that_waited(playback):
        return LOOK_AGAIN
    if playback.group.seeking:
        playback.seek()
    else:
        playback.go_on()
    return 0.0


def _continue_until(playback: Playback) -> float:
    condition, until, run = playback.condition, playback.clock() + CHUNK, playback.group.current.run
    while condition is not None and playback.condition is condition:
        before = run.step
        steps = min(condition.stride or condition.steps, condition.steps - before)
        playback.transport.take_steps(steps, condition.episodes - run.learner.episodes)
        playback.changed = True
        playback.keep_pins()
        playback.stop_if_due()
        if run.step > before and condition.is_over(run) and not run.over:
            playback.rest()
            if condition.until.event is Event.EPISODE:
                playback.group.current.begun_at = run.step
            if condition.until.event is not Event.EPISODE_END:
                playback.paused_by = until_in_words(condition.until, run.world)
        if playback.clock() >= until:
            break
    return 0.0


def _continue_running(playback: Playback) -> float | None:
    if not playback.automatic and not playback.on_the_way:
        return _stand_still(playback)
    run, before = playback.group.current.run, playback.group.current.run.step
    wait = playback.transport.keep_pace()
    if run.step > before or run.over:
        playback.changed = True
        playback.stop_if_due()
    return wait


def _stand_still(playback: Playback) -> float | None:
    if not playback.automatic:
        return None
    group = playback.group
    had_news = not group.trails_are_whole
    if had_news:
        group.find_trails(CHUNK)
    goes_on = had_news and not group.trails_are_whole
    if not goes_on and playback.questions.studied is not None:
        goes_on = playback.questions.work(group, playback.pins_beside.drawn)
    playback.changed = playback.changed or had_news or goes_on
    return 0.0 if goes_on else None


WORK: Final[Mapping[State, Callable[[Playback], float | None]]] = {
    State.BUILDING: _build,
    State.SEEKING: continue_seek,
    State.TRAINING: _continue_training,
    State.REBUILDING: _continue_rebuild,
    State.UNTIL: _continue_until,
    State.RUNNING: _continue_running,
    State.PAUSED: _stand_still,
    State.SPENT: _stand_still,
    State.DONE: _stand_still,
    State.STOPPED: _stand_still,
}
"""Work in each state. It returns the seconds until the next call, or None for never."""
