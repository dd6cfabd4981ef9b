"""rl-tui: watch a tabular reinforcement-learning agent learn, in any terminal.

With Gymnasium, ``import rl_tui`` makes every shipped scenario one of its environments: ``rl_tui/NAME-v0``.
"""

from rl_tui.common.after_import import import_after

__version__ = "0.1.0"

import_after("gymnasium", "rl_tui.worlds.environments.registration")
