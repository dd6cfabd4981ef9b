"""``python -m rl_tui.cli``, for where the command is not on the path."""

from rl_tui.cli.main import main

if __name__ == "__main__":
    main()
