"""The base class of agents in RL-Glue's shape. It asks for nothing."""

from __future__ import annotations

from typing import Any


class BaseAgent:
    """An agent that RL-Glue knows."""

    def agent_init(self, agent_info: dict[str, Any] | None = None) -> None:
        """Prepare for learning; nothing to do here."""

    def agent_cleanup(self) -> None:
        """Clean up after learning; nothing to do here."""

    def agent_message(self, message: str) -> str:
        """Answer a ``message``; there is nothing to say here."""
        return ""
