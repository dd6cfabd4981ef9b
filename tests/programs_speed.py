"""How fast scripts run while they are watched, beside how fast they run alone. Prints a table; no test.

The clock starts after 20,000 steps, when the lines that change the table have been looked for.

python tests/programs_speed.py [STEPS]
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rl_tui.lab.programs.program_process import ProgramRequest
from rl_tui.lab.programs.to_the_end import watched_to_the_end

RUNS = 5
LOOP = """
import sys, time, random
import gymnasium as gym, numpy as np
env = gym.make("{id}"); S, A = env.observation_space.n, env.action_space.n
q = {table}
begin = None
done = True
for t in range(int(sys.argv[1])):
    if t == 20_000: begin = time.perf_counter()
    if done: s, _ = env.reset()
    row = {row}
    a = env.action_space.sample() if random.random() < .1 else int(np.argmax(row))
    s2, r, te, tr, _ = env.step(a)
    best = 0 if te else max({next_row})
    {cell} += .1 * (r + .9 * best - {cell})
    s, done = s2, te or tr
print((t - 20_000) / (time.perf_counter() - begin), file=open(sys.argv[2], "w"))
"""
FORMS = {
    "array": ("np.zeros((S, A))", "q[s]", "q[s2]", "q[s, a]"),
    "lists": ("[[0.0] * A for _ in range(S)]", "q[s]", "q[s2]", "q[s][a]"),
    "dict of arrays": ("{i: np.zeros(A) for i in range(S)}", "q[s]", "q[s2]", "q[s][a]"),
    "dict of pairs": (
        "{(i, b): 0.0 for i in range(S) for b in range(A)}",
        "[q[s, b] for b in range(A)]",
        "[q[s2, b] for b in range(A)]",
        "q[s, a]",
    ),
}


def main(steps: int) -> None:
    """Run each script in turns alone and watched, and print the medians of steps a second."""
    with tempfile.TemporaryDirectory() as name:
        script, result = Path(name, "script.py"), Path(name, "result")
        arguments = (str(steps), str(result))
        print(f"{'':28}{'alone':>10}{'watched':>10}{'share':>8}")
        for world in ("FrozenLake-v1", "Taxi-v4"):
            for form, (table, row, next_row, cell) in FORMS.items():
                script.write_text(LOOP.format(id=world, table=table, row=row, next_row=next_row, cell=cell))
                alone, seen = [], []
                for _ in range(RUNS):
                    subprocess.run([sys.executable, str(script), *arguments], check=True)
                    alone.append(float(result.read_text()))
                    log = watched_to_the_end(ProgramRequest(script, arguments))
                    assert log.error is None, log.error
                    assert log.recording.count == steps
                    seen.append(float(result.read_text()))
                    time.sleep(0.1)
                a, w = statistics.median(alone), statistics.median(seen)
                print(f"{world + ', ' + form:28}{a:10,.0f}{w:10,.0f}{w / a:8.0%}", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 80_000)
