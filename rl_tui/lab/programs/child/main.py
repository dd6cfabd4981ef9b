"""Where the process of a watched program begins."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rl_tui.lab.programs.child.channel import Channel
from rl_tui.lab.programs.child.environments.making import Making
from rl_tui.lab.programs.child.environments.seeding import seed_all
from rl_tui.lab.programs.child.faults import described
from rl_tui.lab.programs.child.gate import Gate
from rl_tui.lab.programs.child.recorder import Recorder
from rl_tui.lab.programs.child.script import run_script
from rl_tui.lab.programs.child.source import read_script
from rl_tui.lab.programs.child.surroundings import bound_memory, end_with, surround
from rl_tui.lab.programs.child.watchman import Watchman, flush_at_exit
from rl_tui.lab.programs.messages import MessageKind


def main(said: dict[str, Any]) -> None:
    """Run what was ``said`` (program_process.py), and tell of it until it is over."""
    channel = Channel(said["reports"])
    gate = Gate(channel, said["asked"], said["shared"])
    recorder = Recorder(channel, gate, most=said["steps"], wanted=said["table"])

    def note(text: str) -> None:
        channel.message(MessageKind.NOTE, text=text)

    end_with(said["life"])
    if said["memory"] is not None:
        bound_memory(said["memory"])
    surround(note)
    making = Making(recorder, said["seed"])
    making.install()
    seed_all(said["seed"])
    flush_at_exit(recorder)
    Watchman(channel, gate, recorder).begin()
    channel.message(MessageKind.STARTED)
    try:
        if said["agent"] is None:
            path = Path(said["path"])
            run_script(read_script(path), path, said["arguments"], note)
        else:
            from rl_tui.lab.programs.child.agent import run_agent

            run_agent(said, channel.message)
        making.tell_what_was_missed()
    except BaseException as error:
        channel.message(MessageKind.ERROR, **described(error))
    recorder.end()
