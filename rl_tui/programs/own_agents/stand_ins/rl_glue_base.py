"""The base class of agents in RL-Glue's shape, without requirements."""

from __future__ import annotations

from typing import Any


class BaseAgent:
    """A base class for RL-Glue agents."""

    def agent_init(self, agent_info: dict[str, Any] | None = None) -> None:
        """Prepare for learning. Nothing to do here."""

    def agent_cleanup(self) -> None:
        """Clean up after learning. Nothing to do here."""

    def agent_message(self, message: str) -> str:
        """Return the answer to `message`, which is empty here."""
        return ""
