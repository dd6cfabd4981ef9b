"""Start the program by ``python -m rl_tui``."""

from rl_tui.commands.__main__ import main

if __name__ == "__main__":
    main()
