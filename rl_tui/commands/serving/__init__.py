"""The server of ``rl-tui serve``: one app process per browser tab."""
