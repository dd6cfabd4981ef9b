"""The base class of agents in RL-Glue's shape, without requirements."""

from __future__ import annotations

from typing import Any


class BaseAgent:
    """A base class for RL-Glue agents."""

    def agent_init(self, agent_info: dict[str, Any] | None = None) -> None:
        """Do nothing before learning."""

    def agent_cleanup(self) -> None:
        """Do nothing after learning."""

    def agent_message(self, message: str) -> str:
        """Return no answer to `message`."""
        return ""
