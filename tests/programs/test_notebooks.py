"""Notebooks as scripts."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest
from watched_scripts import LOOP, lines_of, script_in, watched

from rl_tui.common.errors import UserError
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.syntax import parsed_file
from rl_tui.programs.watched.child.script import check_script
from rl_tui.programs.watched.notebook import cell_of, place_in_words, read_notebook


def notebook_in(folder: Path, *cells: str, indent: int | None = 1, **more: Any) -> Path:
    said = []
    for each in cells:
        kind = "markdown" if each.startswith("text:") else "code"
        said.append({"cell_type": kind, "outputs": [], "source": each.splitlines(keepends=True)})
    path = folder / "course.ipynb"
    path.write_text(json.dumps({"cells": said, **more}, indent=indent))
    return path


def code_of(path: Path) -> list[str]:
    return [line for line in read_notebook(path).text.splitlines() if line]


def test_code_has_the_line_numbers_of_the_file(tmp_path: Path) -> None:
    path = notebook_in(tmp_path, "text: first\n\nlast", "x = 1\ny = 'ä'", "x = 1\nz = x")
    lines, code = path.read_text().splitlines(), read_notebook(path).text.splitlines()
    assert [(line, lines[place].strip()) for place, line in enumerate(code) if line] == [
        ("x = 1", r'"x = 1\n",'),
        ("y = 'ä'", r'''"y = '\u00e4'"'''),
        ("x = 1", r'"x = 1\n",'),
        ("z = x", '"z = x"'),
    ]
    assert cell_of(str(path), code.index("z = x") + 1) == (3, 2)


def test_a_notebook_in_one_line_is_read_too(tmp_path: Path) -> None:
    path = notebook_in(tmp_path, "x = 1", "text:", "y = 2\nz = 3", indent=None)
    assert read_notebook(path).text == "x = 1\ny = 2\nz = 3\n"
    assert place_in_words(str(path), 3) == "cell 3, line 2"


def test_a_notebook_with_large_outputs_is_parsed(tmp_path: Path) -> None:
    path = notebook_in(tmp_path, "x = 1", metadata={"picture": "A" * 2_000_000})
    tree = parsed_file(str(path))
    assert tree is not None
    assert [ast.unparse(each) for each in tree.body] == ["x = 1"]


def test_an_old_notebook_has_sheets(tmp_path: Path) -> None:
    path = tmp_path / "old.ipynb"
    path.write_text(json.dumps({"worksheets": [{"cells": [{"cell_type": "code", "input": "x = 1\ny = 2"}]}]}))
    assert code_of(path) == ["x = 1", "y = 2"]


@pytest.mark.parametrize(
    ("cell", "code"),
    [
        ("%%time\nx = 1", ["pass", "x = 1"]),
        ("\n%%capture out\nx = 1", ["pass", "x = 1"]),
        ("%%bash\nls", []),
        ("%%writefile a.py\nx = 1", []),
        ("if x:\n    files = !ls *.py", ["if x:", "    pass"]),
        ("np.zeros?", ["pass"]),
        ("??np.zeros", ["pass"]),
        ("x = 'why?'", ["x = 'why?'"]),
    ],
)
def test_lines_that_are_not_python_are_left_out(cell: str, code: list[str], tmp_path: Path) -> None:
    assert code_of(notebook_in(tmp_path, cell)) == code


@pytest.mark.parametrize("text", ["", "[]", '{"cells": 3}', '{"cells": [{}]}', "{", "null"])
def test_what_is_not_a_notebook_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "no.ipynb"
    path.write_text(text)
    with pytest.raises(UserError, match="not a Jupyter notebook"):
        read_notebook(path)


def test_a_notebook_in_another_language_is_refused(tmp_path: Path) -> None:
    path = notebook_in(tmp_path, "x <- 1", metadata={"kernelspec": {"language": "R"}})
    with pytest.raises(UserError, match="Python"):
        read_notebook(path)


@pytest.mark.process
def test_an_installation_without_a_sign_is_skipped(tmp_path: Path) -> None:
    log = watched(notebook_in(tmp_path, "pip install some-package", "print(1)"))
    assert (log.error, lines_of(log)) == (None, ["1"])
    assert log.notes[0] == "1 line that only notebooks understand is skipped"


def test_a_mistake_is_shown_as_the_cell_has_it(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r'cell 2, line 2: .* in "x = \(1"$'):
        check_script(notebook_in(tmp_path, "text: A mistake", "y = 'a'\nx = (1\n"))


@pytest.mark.process
def test_a_notebook_is_watched(tmp_path: Path) -> None:
    imports, *loop = LOOP.format(episodes=300).split("env =")
    path = notebook_in(
        tmp_path, "text: a lake", f"!pip install gymnasium\n{imports}", "%%time\nenv =" + "env =".join(loop)
    )
    log = watched(path)
    assert log.error is None
    assert log.notes[0] == "2 lines that only notebooks understand are skipped"
    update = verdict_of(log).update
    assert (update.alpha, update.gamma) == (pytest.approx(0.5), pytest.approx(0.9))
    assert cell_of(*log.called["step"]) == (3, 9)


@pytest.mark.process
def test_a_traceback_names_cells(tmp_path: Path) -> None:
    path = notebook_in(tmp_path, "def f():\n    return 1 / 0", "text:", "\nf()")
    error = watched(path).error
    assert f'"{path}, cell 3", line 2, in <module>\n    f()' in error.traceback
    assert f'"{path}, cell 1", line 2, in f\n    return 1 / 0' in error.traceback


@pytest.mark.process
def test_functions_and_modules_of_notebooks_do_no_harm(tmp_path: Path) -> None:
    text = """\
    get_ipython().run_line_magic("matplotlib", "inline")
    from IPython.display import clear_output, display as show
    import wandb
    wandb.init(project="x").log({"a": 1})
    with wandb.run as run:
        clear_output(wait=True)
    display("shown")
    print("done")
    """
    log = watched(script_in(tmp_path, text))
    assert (log.error, lines_of(log)) == (None, ["shown", "done"])
    assert "get_ipython() belongs to notebooks: its commands are skipped" in log.notes
    assert "wandb is not installed: its functions do nothing" in log.notes


@pytest.mark.process
def test_a_library_finds_no_notebook(tmp_path: Path) -> None:
    text = """\
    import os
    try:
        exec(compile("get_ipython()", os.__file__, "exec"))
    except NameError:
        print("none")
    """
    log = watched(script_in(tmp_path, text))
    assert (lines_of(log), len(log.notes)) == (["none"], 1)


@pytest.mark.process
def test_removed_names_work_and_are_noted(tmp_path: Path) -> None:
    (tmp_path / "pandas.py").write_text(
        "class Series:\n    pass\n\n\nclass DataFrame:\n    loc = 'located'\n\n\n"
        "def concat(frames, ignore_index):\n    return len(frames)\n"
    )
    text = """\
    import time, numpy as np, pandas as pd
    from collections import Mapping
    from fractions import gcd
    for _ in xrange(2):
        print(np.zeros(2, np.int).dtype, np.Inf, np.float_(1), isinstance({}, Mapping), gcd(4, 6))
    time.clock()
    print(pd.DataFrame().append(pd.DataFrame()), pd.DataFrame().ix)
    np.nothing
    """
    log = watched(script_in(tmp_path, text))
    assert lines_of(log) == ["int64 inf 1.0 True 2"] * 2 + ["2 located"]
    assert (log.error.type, log.error.line) == ("AttributeError", 8)
    expected = {
        "numpy.int": ("NumPy", "int"),
        "numpy.Inf": ("NumPy", "numpy.inf"),
        "collections.Mapping": ("Python", "collections.abc.Mapping"),
        "xrange": ("Python", "range"),
        "pandas.DataFrame.append": ("pandas", "pandas.concat"),
    }
    for name, (owner, now) in expected.items():
        assert f"{name} is not in this {owner}: {now} was used instead" in log.notes


@pytest.mark.process
def test_a_seed_of_another_type_is_read_as_text(tmp_path: Path) -> None:
    text = (
        "import random\nfor each in ((1, 2), '(1, 2)', 7):\n    random.seed(each); print(random.random())\n"
    )
    text += "    print(random.Random(each).random())\n"
    log = watched(script_in(tmp_path, text))
    (first, third, fifth), again = lines_of(log)[::2], lines_of(log)[1::2]
    assert [first, third, fifth] == again
    assert first == third != fifth
    assert (
        log.notes[0]
        == "random accepts a tuple as seed only in older versions of Python: its text was used instead"
    )


@pytest.mark.process
def test_an_array_of_one_number_converts_as_before(tmp_path: Path) -> None:
    text = """\
    import numpy as np
    print(int(np.random.randint(low=3, high=4, size=1)), float(np.full(1, 2.5)), int(np.minimum(4, 7)))
    print(int("11", base=2), int(str("12")), int(np.array([5])[0]))
    int(np.full(2, 1))
    """
    log = watched(script_in(tmp_path, text))
    assert lines_of(log) == ["3 2.5 4", "3 12 5"]
    assert (log.error.type, log.error.line) == ("TypeError", 4)
    assert log.notes == [
        "this version of NumPy does not turn an array into a number: its only entry was used instead"
    ]
