"""rl-tui with a Textual in which some private names are renamed, as a later version may do.

``python other_textual.py NAME,NAME play …``
"""

from __future__ import annotations

import re
import sys
from importlib.machinery import SourceFileLoader
from types import CodeType


def rename(names: list[str]) -> None:
    found = re.compile(rf"(?<!drivers\.)(?<!textual\.)\b(?:{'|'.join(map(re.escape, names))})\b".encode())
    get_code = SourceFileLoader.get_code

    def code_with_other_names(loader: SourceFileLoader, module: str) -> CodeType | None:
        if module.split(".")[0] == "textual":
            path = loader.get_filename(module)
            source = loader.get_data(path)
            if found.search(source):
                return loader.source_to_code(found.sub(rb"\g<0>_of_another_version", source), path)
        return get_code(loader, module)

    SourceFileLoader.get_code = code_with_other_names  # type: ignore[method-assign]


if __name__ == "__main__":
    rename(sys.argv[1].split(","))
    from rl_tui.commands.main import main

    del sys.argv[1]
    main()
