"""Where the program starts: ``rl-tui``, or ``python -m rl_tui``.

It looks out for ctrl+C first: the rest takes a tenth of a second to import.
"""

import os


def main() -> None:
    """Run rl-tui and exit."""
    try:
        from rl_tui.common.interrupts import leave_when_interrupted

        leave_when_interrupted()
    except KeyboardInterrupt:
        os._exit(130)
    from rl_tui.commands.main import main as run

    run()


if __name__ == "__main__":
    main()
