"""``import rl_tui`` registers scenarios in Gymnasium."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from shipped import SHIPPED

KNOWN = """
import json, sys
{imports}
before = sorted({{name.partition(".")[0] for name in sys.modules}})
names = [name for name in gymnasium.registry if name.startswith("rl_tui/")]
made = str(gymnasium.make("{id}"))
print(json.dumps([names, before, made]))
"""


def in_a_fresh_process(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True
    )
    return done.stdout


@pytest.mark.exhaustive("starts Python in every order", but=["import rl_tui, gymnasium"])
@pytest.mark.parametrize(
    "imports",
    [
        "import gymnasium, rl_tui",
        "import rl_tui, gymnasium",
        "import rl_tui.worlds.environments.registration, gymnasium",
        "import rl_tui, importlib.util\nimportlib.util.find_spec('gymnasium')\nimport gymnasium",
        "import rl_tui\nfrom gymnasium.envs.registration import registry\nimport gymnasium",
    ],
)
def test_scenarios_are_known_in_whichever_order_both_are_imported(imports: str) -> None:
    names, loaded, made = json.loads(in_a_fresh_process(KNOWN.format(imports=imports, id="rl_tui/cliff-v0")))
    assert set(names) == {f"rl_tui/{name}-v0" for name in SHIPPED}
    assert not set(loaded) & {"numba", "pydantic", "scipy", "textual"}
    assert "ScenarioEnv<rl_tui/cliff-v0>" in made


def test_an_id_may_name_the_module_to_import() -> None:
    code = "import gymnasium; print(gymnasium.make('rl_tui:rl_tui/cliff-v0'))"
    assert "ScenarioEnv<rl_tui/cliff-v0>" in in_a_fresh_process(code)


def test_several_are_made_at_once() -> None:
    code = """
import gymnasium, rl_tui
envs = gymnasium.make_vec("rl_tui/frozenlake-v0", num_envs=2, max_episode_steps=3)
print(envs.reset(seed=1)[0].tolist(), gymnasium.make_vec("rl_tui/taxi-v0", 2).spec.max_episode_steps)
"""
    assert in_a_fresh_process(code).split() == ["[0,", "0]", "200"]


def test_registering_reads_no_scenario() -> None:
    code = """
import gymnasium, rl_tui, sys
print("rl_tui.worlds.files.scenario" in sys.modules, "tomllib" in sys.modules)
"""
    assert in_a_fresh_process(code).split() == ["False", "False"]
