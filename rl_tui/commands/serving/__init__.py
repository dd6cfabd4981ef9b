"""The server behind ``rl-tui serve``: one app process for each browser tab."""
