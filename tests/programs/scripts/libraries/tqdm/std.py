"""Bars of a terminal."""

import sys


class tqdm:  # noqa: N801
    """Passes on what it iterates over, and writes one line again and again to stderr."""

    def __init__(self, iterable, desc="", leave=True):
        self.iterable, self.desc, self.leave = iterable, desc, leave

    def __iter__(self):
        for count, each in enumerate(self.iterable):
            if count % 100 == 0:
                sys.stderr.write(f"\r{self.desc}: {count}it")
            yield each
        sys.stderr.write("\n" if self.leave else "\r")


def trange(*bounds, **more):
    """Count, with a bar."""
    return tqdm(range(*bounds), **more)
